//! Spherical lights: a sphere of the scene, looked at where it is.

use super::LightSample;
use crate::real::{Real, Vec3, Vector, WideVec3, greater, narrow, widen};
use crate::robust::{gamma, offset_ray_origin};
use crate::scene::Scene;
use crate::shape::Sphere;
use crate::surface::SurfacePoint;
use crate::warp::{cone_of_versine, cosine_hemisphere, to_world};

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
        let (sphere, emission) = self.body(scene);
        let to_center = widen::<R>(sphere.center) - widen::<R>(point.p);
        let square = to_center.dot(to_center);
        match sampling {
            LightSampling::None => None,
            LightSampling::Hemisphere if !is_inside(sphere, square) => {
                let (outward, wi, inverse_pdf) = hemisphere(sphere, to_center, square, u, v)?;
                let end = sphere.point_toward(outward);
                let target = offset_ray_origin::<R>(end.p, end.p_error, end.outward, -narrow::<R>(wi));
                let weight = emission * R::narrow(inverse_pdf);
                Some(LightSample { wi: narrow::<R>(wi), target, sphere: self.sphere, weight })
            }
            LightSampling::Hemisphere | LightSampling::Cone => Some(self.sample_cone(sphere, emission, point.p, u, v)),
        }
    }

    /// The sphere, and the radiance it emits.
    #[inline(always)]
    pub(crate) fn body<'a, R: Real>(&self, scene: &Scene<'a, R>) -> (&'a Sphere<R>, Vec3<R>) {
        let sphere = &scene.geometry().spheres()[self.sphere as usize];
        (sphere, scene.materials()[sphere.material as usize].emission)
    }

    /// A direction from `p` that is uniform in the solid angle of the sphere.
    #[inline(always)]
    pub(crate) fn sample_cone<R: Real>(
        &self,
        sphere: &Sphere<R>,
        emission: Vec3<R>,
        p: Vec3<R>,
        u: R,
        v: R,
    ) -> LightSample<R> {
        let p = widen::<R>(p);
        let to_center = widen::<R>(sphere.center) - p;
        let square = to_center.dot(to_center);
        let (wi, t, solid_angle) = uniform(sphere, to_center, square, is_inside(sphere, square), u, v);
        let weight = emission * R::narrow(solid_angle);
        LightSample { wi: narrow::<R>(wi), target: narrow::<R>(p + wi * t), sphere: self.sphere, weight }
    }
}

/// Whether a point whose squared distance from the centre is `square` is inside.
#[inline(always)]
fn is_inside<R: Real>(sphere: &Sphere<R>, square: R::Wide) -> bool {
    let radius = sphere.radius.widen();
    !(square > radius * radius)
}

/// A direction that is uniform in the solid angle of the sphere, how far it goes to just before the sphere, and the
/// solid angle.
///
/// Its end lies on a sphere whose radius differs from the light's by what rounding can take away: `u` of each
/// coordinate of the end (at most `|c| + r`), and some wide roundings of the distance. So a shadow ray that runs to
/// the end does not meet the light.
#[inline(always)]
fn uniform<R: Real>(
    sphere: &Sphere<R>,
    to_center: WideVec3<R>,
    square: R::Wide,
    inside: bool,
    u: R,
    v: R,
) -> (WideVec3<R>, R::Wide, R::Wide) {
    let zero = R::Wide::ZERO;
    let radius = sphere.radius.widen();
    let radius_square = radius * radius;
    // Not zero, so that nothing is divided by zero at the centre; any axis will do there.
    let distance = greater(square, R::Wide::MIN_POSITIVE).sqrt();
    // 1 - cos = sin^2 / (1 + cos), with both over the distance.
    let versine = if inside {
        R::Wide::from_f64(2.0)
    } else {
        radius_square / (distance * (distance + (square - radius_square).sqrt()))
    };
    let sampled = cone_of_versine(versine, u.widen());
    let axis: WideVec3<R> = to_center * (R::Wide::ONE / distance);
    let axis = Vector::new(axis.x(), axis.y(), if square > zero { axis.z() } else { R::Wide::ONE });
    let (sine, cosine) = v.sin_cos_turns();
    let local = Vector::new(cosine.widen() * sampled.sine, sine.widen() * sampled.sine, sampled.cosine);
    let wi = to_world::<R::Wide>(axis, local);

    let size = sphere.center.abs().dot(Vector::ONE) + sphere.radius;
    let lift = (size * gamma::<R>(4)).widen() + distance * gamma::<R::Wide>(16);
    let reach = if inside { radius - lift } else { radius + lift };
    // Where the direction meets that sphere, from the foot of the centre's perpendicular.
    let foot = distance * sampled.cosine;
    let half_square = reach * reach - square * sampled.sine_square;
    let half = if half_square > zero { half_square.sqrt() } else { zero };
    (wi, if inside { foot + half } else { foot - half }, sampled.solid_angle)
}

/// A cosine-weighted point of the hemisphere that faces the shading point, from the centre; the unit direction to it;
/// one over its pdf per steradian. `None` where it cannot be seen.
#[inline]
fn hemisphere<R: Real>(
    sphere: &Sphere<R>,
    to_center: WideVec3<R>,
    square: R::Wide,
    u: R,
    v: R,
) -> Option<(WideVec3<R>, WideVec3<R>, R::Wide)> {
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
