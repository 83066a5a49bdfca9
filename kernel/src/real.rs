//! Precision is chosen here: the sealed trait [`Real`] for f32 and f64.
//!
//! Every operation is one IEEE 754 operation, an exact bit operation, or a routine of `elementary.rs` or of the `libm`
//! crate, so that its result is the same on every target.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::elementary::{sin_cos_turns, two_product, two_sum};

pub use crate::vector::{Vec3, Vector, WideVec3, narrow, vec3_from_f64, widen};

mod sealed {
    /// Keeps [`super::Real`] closed.
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A floating-point precision: f32 or f64.
pub trait Real:
    sealed::Sealed
    + crate::lanes::Numbers
    + Copy
    + Default
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Three components of this precision.
    type Vec3: Vector<Self>;
    /// Four numbers of this precision.
    type Lanes: crate::lanes::Lanes<Self>;
    /// The precision in which f32 forms what must be exact; f64 for both.
    type Wide: Real<Wide = Self::Wide>;
    /// Whether [`Real::Wide`] adds no bits, so that a formula has to be stable by itself.
    const WIDE_IS_SELF: bool;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The largest finite value.
    const MAX: Self;
    /// The smallest finite value, `-MAX`.
    const LOWEST: Self;
    /// Above all finite values.
    const INFINITY: Self;
    /// Not a number.
    const NAN: Self;
    /// The smallest positive value with a full significand.
    const MIN_POSITIVE: Self;
    /// Unit roundoff: half the distance from 1 to the next larger value.
    const UNIT_ROUNDOFF: Self;
    /// The nearest value to `x`.
    fn from_f64(x: f64) -> Self;
    /// The same value in f64; exact.
    fn to_f64(self) -> f64;
    /// The nearest f32.
    fn to_f32(self) -> f32;
    /// `bits / 2^32`, rounded down to this precision, hence in `0 <= x < 1`.
    fn from_unit_bits(bits: u32) -> Self;
    /// The same value in the wide precision; exact.
    fn widen(self) -> Self::Wide;
    /// The nearest value to a wide one.
    fn narrow(wide: Self::Wide) -> Self;
    /// Correctly rounded square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// Magnitude; exact.
    fn abs(self) -> Self;
    /// Largest integer not above; exact.
    fn floor(self) -> Self;
    /// The integer part, clamped to the range of i32; NaN gives 0.
    fn to_i32(self) -> i32;
    /// The last 32 bits of its encoding.
    fn last_bits(self) -> u32;
    /// This magnitude with the sign bit of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Whether the sign bit is set (-0 included).
    fn is_sign_negative(self) -> bool;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// The next larger value; bitwise.
    fn next_up(self) -> Self;
    /// The next smaller value; bitwise.
    fn next_down(self) -> Self;
    /// `a * b - c * d` whose sign is exact as long as no product over- or underflows.
    ///
    /// f32: the products are exact in f64. f64: both products are split into value and error (Dekker 1971).
    fn difference_of_products(a: Self, b: Self, c: Self, d: Self) -> Self::Wide;
    /// The squared length of a vector within `gamma(1)` of `Self`, as long as no square overflows and none that
    /// counts is below 2^-969 (f64), where its error underflows.
    ///
    /// f32: in f64. f64: with the errors of all squares and sums (Ogita, Rump, Oishi 2005).
    fn squared_length(v: [Self; 3]) -> Self::Wide;
    /// Sine and cosine of `2 pi self`, for `0 <= self <= 1`, within 1 ulp of 1.
    fn sin_cos_turns(self) -> (Self, Self);
    /// Natural logarithm, from the `libm` crate.
    fn ln(self) -> Self;
}

/// The smaller of two; the first where they compare equal or not at all.
#[inline]
pub fn lesser<R: Real>(a: R, b: R) -> R {
    if b < a { b } else { a }
}

/// The larger of two; the first where they compare equal or not at all.
#[inline]
pub fn greater<R: Real>(a: R, b: R) -> R {
    if b > a { b } else { a }
}

impl Real for f32 {
    type Vec3 = glam::Vec3;
    type Lanes = glam::Vec4;
    type Wide = f64;
    const WIDE_IS_SELF: bool = false;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f32::MAX;
    const LOWEST: Self = f32::MIN;
    const INFINITY: Self = f32::INFINITY;
    const NAN: Self = f32::NAN;
    const MIN_POSITIVE: Self = f32::MIN_POSITIVE;
    const UNIT_ROUNDOFF: Self = f32::EPSILON * 0.5;

    #[inline]
    fn from_f64(x: f64) -> Self {
        x as f32
    }

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn to_f32(self) -> f32 {
        self
    }

    #[inline]
    fn from_unit_bits(bits: u32) -> Self {
        (bits >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    #[inline]
    fn widen(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn narrow(wide: f64) -> Self {
        wide as f32
    }

    #[inline]
    fn sqrt(self) -> Self {
        glam::Vec2::new(self, 0.0).sqrt().x
    }

    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline]
    fn floor(self) -> Self {
        libm::floorf(self)
    }

    #[inline]
    fn to_i32(self) -> i32 {
        self as i32
    }

    #[inline]
    fn last_bits(self) -> u32 {
        self.to_bits()
    }

    #[inline]
    fn copysign(self, sign: Self) -> Self {
        f32::copysign(self, sign)
    }

    #[inline]
    fn is_sign_negative(self) -> bool {
        f32::is_sign_negative(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline]
    fn next_up(self) -> Self {
        f32::next_up(self)
    }

    #[inline]
    fn next_down(self) -> Self {
        f32::next_down(self)
    }

    #[inline]
    fn difference_of_products(a: Self, b: Self, c: Self, d: Self) -> f64 {
        f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)
    }

    #[inline]
    fn squared_length(v: [Self; 3]) -> f64 {
        let [x, y, z] = v.map(f64::from);
        x * x + y * y + z * z
    }

    #[inline]
    fn sin_cos_turns(self) -> (Self, Self) {
        let (sine, cosine) = sin_cos_turns::<6>(f64::from(self));
        (sine as f32, cosine as f32)
    }

    #[inline]
    fn ln(self) -> Self {
        libm::logf(self)
    }
}

impl Real for f64 {
    type Vec3 = glam::DVec3;
    type Lanes = crate::lanes::F64x4;
    type Wide = f64;
    const WIDE_IS_SELF: bool = true;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f64::MAX;
    const LOWEST: Self = f64::MIN;
    const INFINITY: Self = f64::INFINITY;
    const NAN: Self = f64::NAN;
    const MIN_POSITIVE: Self = f64::MIN_POSITIVE;
    const UNIT_ROUNDOFF: Self = f64::EPSILON * 0.5;

    #[inline]
    fn from_f64(x: f64) -> Self {
        x
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline]
    fn to_f32(self) -> f32 {
        self as f32
    }

    #[inline]
    fn from_unit_bits(bits: u32) -> Self {
        f64::from(bits) * (1.0 / 4_294_967_296.0)
    }

    #[inline]
    fn widen(self) -> f64 {
        self
    }

    #[inline]
    fn narrow(wide: f64) -> Self {
        wide
    }

    #[inline]
    fn sqrt(self) -> Self {
        glam::DVec2::new(self, 0.0).sqrt().x
    }

    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline]
    fn floor(self) -> Self {
        libm::floor(self)
    }

    #[inline]
    fn to_i32(self) -> i32 {
        self as i32
    }

    #[inline]
    fn last_bits(self) -> u32 {
        self.to_bits() as u32
    }

    #[inline]
    fn copysign(self, sign: Self) -> Self {
        f64::copysign(self, sign)
    }

    #[inline]
    fn is_sign_negative(self) -> bool {
        f64::is_sign_negative(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    #[inline]
    fn next_up(self) -> Self {
        f64::next_up(self)
    }

    #[inline]
    fn next_down(self) -> Self {
        f64::next_down(self)
    }

    #[inline]
    fn difference_of_products(a: Self, b: Self, c: Self, d: Self) -> f64 {
        let (p, p_error) = two_product(a, b);
        let (q, q_error) = two_product(c, d);
        (p - q) + (p_error - q_error)
    }

    #[inline]
    fn squared_length(v: [Self; 3]) -> f64 {
        let [(x, x_error), (y, y_error), (z, z_error)] = v.map(|x| two_product(x, x));
        let (xy, xy_error) = two_sum(x, y);
        let (all, all_error) = two_sum(xy, z);
        all + (x_error + y_error + z_error + xy_error + all_error)
    }

    #[inline]
    fn sin_cos_turns(self) -> (Self, Self) {
        sin_cos_turns::<10>(self)
    }

    #[inline]
    fn ln(self) -> Self {
        libm::log(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_within_an_ulp_of_libm() {
        for i in 0..=100_000u32 {
            let turns = f64::from(i) / 100_000.0;
            let angle = core::f64::consts::TAU * turns;
            let (sine, cosine) = turns.sin_cos_turns();
            assert!((sine - libm::sin(angle)).abs() < 1e-15, "sin of {turns} turns: {sine}");
            assert!((cosine - libm::cos(angle)).abs() < 1e-15, "cos of {turns} turns: {cosine}");
            let turns = turns as f32;
            let (s, c) = turns.sin_cos_turns();
            let angle = core::f64::consts::TAU * f64::from(turns);
            assert!((f64::from(s) - libm::sin(angle)).abs() <= 6e-8, "sin of {turns} turns: {s}");
            assert!((f64::from(c) - libm::cos(angle)).abs() <= 6e-8, "cos of {turns} turns: {c}");
        }
    }

    #[test]
    fn unit_numbers_never_reach_one() {
        assert_eq!(f32::from_unit_bits(u32::MAX), 1.0 - f32::UNIT_ROUNDOFF);
        assert!(f64::from_unit_bits(u32::MAX) < 1.0);
        assert_eq!(f32::from_unit_bits(0), 0.0);
    }

    #[test]
    fn squared_lengths_are_rounded_once() {
        // (1 + e)^2 + (1.5 + e)^2 + 1 = 4.25 + 5 e + 2 e^2, of which 4 e is a unit in the last place. A sum that rounds
        // each term is off by one.
        let [x, y] = [1.0f64.next_up(), 1.5f64.next_up()];
        assert_eq!(f64::squared_length([x, y, 1.0]), 4.25f64.next_up());
        assert_ne!(x * x + y * y + 1.0, 4.25f64.next_up());
        assert_eq!(f32::squared_length([3.0, 4.0, 12.0]), 169.0);
    }

    #[test]
    fn difference_of_products_has_the_exact_sign() {
        // (1 + e)(1 - e) - 1 = -e^2, which rounding each product alone would lose.
        let e = f32::EPSILON;
        assert!(f32::difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0) < 0.0);
        let e = f64::EPSILON;
        assert_eq!(f64::difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
    }
}
