//! Random numbers of the tests' own, so that the kernel's generator is not its own judge.

/// SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `0 <= x < 1`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the cube -1..1.
    pub(crate) fn in_cube(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-1.0, 1.0))
    }

    /// Uniform on the unit sphere (Marsaglia 1972).
    pub(crate) fn on_sphere(&mut self) -> [f64; 3] {
        loop {
            let [x, y] = [self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
            let square = x * x + y * y;
            if square < 1.0 {
                let root = (1.0 - square).sqrt();
                return [2.0 * x * root, 2.0 * y * root, 1.0 - 2.0 * square];
            }
        }
    }

    /// Positive weights of a triangle's corners that add to about 1.
    pub(crate) fn barycentric(&mut self) -> [f64; 3] {
        let [a, b] = [self.unit(), self.unit()];
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        [1.0 - a - b, a, b]
    }
}
