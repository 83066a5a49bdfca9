//! Vectors of three components, in both precisions: glam's plain scalar ones.

use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

use crate::real::{Real, greater};

/// Three components. Only arithmetic whose order is written here or in the caller.
pub trait Vector<R: Real>:
    Copy
    + Default
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<R, Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// (0, 0, 0).
    const ZERO: Self;
    /// (1, 1, 1).
    const ONE: Self;
    /// From components.
    fn new(x: R, y: R, z: R) -> Self;
    /// All components equal.
    fn splat(value: R) -> Self;
    /// First component.
    fn x(self) -> R;
    /// Second component.
    fn y(self) -> R;
    /// Third component.
    fn z(self) -> R;
    /// Scalar product, `(x x' + y y') + z z'`.
    fn dot(self, other: Self) -> R;
    /// Vector product.
    fn cross(self, other: Self) -> Self;
    /// Magnitude of each component.
    fn abs(self) -> Self;

    /// As an array.
    #[inline]
    fn to_array(self) -> [R; 3] {
        [self.x(), self.y(), self.z()]
    }

    /// From an array.
    #[inline]
    fn from_array([x, y, z]: [R; 3]) -> Self {
        Self::new(x, y, z)
    }

    /// Whether no component is NaN or infinite.
    #[inline]
    fn is_finite(self) -> bool {
        self.x().is_finite() && self.y().is_finite() && self.z().is_finite()
    }

    /// The largest component; a NaN loses.
    #[inline]
    fn max_component(self) -> R {
        greater(greater(self.x(), self.y()), self.z())
    }
}

/// A vector of precision `R`.
pub type Vec3<R> = <R as Real>::Vec3;
/// A vector of the precision in which `R` forms what must be exact.
pub type WideVec3<R> = <<R as Real>::Wide as Real>::Vec3;

/// The same vector in the wide precision; exact.
#[inline(always)]
pub fn widen<R: Real>(v: Vec3<R>) -> WideVec3<R> {
    Vector::new(v.x().widen(), v.y().widen(), v.z().widen())
}

/// The nearest vector to a wide one.
#[inline(always)]
pub fn narrow<R: Real>(v: WideVec3<R>) -> Vec3<R> {
    Vector::new(R::narrow(v.x()), R::narrow(v.y()), R::narrow(v.z()))
}

/// From f64 components, each rounded to nearest.
#[inline]
pub fn vec3_from_f64<R: Real>(v: [f64; 3]) -> Vec3<R> {
    Vector::new(R::from_f64(v[0]), R::from_f64(v[1]), R::from_f64(v[2]))
}

/// The same forwarding for both of glam's plain scalar vectors.
macro_rules! vector {
    ($real:ty, $vector:ty) => {
        impl Vector<$real> for $vector {
            const ZERO: Self = <$vector>::ZERO;
            const ONE: Self = <$vector>::ONE;

            #[inline]
            fn new(x: $real, y: $real, z: $real) -> Self {
                <$vector>::new(x, y, z)
            }

            #[inline]
            fn splat(value: $real) -> Self {
                <$vector>::splat(value)
            }

            #[inline]
            fn x(self) -> $real {
                self.x
            }

            #[inline]
            fn y(self) -> $real {
                self.y
            }

            #[inline]
            fn z(self) -> $real {
                self.z
            }

            #[inline]
            fn dot(self, other: Self) -> $real {
                <$vector>::dot(self, other)
            }

            #[inline]
            fn cross(self, other: Self) -> Self {
                <$vector>::cross(self, other)
            }

            #[inline]
            fn abs(self) -> Self {
                <$vector>::new(self.x.abs(), self.y.abs(), self.z.abs())
            }
        }
    };
}

vector!(f32, glam::Vec3);
vector!(f64, glam::DVec3);
