//! The sample numbers of all lanes.

use super::columns::{Column, GROUP, LANES};
use crate::effects::{EffectSet, Effects};
use crate::sampler::{AddressedSampler, Block, Sampler, SamplerKind, independent};

/// Where each lane is among the sample numbers.
pub(super) struct Addresses {
    seed: u64,
    row: u32,
    kind: SamplerKind,
    column: Column<u32>,
    sample: Column<u32>,
    /// Needed only where numbers are not independent.
    sampler: Column<AddressedSampler>,
}

impl Addresses {
    pub(super) fn new(seed: u64, row: u32, kind: SamplerKind) -> Self {
        let sampler = [AddressedSampler::new(seed, 0, row, 0); LANES];
        Self { seed, row, kind, column: [0; LANES], sample: [0; LANES], sampler }
    }

    /// Whether numbers are independent: then all lanes' are made at once.
    #[inline(always)]
    fn are_independent<E: EffectSet>(&self) -> bool {
        self.kind == SamplerKind::Independent || const { !E::EFFECTS.contains(Effects::SOBOL) }
    }

    /// Moves the lanes of a group to samples of pixels; the numbers of their cameras.
    #[inline(always)]
    pub(super) fn start<E: EffectSet>(
        &mut self,
        lanes: &[usize],
        columns: &[u32; GROUP],
        samples: &[u32; GROUP],
    ) -> [[u32; GROUP]; 4] {
        for (k, &lane) in lanes.iter().enumerate() {
            self.column[lane] = columns[k];
            self.sample[lane] = samples[k];
        }
        if self.are_independent::<E>() {
            return self.independent(columns, samples, &[0; GROUP], Block::Scatter);
        }
        let mut numbers = [[0; GROUP]; 4];
        for (k, &lane) in lanes.iter().enumerate() {
            self.sampler[lane] = AddressedSampler::new(self.seed, columns[k], self.row, samples[k]).of_kind(self.kind);
            put(&mut numbers, k, self.sampler[lane].numbers(Block::Scatter));
        }
        numbers
    }

    /// The four numbers of a block in each wanted lane.
    #[inline(always)]
    pub(super) fn numbers<E: EffectSet>(
        &mut self,
        vertex: &Column<u32>,
        block: Block,
        wanted: &Column<bool>,
    ) -> [Column<u32>; 4] {
        if self.are_independent::<E>() {
            return self.independent(&self.column, &self.sample, vertex, block);
        }
        let mut numbers = [[0; LANES]; 4];
        for lane in 0..LANES {
            if wanted[lane] {
                self.sampler[lane].begin_vertex(vertex[lane]);
                put(&mut numbers, lane, self.sampler[lane].numbers(block));
            }
        }
        numbers
    }

    #[inline(always)]
    fn independent<const N: usize>(
        &self,
        columns: &[u32; N],
        samples: &[u32; N],
        vertices: &[u32; N],
        block: Block,
    ) -> [[u32; N]; 4] {
        let mut numbers = [[0; N]; 4];
        for k in 0..N {
            put(&mut numbers, k, independent(self.seed, columns[k], self.row, samples[k], vertices[k], block));
        }
        numbers
    }
}

/// Puts four numbers at the same place of four columns.
#[inline(always)]
fn put<const N: usize>(columns: &mut [[u32; N]; 4], at: usize, four: [u32; 4]) {
    for (column, number) in columns.iter_mut().zip(four) {
        column[at] = number;
    }
}
