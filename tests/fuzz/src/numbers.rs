//! Numbers made of bytes: any bit pattern, and more often those that meet each other.

use arbitrary::{Arbitrary, Result, Unstructured};
use ocellus_kernel::Ray;
use ocellus_kernel::real::{Real, Vec3, Vector};

/// A precision that any bit pattern can be put into.
pub trait Float: Real {
    /// The number with these bits, or with the lowest of them.
    fn from_pattern(bits: u64) -> Self;
}

impl Float for f32 {
    fn from_pattern(bits: u64) -> Self {
        f32::from_bits(bits as u32)
    }
}

impl Float for f64 {
    fn from_pattern(bits: u64) -> Self {
        f64::from_bits(bits)
    }
}

/// A number of either precision. Arbitrary bits alone would hardly ever be equal, lie in a plane or on a line.
#[derive(Clone, Copy, Debug)]
pub enum Number {
    /// A multiple of 1/8.
    Grid(i8),
    /// A power of two, of either sign; beyond the range of f32 at both ends.
    Power(bool, i8),
    /// An end of some range.
    Special(u8),
    /// Any bits.
    Pattern(u64),
}

impl<'a> Arbitrary<'a> for Number {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        Ok(match bytes.arbitrary::<u8>()? {
            0..=127 => Self::Grid(bytes.arbitrary()?),
            kind @ 128..=175 => Self::Power(kind % 2 == 1, bytes.arbitrary()?),
            kind @ 176..=207 => Self::Special(kind % 16),
            208.. => Self::Pattern(bytes.arbitrary()?),
        })
    }
}

impl Number {
    /// In precision `R`.
    pub fn real<R: Float>(self) -> R {
        match self {
            Self::Grid(eighths) => R::from_f64(f64::from(eighths) / 8.0),
            Self::Power(negative, exponent) => {
                // Steps of two leave the range of f32; 2^k is exact in f64.
                let power = f64::from_bits(((1023 + 2 * i64::from(exponent)) as u64) << 52);
                R::from_f64(if negative { -power } else { power })
            }
            Self::Special(which) => {
                let infinity = R::from_f64(f64::INFINITY);
                let values = [
                    -R::ZERO,
                    infinity,
                    R::NAN,
                    R::MAX,
                    R::MIN_POSITIVE,
                    R::ZERO.next_up(),
                    R::ONE.next_up(),
                    R::ONE.next_down(),
                ];
                let value = values[usize::from(which % 8)];
                if which < 8 { value } else { -value }
            }
            Self::Pattern(bits) => R::from_pattern(bits),
        }
    }
}

/// Three of them as a vector.
pub fn vector<R: Float>(numbers: [Number; 3]) -> Vec3<R> {
    Vec3::<R>::from_array(numbers.map(Number::real))
}

/// A ray, perhaps at a point of the scene, perhaps with ends.
#[derive(Clone, Copy, Debug)]
pub struct AnyRay {
    origin: [Number; 3],
    direction: [Number; 3],
    /// Which point it starts at, and which it goes to.
    anchors: [Option<u8>; 2],
    ends: [Option<Number>; 2],
}

impl<'a> Arbitrary<'a> for AnyRay {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        let choices: u8 = bytes.arbitrary()?;
        let optional = |bit: u8, bytes: &mut Unstructured<'a>| -> Result<Option<Number>> {
            (choices & bit != 0).then(|| bytes.arbitrary()).transpose()
        };
        let ends = [optional(1, bytes)?, optional(2, bytes)?];
        let anchor = |wanted: bool, bytes: &mut Unstructured<'a>| wanted.then(|| bytes.arbitrary()).transpose();
        // One in four starts at a point of the scene, every other one goes to one, and so do those of bytes that ran out:
        // without a direction they would all be invalid.
        let anchors = [anchor(choices & 12 == 12, bytes)?, anchor(choices & 16 == 0, bytes)?];
        Ok(Self { origin: bytes.arbitrary()?, direction: bytes.arbitrary()?, anchors, ends })
    }
}

impl AnyRay {
    /// In precision `R`, among `points`.
    pub fn ray<R: Float>(&self, points: &[Vec3<R>]) -> Ray<R> {
        let point = |anchor: Option<u8>| points.get(usize::from(anchor?) % points.len().max(1)).copied();
        let origin = point(self.anchors[0]).unwrap_or(vector::<R>(self.origin));
        let direction = match point(self.anchors[1]) {
            Some(target) => target - origin,
            None => vector::<R>(self.direction),
        };
        let ray = Ray::new(origin, direction);
        Ray {
            tmin: self.ends[0].map_or(ray.tmin, Number::real),
            tmax: self.ends[1].map_or(ray.tmax, Number::real),
            ..ray
        }
    }
}
