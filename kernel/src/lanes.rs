//! Four numbers at once.
//!
//! On targets with four-lane registers glam's `Vec4` is one. Every operation is lane by lane, in the words that scalars
//! use, so that a lane holds the bits that a scalar would, on every target; nothing is ever summed across lanes.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Sub};

use crate::real;

/// What formulas ask of a number, or of several side by side.
pub trait Numbers: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The smaller of two; the first where they compare equal or not at all.
    fn lesser(self, other: Self) -> Self;
    /// The larger of two; the first where they compare equal or not at all.
    fn greater(self, other: Self) -> Self;
}

/// Four numbers of precision `R`.
pub trait Lanes<R>: Numbers + Debug + PartialEq + Send + Sync + 'static {
    /// Four zeros.
    const ZERO: Self;
    /// Four times the largest finite value.
    const MAX: Self;
    /// Four times the smallest finite value.
    const LOWEST: Self;
    /// Four times no number.
    const NAN: Self;
    /// From numbers.
    fn new(values: [R; 4]) -> Self;
    /// As numbers.
    fn to_array(self) -> [R; 4];
    /// All four equal.
    fn splat(value: R) -> Self;
    /// The magnitude of each.
    fn abs(self) -> Self;
    /// Bit k is set where, in one of the rows at least, lane k of the first is greater than that of the second in
    /// both pairs. A NaN is never greater, nor is anything greater than it.
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32;
    /// Bit k is set where, in all pairs, lane k of the first is at most that of the second. A NaN is never, nor is anything
    /// at most a NaN.
    fn all_at_most<const PAIRS: usize>(pairs: [(Self, Self); PAIRS]) -> u32;
}

impl Numbers for glam::Vec4 {
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        // With SSE the smaller of two is what it is here; elsewhere NaN and -0 may go other ways. (No bit of a hit comes
        // from lanes: they only leave out what cannot be one.)
        if cfg!(target_feature = "sse2") { other.min(self) } else { Self::select(other.cmplt(self), other, self) }
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        if cfg!(target_feature = "sse2") { other.max(self) } else { Self::select(other.cmpgt(self), other, self) }
    }
}

impl Lanes<f32> for glam::Vec4 {
    const ZERO: Self = glam::Vec4::ZERO;
    const MAX: Self = glam::Vec4::MAX;
    const LOWEST: Self = glam::Vec4::MIN;
    const NAN: Self = glam::Vec4::NAN;

    #[inline(always)]
    fn new(values: [f32; 4]) -> Self {
        glam::Vec4::from_array(values)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        glam::Vec4::to_array(&self)
    }

    #[inline(always)]
    fn splat(value: f32) -> Self {
        glam::Vec4::splat(value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        glam::Vec4::abs(self)
    }

    #[inline(always)]
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32 {
        let both = rows.map(|[a, b]| a.0.cmpgt(a.1) & b.0.cmpgt(b.1));
        both.into_iter().reduce(|some, more| some | more).map_or(0, |mask| mask.bitmask())
    }

    #[inline(always)]
    fn all_at_most<const PAIRS: usize>(pairs: [(Self, Self); PAIRS]) -> u32 {
        let at_most = pairs.map(|(a, b)| a.cmple(b));
        at_most.into_iter().reduce(|all, more| all & more).map_or(0b1111, |mask| mask.bitmask())
    }
}

macro_rules! one_number {
    ($($real:ty),*) => {
        $(impl Numbers for $real {
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                real::lesser(self, other)
            }

            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                real::greater(self, other)
            }
        })*
    };
}

one_number!(f32, f64);

/// Four f64, in plain code that compilers turn into what registers there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct F64x4([f64; 4]);

impl F64x4 {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| operation(self.0[lane], other.0[lane])))
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $name:ident;)*) => {
        $(impl $operator for F64x4 {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.zip(other, $operator::$name)
            }
        })*
    };
}

lane_by_lane! { Add add; Sub sub; Mul mul; Div div; }

impl Numbers for F64x4 {
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        self.zip(other, real::lesser)
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        self.zip(other, real::greater)
    }
}

impl Lanes<f64> for F64x4 {
    const ZERO: Self = Self([0.0; 4]);
    const MAX: Self = Self([f64::MAX; 4]);
    const LOWEST: Self = Self([f64::MIN; 4]);
    const NAN: Self = Self([f64::NAN; 4]);

    #[inline(always)]
    fn new(values: [f64; 4]) -> Self {
        Self(values)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        self.0
    }

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    #[inline(always)]
    fn both_greater<const ROWS: usize>(rows: [[(Self, Self); 2]; ROWS]) -> u32 {
        let in_lane = |lane: usize| rows.iter().any(|row| row.iter().all(|(a, b)| a.0[lane] > b.0[lane]));
        (0..4).map(|lane| u32::from(in_lane(lane)) << lane).sum()
    }

    #[inline(always)]
    fn all_at_most<const PAIRS: usize>(pairs: [(Self, Self); PAIRS]) -> u32 {
        let in_lane = |lane: usize| pairs.iter().fold(true, |all, (a, b)| all & (a.0[lane] <= b.0[lane]));
        (0..4).map(|lane| u32::from(in_lane(lane)) << lane).sum()
    }
}

/// The bits that are set, the lowest first.
#[inline(always)]
pub(crate) fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane as usize
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    #[test]
    fn both_precisions_agree_and_nan_is_neither_greater_nor_less() {
        let values = [[1.0, -2.0, 3.0, 4.0], [5.0, 6.0, -7.0, 8.0], [9.0, f32::NAN, 11.0, -12.0]];
        let narrow = values.map(<Vec4 as Lanes<f32>>::new);
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
        for (a, b, expected) in [(0, 1, 0b1011), (0, 2, 0b0101), (2, 2, 0b1101)] {
            assert_eq!(Lanes::all_at_most([(narrow[a], narrow[b]); 2]), expected);
            assert_eq!(F64x4::all_at_most([(wide[a], wide[b]); 2]), expected);
        }
        assert_eq!(Lanes::all_at_most([(narrow[0], narrow[1]), (narrow[1], narrow[0])]), 0);
    }

    #[test]
    fn each_lane_is_a_number_of_its_own() {
        let numbers = [0.0f32, -0.0, 1.5, -2.5, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-45];
        for (a, b) in numbers.into_iter().flat_map(|a| numbers.map(|b| (a, b))) {
            let lanes = [a, b].map(<Vec4 as Lanes<f32>>::splat);
            let wide = [a, b].map(|x| F64x4::splat(f64::from(x)));
            let check = |narrow: Vec4, wide: F64x4, expected: f32| {
                let is_it = |found: f32| found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
                assert!(narrow.to_array().into_iter().all(is_it), "{a} {b} {narrow}");
                assert!(wide.to_array().into_iter().all(|found| is_it(found as f32)), "{a} {b} {wide:?}");
            };
            check(lanes[0].lesser(lanes[1]), wide[0].lesser(wide[1]), real::lesser(a, b));
            check(lanes[0].greater(lanes[1]), wide[0].greater(wide[1]), real::greater(a, b));
            check(lanes[0] - lanes[1], wide[0] - wide[1], a - b);
            check(lanes[0] / lanes[1], wide[0] / wide[1], a / b);
        }
        assert!(set_bits(0b1001).eq([0, 3]));
    }
}
