//! To and from the generators of `rand_core`.

use core::convert::Infallible;
use rand_core::{Rng, TryRng};

use super::{AddressedSampler, Block, Sampler};

/// The kernel's own numbers as a `rand_core` generator: all blocks of vertex 0, then of vertex 1, and so on.
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
}
