//! Lambertian reflection: `f = albedo / pi`, on both sides.

use super::BsdfSample;
use crate::real::{Real, Vec3, Vector};
use crate::surface::Facing;
use crate::warp::{cosine_hemisphere, to_world};

/// A Lambertian surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse<R: Real> {
    /// Reflected fraction per channel, linear, 0..=1; multiplies the texture.
    pub albedo: Vec3<R>,
    /// Index of the texture.
    pub texture: Option<u32>,
}

/// The cosine between `wi` and the shading normal, or 0 where `wi` leaves on the other side than `wo`, by either
/// normal: no light passes through.
#[inline(always)]
pub(crate) fn cosine<R: Real>(facing: &Facing<R>, wi: Vec3<R>) -> R {
    let cosine = facing.ns.dot(wi);
    if cosine > R::ZERO && facing.ng.dot(wi) > R::ZERO { cosine } else { R::ZERO }
}

/// A direction with the density of the cosine about the shading normal.
#[inline(always)]
pub(crate) fn direction<R: Real>(facing: &Facing<R>, u: R, v: R) -> Vec3<R> {
    to_world::<R>(facing.ns, cosine_hemisphere(u, v))
}

/// A direction with the density of the cosine; the weight is the albedo. `None` where it would pass the surface.
#[inline]
pub(crate) fn sample<R: Real>(facing: &Facing<R>, albedo: Vec3<R>, u: R, v: R) -> Option<BsdfSample<R>> {
    let wi = direction(facing, u, v);
    (facing.ng.dot(wi) > R::ZERO).then_some(BsdfSample { wi, weight: albedo, delta: false })
}
