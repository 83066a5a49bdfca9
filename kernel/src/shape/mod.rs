//! The primitives of a scene and the ray in the form that their tests want. ADD A SHAPE HERE.

pub mod sphere;
pub mod sphere_quad;
pub mod triangle;

use crate::bvh::Bounds;
use crate::effects::{EffectSet, Effects};
use crate::error::GeometryError;
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::{Real, Vec3, Vector, WideVec3, greater, widen};
use crate::robust::{slab_far_padding, slab_near_padding};

pub use sphere::Sphere;
pub use triangle::{Shear, TriangleAttributes};

/// A ray with all that is computed once per query.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay<R: Real> {
    /// Origin, scene units.
    pub origin: [R; 3],
    /// One over each component of the direction, padded for the near side of a slab, and minus that padded for the
    /// far side; infinite where the component is zero.
    pub inverse: [[R; 3]; 2],
    /// Whether the direction's sign bit is set: then a slab is entered through its upper side.
    pub negative: [bool; 3],
    /// Exclusive lower end of t.
    pub tmin: R,
    direction: [R; 3],
    /// The sum of the magnitudes of the direction's components: no less than its length.
    direction_sum: R,
    /// One over the squared length of the direction.
    inverse_square: R,
    wide_origin: WideVec3<R>,
    wide_direction: WideVec3<R>,
    wide_inverse_square: R::Wide,
    shear: Shear<R>,
}

impl<R: Real> PreparedRay<R> {
    /// Computes what the tests share.
    #[inline]
    pub fn new(ray: &Ray<R>) -> Self {
        let direction = ray.direction.to_array();
        let wide_direction = widen::<R>(ray.direction);
        let wide_inverse_square = R::Wide::ONE / wide_direction.dot(wide_direction);
        let inverse = direction.map(|d| R::ONE / d);
        Self {
            origin: ray.origin.to_array(),
            inverse: [slab_near_padding::<R>(), -slab_far_padding::<R>()].map(|pad| inverse.map(|d| d * pad)),
            negative: direction.map(|d| d.is_sign_negative()),
            tmin: ray.tmin,
            direction,
            direction_sum: direction[0].abs() + direction[1].abs() + direction[2].abs(),
            inverse_square: R::narrow(wide_inverse_square),
            wide_origin: widen::<R>(ray.origin),
            wide_direction,
            wide_inverse_square,
            shear: Shear::new(ray, inverse),
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

    /// Tests all primitives and makes the best hit of those that win. With `ANY` it may stop at the first.
    ///
    /// A hit counts only where the ray also meets the primitive's own box, and no nearer than that box: so a box
    /// around several primitives, which is entered no later than each of theirs, can never cull the winner.
    #[inline(always)]
    pub(crate) fn test_all<E: EffectSet, const ANY: bool>(&self, ray: &PreparedRay<R>, best: &mut Hit<R>) {
        if const { E::EFFECTS.contains(Effects::SPHERES) } {
            for (chunk, first) in self.spheres.chunks(4).zip((0..).step_by(4)) {
                let lane = |lane: usize| chunk.get(lane).unwrap_or(&chunk[0]);
                let four = [lane(0), lane(1), lane(2), lane(3)];
                self.test_four_spheres(ray, four, chunk.len(), |lane| first + lane as u32, best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
        if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
            for index in self.spheres.len()..self.len() {
                self.test_triangle(ray, index as u32, best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
    }

    /// [`Geometry::test_all`] for the primitives of a leaf, in ascending order.
    #[inline(always)]
    pub(crate) fn test_leaf<E: EffectSet, const ANY: bool>(
        &self,
        ray: &PreparedRay<R>,
        leaf: &[u32],
        best: &mut Hit<R>,
    ) {
        let mut rest = leaf;
        if const { E::EFFECTS.contains(Effects::SPHERES) } {
            while let Some(&first) = rest.first().filter(|&&first| (first as usize) < self.spheres.len()) {
                // Where fewer than four spheres are left, the first stands in for the others and is masked out.
                let lane = |lane: usize| rest.get(lane).filter(|&&index| (index as usize) < self.spheres.len());
                let count = 1 + (1..4).take_while(|&at| lane(at).is_some()).count();
                let indices: [u32; 4] = core::array::from_fn(|at| *lane(at).unwrap_or(&first));
                let four = indices.map(|index| &self.spheres[index as usize]);
                self.test_four_spheres(ray, four, count, |lane| indices[lane], best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
                rest = &rest[count..];
            }
        }
        if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
            for &index in rest {
                self.test_triangle(ray, index, best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
    }

    /// Tests the first `count` of four spheres.
    #[inline(always)]
    fn test_four_spheres(
        &self,
        ray: &PreparedRay<R>,
        four: [&Sphere<R>; 4],
        count: usize,
        index: impl Fn(usize) -> u32,
        best: &mut Hit<R>,
    ) {
        let mut candidates = sphere_quad::candidates(ray, four) & ((1 << count) - 1);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            let sphere = four[lane];
            if let Some(t) = sphere.intersect(ray, best.t) {
                accept(sphere.bounds(), ray, Hit { t, u: R::ZERO, v: R::ZERO, primitive: index(lane) }, best);
            }
        }
    }

    #[inline(always)]
    fn test_triangle(&self, ray: &PreparedRay<R>, index: u32, best: &mut Hit<R>) {
        let corners = self.corners(index as usize - self.spheres.len());
        if let Some((t, u, v)) = triangle::intersect(&corners, ray, best.t) {
            accept(triangle::bounds(&corners), ray, Hit { t, u, v, primitive: index }, best);
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
