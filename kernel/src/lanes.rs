//! Four numbers at once, for tests that only have to be conservative.
//!
//! On targets with four-lane registers glam's `Vec4` is one. Every operation here is lane by lane, so the lanes hold
//! the same numbers on every target; nothing is summed across them.

use core::fmt::Debug;
use core::ops::{Add, Mul, Sub};

/// Four numbers of precision `R`.
pub trait Lanes<R>:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Send + Sync + 'static
{
    /// Four zeros.
    const ZERO: Self;
    /// From numbers.
    fn new(values: [R; 4]) -> Self;
    /// All four equal.
    fn splat(value: R) -> Self;
    /// Bit k is set where, in one of the rows at least, lane k of the first is greater than that of the second in
    /// both pairs. A NaN is never greater, nor is anything greater than it.
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32;
}

impl Lanes<f32> for glam::Vec4 {
    const ZERO: Self = glam::Vec4::ZERO;

    #[inline]
    fn new(values: [f32; 4]) -> Self {
        glam::Vec4::from_array(values)
    }

    #[inline]
    fn splat(value: f32) -> Self {
        glam::Vec4::splat(value)
    }

    #[inline]
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32 {
        let both = rows.map(|[a, b]| a.0.cmpgt(a.1) & b.0.cmpgt(b.1));
        both.into_iter().reduce(|some, more| some | more).map_or(0, |mask| mask.bitmask())
    }
}

/// Four f64, in plain code that compilers turn into what registers there are.
#[derive(Clone, Copy, Debug)]
pub struct F64x4([f64; 4]);

impl F64x4 {
    #[inline]
    fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| operation(self.0[lane], other.0[lane])))
    }
}

impl Add for F64x4 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for F64x4 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for F64x4 {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Lanes<f64> for F64x4 {
    const ZERO: Self = Self([0.0; 4]);

    #[inline]
    fn new(values: [f64; 4]) -> Self {
        Self(values)
    }

    #[inline]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline]
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32 {
        let in_lane = |lane: usize| rows.iter().any(|row| row.iter().all(|(a, b)| a.0[lane] > b.0[lane]));
        (0..4).map(|lane| u32::from(in_lane(lane)) << lane).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_precisions_agree_and_nan_is_never_greater() {
        let values = [[1.0, -2.0, 3.0, 4.0], [5.0, 6.0, -7.0, 8.0], [9.0, f32::NAN, 11.0, -12.0]];
        let narrow = values.map(<glam::Vec4 as Lanes<f32>>::new);
        let wide = values.map(|values| F64x4::new(values.map(f64::from)));
        for (rows, expected) in [
            (&[(1, 0, 1, 0)][..], 0b1011),
            (&[(0, 2, 0, 2)], 0b1000),
            (&[(2, 0, 2, 1)], 0b0101),
            (&[(0, 1, 0, 1), (2, 0, 2, 1)], 0b0101),
            (&[(0, 1, 0, 1), (0, 2, 0, 2), (2, 1, 2, 1)], 0b1101),
        ] {
            let found: u32 = rows
                .iter()
                .map(|&(a, b, c, d)| {
                    let bits = Lanes::both_greater([[(narrow[a], narrow[b]), (narrow[c], narrow[d])]]);
                    assert_eq!(bits, F64x4::both_greater([[(wide[a], wide[b]), (wide[c], wide[d])]]));
                    bits
                })
                .fold(0, |all, bits| all | bits);
            assert_eq!(found, expected, "{rows:?}");
        }
        let row = |a: usize, b: usize| [(narrow[a], narrow[b]); 2];
        assert_eq!(Lanes::both_greater([row(0, 1), row(2, 0)]), 0b0101);
    }
}
