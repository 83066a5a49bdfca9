//! Sample numbers: addressed, not drawn in order.
//!
//! A number is a pure function of (seed, pixel, sample, vertex, dimension), so any subset of samples can be computed
//! anywhere, in any order, and a vertex that needs no number shifts none. Vertex 0 is the camera, vertex k + 1 the
//! surface reached by segment k + 1 of the path.
//!
//! | block | camera | surface |
//! |---|---|---|
//! | [`Block::Scatter`] | film x, film y, lens, lens | direction, direction, reflect or refract (glass) or whether to aim (diffuse), roulette |
//! | [`Block::Light`] | - | point on the light, point on the light, two that wait for use |
//!
//! How the numbers of the samples of one pixel relate to each other is a choice, [`SamplerKind`].

mod foreign;
mod philox;
mod sobol;

pub use foreign::{AddressedRng, ForeignSampler, NUMBERS_PER_VERTEX};
pub use philox::philox;

use philox::ROUNDS;
pub(crate) use sobol::Places;

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

/// How the numbers of the samples of one pixel relate to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Not at all: Philox. The error of a pixel falls with the root of the number of samples.
    #[default]
    Independent,
    /// They fill each block's space evenly: Sobol's sequence, scrambled anew for each seed, pixel, vertex and block. Every
    /// sample on its own is as random as an independent one and so is every picture unbiased, but samples of a pixel
    /// avoid each other: the error falls faster, most where few numbers matter, and at counts that are powers of two.
    Sobol,
}

/// What [`AddressedSampler`] gives for independent numbers.
#[inline(always)]
pub(crate) fn independent(seed: u64, x: u32, y: u32, sample: u32, vertex: u32, block: Block) -> [u32; 4] {
    philox::<ROUNDS>([pixel(x, y), sample, vertex, block as u32], key(seed))
}

/// Row and column, 16 bits each.
#[inline(always)]
fn pixel(x: u32, y: u32) -> u32 {
    (y << 16) | (x & 0xFFFF)
}

/// The seed, low half first.
#[inline(always)]
fn key(seed: u64) -> [u32; 2] {
    [seed as u32, (seed >> 32) as u32]
}

/// The kernel's own numbers.
#[derive(Clone, Copy, Debug)]
pub struct AddressedSampler {
    /// Where Sobol's numbers of the pixel are; `None` for independent ones.
    place: Option<sobol::Place>,
    /// The seed, low half first.
    key: [u32; 2],
    /// Row and column, 16 bits each.
    pixel: u32,
    sample: u32,
    vertex: u32,
}

impl AddressedSampler {
    /// The numbers of sample `sample` of the pixel in column `x` and row `y` (each below 65,536), independent of all
    /// others.
    #[inline]
    pub fn new(seed: u64, x: u32, y: u32, sample: u32) -> Self {
        Self { place: None, key: key(seed), pixel: pixel(x, y), sample, vertex: 0 }
    }

    /// The same address with numbers of another kind.
    #[inline]
    #[must_use]
    pub fn of_kind(self, kind: SamplerKind) -> Self {
        let place = match kind {
            SamplerKind::Independent => None,
            SamplerKind::Sobol => Some(sobol::Place::new(self.pixel, self.key)),
        };
        Self { place, ..self }
    }
}

impl Sampler for AddressedSampler {
    #[inline]
    fn begin_vertex(&mut self, vertex: u32) {
        self.vertex = vertex;
    }

    #[inline(always)]
    fn numbers(&self, block: Block) -> [u32; 4] {
        match &self.place {
            None => philox::<ROUNDS>([self.pixel, self.sample, self.vertex, block as u32], self.key),
            Some(place) => place.numbers([self.vertex, block as u32], self.sample),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_the_address_counts() {
        for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
            let sampler = |seed, x, y, sample| AddressedSampler::new(seed, x, y, sample).of_kind(kind);
            let base = sampler(1, 2, 3, 4).numbers(Block::Scatter);
            for other in [(0, 2, 3, 4), (1 << 40, 2, 3, 4), (1, 3, 3, 4), (1, 2, 2, 4), (1, 2, 3, 5)] {
                let (seed, x, y, sample) = other;
                assert_ne!(sampler(seed, x, y, sample).numbers(Block::Scatter), base);
            }
            let mut next = sampler(1, 2, 3, 4);
            assert_ne!(next.numbers(Block::Light), base);
            next.begin_vertex(1);
            assert_ne!(next.numbers(Block::Scatter), base);
        }
    }
}
