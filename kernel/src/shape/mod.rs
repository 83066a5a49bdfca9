//! The primitives of a scene and the ray in the form that their tests want. ADD A SHAPE HERE.

pub mod sphere;
pub mod triangle;

use crate::bvh::Bounds;
use crate::effects::{EffectSet, Effects};
use crate::error::GeometryError;
use crate::ray::{Hit, Ray};
use crate::real::{Real, Vec3, Vector, WideVec3, greater, widen};

pub use sphere::Sphere;
pub use triangle::{Shear, TriangleAttributes};

/// A ray with all that is computed once per query.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay<R: Real> {
    /// Origin, scene units.
    pub origin: [R; 3],
    /// One over each component of the direction; infinite with its sign where that is zero.
    pub inverse: [R; 3],
    /// 1 where the direction's sign bit is set, else 0: the corner that a slab is entered through.
    pub negative: [usize; 3],
    /// Exclusive lower end of t.
    pub tmin: R,
    wide_origin: WideVec3<R>,
    wide_direction: WideVec3<R>,
    /// One over the squared length of the direction.
    inverse_square: R::Wide,
    shear: Shear<R>,
}

impl<R: Real> PreparedRay<R> {
    /// Computes what the tests share.
    #[inline]
    pub fn new(ray: &Ray<R>) -> Self {
        let direction = ray.direction.to_array();
        let wide_direction = widen::<R>(ray.direction);
        Self {
            origin: ray.origin.to_array(),
            inverse: direction.map(|d| R::ONE / d),
            negative: direction.map(|d| usize::from(d.is_sign_negative())),
            tmin: ray.tmin,
            wide_origin: widen::<R>(ray.origin),
            wide_direction,
            inverse_square: R::Wide::ONE / wide_direction.dot(wide_direction),
            shear: Shear::new(ray),
        }
    }
}

/// The primitives: spheres, then triangles. Indices were checked when it was made.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a, R: Real> {
    spheres: &'a [Sphere<R>],
    positions: &'a [Vec3<R>],
    triangles: &'a [[u32; 3]],
}

impl<'a, R: Real> Geometry<'a, R> {
    /// Borrows spheres and triangles; `triangles` index `positions`, counter-clockwise seen from the front.
    ///
    /// # Errors
    /// An index out of range, a sphere without a finite centre and a positive finite radius, or more than 2^31
    /// primitives. A triangle may be anything: one with a NaN corner or without area is never hit.
    pub fn new(
        spheres: &'a [Sphere<R>],
        positions: &'a [Vec3<R>],
        triangles: &'a [[u32; 3]],
    ) -> Result<Self, GeometryError> {
        for (index, sphere) in spheres.iter().enumerate() {
            if !(sphere.center.is_finite() && sphere.radius.is_finite() && sphere.radius > R::ZERO) {
                return Err(GeometryError::Sphere { index });
            }
        }
        for (index, corners) in triangles.iter().enumerate() {
            if corners.iter().any(|&corner| corner as usize >= positions.len()) {
                return Err(GeometryError::TriangleCorner { index, positions: positions.len() });
            }
        }
        if spheres.len().saturating_add(triangles.len()) > 1 << 31 {
            return Err(GeometryError::TooMany);
        }
        Ok(Self { spheres, positions, triangles })
    }

    /// Number of primitives.
    #[inline]
    pub fn len(&self) -> usize {
        self.spheres.len() + self.triangles.len()
    }

    /// Whether there is nothing to hit.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The spheres: primitives from 0.
    #[inline]
    pub fn spheres(&self) -> &'a [Sphere<R>] {
        self.spheres
    }

    /// The triangles' corner indices: primitives after the spheres.
    #[inline]
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// Corners of triangle `index` (counted without the spheres).
    #[inline]
    pub fn corners(&self, index: usize) -> [Vec3<R>; 3] {
        self.triangles[index].map(|corner| self.positions[corner as usize])
    }

    /// The box of primitive `index`.
    #[inline]
    pub fn bounds(&self, index: usize) -> Bounds<R> {
        match self.spheres.get(index) {
            Some(sphere) => sphere.bounds(),
            None => triangle::bounds(&self.corners(index - self.spheres.len())),
        }
    }

    /// Tests primitive `index` and makes it the best hit if it wins.
    ///
    /// A hit counts only where the ray also meets the primitive's own box, and no nearer than that box: so a box
    /// around several primitives, which is entered no later than each of theirs, can never cull the winner.
    #[inline(always)]
    pub(crate) fn test<E: EffectSet>(&self, ray: &PreparedRay<R>, index: u32, best: &mut Hit<R>) {
        let at = index as usize;
        let sphere_count = if const { E::EFFECTS.contains(Effects::SPHERES) } { self.spheres.len() } else { 0 };
        if const { E::EFFECTS.contains(Effects::SPHERES) } && at < sphere_count {
            let sphere = &self.spheres[at];
            if let Some(t) = sphere.intersect(ray, best.t) {
                accept(sphere.bounds(), ray, Hit { t, u: R::ZERO, v: R::ZERO, primitive: index }, best);
            }
        } else if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
            let corners = self.corners(at - sphere_count);
            if let Some((t, u, v)) = triangle::intersect(&corners, ray, best.t) {
                accept(triangle::bounds(&corners), ray, Hit { t, u, v, primitive: index }, best);
            }
        }
    }
}

#[inline(always)]
fn accept<R: Real>(own: Bounds<R>, ray: &PreparedRay<R>, found: Hit<R>, best: &mut Hit<R>) {
    if let Some(near) = own.entry(ray, best.t) {
        let t = greater(found.t, near);
        if best.loses_to(t, found.primitive) {
            *best = Hit { t, ..found };
        }
    }
}
