//! Spherical lights: a sphere of the scene, looked at where it is.

use super::LightSample;
use crate::real::{Real, Vector, WideVec3, narrow, widen};
use crate::robust::offset_ray_origin;
use crate::scene::Scene;
use crate::shape::Sphere;
use crate::surface::SurfacePoint;
use crate::warp::{cone, cosine_hemisphere, frame, to_world};

/// A sphere of the scene that is sampled as a light. Its material says what it emits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereLight {
    /// Index of the sphere.
    pub sphere: u32,
}

/// How points on a spherical light are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSampling {
    /// Cosine-weighted on the hemisphere that faces the shading point, as in the report: some of its points cannot
    /// be seen from there and contribute nothing.
    Hemisphere,
    /// Uniform in the solid angle of the sphere (PBR 4ed, section 6.2.4).
    #[default]
    Cone,
    /// Not at all: paths find the light by chance.
    None,
}

impl SphereLight {
    /// A direction to the light; from inside of it, any direction.
    #[inline]
    pub(crate) fn sample<R: Real>(
        &self,
        scene: &Scene<'_, R>,
        sampling: LightSampling,
        point: &SurfacePoint<R>,
        u: R,
        v: R,
    ) -> Option<LightSample<R>> {
        let sphere = &scene.geometry().spheres()[self.sphere as usize];
        let emission = scene.materials()[sphere.material as usize].emission;
        let to_center = widen::<R>(sphere.center) - widen::<R>(point.p);
        let square = to_center.dot(to_center);
        let radius = sphere.radius.widen();
        let inside = !(square > radius * radius);
        let (outward, wi, inverse_pdf) = match sampling {
            LightSampling::None => return None,
            LightSampling::Hemisphere if !inside => hemisphere(sphere, to_center, square, u, v)?,
            LightSampling::Hemisphere | LightSampling::Cone => uniform::<R>(radius, to_center, square, inside, u, v),
        };
        let target = sphere.point_toward(outward);
        let wi = narrow::<R>(wi);
        Some(LightSample {
            wi,
            target: offset_ray_origin::<R>(target.p, target.p_error, target.outward, -wi),
            weight: emission * R::narrow(inverse_pdf),
        })
    }
}

/// A point of a sphere from its centre, the unit direction to it, and one over its pdf per steradian.
type SpherePointSample<R> = (WideVec3<R>, WideVec3<R>, <R as Real>::Wide);

/// A point seen uniformly in the solid angle of the sphere.
#[inline]
fn uniform<R: Real>(
    radius: R::Wide,
    to_center: WideVec3<R>,
    square: R::Wide,
    inside: bool,
    u: R,
    v: R,
) -> SpherePointSample<R> {
    let one = R::Wide::ONE;
    let sine_square = if inside { one } else { radius * radius / square };
    let sampled = cone(sine_square, u.widen());
    let axis = if square > R::Wide::ZERO {
        to_center * (one / square.sqrt())
    } else {
        Vector::new(R::Wide::ZERO, R::Wide::ZERO, one)
    };
    let [x, y] = frame::<R::Wide>(axis);
    let (sine, cosine) = v.sin_cos_turns();
    let wi = (x * cosine.widen() + y * sine.widen()) * sampled.sine + axis * sampled.cosine;
    // Where the direction meets the sphere, from the foot of the centre's perpendicular.
    let foot = to_center.dot(wi);
    let half_square = radius * radius - square * sampled.sine * sampled.sine;
    let half = if half_square > R::Wide::ZERO { half_square.sqrt() } else { R::Wide::ZERO };
    let t = if inside { foot + half } else { foot - half };
    (wi * t - to_center, wi, sampled.solid_angle)
}

/// A cosine-weighted point of the hemisphere that faces the shading point; `None` where it cannot be seen.
#[inline]
fn hemisphere<R: Real>(
    sphere: &Sphere<R>,
    to_center: WideVec3<R>,
    square: R::Wide,
    u: R,
    v: R,
) -> Option<SpherePointSample<R>> {
    let facing = to_center * -(R::Wide::ONE / square.sqrt());
    let outward = to_world::<R::Wide>(facing, widen::<R>(cosine_hemisphere(u, v)));
    let radius = sphere.radius.widen();
    let to_light = to_center + outward * radius;
    let distance_square = to_light.dot(to_light);
    let cosine_at_light = -(outward.dot(to_light));
    let cosine_of_choice = outward.dot(facing);
    if !(cosine_at_light > R::Wide::ZERO && cosine_of_choice > R::Wide::ZERO) {
        return None;
    }
    // pdf per area is cos / (pi r^2); per steradian it is that times d^2 / cos at the light.
    let pi = R::Wide::from_f64(core::f64::consts::PI);
    let inverse_distance = R::Wide::ONE / distance_square.sqrt();
    let inverse_pdf = pi * radius * radius * cosine_at_light * inverse_distance / (cosine_of_choice * distance_square);
    Some((outward, to_light * inverse_distance, inverse_pdf))
}
