//! Inputs, the same on every target, and the hash of outputs.

use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::sampler::philox;

/// The inputs of one query.
pub struct Numbers {
    counter: [u32; 4],
    block: [u32; 4],
    used: usize,
}

impl Numbers {
    /// The inputs of query number `query` of operation number `operation`.
    pub fn new(operation: u32, query: u32) -> Self {
        Self { counter: [query, operation, 0, 0], block: [0; 4], used: 4 }
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        if self.used == 4 {
            self.block = philox::<7>(self.counter, [1, 0]);
            self.counter[2] += 1;
            self.used = 0;
        }
        self.used += 1;
        self.block[self.used - 1]
    }

    /// Uniform in `0 <= x < 1`.
    pub fn unit<R: Real>(&mut self) -> R {
        R::from_unit_bits(self.bits())
    }

    /// Uniform in `-1 <= x < 1`.
    pub fn signed<R: Real>(&mut self) -> R {
        self.unit::<R>() * R::from_f64(2.0) - R::ONE
    }

    /// Of any sign and of magnitudes 2^-16 to 2^16; one in 16 is special: zeros, ones, tiny, huge.
    pub fn any<R: Real>(&mut self) -> R {
        const SPECIAL: [f64; 8] = [0.0, -0.0, 1.0, -1.0, 1e-30, -1e-40, 1e30, -1e18];
        let choice = self.bits();
        if choice & 15 == 0 {
            return R::from_f64(SPECIAL[(choice >> 4 & 7) as usize]);
        }
        let exponent = i64::from(choice >> 4 & 31) - 16;
        let scale = f64::from_bits(((1023 + exponent) as u64) << 52);
        self.signed::<R>() * R::from_f64(scale)
    }

    /// Three of `one`.
    pub fn vector<R: Real>(&mut self, one: impl Fn(&mut Self) -> R) -> Vec3<R> {
        let [x, y, z] = [one(self), one(self), one(self)];
        Vec3::<R>::new(x, y, z)
    }
}

/// FNV-1a over the bits of results.
pub struct Hash(u64);

impl Hash {
    /// Of nothing.
    pub fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    /// Adds an integer.
    pub fn integer(&mut self, value: u64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }

    /// Adds a number. Which NaN it is IEEE 754 leaves open, so all are one.
    pub fn real<R: Real>(&mut self, value: R) {
        let value = value.to_f64();
        self.integer(if value.is_nan() { u64::MAX } else { value.to_bits() });
    }

    /// Adds several numbers.
    pub fn reals<R: Real>(&mut self, values: impl IntoIterator<Item = R>) {
        values.into_iter().for_each(|value| self.real(value));
    }

    /// The hash of all that was added.
    pub fn finish(&self) -> u64 {
        self.0
    }
}
