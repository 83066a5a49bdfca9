//! Four numbers at once, for tests that only have to be conservative.
//!
//! On targets with four-lane registers glam's `Vec4` is one. Every operation here is lane by lane, so the lanes hold
//! the same numbers on every target; nothing is summed across them.

use core::ops::{Add, Mul, Sub};

/// Four numbers of precision `R`.
pub trait Lanes<R>: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// All four equal.
    fn splat(value: R) -> Self;
    /// Four vectors of four components, transposed: the first result holds the first component of each.
    fn transpose(rows: [[R; 4]; 4]) -> [Self; 4];
    /// Magnitude of each.
    fn abs(self) -> Self;
    /// Bit k is set where lane k is greater than the other's; not where either is a NaN.
    fn greater(self, other: Self) -> u32;
}

impl Lanes<f32> for glam::Vec4 {
    #[inline]
    fn splat(value: f32) -> Self {
        glam::Vec4::splat(value)
    }

    #[inline]
    fn transpose(rows: [[f32; 4]; 4]) -> [Self; 4] {
        let columns = glam::Mat4::from_cols_array_2d(&rows).transpose();
        [columns.x_axis, columns.y_axis, columns.z_axis, columns.w_axis]
    }

    #[inline]
    fn abs(self) -> Self {
        glam::Vec4::abs(self)
    }

    #[inline]
    fn greater(self, other: Self) -> u32 {
        self.cmpgt(other).bitmask()
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
    #[inline]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline]
    fn transpose(rows: [[f64; 4]; 4]) -> [Self; 4] {
        core::array::from_fn(|component| Self(rows.map(|row| row[component])))
    }

    #[inline]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    #[inline]
    fn greater(self, other: Self) -> u32 {
        (0..4).map(|lane| u32::from(self.0[lane] > other.0[lane]) << lane).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_precisions_agree_and_nan_is_never_greater() {
        let rows = [[1.0, -2.0, 3.0, 4.0], [5.0, 6.0, -7.0, 8.0], [9.0, 10.0, 11.0, -12.0], [0.5, 0.25, f32::NAN, 1.0]];
        let narrow = <glam::Vec4 as Lanes<f32>>::transpose(rows);
        let wide = F64x4::transpose(rows.map(|row| row.map(f64::from)));
        let zero = (<glam::Vec4 as Lanes<f32>>::splat(0.0), F64x4::splat(0.0));
        for (component, expected) in [0b1111, 0b1110, 0b0101, 0b1011].into_iter().enumerate() {
            assert_eq!(Lanes::greater(narrow[component], zero.0), expected);
            assert_eq!(wide[component].greater(zero.1), expected);
        }
        assert_eq!(Lanes::greater(Lanes::abs(narrow[1]), zero.0), 0b1111);
    }
}
