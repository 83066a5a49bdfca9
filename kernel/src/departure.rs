//! Where the rays that leave a surface start.

use crate::accuracy::{CONSTANT_OFFSET, RayOffset};
use crate::clearance::Clearance;
use crate::effects::{EffectSet, Effects};
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::{Real, Vec3, Vector};
use crate::robust::{distance_error, error_box, offset_distance, origin_error};
use crate::scene::Scene;
use crate::surface::{Facing, SurfacePoint};

/// Where the rays that leave a surface point start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Departure<R: Real> {
    /// Off the surface, scene units.
    pub(crate) origin: Vec3<R>,
    /// How far that is from the exact point of the surface, at most.
    pub(crate) error: R,
    /// The sphere on whose outside it is, which the rays cannot meet; [`NO_PRIMITIVE`] if there is none.
    pub(crate) sphere: u32,
    /// The sphere that the rays end before, [`NO_PRIMITIVE`] if they do not: a light does not stand in its own way.
    pub(crate) light: u32,
}

impl<R: Real> Departure<R> {
    /// Off a surface, to the side of the unit normal `ng`; `t` is that of the ray that found the point.
    #[inline(always)]
    pub(crate) fn off(p: Vec3<R>, p_error: Vec3<R>, t: R, ng: Vec3<R>) -> Self {
        let offset = ng * offset_distance::<R>(p, p_error, ng);
        Self { error: origin_error::<R>(p, p_error, t), ..Self::exactly(p + offset) }
    }

    /// Exactly from `origin`, and from no surface.
    #[inline]
    pub(crate) fn exactly(origin: Vec3<R>) -> Self {
        Self { origin, error: R::ZERO, sphere: NO_PRIMITIVE, light: NO_PRIMITIVE }
    }
}

/// The end of a ray.
pub(crate) struct Arrival<'a, R: Real> {
    pub(crate) scene: &'a Scene<'a, R>,
    pub(crate) ray: &'a Ray<R>,
    pub(crate) hit: &'a Hit<R>,
    pub(crate) point: &'a SurfacePoint<R>,
}

impl<R: Real> Arrival<'_, R> {
    /// Of rays that stay on the side that the ray came from.
    #[inline(always)]
    pub(crate) fn reflected<E: EffectSet>(&self, facing: &Facing<R>) -> Departure<R> {
        self.departure::<E>(facing.ng, facing.front, true)
    }

    /// Of rays of direction `wi`, which may pass through the surface.
    #[inline(always)]
    pub(crate) fn scattered<E: EffectSet>(&self, facing: &Facing<R>, wi: Vec3<R>) -> Departure<R> {
        let front = wi.dot(self.point.ng) > R::ZERO;
        let ng = if front { self.point.ng } else { -self.point.ng };
        self.departure::<E>(ng, front, front == facing.front)
    }

    /// Of rays that leave to the side of the unit normal `ng`: whether that is the surface's front, and whether it is the
    /// side that the ray came from.
    #[inline(always)]
    fn departure<E: EffectSet>(&self, ng: Vec3<R>, front: bool, same_side: bool) -> Departure<R> {
        let Self { scene, hit, point, .. } = *self;
        if const { matches!(E::ACCURACY.offset, RayOffset::Constant) } {
            return Departure::exactly(point.p + ng * R::from_f64(CONSTANT_OFFSET));
        }
        let mut departure = Departure {
            sphere: outside_of::<R, E>(scene, hit.primitive, front),
            ..Departure::off(point.p, point.p_error, hit.t, ng)
        };
        let clears =
            const { matches!(E::ACCURACY.offset, RayOffset::Cleared) && E::EFFECTS.contains(Effects::TRIANGLES) };
        if !clears {
            return departure;
        }
        // Rays that pass through a triangle are where it is: on the side of others that it lies on. (Those that pass
        // through a sphere are not looked after.)
        let seen_from = if same_side { Some(self.ray.origin) } else { scene.geometry().middle(hit.primitive) };
        if let Some(viewer) = seen_from {
            let offset = ng * offset_distance::<R>(point.p, point.p_error, ng);
            let error = error_box::<R>(point.p, point.p_error);
            let along = distance_error::<R>(hit.t);
            let clearance = Clearance { scene, point, viewer, ng, error, along };
            if clearance.is_needed(offset) {
                let cleared = clearance.cleared(offset);
                departure.origin = point.p + cleared;
                departure.error = departure.error + cleared.abs().dot(Vec3::<R>::ONE);
            }
        }
        departure
    }
}

/// The primitive, if a ray that leaves it to its front or its back departs from the outside of a sphere.
#[inline]
fn outside_of<R: Real, E: EffectSet>(scene: &Scene<'_, R>, primitive: u32, front: bool) -> u32 {
    match scene.geometry().spheres().get(primitive as usize) {
        Some(sphere) if const { E::EFFECTS.contains(Effects::SPHERES) } && sphere.inverted != front => primitive,
        _ => NO_PRIMITIVE,
    }
}
