//! The sample numbers of all lanes.

use super::columns::{Column, LANES};
use crate::effects::{EffectSet, Effects};
use crate::sampler::{AddressedSampler, Block, Sampler, SamplerKind, independent};

/// Where each lane is among the sample numbers.
pub(super) struct Addresses {
    seed: u64,
    row: u32,
    /// Whether numbers are independent: then all lanes' are made at once.
    independent: bool,
    pub(super) column: Column<u32>,
    pub(super) sample: Column<u32>,
    pub(super) sampler: Column<AddressedSampler>,
}

impl Addresses {
    pub(super) fn new(seed: u64, row: u32, kind: SamplerKind) -> Self {
        let independent = kind == SamplerKind::Independent;
        let sampler = [AddressedSampler::new(seed, 0, row, 0); LANES];
        Self { seed, row, independent, column: [0; LANES], sample: [0; LANES], sampler }
    }

    /// Whether samplers are not needed.
    #[inline(always)]
    pub(super) fn are_independent<E: EffectSet>(&self) -> bool {
        self.independent || const { !E::EFFECTS.contains(Effects::SOBOL) }
    }

    /// The four numbers of a block in each wanted lane.
    #[inline(always)]
    pub(super) fn numbers<E: EffectSet>(
        &mut self,
        vertex: &Column<u32>,
        block: Block,
        wanted: &Column<bool>,
    ) -> [Column<u32>; 4] {
        let mut numbers = [[0; LANES]; 4];
        if self.are_independent::<E>() {
            for lane in 0..LANES {
                let four = independent(self.seed, self.column[lane], self.row, self.sample[lane], vertex[lane], block);
                for (column, number) in numbers.iter_mut().zip(four) {
                    column[lane] = number;
                }
            }
        } else {
            for lane in 0..LANES {
                if wanted[lane] {
                    self.sampler[lane].begin_vertex(vertex[lane]);
                    for (column, number) in numbers.iter_mut().zip(self.sampler[lane].numbers(block)) {
                        column[lane] = number;
                    }
                }
            }
        }
        numbers
    }
}
