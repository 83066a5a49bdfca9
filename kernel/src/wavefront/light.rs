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

/// A [`LightSample`] of one light in each lane, and its shadow ray.
pub(super) struct Samples<R: Real> {
    shadow: Rays<R>,
    wi: Vectors<R>,
    target: Vectors<R>,
    weight: Vectors<R>,
    /// Whether there is one. Where there is none, the rest is of an earlier light or step, and means nothing.
    seen: Column<bool>,
}

impl<R: Real> Samples<R> {
    pub(super) fn none() -> Self {
        let none = Vectors::ZERO;
        let shadow = Rays { tmax: shadow_tmax::<R>(), ..Rays::none() };
        Self { shadow, wi: none, target: none, weight: none, seen: [false; LANES] }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, sample: &LightSample<R>) {
        self.wi.set(lane, sample.wi);
        self.target.set(lane, sample.target);
        self.weight.set(lane, sample.weight);
    }

    /// Of a light, in the wanted lanes.
    #[inline(always)]
    fn sample<E: EffectSet>(
        &mut self,
        light: &Light<R>,
        sampling: LightSampling,
        [u, v]: [&Column<R>; 2],
        from: &Arrivals<'_, R>,
        departures: &Departures<R>,
        wanted: &Column<bool>,
    ) {
        let surfaces = from.surfaces;
        self.shadow.light = NO_PRIMITIVE;
        self.seen = [false; LANES];
        match light {
            Light::Sphere(light) if const { E::EFFECTS.contains(Effects::SPHERE_LIGHT) } => {
                self.shadow.light = light.sphere;
                for lane in 0..LANES {
                    self.seen[lane] = wanted[lane] && departures.sphere[lane] != light.sphere;
                }
                if sampling == LightSampling::Cone {
                    let (&sphere, emission) = light.body(from.few.scene);
                    for lane in 0..LANES {
                        let sample = light.sample_cone::<R>(&sphere, emission, surfaces.p.at(lane), u[lane], v[lane]);
                        self.set(lane, &sample);
                    }
                    return;
                }
                for lane in 0..LANES {
                    let point = surfaces.point(lane);
                    if self.seen[lane] {
                        let found = light.sample(from.few.scene, sampling, &point, u[lane], v[lane]);
                        found.iter().for_each(|sample| self.set(lane, sample));
                        self.seen[lane] = found.is_some();
                    }
                }
            }
            Light::Point(light) if const { E::EFFECTS.contains(Effects::POINT_LIGHT) } => {
                for lane in 0..LANES {
                    if wanted[lane] {
                        let found = light.sample(&surfaces.point(lane));
                        found.iter().for_each(|sample| self.set(lane, sample));
                        self.seen[lane] = found.is_some();
                    }
                }
            }
            _ => {}
        }
    }

    /// [`crate::light::direct`] in the wanted lanes, and how many shadow rays it took.
    #[inline(always)]
    pub(super) fn direct<E: EffectSet>(
        &mut self,
        options: &PathOptions,
        from: &Arrivals<'_, R>,
        departures: &Departures<R>,
        numbers: &[Column<u32>; 4],
        wanted: &Column<bool>,
    ) -> (Vectors<R>, u64) {
        let (mut sum, mut shadows) = (Vectors::<R>::ZERO, 0);
        self.shadow.origin = departures.origin;
        self.shadow.error = departures.error;
        self.shadow.departed = departures.sphere;
        for (index, light) in from.few.scene.lights().iter().enumerate() {
            let (mut u, mut v) = ([R::ZERO; LANES], [R::ZERO; LANES]);
            for lane in 0..LANES {
                [u[lane], v[lane]] = numbers_of(index, [numbers[0][lane], numbers[1][lane]]);
            }
            self.sample::<E>(light, options.light_sampling, [&u, &v], from, departures, wanted);
            let mut cosines = [R::ZERO; LANES];
            for lane in 0..LANES {
                self.shadow.direction.set(lane, self.target.at(lane) - departures.origin.at(lane));
                cosines[lane] = diffuse::cosine(&from.surfaces.facing(lane), self.wi.at(lane));
            }
            for lane in 0..LANES {
                self.seen[lane] &= cosines[lane] != R::ZERO;
                shadows += u64::from(self.seen[lane]);
            }
            let hidden = occluded::<R, E>(from.few, &self.shadow, &self.seen);
            for lane in 0..LANES {
                let lit = self.seen[lane] & !hidden[lane];
                let more = reflected::<R>(self.weight.at(lane), cosines[lane]);
                let more = if lit { more } else { Vec3::<R>::ZERO };
                sum.set(lane, sum.at(lane) + more);
            }
        }
        (sum, shadows)
    }
}
