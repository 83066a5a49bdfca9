//! The sample numbers of all lanes.

use super::columns::{Column, GROUP, LANES};
use crate::effects::{EffectSet, Effects};
use crate::sampler::{Block, Places, SamplerKind, independent};

/// Where each lane is among the sample numbers.
pub(super) struct Addresses {
    seed: u64,
    row: u32,
    kind: SamplerKind,
    column: Column<u32>,
    sample: Column<u32>,
    /// Needed only where numbers are not independent.
    places: Places<LANES>,
}

impl Addresses {
    pub(super) fn new(seed: u64, row: u32, kind: SamplerKind) -> Self {
        Self { seed, row, kind, column: [0; LANES], sample: [0; LANES], places: Places::NONE }
    }

    /// Whether numbers are independent.
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
        let places = Places::new(self.seed, columns, self.row);
        for (k, &lane) in lanes.iter().enumerate() {
            self.places.set(lane, places.at(k));
        }
        places.numbers(&[0; GROUP], Block::Scatter, samples)
    }

    /// The four numbers of a block in each lane.
    #[inline(always)]
    pub(super) fn numbers<E: EffectSet>(&self, vertex: &Column<u32>, block: Block) -> [Column<u32>; 4] {
        if self.are_independent::<E>() {
            return self.independent(&self.column, &self.sample, vertex, block);
        }
        self.places.numbers(vertex, block, &self.sample)
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
            let four = independent(self.seed, columns[k], self.row, samples[k], vertices[k], block);
            for (column, number) in numbers.iter_mut().zip(four) {
                column[k] = number;
            }
        }
        numbers
    }
}
