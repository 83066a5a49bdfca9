//! The whole path loop.

use crate::aim;
use crate::departure::{Arrival, Departure};
use crate::effects::{EffectSet, Effects};
use crate::light::{self, LightSampling};
use crate::material::{Diffuse, Fresnel, Scattering, dielectric, diffuse, mirror};
use crate::ray::Ray;
use crate::real::{Real, Vec3, Vector};
use crate::sampler::{Block, Sampler, SamplerKind};
use crate::scene::Scene;
use crate::surface::{SurfacePoint, surface_point};

/// Which light transport is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathOptions {
    /// Scattering events a path may have: 0 shows emitters only, 1 direct light. A light that is reached after the
    /// last event still counts.
    pub max_bounces: u32,
    /// `false` ends a path at its first diffuse hit, after direct light.
    pub indirect: bool,
    /// How spherical lights are sampled.
    pub light_sampling: LightSampling,
    /// How dielectrics share light between reflection and refraction.
    pub fresnel: Fresnel,
    /// Paths that carry little may end at random, unbiased, after any scattering event but the first so many; `None`
    /// never.
    pub roulette_after: Option<u32>,
    /// Whether some diffuse directions go to [`crate::SceneParts::aims`].
    pub aim: bool,
    /// How the numbers of the samples of one pixel relate to each other, where the kernel makes them itself.
    pub sampler: SamplerKind,
    /// Seed of the sample numbers.
    pub seed: u64,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            max_bounces: 7,
            indirect: true,
            light_sampling: LightSampling::Cone,
            fresnel: Fresnel::Exact,
            roulette_after: None,
            aim: false,
            sampler: SamplerKind::Independent,
            seed: 0,
        }
    }
}

impl PathOptions {
    /// The effects that these options need in any scene.
    pub fn required_effects(&self) -> Effects {
        let roulette = Effects::ROULETTE.when(self.roulette_after.is_some());
        let sobol = Effects::SOBOL.when(self.sampler == SamplerKind::Sobol);
        Effects::INDIRECT.when(self.indirect).union(roulette).union(sobol)
    }
}

/// The radiance that one path found, and the ray queries it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSample<R: Real> {
    /// Linear Rec.709 radiance along the first ray.
    pub radiance: Vec3<R>,
    /// Number of ray queries.
    pub rays: u32,
}

/// Follows one path from `ray` through `scene`. The sampler stands at vertex 0, whose numbers made the ray.
#[inline(always)]
pub fn radiance<R: Real, E: EffectSet>(
    scene: &Scene<'_, R>,
    options: &PathOptions,
    mut ray: Ray<R>,
    sampler: &mut impl Sampler,
) -> PathSample<R> {
    let (mut radiance, mut throughput, mut rays) = (Vec3::<R>::ZERO, Vec3::<R>::ONE, 0);
    // Whether a sampled light that the ray meets has yet to be counted: not after a diffuse bounce.
    let mut sees_lights = true;
    let mut departure = Departure::exactly(ray.origin);
    for bounce in 0..=options.max_bounces {
        if bounce == options.max_bounces && !last_segment_counts(scene, sees_lights) {
            break;
        }
        rays += 1;
        let Some(hit) = scene.intersect_from::<E>(&ray, &departure) else {
            if const { E::EFFECTS.contains(Effects::BACKGROUND) } {
                radiance = radiance + throughput * scene.background();
            }
            break;
        };
        let point = surface_point::<R, E>(scene, &ray, &hit);
        let material = &scene.materials()[point.material as usize];
        if const { E::EFFECTS.intersects(Effects::EMISSION.union(Effects::SPHERE_LIGHT)) }
            && material.is_emissive()
            && (sees_lights || !scene.is_light(hit.primitive))
        {
            radiance = radiance + throughput * material.emission;
        }
        if bounce == options.max_bounces {
            break;
        }

        sampler.begin_vertex(bounce + 1);
        let numbers = sampler.numbers(Block::Scatter);
        let facing = point.toward_viewer::<E>();
        let arrival = Arrival { scene, ray: &ray, hit: &hit, point: &point };
        let sample = match &material.scattering {
            Scattering::Mirror(glossy) if const { E::EFFECTS.contains(Effects::MIRROR) } => {
                let sample = mirror::sample(point.wo, &facing, glossy);
                departure = arrival.reflected::<E>(&facing);
                sample
            }
            Scattering::Dielectric(glass) if const { E::EFFECTS.contains(Effects::GLASS) } => {
                let sample = dielectric::sample(&point, &facing, glass, options.fresnel, numbers[2]);
                departure = arrival.scattered::<E>(&facing, sample.wi);
                sample
            }
            Scattering::Diffuse(surface) => {
                let albedo = albedo::<R, E>(scene, &point, surface);
                if albedo == Vec3::<R>::ZERO {
                    break;
                }
                departure = arrival.reflected::<E>(&facing);
                if const { E::EFFECTS.intersects(Effects::POINT_LIGHT.union(Effects::SPHERE_LIGHT)) } {
                    let light = sampler.numbers(Block::Light);
                    let arriving = light::direct::<R, E>(scene, options, &point, &facing, &departure, light, &mut rays);
                    radiance = radiance + throughput * albedo * arriving;
                }
                if !(const { E::EFFECTS.contains(Effects::INDIRECT) } && options.indirect) {
                    break;
                }
                let sample = if const { E::EFFECTS.contains(Effects::AIM) } && options.aim {
                    aim::sample(scene.aims(), &point, &facing, albedo, numbers)
                } else {
                    let [u, v] = [numbers[0], numbers[1]].map(R::from_unit_bits);
                    diffuse::sample(&facing, albedo, u, v)
                };
                match sample {
                    Some(sample) => sample,
                    None => break,
                }
            }
            _ => break,
        };
        throughput = throughput * sample.weight;
        if const { E::EFFECTS.contains(Effects::ROULETTE) }
            && options.roulette_after.is_some_and(|after| bounce >= after)
        {
            match survival::<R>(throughput, numbers[3]) {
                Some(compensation) => throughput = throughput * compensation,
                None => break,
            }
        }
        let by_chance =
            const { E::EFFECTS.contains(Effects::SPHERE_LIGHT) } && options.light_sampling == LightSampling::None;
        sees_lights = sample.delta || by_chance;
        ray = Ray::new(departure.origin, sample.wi);
    }
    PathSample { radiance, rays }
}

/// Whether the segment after the last scattering event can add anything: it can only end at light.
#[inline]
pub(crate) fn last_segment_counts<R: Real>(scene: &Scene<'_, R>, sees_lights: bool) -> bool {
    let effects = scene.required_effects();
    effects.intersects(Effects::EMISSION.union(Effects::BACKGROUND))
        || (sees_lights && effects.contains(Effects::SPHERE_LIGHT))
}

/// Albedo of a diffuse surface at a point, with its texture.
#[inline]
pub(crate) fn albedo<R: Real, E: EffectSet>(
    scene: &Scene<'_, R>,
    point: &SurfacePoint<R>,
    surface: &Diffuse<R>,
) -> Vec3<R> {
    match surface.texture {
        Some(texture) if const { E::EFFECTS.contains(Effects::TEXTURES) } => {
            surface.albedo * scene.textures()[texture as usize].lookup(point.uv)
        }
        _ => surface.albedo,
    }
}

/// Below this throughput paths may end: above it they are worth their time, since ending them adds noise.
const ROULETTE_BELOW: f64 = 0.25;

/// Roulette: a path whose largest throughput is below [`ROULETTE_BELOW`] lives with the probability of their ratio (at
/// least 1/20, so that no weight grows beyond 20 times), and what lives is worth more in turn. Unbiased.
#[inline]
pub(crate) fn survival<R: Real>(throughput: Vec3<R>, number: u32) -> Option<R> {
    let least = R::from_f64(0.05);
    let ratio = throughput.max_component() * R::from_f64(1.0 / ROULETTE_BELOW);
    let probability = if ratio > least { ratio } else { least };
    if probability >= R::ONE {
        Some(R::ONE)
    } else if R::from_unit_bits(number) < probability {
        Some(R::ONE / probability)
    } else {
        None
    }
}
