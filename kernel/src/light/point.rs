//! Isotropic point lights.

use super::LightSample;
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3, Vector, narrow, widen};
use crate::surface::SurfacePoint;

/// A point that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight<R: Real> {
    /// Position, scene units.
    pub position: Vec3<R>,
    /// Radiant intensity per channel, W/sr: power / 4 pi.
    pub intensity: Vec3<R>,
}

impl<R: Real> PointLight<R> {
    /// The only direction there is; `None` at the light itself.
    #[inline]
    pub(crate) fn sample(&self, point: &SurfacePoint<R>) -> Option<LightSample<R>> {
        let to_light = widen::<R>(self.position) - widen::<R>(point.p);
        let square = to_light.dot(to_light);
        if !(square > R::Wide::ZERO) {
            return None;
        }
        Some(LightSample {
            wi: narrow::<R>(to_light * (R::Wide::ONE / square.sqrt())),
            target: self.position,
            sphere: NO_PRIMITIVE,
            weight: self.intensity * R::narrow(R::Wide::ONE / square),
        })
    }
}
