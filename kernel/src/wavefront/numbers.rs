//! The sample numbers of all lanes.

use super::columns::{Column, GROUP, LANES};
use crate::effects::{EffectSet, Effects};
use crate::sampler::{Block, Places, SamplerKind, independent, place};

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
        let mut places = Places::<GROUP>::NONE;
        for k in 0..GROUP {
            place(&mut places, k, self.seed, columns[k], self.row);
        }
        for (k, &lane) in lanes.iter().enumerate() {
            self.places.copy(lane, &places, k);
        }
        places.numbers(&[0; GROUP], Block::Scatter as u32, samples)
    }

    /// The four numbers of a block in each lane.
    #[inline(always)]
    pub(super) fn numbers<E: EffectSet>(&self, vertex: &Column<u32>, block: Block) -> [Column<u32>; 4] {
        if self.are_independent::<E>() {
            return self.independent(&self.column, &self.sample, vertex, block);
        }
        let mut numbers = [[0; LANES]; 4];
        for group in (0..LANES).step_by(GROUP) {
            let [vertices, samples] = [vertex, &self.sample].map(|column| core::array::from_fn(|k| column[group + k]));
            let of_group = self.places.part::<GROUP>(group).numbers(&vertices, block as u32, &samples);
            for (column, own) in numbers.iter_mut().zip(&of_group) {
                column[group..group + GROUP].copy_from_slice(own);
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
