//! Lights that are sampled. ADD A LIGHT HERE.
//!
//! Each light has `sample`: from a surface point and two numbers to a [`LightSample`].

pub mod point;
pub mod sphere;

pub use point::PointLight;
pub use sphere::{LightSampling, SphereLight};

use crate::departure::Departure;
use crate::effects::{EffectSet, Effects};
use crate::material::diffuse;
use crate::path::PathOptions;
use crate::ray::Ray;
use crate::real::{Real, Vec3, Vector};
use crate::robust::shadow_tmax;
use crate::scene::Scene;
use crate::surface::{Facing, SurfacePoint};

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light<R: Real> {
    /// An isotropic point.
    Point(PointLight<R>),
    /// A sphere of the scene whose material emits.
    Sphere(SphereLight),
}

/// A sampled direction to a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample<R: Real> {
    /// Unit direction from the surface to the light.
    pub wi: Vec3<R>,
    /// Where the shadow ray ends: on the light, off its surface.
    pub target: Vec3<R>,
    /// The sphere that the light is; [`NO_PRIMITIVE`](crate::ray::NO_PRIMITIVE) if it is none.
    pub sphere: u32,
    /// Radiance over pdf per steradian (surfaces), intensity over squared distance (points).
    pub weight: Vec3<R>,
}

/// The light that reaches a diffuse surface of albedo 1 and leaves it toward the viewer: the sum over all lights.
/// Shadow rays start at `departure`, on the viewer's side.
///
/// Every light uses the same two numbers, moved by a constant of its own around the unit square: each estimate is
/// unbiased by itself, hence so is the sum. Adds the shadow rays to `rays`.
#[inline(always)]
pub(crate) fn direct<R: Real, E: EffectSet>(
    scene: &Scene<'_, R>,
    options: &PathOptions,
    point: &SurfacePoint<R>,
    facing: &Facing<R>,
    departure: &Departure<R>,
    numbers: [u32; 4],
    rays: &mut u32,
) -> Vec3<R> {
    let mut sum = Vec3::<R>::ZERO;
    for (index, light) in scene.lights().iter().enumerate() {
        let [u, v] = numbers_of(index, [numbers[0], numbers[1]]);
        let sampled = match light {
            Light::Point(light) if const { E::EFFECTS.contains(Effects::POINT_LIGHT) } => light.sample(point),
            // From its own outside no light is seen.
            Light::Sphere(light)
                if const { E::EFFECTS.contains(Effects::SPHERE_LIGHT) } && light.sphere != departure.sphere =>
            {
                light.sample(scene, options.light_sampling, point, u, v)
            }
            _ => None,
        };
        let Some(sampled) = sampled else { continue };
        let cosine = diffuse::cosine(facing, sampled.wi);
        if cosine == R::ZERO {
            continue;
        }
        let shadow = Ray { tmax: shadow_tmax::<R>(), ..Ray::new(departure.origin, sampled.target - departure.origin) };
        *rays += 1;
        if !scene.occluded_from::<E>(&shadow, &Departure { light: sampled.sphere, ..*departure }) {
            sum = sum + reflected::<R>(sampled.weight, cosine);
        }
    }
    sum
}

/// The numbers of light `index`: steps of the R2 sequence (Roberts 2018), so that neighbouring lights land far apart.
#[inline(always)]
pub(crate) fn numbers_of<R: Real>(index: usize, [u, v]: [u32; 2]) -> [R; 2] {
    let shift = index as u32;
    let u = u.wrapping_add(shift.wrapping_mul(0xC13F_A9A9));
    let v = v.wrapping_add(shift.wrapping_mul(0x91E1_0DA5));
    [u, v].map(R::from_unit_bits)
}

/// What a diffuse surface of albedo 1 reflects of a light sample's `weight`.
#[inline(always)]
pub(crate) fn reflected<R: Real>(weight: Vec3<R>, cosine: R) -> Vec3<R> {
    weight * (cosine * R::from_f64(core::f64::consts::FRAC_1_PI))
}
