//! Numbers and vectors of all lanes.

use crate::real::{Real, Vec3, Vector};

/// How many paths go side by side: enough that what a loop costs by itself is little, few enough that all of them stay in
/// the nearest cache.
pub(crate) const LANES: usize = 64;

/// A value of each lane.
pub(crate) type Column<T> = [T; LANES];

/// A vector of each lane.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<R: Real> {
    x: Column<R>,
    y: Column<R>,
    z: Column<R>,
}

impl<R: Real> Vectors<R> {
    /// (0, 0, 0) everywhere.
    pub(crate) const ZERO: Self = Self { x: [R::ZERO; LANES], y: [R::ZERO; LANES], z: [R::ZERO; LANES] };

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
