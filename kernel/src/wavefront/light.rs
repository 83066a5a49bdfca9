//! Direct light at the surfaces of all lanes.

use super::columns::{Column, LANES, Vectors};
use super::departures::{Arrivals, Departures};
use super::hits::{Rays, occluded};
use crate::effects::{EffectSet, Effects};
use crate::light::{Light, LightSample, LightSampling, numbers_of, reflected};
use crate::material::diffuse;
use crate::path::PathOptions;
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3, Vector};
use crate::robust::shadow_tmax;

/// A [`LightSample`] of one light in each lane.
struct Samples<R: Real> {
    wi: Vectors<R>,
    target: Vectors<R>,
    weight: Vectors<R>,
    /// Whether there is one.
    seen: Column<bool>,
    sphere: u32,
}

impl<R: Real> Samples<R> {
    #[inline(always)]
    fn set(&mut self, lane: usize, sample: &LightSample<R>) {
        self.wi.set(lane, sample.wi);
        self.target.set(lane, sample.target);
        self.weight.set(lane, sample.weight);
    }

    /// Of a light, in the wanted lanes.
    #[inline(always)]
    fn new<E: EffectSet>(
        light: &Light<R>,
        sampling: LightSampling,
        [u, v]: [&Column<R>; 2],
        from: &Arrivals<'_, R>,
        departures: &Departures<R>,
        wanted: &Column<bool>,
    ) -> Self {
        let none = Vectors::ZERO;
        let mut samples = Self { wi: none, target: none, weight: none, seen: [false; LANES], sphere: NO_PRIMITIVE };
        let surfaces = from.surfaces;
        match light {
            Light::Sphere(light) if const { E::EFFECTS.contains(Effects::SPHERE_LIGHT) } => {
                samples.sphere = light.sphere;
                for lane in 0..LANES {
                    samples.seen[lane] = wanted[lane] && departures.sphere[lane] != light.sphere;
                }
                if sampling == LightSampling::Cone {
                    let (&sphere, emission) = light.body(from.few.scene);
                    for lane in 0..LANES {
                        let sample = light.sample_cone::<R>(&sphere, emission, surfaces.p.at(lane), u[lane], v[lane]);
                        samples.set(lane, &sample);
                    }
                    return samples;
                }
                for lane in 0..LANES {
                    let point = surfaces.point(lane);
                    if samples.seen[lane] {
                        let found = light.sample(from.few.scene, sampling, &point, u[lane], v[lane]);
                        found.iter().for_each(|sample| samples.set(lane, sample));
                        samples.seen[lane] = found.is_some();
                    }
                }
            }
            Light::Point(light) if const { E::EFFECTS.contains(Effects::POINT_LIGHT) } => {
                for lane in 0..LANES {
                    if wanted[lane] {
                        let found = light.sample(&surfaces.point(lane));
                        found.iter().for_each(|sample| samples.set(lane, sample));
                        samples.seen[lane] = found.is_some();
                    }
                }
            }
            _ => {}
        }
        samples
    }
}

/// [`crate::light::direct`] in the wanted lanes, and how many shadow rays it took.
#[inline(always)]
pub(super) fn direct<R: Real, E: EffectSet>(
    options: &PathOptions,
    from: &Arrivals<'_, R>,
    departures: &Departures<R>,
    numbers: &[Column<u32>; 4],
    wanted: &Column<bool>,
) -> (Vectors<R>, u64) {
    let (mut sum, mut shadows) = (Vectors::<R>::ZERO, 0);
    for (index, light) in from.few.scene.lights().iter().enumerate() {
        let (mut u, mut v) = ([R::ZERO; LANES], [R::ZERO; LANES]);
        for lane in 0..LANES {
            [u[lane], v[lane]] = numbers_of(index, [numbers[0][lane], numbers[1][lane]]);
        }
        let samples = Samples::new::<E>(light, options.light_sampling, [&u, &v], from, departures, wanted);

        let mut shadow = Rays::none();
        shadow.tmax = shadow_tmax::<R>();
        shadow.light = samples.sphere;
        shadow.origin = departures.origin;
        shadow.error = departures.error;
        shadow.departed = departures.sphere;
        let mut cosines = [R::ZERO; LANES];
        for lane in 0..LANES {
            shadow.direction.set(lane, samples.target.at(lane) - departures.origin.at(lane));
            cosines[lane] = diffuse::cosine(&from.surfaces.facing(lane), samples.wi.at(lane));
        }
        let mut seen = samples.seen;
        for lane in 0..LANES {
            seen[lane] &= cosines[lane] != R::ZERO;
            shadows += u64::from(seen[lane]);
        }
        let hidden = occluded::<R, E>(from.few, &shadow, &seen);
        for lane in 0..LANES {
            let lit = seen[lane] & !hidden[lane];
            let more = reflected::<R>(samples.weight.at(lane), cosines[lane]);
            let more = if lit { more } else { Vec3::<R>::ZERO };
            sum.set(lane, sum.at(lane) + more);
        }
    }
    (sum, shadows)
}
