//! Rays and hits: what goes into the acceleration structure and what comes out.

use crate::real::{Real, Vec3, Vector};

/// A half-open part of a line, `origin + t direction` for `tmin < t <= tmax`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<R: Real> {
    /// Where t = 0, scene units.
    pub origin: Vec3<R>,
    /// Any non-zero length; t is a distance only where it is 1.
    pub direction: Vec3<R>,
    /// Exclusive lower end of t; zero or more.
    pub tmin: R,
    /// Inclusive upper end of t.
    pub tmax: R,
}

impl<R: Real> Ray<R> {
    /// From `origin` on, without end.
    #[inline]
    pub fn new(origin: Vec3<R>, direction: Vec3<R>) -> Self {
        Self { origin, direction, tmin: R::ZERO, tmax: R::MAX }
    }

    /// Whether the ray can hit anything: finite, with a direction, and `0 <= tmin <= tmax`. Others always miss.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // A NaN or an infinity times zero is NaN, and stays NaN through the sums.
        let poison = self.origin * R::ZERO + self.direction * R::ZERO;
        let finite = poison.x() + poison.y() + poison.z() == R::ZERO;
        let d = self.direction;
        let directed = d.x() != R::ZERO || d.y() != R::ZERO || d.z() != R::ZERO;
        finite && directed && self.has_range()
    }

    /// Whether `0 <= tmin <= tmax`.
    #[inline]
    pub(crate) fn has_range(&self) -> bool {
        self.tmin >= R::ZERO && self.tmax >= self.tmin
    }
}

/// The primitive number that stands for none.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// The result of a traversal: where on which primitive. [`crate::surface`] makes the rest of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Barycentric coordinate of the second corner (triangles; else 0).
    pub u: R,
    /// Barycentric coordinate of the third corner (triangles; else 0).
    pub v: R,
    /// Primitive number: spheres first, then triangles.
    pub primitive: u32,
}

impl<R: Real> Hit<R> {
    /// The state of a search before anything was found.
    #[inline]
    pub(crate) fn none(tmax: R) -> Self {
        Self { t: tmax, u: R::ZERO, v: R::ZERO, primitive: NO_PRIMITIVE }
    }

    /// Becomes `other` if that wins: nearer, or as near with a lower number. This tie rule is what makes the answer
    /// independent of the order of visits.
    #[inline]
    pub(crate) fn keep_closer(&mut self, other: Self) {
        if other.t < self.t || (other.t == self.t && other.primitive < self.primitive) {
            *self = other;
        }
    }
}
