//! Smooth glass and liquids: reflection or refraction, one of the two by a random number.

use super::BsdfSample;
use super::fresnel::{Fresnel, Interface, reflectance};
use crate::real::{Real, Vec3, Vector, narrow, widen};
use crate::robust::normalize_wide;
use crate::surface::{Facing, SurfacePoint};

/// The interface between two dielectrics. A body that lies in another names the other's index as its exterior;
/// the inner wall of a hollow shell is a surface whose normal points into the hollow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<R: Real> {
    /// Index of refraction behind the surface (against its geometric normal).
    pub interior_ior: R,
    /// Index of refraction in front of the surface (where its geometric normal points).
    pub exterior_ior: R,
    /// Transmitted fraction per channel, linear, 0..=1; 1 is clear.
    pub transmittance: Vec3<R>,
}

impl<R: Real> Dielectric<R> {
    /// Indices of refraction on the side that light comes from (backwards: the viewer's) and beyond.
    #[inline(always)]
    pub(crate) fn iors(&self, entering: bool) -> [R; 2] {
        if entering { [self.exterior_ior, self.interior_ior] } else { [self.interior_ior, self.exterior_ior] }
    }
}

/// A sampled direction. Radiance is basic radiance, L / n^2: it does not change as it is refracted, and where light
/// and camera are in the same medium it equals radiance.
///
/// `choice` is a number of 32 bits: below the reflected fraction the light is reflected. Both weights are then 1.
#[inline]
pub fn sample<R: Real>(
    point: &SurfacePoint<R>,
    facing: &Facing<R>,
    glass: &Dielectric<R>,
    model: Fresnel,
    choice: u32,
) -> BsdfSample<R> {
    let Facing { ng, ns, .. } = *facing;
    let choice = R::Wide::from_unit_bits(choice);
    let entering = point.wo.dot(point.ng) >= R::ZERO;
    let [ior_i, ior_t] = glass.iors(entering);
    let attempt = |n: Vec3<R>| {
        let (wi, transmitted) = scatter::<R>(point.wo, n, ior_i.widen(), ior_t.widen(), model, choice);
        let side = ng.dot(wi);
        let possible = if transmitted { side < R::ZERO } else { side > R::ZERO };
        (wi, transmitted, possible)
    };
    let mut found = attempt(ns);
    if !found.2 && ns != ng {
        found = attempt(ng);
    }
    let (wi, transmitted, _) = found;
    let weight = if transmitted { glass.transmittance } else { Vec3::<R>::ONE };
    BsdfSample { wi, weight, delta: true }
}

/// Reflects or refracts about `n`, which is on the side of `wo`. The tangential part of `wo` carries the sine, so
/// nothing cancels near normal incidence; all in the wide precision.
#[inline(always)]
pub(crate) fn scatter<R: Real>(
    wo: Vec3<R>,
    n: Vec3<R>,
    ior_i: R::Wide,
    ior_t: R::Wide,
    model: Fresnel,
    choice: R::Wide,
) -> (Vec3<R>, bool) {
    let one = R::Wide::ONE;
    let n = normalize_wide::<R>(widen::<R>(n));
    let wo = normalize_wide::<R>(widen::<R>(wo));
    let cos_i = wo.dot(n);
    let tangent = wo - n * cos_i;
    let tangent = tangent - n * tangent.dot(n);
    let eta = ior_i / ior_t;
    let sine_square = eta * eta * tangent.dot(tangent);
    let refracts = if sine_square < one {
        let cos_t = (one - sine_square).sqrt();
        let reflected = reflectance(model, &Interface { cos_i: cos_i.abs(), cos_t, ior_i, ior_t });
        if choice < reflected { None } else { Some(cos_t) }
    } else {
        None
    };
    match refracts {
        Some(cos_t) => (narrow::<R>(normalize_wide::<R>(-(tangent * eta) - n * cos_t)), true),
        None => (narrow::<R>(normalize_wide::<R>(n * (cos_i + cos_i) - wo)), false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Everything;
    use glam::Vec3 as V;

    fn point(wo: V) -> SurfacePoint<f32> {
        SurfacePoint {
            p: V::ZERO,
            p_error: V::ZERO,
            ng: V::Z,
            ns: V::Z,
            uv: [0.0; 2],
            wo: crate::robust::normalize::<f32>(wo),
            material: 0,
        }
    }

    const GLASS: Dielectric<f32> =
        Dielectric { interior_ior: 1.5, exterior_ior: 1.0, transmittance: V::new(0.9, 0.8, 0.7) };

    fn sample_at(point: SurfacePoint<f32>, glass: &Dielectric<f32>, model: Fresnel, choice: u32) -> BsdfSample<f32> {
        sample(&point, &point.toward_viewer::<Everything>(), glass, model, choice)
    }

    #[test]
    fn refraction_obeys_snell_both_ways() {
        let wo = V::new(0.6, 0.0, 0.8);
        let entered = sample_at(point(wo), &GLASS, Fresnel::Exact, u32::MAX);
        assert!((entered.wi - V::new(-0.4, 0.0, -(1.0f32 - 0.16).sqrt())).abs().max_component() < 1e-7);
        assert_eq!(entered.weight, GLASS.transmittance);
        let left = sample_at(point(entered.wi), &GLASS, Fresnel::Exact, u32::MAX);
        assert!((left.wi - wo).abs().max_component() < 1e-7);
    }

    #[test]
    fn small_numbers_reflect_and_total_reflection_is_total() {
        let wo = V::new(0.6, 0.0, 0.8);
        let reflected = sample_at(point(wo), &GLASS, Fresnel::Exact, 0);
        assert!((reflected.wi - V::new(-0.6, 0.0, 0.8)).abs().max_component() < 1e-7);
        assert_eq!(reflected.weight, V::ONE);
        // From inside at 45 degrees, beyond the critical angle of 41.8 degrees.
        let total = sample_at(point(V::new(1.0, 0.0, -1.0)), &GLASS, Fresnel::None, u32::MAX);
        assert!(total.wi.z < 0.0);
    }
}
