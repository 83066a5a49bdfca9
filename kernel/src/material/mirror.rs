//! Perfect mirrors.

use super::BsdfSample;
use crate::real::{Real, Vec3, Vector};
use crate::robust::normalize;
use crate::surface::Facing;

/// A perfect mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror<R: Real> {
    /// Reflected fraction per channel, linear, 0..=1.
    pub reflectance: Vec3<R>,
}

/// `wo` mirrored about the unit vector `n`, at length 1 again so that long chains do not drift.
#[inline]
fn reflect<R: Real>(wo: Vec3<R>, n: Vec3<R>) -> Vec3<R> {
    let along = wo.dot(n);
    // A normal that was formed without wider numbers is a few roundings off length 1, and the mirror off its plane.
    let along = if const { R::WIDE_IS_SELF } { along / n.dot(n) } else { along };
    normalize::<R>(n * (along + along) - wo)
}

/// The mirrored direction: about the shading normal, or about the geometric one where the first would pass the
/// surface. `wo` has length 1 and is on the side of `facing`.
#[inline]
pub fn sample<R: Real>(wo: Vec3<R>, facing: &Facing<R>, mirror: &Mirror<R>) -> BsdfSample<R> {
    let about_ns = reflect::<R>(wo, facing.ns);
    let wi = if facing.ng.dot(about_ns) > R::ZERO { about_ns } else { reflect::<R>(wo, facing.ng) };
    BsdfSample { wi, weight: mirror.reflectance, delta: true }
}
