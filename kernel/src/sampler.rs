//! Sample numbers: addressed, not drawn in order.
//!
//! A number is a pure function of (seed, pixel, sample, vertex, dimension), so any subset of samples can be computed
//! anywhere, in any order, and a vertex that needs no number shifts none. Vertex 0 is the camera, vertex k + 1 the
//! surface reached by segment k + 1 of the path.
//!
//! | block | camera | surface |
//! |---|---|---|
//! | [`Block::Scatter`] | film x, film y, lens, lens | direction, direction, reflect or refract, roulette |
//! | [`Block::Light`] | - | point on the light, point on the light, two that wait for use |

use core::convert::Infallible;
use rand_core::{Rng, TryRng};

/// Which four numbers of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// What decides how the path goes on.
    Scatter = 0,
    /// What decides which point of a light is looked at.
    Light = 1,
}

/// A source of the numbers of one path.
pub trait Sampler {
    /// Moves to a vertex. Vertices are visited in order, from 0.
    fn begin_vertex(&mut self, vertex: u32);
    /// Four numbers of the vertex, each `0 <= n < 2^32`.
    fn numbers(&self, block: Block) -> [u32; 4];
}

/// Rounds of [`philox`]: the fewest with which it passes BigCrush (Salmon et al., SC 2011, table 2).
const ROUNDS: usize = 7;

/// Philox4x32 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3. SC 2011).
#[inline]
pub fn philox<const ROUNDS: usize>(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let multiply = |a: u32, b: u32| {
        let product = u64::from(a) * u64::from(b);
        ((product >> 32) as u32, product as u32)
    };
    let ([mut a, mut b, mut c, mut d], [mut k, mut l]) = (counter, key);
    for _ in 0..ROUNDS {
        let (high_a, low_a) = multiply(0xD251_1F53, a);
        let (high_c, low_c) = multiply(0xCD9E_8D57, c);
        [a, b, c, d] = [high_c ^ b ^ k, low_c, high_a ^ d ^ l, low_a];
        k = k.wrapping_add(0x9E37_79B9);
        l = l.wrapping_add(0xBB67_AE85);
    }
    [a, b, c, d]
}

/// The kernel's own numbers: independent for each seed, pixel, sample, vertex and dimension.
#[derive(Clone, Copy, Debug)]
pub struct AddressedSampler {
    key: [u32; 2],
    pixel: u32,
    sample: u32,
    vertex: u32,
}

impl AddressedSampler {
    /// The numbers of sample `sample` of the pixel in column `x` and row `y` (each below 65,536).
    #[inline]
    pub fn new(seed: u64, x: u32, y: u32, sample: u32) -> Self {
        Self { key: [seed as u32, (seed >> 32) as u32], pixel: (y << 16) | (x & 0xFFFF), sample, vertex: 0 }
    }
}

impl Sampler for AddressedSampler {
    #[inline]
    fn begin_vertex(&mut self, vertex: u32) {
        self.vertex = vertex;
    }

    #[inline]
    fn numbers(&self, block: Block) -> [u32; 4] {
        philox::<ROUNDS>([self.pixel, self.sample, self.vertex, block as u32], self.key)
    }
}

/// The same numbers as a `rand_core` generator: all blocks of vertex 0, then of vertex 1, and so on.
#[derive(Clone, Debug)]
pub struct AddressedRng {
    sampler: AddressedSampler,
    next: u32,
}

impl AddressedRng {
    /// Starts at the first number of a path.
    pub fn new(sampler: AddressedSampler) -> Self {
        Self { sampler, next: 0 }
    }
}

impl TryRng for AddressedRng {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let (vertex, lane) = (self.next / NUMBERS_PER_VERTEX as u32, self.next as usize % NUMBERS_PER_VERTEX);
        self.next = self.next.wrapping_add(1);
        self.sampler.begin_vertex(vertex);
        let block = if lane < 4 { Block::Scatter } else { Block::Light };
        Ok(self.sampler.numbers(block)[lane % 4])
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        rand_core::utils::next_u64_via_u32(self)
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        rand_core::utils::fill_bytes_via_next_word(destination, || self.try_next_u32())
    }
}

/// Numbers that a foreign generator is asked for at each vertex, used or not, so that a missing effect shifts none.
pub const NUMBERS_PER_VERTEX: usize = 8;

/// Drives the kernel with any `rand_core` generator.
#[derive(Clone, Debug)]
pub struct ForeignSampler<G> {
    generator: G,
    numbers: [[u32; 4]; 2],
}

impl<G: Rng> ForeignSampler<G> {
    /// Takes the generator as it stands.
    pub fn new(generator: G) -> Self {
        Self { generator, numbers: [[0; 4]; 2] }
    }
}

impl<G: Rng> Sampler for ForeignSampler<G> {
    fn begin_vertex(&mut self, _vertex: u32) {
        for number in self.numbers.as_flattened_mut() {
            *number = self.generator.next_u32();
        }
    }

    fn numbers(&self, block: Block) -> [u32; 4] {
        self.numbers[block as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_known_answers() {
        // From the test vectors published with Random123.
        assert_eq!(philox::<10>([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox::<7>([0; 4], [0; 2]), [0x5f6f_b709, 0x0d89_3f64, 0x4f12_1f81, 0x4f73_0a48]);
        let pi = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let key = [0xa409_3822, 0x299f_31d0];
        assert_eq!(philox::<10>(pi, key), [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }

    #[test]
    fn a_foreign_generator_reads_the_same_numbers_in_the_same_order() {
        let mut own = AddressedSampler::new(7, 3, 5, 11);
        let mut foreign = ForeignSampler::new(AddressedRng::new(own));
        for vertex in 0..4 {
            own.begin_vertex(vertex);
            foreign.begin_vertex(vertex);
            for block in [Block::Scatter, Block::Light] {
                assert_eq!(own.numbers(block), foreign.numbers(block));
            }
        }
    }

    #[test]
    fn every_part_of_the_address_counts() {
        let base = AddressedSampler::new(1, 2, 3, 4).numbers(Block::Scatter);
        for other in [(0, 2, 3, 4), (1 << 40, 2, 3, 4), (1, 3, 3, 4), (1, 2, 2, 4), (1, 2, 3, 5)] {
            let (seed, x, y, sample) = other;
            assert_ne!(AddressedSampler::new(seed, x, y, sample).numbers(Block::Scatter), base);
        }
        let mut next = AddressedSampler::new(1, 2, 3, 4);
        assert_ne!(next.numbers(Block::Light), base);
        next.begin_vertex(1);
        assert_ne!(next.numbers(Block::Scatter), base);
    }
}
