//! Numbers and vectors of all lanes.

use crate::real::{Real, Vec3, Vector};

/// How many paths go side by side: enough that what a loop costs by itself is little, few enough that all of them stay in
/// the nearest cache.
pub(crate) const LANES: usize = 64;

/// A value of each lane.
pub(crate) type Column<T> = [T; LANES];

/// How many lanes are taken together where not all have something to do: a vector's worth.
pub(crate) const GROUP: usize = 16;

/// Some of the lanes.
#[derive(Clone, Copy)]
pub(crate) struct Lanes(u64);

impl Lanes {
    /// Those that `are`.
    #[inline(always)]
    pub(crate) fn that(are: impl Fn(usize) -> bool) -> Self {
        const { assert!(LANES == u64::BITS as usize) };
        let mut bits = 0;
        for lane in 0..LANES {
            bits |= u64::from(are(lane)) << lane;
        }
        Self(bits)
    }

    /// The next of up to [`GROUP`] of them, and how many; they are taken away.
    #[inline(always)]
    pub(crate) fn next_group(&mut self) -> ([usize; GROUP], usize) {
        let (mut group, mut count) = ([0; GROUP], 0);
        for (at, lane) in group.iter_mut().zip(&mut *self) {
            *at = lane;
            count += 1;
        }
        (group, count)
    }
}

impl Iterator for Lanes {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}

/// A vector of each lane, or of each of a group.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<R: Real, const N: usize = LANES> {
    x: [R; N],
    y: [R; N],
    z: [R; N],
}

impl<R: Real, const N: usize> Vectors<R, N> {
    /// (0, 0, 0) everywhere.
    pub(crate) const ZERO: Self = Self { x: [R::ZERO; N], y: [R::ZERO; N], z: [R::ZERO; N] };

    #[inline(always)]
    pub(crate) fn at(&self, lane: usize) -> Vec3<R> {
        Vector::new(self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, value: Vec3<R>) {
        self.x[lane] = value.x();
        self.y[lane] = value.y();
        self.z[lane] = value.z();
    }
}
