//! Numbers and vectors of all lanes.

use crate::real::{Real, Vec3, Vector};

/// How many paths go side by side: enough that what a loop costs by itself is little, few enough that all of them stay in
/// the nearest cache.
pub(crate) const LANES: usize = 64;

/// A value of each lane.
pub(crate) type Column<T> = [T; LANES];

/// How many lanes are taken together where not all have something to do: a vector's worth.
pub(crate) const GROUP: usize = 16;

/// The lanes that `are`, in order, and how many.
#[inline(always)]
pub(crate) fn lanes_that(are: impl Fn(usize) -> bool) -> ([usize; LANES], usize) {
    let (mut lanes, mut count) = ([0; LANES], 0);
    for lane in 0..LANES {
        lanes[count % LANES] = lane;
        count += usize::from(are(lane));
    }
    (lanes, count)
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
