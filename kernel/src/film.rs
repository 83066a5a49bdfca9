//! The film: what is kept of a pixel's samples, and the hash of a picture.

use crate::elementary::two_sum;
use crate::real::Vector;

/// A sum of f32 values as a pair of f64, exact while the values of one sum span less than about 2^56 in magnitude
/// (`high` is the sum rounded, `low` the rest); beyond that the last bit can depend on the order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ExactSum {
    high: f64,
    low: f64,
}

impl ExactSum {
    /// As [`ExactSum::merge`] of a sum whose rest is zero, where half of it has no effect.
    #[inline(always)]
    fn add(&mut self, value: f64) {
        let (sum, error) = two_sum(self.high, value);
        let (high, low) = two_sum(sum, error + self.low);
        *self = Self { high, low };
    }

    #[inline(always)]
    fn merge(&mut self, other: Self) {
        let (sum, error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let (sum, error) = two_sum(sum, error + low);
        let (high, low) = two_sum(sum, error + low_error);
        *self = Self { high, low };
    }
}

/// What is kept of a pixel: count, sum and sum of squares of its samples. 80 bytes.
///
/// A sample enters as f32 in both precisions. Sums do not depend on the order in which samples arrive or pixels are
/// merged, so any split of the work gives the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    sums: [ExactSum; 3],
    squares: [f64; 3],
    count: u32,
    non_finite: u32,
}

impl Pixel {
    /// A pixel without samples.
    pub const EMPTY: Self =
        Self { sums: [ExactSum { high: 0.0, low: 0.0 }; 3], squares: [0.0; 3], count: 0, non_finite: 0 };

    /// Adds a sample. One that is not finite is counted apart and enters no sum.
    #[inline(always)]
    pub fn add(&mut self, radiance: [f32; 3]) {
        if !radiance.iter().all(|x| x.is_finite()) {
            self.non_finite = self.non_finite.saturating_add(1);
            return;
        }
        self.count = self.count.saturating_add(1);
        for (channel, value) in radiance.into_iter().enumerate() {
            let value = f64::from(value);
            self.sums[channel].add(value);
            self.squares[channel] += value * value;
        }
    }

    /// Adds all samples of another pixel.
    pub fn merge(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        self.non_finite = self.non_finite.saturating_add(other.non_finite);
        for channel in 0..3 {
            self.sums[channel].merge(other.sums[channel]);
            self.squares[channel] += other.squares[channel];
        }
    }

    /// Number of finite samples.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Number of samples that were NaN or infinite.
    pub fn non_finite(&self) -> u32 {
        self.non_finite
    }

    /// Mean of the finite samples, linear Rec.709; 0 without samples.
    pub fn mean(&self) -> [f32; 3] {
        let count = f64::from(self.count.max(1));
        self.sums.map(|sum| ((sum.high + sum.low) / count) as f32)
    }

    /// Unbiased estimate of the variance of one sample, per channel; 0 below two samples. f64's quality: the order
    /// of samples can change its last bits.
    pub fn variance(&self) -> [f64; 3] {
        let count = f64::from(self.count);
        core::array::from_fn(|channel| {
            let sum = self.sums[channel].high;
            let spread = self.squares[channel] - sum * sum / count;
            if self.count < 2 || spread < 0.0 { 0.0 } else { spread / (count - 1.0) }
        })
    }
}

/// A sample as it enters the film.
#[inline]
pub(crate) fn to_sample<R: crate::real::Real>(radiance: R::Vec3) -> [f32; 3] {
    radiance.to_array().map(|x| x.to_f32())
}

/// The hash of a picture: FNV-1a, 64 bits, over width and height (u32) and the f32 means row by row, all
/// little-endian, with -0 as 0. The same on every target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageHash(u64);

impl ImageHash {
    /// Starts with the size of the picture.
    pub fn new(width: u32, height: u32) -> Self {
        let mut hash = Self(0xCBF2_9CE4_8422_2325);
        hash.bytes(width.to_le_bytes());
        hash.bytes(height.to_le_bytes());
        hash
    }

    /// Adds the next pixel.
    #[inline]
    pub fn add(&mut self, mean: [f32; 3]) {
        for value in mean {
            let value = if value == 0.0 { 0.0f32 } else { value };
            self.bytes(value.to_le_bytes());
        }
    }

    /// The hash of all that was added.
    pub fn finish(self) -> u64 {
        self.0
    }

    #[inline]
    fn bytes(&mut self, bytes: [u8; 4]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_takes_80_bytes() {
        assert_eq!(size_of::<Pixel>(), 80);
    }

    #[test]
    fn means_do_not_drift() {
        let mut pixel = Pixel::EMPTY;
        for _ in 0..1 << 20 {
            pixel.add([0.1, 1e6, 1e-4]);
        }
        assert_eq!(pixel.mean(), [0.1, 1e6, 1e-4]);
        assert_eq!(pixel.variance()[1], 0.0);
    }

    #[test]
    fn adding_a_sample_is_merging_a_pixel_of_it() {
        let (mut added, mut merged, mut state) = (Pixel::EMPTY, Pixel::EMPTY, 1u32);
        for k in 0..100_000 {
            // All signs and magnitudes, and now and then what was there before, taken away.
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let any = f32::from_bits(state);
            let sample = [any, -added.mean()[1] + any * 1e-8, if k % 3 == 0 { -0.0 } else { (state >> 8) as f32 }];
            if sample.iter().all(|x| x.is_finite()) {
                let mut one = Pixel::EMPTY;
                one.add(sample);
                added.add(sample);
                merged.merge(&one);
                let bits = |pixel: &Pixel| pixel.sums.map(|sum| [sum.high, sum.low].map(f64::to_bits));
                assert_eq!((added, bits(&added)), (merged, bits(&merged)), "{k}");
            }
        }
        assert!(added.count() > 90_000);
    }

    #[test]
    fn non_finite_samples_are_counted_apart() {
        let mut pixel = Pixel::EMPTY;
        pixel.add([1.0, 2.0, 3.0]);
        pixel.add([f32::NAN, 0.0, 0.0]);
        pixel.add([0.0, f32::INFINITY, 0.0]);
        assert_eq!((pixel.count(), pixel.non_finite(), pixel.mean()), (1, 2, [1.0, 2.0, 3.0]));
    }

    #[test]
    fn the_hash_is_fnv_1a_and_sees_size_order_and_value() {
        // FNV-1a of eight zero bytes.
        assert_eq!(ImageHash::new(0, 0).finish(), 0xA8C7_F832_281A_39C5);
        let of = |size: (u32, u32), pixels: &[[f32; 3]]| {
            let mut hash = ImageHash::new(size.0, size.1);
            pixels.iter().for_each(|pixel| hash.add(*pixel));
            hash.finish()
        };
        let base = of((2, 1), &[[1.0, 2.0, 3.0], [0.0; 3]]);
        assert_eq!(of((2, 1), &[[1.0, 2.0, 3.0], [-0.0; 3]]), base);
        assert_ne!(of((1, 2), &[[1.0, 2.0, 3.0], [0.0; 3]]), base);
        assert_ne!(of((2, 1), &[[0.0; 3], [1.0, 2.0, 3.0]]), base);
        assert_ne!(of((2, 1), &[[1.0, 2.0, 3.000_000_2], [0.0; 3]]), base);
    }
}
