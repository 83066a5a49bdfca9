//! The primitives of a scene and the ray in the form that their tests want. ADD A SHAPE HERE.

pub mod sphere;
mod sphere_quad;
pub mod triangle;
mod triangle_quad;

use crate::accuracy::{SphereTest, TriangleTest};
use crate::bvh::{Bounds, Slabs};
use crate::departure::Departure;
use crate::effects::{EffectSet, Effects, Everything};
use crate::error::GeometryError;
use crate::lanes::set_bits;
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::{Real, Vec3, Vector, WideVec3, greater, widen};

pub use sphere::Sphere;
pub use sphere_quad::SphereQuad;
pub use triangle::{Shear, TriangleAttributes};
pub use triangle_quad::TriangleQuad;

/// Squared lengths of directions between which products of coordinates neither over- nor underflow where it matters:
/// 2^-80 and 2^80.
const SQUARE_RANGE: [f64; 2] = [1.0 / ((1u128 << 80) as f64), (1u128 << 80) as f64];

/// Coordinates up to which the square of a distance does not overflow: 2^61.
const REACH: f64 = (1u64 << 61) as f64;

/// Coordinates up to which the square of a distance does not overflow, even times this number: 2^40.
const NEAR: f64 = (1u64 << 40) as f64;

/// A ray with all that is computed once per query.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay<R: Real> {
    /// What boxes need.
    pub(crate) slabs: Slabs<R>,
    /// Origin, scene units.
    pub origin: [R; 3],
    /// Exclusive lower end of t.
    pub tmin: R,
    /// The sphere that the ray starts on the outside of, and cannot meet again; `NO_PRIMITIVE` if there is none.
    departed: u32,
    /// The sphere that the ray ends before; `NO_PRIMITIVE` if there is none.
    light: u32,
    /// How far the origin is from where it should be, at most; scene units.
    error: R::Wide,
    direction: [R; 3],
    /// The squared length of the direction; NaN where that or its reciprocal is far from 1, or the origin very far off.
    square: R,
    /// One over the squared length of the direction; NaN as above.
    inverse_square: R,
    wide_origin: WideVec3<R>,
    wide_direction: WideVec3<R>,
    wide_square: R::Wide,
    wide_inverse_square: R::Wide,
    shear: Shear<R>,
    wide_shear: Shear<R::Wide>,
}

impl<R: Real> PreparedRay<R> {
    /// Computes what the tests share.
    #[inline]
    pub fn new(ray: &Ray<R>) -> Self {
        Self::new_in::<Everything, true>(ray, &Departure::exactly(ray.origin))
    }

    /// [`PreparedRay::new`] for a kernel of fewer effects. Without `BOXES` it is for [`Geometry::test_all`] alone.
    #[inline(always)]
    pub(crate) fn new_in<E: EffectSet, const BOXES: bool>(ray: &Ray<R>, from: &Departure<R>) -> Self {
        // Triangles are always tested against their own box, and so are spheres where `Sphere::has_in_box` says no.
        let boxes = const { BOXES || E::EFFECTS.contains(Effects::TRIANGLES) || needs_boxes_of_spheres::<R, E>() };
        let triangles = const { E::EFFECTS.contains(Effects::TRIANGLES) };
        let wide_triangles = const { matches!(E::ACCURACY.triangle, TriangleTest::Wide) };
        let direction = ray.direction.to_array();
        let wide_direction = widen::<R>(ray.direction);
        // What decides about spheres is in the precision of their test.
        let wide_square = R::squared_length(direction);
        let square = R::narrow(wide_square);
        let (wide_square, wide_inverse_square) = if const { matches!(E::ACCURACY.sphere, SphereTest::Narrow) } {
            (square.widen(), (R::ONE / square).widen())
        } else {
            (wide_square, R::Wide::ONE / wide_square)
        };
        let usual = square > R::from_f64(SQUARE_RANGE[0])
            && square < R::from_f64(SQUARE_RANGE[1])
            && ray.origin.abs().max_component() < R::from_f64(REACH);
        let inverse = if boxes { direction.map(|d| R::ONE / d) } else { [R::NAN; 3] };
        Self {
            slabs: Slabs::new::<E>(ray.origin.to_array(), inverse),
            origin: ray.origin.to_array(),
            tmin: ray.tmin,
            departed: from.sphere,
            light: from.light,
            error: from.error.widen(),
            direction,
            square: if usual { square } else { R::NAN },
            inverse_square: if usual { R::narrow(wide_inverse_square) } else { R::NAN },
            wide_origin: widen::<R>(ray.origin),
            wide_direction,
            wide_square,
            wide_inverse_square,
            shear: if triangles && !wide_triangles { Shear::new(ray.direction, inverse) } else { Shear::NONE },
            wide_shear: if triangles && wide_triangles {
                Shear::new(wide_direction, wide_direction.to_array().map(|d| R::Wide::ONE / d))
            } else {
                Shear::NONE
            },
        }
    }

    /// The squared length of a ray's direction, if it is above 2^-40 and below 2^80, and the origin nearer than
    /// [`Sphere::is_near`] asks of spheres.
    #[inline(always)]
    pub(crate) fn square_in_range(ray: &Ray<R>) -> Option<R> {
        let square = R::narrow(R::squared_length(ray.direction.to_array()));
        let in_range = square > R::from_f64(1.0 / NEAR)
            && square < R::from_f64(SQUARE_RANGE[1])
            && ray.origin.abs().max_component() < R::from_f64(NEAR);
        if in_range { Some(square) } else { None }
    }

    /// Whether a sphere is one that it is not to meet: the one it leaves, the light it ends before.
    #[inline(always)]
    fn leaves_out(&self, sphere: u32) -> bool {
        sphere == self.departed || sphere == self.light
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

    /// Corner positions, scene units.
    #[inline]
    pub fn positions(&self) -> &'a [Vec3<R>] {
        self.positions
    }

    /// Corners of primitive `index`, which must be a triangle.
    #[inline]
    pub(crate) fn corners(&self, index: usize) -> [Vec3<R>; 3] {
        self.triangles[index - self.spheres.len()].map(|corner| self.positions[corner as usize])
    }

    /// The middle of primitive `index`; `None` for a sphere.
    #[inline]
    pub(crate) fn middle(&self, index: u32) -> Option<Vec3<R>> {
        let index = index as usize;
        (index >= self.spheres.len()).then(|| {
            let [a, b, c] = self.corners(index);
            (a + b + c) * R::from_f64(1.0 / 3.0)
        })
    }

    /// The box of primitive `index`, which must be one.
    #[inline]
    pub(crate) fn bounds(&self, index: usize) -> Bounds<R> {
        match self.spheres.get(index) {
            Some(sphere) => sphere.bounds(),
            None => triangle::bounds(&self.corners(index)),
        }
    }

    /// Tests all primitives, one by one, and makes the best hit of those that win. With `ANY` it may stop at the first.
    ///
    /// A hit counts only where the ray also meets the primitive's own box, and no nearer than that box: so a box
    /// around several primitives, which is entered no later than each of theirs, can never cull the winner.
    #[inline(always)]
    pub(crate) fn test_all<E: EffectSet, const ANY: bool>(&self, ray: &PreparedRay<R>, best: &mut Hit<R>) {
        if const { E::EFFECTS.contains(Effects::SPHERES) } {
            for index in (0..self.spheres.len() as u32).filter(|&index| !ray.leaves_out(index)) {
                self.test_sphere::<E>(ray, index, best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
        if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
            for index in self.spheres.len()..self.len() {
                test_triangle::<R, E>(ray, index as u32, &self.corners(index), best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
    }

    /// [`Geometry::test_all`] for some of the spheres: all in fours, then what is left one by one. `NARROWED` says
    /// whether the end of the ray is worth a look: not in the search for the closest before anything was hit.
    #[inline(always)]
    pub(crate) fn test_spheres<E: EffectSet, const ANY: bool, const NARROWED: bool>(
        &self,
        ray: &PreparedRay<R>,
        quads: &[SphereQuad<R>],
        best: &mut Hit<R>,
    ) {
        if const { !E::EFFECTS.contains(Effects::SPHERES) } {
            return;
        }
        // One bit for each sphere of eight quads.
        for quads in quads.chunks(8) {
            let end = if NARROWED { Some(best.t) } else { None };
            let mut candidates = 0;
            for (quad, shift) in quads.iter().zip((0..).step_by(4)) {
                candidates |= quad.candidates(ray, end) << shift;
            }
            for at in set_bits(candidates) {
                let index = quads[at / 4].primitives()[at % 4];
                if ray.leaves_out(index) {
                    continue;
                }
                self.test_sphere::<E>(ray, index, best);
                if ANY && best.primitive != NO_PRIMITIVE {
                    return;
                }
            }
        }
    }

    /// Shows `see` where the ray crosses primitive `index`, which must be one.
    #[inline]
    pub(crate) fn cross<E: EffectSet>(&self, ray: &PreparedRay<R>, tmax: R, index: u32, see: &mut impl FnMut(Hit<R>)) {
        let at = index as usize;
        match self.spheres.get(at) {
            Some(sphere) if const { E::EFFECTS.contains(Effects::SPHERES) } => {
                for t in sphere.crossings::<E>(ray).into_iter().flatten().filter(|t| *t > ray.tmin && *t <= tmax) {
                    let found = Hit { t, u: R::ZERO, v: R::ZERO, primitive: index };
                    in_box(sphere.bounds().entry(ray, tmax), found).into_iter().for_each(&mut *see);
                }
            }
            None if const { E::EFFECTS.contains(Effects::TRIANGLES) } => {
                let corners = self.corners(at);
                if let Some((t, u, v)) = triangle::test::<R, E, true>(&corners, ray, tmax) {
                    let found = Hit { t, u, v, primitive: index };
                    in_box(triangle::bounds(&corners).entry(ray, tmax), found).into_iter().for_each(see);
                }
            }
            _ => {}
        }
    }

    #[inline(always)]
    fn test_sphere<E: EffectSet>(&self, ray: &PreparedRay<R>, index: u32, best: &mut Hit<R>) {
        let sphere = &self.spheres[index as usize];
        if let Some(t) = sphere.intersect_in::<E>(ray, best.t) {
            let found = Hit { t, u: R::ZERO, v: R::ZERO, primitive: index };
            if const { needs_boxes_of_spheres::<R, E>() } {
                accept(sphere.bounds().entry(ray, best.t), found, best);
            } else if sphere.has_in_box(ray, t) {
                best.keep_closer(found);
            } else {
                let near = entry_apart(sphere.bounds(), ray.origin, ray.direction, ray.tmin, best.t);
                accept(near, found, best);
            }
        }
    }
}

/// [`Geometry::test_all`] for the triangles of a leaf.
#[inline(always)]
pub(crate) fn test_triangles<R: Real, E: EffectSet, const ANY: bool>(
    ray: &PreparedRay<R>,
    quads: &[TriangleQuad<R>],
    best: &mut Hit<R>,
) {
    if const { !E::EFFECTS.contains(Effects::TRIANGLES) } {
        return;
    }
    for quad in quads {
        for lane in set_bits(quad.candidates::<E>(ray)) {
            let (primitive, corners) = quad.triangle(lane);
            test_triangle::<R, E>(ray, primitive, &corners, best);
            if ANY && best.primitive != NO_PRIMITIVE {
                return;
            }
        }
    }
}

#[inline(always)]
fn test_triangle<R: Real, E: EffectSet>(
    ray: &PreparedRay<R>,
    primitive: u32,
    corners: &[Vec3<R>; 3],
    best: &mut Hit<R>,
) {
    if let Some((t, u, v)) = triangle::test::<R, E, false>(corners, ray, best.t) {
        accept(triangle::bounds(corners).entry(ray, best.t), Hit { t, u, v, primitive }, best);
    }
}

/// Whether every hit of a sphere is tested against the sphere's own box: no proof says that it can be left out.
const fn needs_boxes_of_spheres<R: Real, E: EffectSet>() -> bool {
    R::WIDE_IS_SELF || !E::ACCURACY.proves_boxes_of_spheres()
}

/// A hit, if the ray enters the primitive's own box, at `near`, and no nearer than there: so no box around the primitive
/// can hide it.
#[inline(always)]
fn in_box<R: Real>(near: Option<R>, found: Hit<R>) -> Option<Hit<R>> {
    near.map(|near| Hit { t: greater(found.t, near), ..found })
}

/// Makes a hit in its own box the best, if it wins.
#[inline(always)]
fn accept<R: Real>(near: Option<R>, found: Hit<R>, best: &mut Hit<R>) {
    if let Some(found) = in_box(near, found) {
        best.keep_closer(found);
    }
}

/// [`Bounds::entry`] where it is rarely needed: apart, so that a search that never needs it does not prepare the ray
/// for boxes.
#[cold]
#[inline(never)]
fn entry_apart<R: Real>(own: Bounds<R>, origin: [R; 3], direction: [R; 3], tmin: R, tmax: R) -> Option<R> {
    own.entry_between(&Slabs::new::<Everything>(origin, direction.map(|d| R::ONE / d)), tmin, tmax)
}
