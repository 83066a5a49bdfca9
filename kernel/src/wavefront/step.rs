//! The steps that all lanes take together: [`crate::path::radiance`] for many paths.

use core::ops::Range;

use super::columns::{Column, GROUP, LANES, Lanes, Vectors};
use super::departures::{Arrivals, Departures};
use super::directions::{Directions, Kind};
use super::few::{FEW_SPHERES, Few};
use super::glass;
use super::hits::{Hits, Rays, closest};
use super::light::Samples;
use super::numbers::Addresses;
use super::queue::Queue;
use super::surfaces::Surfaces;
use crate::effects::{EffectSet, Effects};
use crate::film::{Pixel, to_sample};
use crate::light::LightSampling;
use crate::material::Scattering;
use crate::path::{albedo, last_segment_counts, survival};
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3, Vector};
use crate::sampler::Block;
use crate::view::{View, Work};

/// The paths of all lanes.
struct Paths<R: Real> {
    rays: Rays<R>,
    radiance: Vectors<R>,
    throughput: Vectors<R>,
    /// Whether there is a path.
    live: Column<bool>,
    sees_lights: Column<bool>,
    bounce: Column<u32>,
    /// Where in the queue the path is.
    place: Column<usize>,
    addresses: Addresses,
}

/// [`View::render`], many paths at a time.
#[inline(always)]
pub(crate) fn render<R: Real, E: EffectSet>(
    view: &View<'_, R>,
    x: u32,
    y: u32,
    samples: Range<u32>,
    pixels: &mut [Pixel],
) -> Work {
    let View { scene, options, .. } = *view;
    // Paths that end before their first segment.
    if options.max_bounces == 0 && !last_segment_counts(scene, true) {
        return view.render::<E>(x, y, samples, pixels);
    }
    let Some(few) = Few::of::<E>(scene) else { return view.render::<E>(x, y, samples, pixels) };
    let mut queue = Queue::new(pixels, samples);
    let mut paths = Paths {
        rays: Rays::none(),
        radiance: Vectors::ZERO,
        throughput: Vectors::ZERO,
        live: [false; LANES],
        sees_lights: [false; LANES],
        bounce: [0; LANES],
        place: [0; LANES],
        addresses: Addresses::new(options.seed, y, options.sampler),
    };
    let (mut hits, mut surfaces) = (Hits::none(), Surfaces::none());
    let (mut departures, mut directions) = (Departures::none(), Directions::none());
    let mut lights = Samples::none();
    let mut rays = 0;
    loop {
        queue.add_ended();
        paths.start::<E>(view, [x, y], &mut queue);
        let alive = paths.live.iter().filter(|live| **live).count();
        if alive == 0 {
            return Work { paths: queue.started() as u64, rays };
        }
        rays += alive as u64;
        closest::<R, E>(&few, &paths.rays, &paths.live, &mut hits);
        surfaces.find::<E>(&few, &paths.rays, &hits);
        let (kinds, albedos) = paths.arrive::<E>(view, &few, &hits, &surfaces, &mut queue);

        let mut vertex = paths.bounce;
        vertex.iter_mut().for_each(|vertex| *vertex += 1);
        let numbers = paths.addresses.numbers::<E>(&vertex, Block::Scatter);
        let from = Arrivals { few: &few, rays: &paths.rays, hits: &hits, surfaces: &surfaces };
        departures.reflect::<E>(&from, &paths.live);
        let is_diffuse = kinds.map(|kind| kind == Kind::Diffuse);
        if const { E::EFFECTS.intersects(Effects::POINT_LIGHT.union(Effects::SPHERE_LIGHT)) } {
            let numbers = paths.addresses.numbers::<E>(&vertex, Block::Light);
            let (arriving, shadows) = lights.direct::<E>(options, &from, &departures, &numbers, &is_diffuse);
            rays += shadows;
            for lane in 0..LANES {
                let more = paths.throughput.at(lane) * albedos.at(lane) * arriving.at(lane);
                let more = if is_diffuse[lane] { more } else { Vec3::<R>::ZERO };
                paths.radiance.set(lane, paths.radiance.at(lane) + more);
            }
        }
        if const { E::EFFECTS.contains(Effects::INDIRECT) } && options.indirect {
            directions.diffuse::<E>(options, &from, &kinds, &albedos, &numbers);
        } else {
            directions.found = [false; LANES];
        }
        if const { E::EFFECTS.intersects(Effects::MIRROR.union(Effects::GLASS)) } {
            directions.one_by_one::<E>(options, &from, &kinds, &numbers, &mut departures);
        }
        if const { E::EFFECTS.contains(Effects::GLASS) && glass::in_groups::<E>() } {
            glass::scatter(options.fresnel, &from, &kinds, &numbers[2], &mut departures, &mut directions);
        }
        paths.go_on::<E>(view, &is_diffuse, &departures, &directions, &numbers[3], &mut queue);
    }
}

impl<R: Real> Paths<R> {
    /// A new path in each lane that has none.
    #[inline(always)]
    fn start<E: EffectSet>(&mut self, view: &View<'_, R>, [x, y]: [u32; 2], queue: &mut Queue<'_>) {
        let mut free = Lanes::that(|lane| !self.live[lane]);
        loop {
            let (lanes, count) = free.next_group();
            let lanes = &lanes[..count];
            if lanes.is_empty() {
                return;
            }
            let (mut columns, mut samples) = ([x; GROUP], [0; GROUP]);
            let mut started = 0;
            for (k, &lane) in lanes.iter().enumerate() {
                let Some(start) = queue.start() else { break };
                columns[k] = x.wrapping_add(start.pixel);
                samples[k] = start.sample;
                self.place[lane] = start.place;
                started = k + 1;
            }
            let numbers = self.addresses.start::<E>(&lanes[..started], &columns, &samples);
            let (mut origins, mut directions) = (Vectors::<R, GROUP>::ZERO, Vectors::<R, GROUP>::ZERO);
            let mut offsets = [[R::ZERO; GROUP]; 2];
            for k in 0..GROUP {
                let [u, v] = [numbers[0][k], numbers[1][k]].map(R::from_unit_bits);
                [offsets[0][k], offsets[1][k]] = view.camera.offset::<E>(u, v);
            }
            for k in 0..GROUP {
                let lens = [numbers[2][k], numbers[3][k]].map(R::from_unit_bits);
                let ray = view.camera.ray_through::<E>([columns[k], y], [offsets[0][k], offsets[1][k]], lens);
                origins.set(k, ray.origin);
                directions.set(k, ray.direction);
            }
            for (k, &lane) in lanes[..started].iter().enumerate() {
                self.rays.origin.set(lane, origins.at(k));
                self.rays.direction.set(lane, directions.at(k));
                self.rays.error[lane] = R::ZERO;
                self.rays.departed[lane] = NO_PRIMITIVE;
                self.radiance.set(lane, Vec3::<R>::ZERO);
                self.throughput.set(lane, Vec3::<R>::ONE);
                self.live[lane] = true;
                self.sees_lights[lane] = true;
                self.bounce[lane] = 0;
            }
        }
    }

    /// Counts what shines where rays arrive, and finds what each surface does, and its albedo where it is diffuse. Paths
    /// that go no further end.
    #[inline(always)]
    fn arrive<E: EffectSet>(
        &mut self,
        view: &View<'_, R>,
        few: &Few<'_, R>,
        hits: &Hits<R>,
        surfaces: &Surfaces<R>,
        queue: &mut Queue<'_>,
    ) -> (Column<Kind>, Vectors<R>) {
        let options = view.options;
        let (mut kinds, mut albedos) = ([Kind::Ends; LANES], Vectors::ZERO);
        let mut has_more = [0u32; LANES];
        for lane in 0..LANES {
            let at = hits.primitive[lane] as usize % FEW_SPHERES;
            let of_spheres = (hits.primitive[lane] as usize) < few.spheres.len();
            kinds[lane] = few.table.kind[at];
            albedos.set(lane, few.table.albedo.at(at));
            has_more[lane] = if of_spheres { few.table.has_more[at] } else { 1 };
        }
        for lane in Lanes::that(|lane| self.live[lane] & (has_more[lane] != 0)) {
            kinds[lane] = Kind::Ends;
            let albedo = self.look::<E>(lane, view, hits, surfaces, &mut kinds[lane]);
            albedos.set(lane, albedo);
        }
        for lane in 0..LANES {
            if !self.live[lane] | (self.bounce[lane] == options.max_bounces) {
                kinds[lane] = Kind::Ends;
            }
        }
        for lane in Lanes::that(|lane| self.live[lane] & (kinds[lane] == Kind::Ends)) {
            self.end(lane, queue);
        }
        (kinds, albedos)
    }

    /// A closer look at where the ray of one lane arrives: its light, the albedo and what the surface does.
    #[inline(always)]
    fn look<E: EffectSet>(
        &mut self,
        lane: usize,
        view: &View<'_, R>,
        hits: &Hits<R>,
        surfaces: &Surfaces<R>,
        kind: &mut Kind,
    ) -> Vec3<R> {
        let scene = view.scene;
        let shine = |radiance: Vec3<R>| self.radiance.at(lane) + self.throughput.at(lane) * radiance;
        if hits.primitive[lane] == NO_PRIMITIVE {
            if const { E::EFFECTS.contains(Effects::BACKGROUND) } {
                self.radiance.set(lane, shine(scene.background()));
            }
            return Vec3::<R>::ZERO;
        }
        let material = &scene.materials()[surfaces.material[lane] as usize];
        if const { E::EFFECTS.intersects(Effects::EMISSION.union(Effects::SPHERE_LIGHT)) }
            && material.is_emissive()
            && (self.sees_lights[lane] || !scene.is_light(hits.primitive[lane]))
        {
            self.radiance.set(lane, shine(material.emission));
        }
        *kind = Kind::of::<R, E>(&material.scattering);
        let Scattering::Diffuse(surface) = &material.scattering else { return Vec3::<R>::ZERO };
        let albedo = albedo::<R, E>(scene, &surfaces.point(lane), surface);
        if albedo == Vec3::<R>::ZERO {
            *kind = Kind::Ends;
        }
        albedo
    }

    /// The next segment of each path, or its end.
    #[inline(always)]
    fn go_on<E: EffectSet>(
        &mut self,
        view: &View<'_, R>,
        is_diffuse: &Column<bool>,
        departures: &Departures<R>,
        directions: &Directions<R>,
        roulette: &Column<u32>,
        queue: &mut Queue<'_>,
    ) {
        let View { scene, options, .. } = *view;
        let by_chance =
            const { E::EFFECTS.contains(Effects::SPHERE_LIGHT) } && options.light_sampling == LightSampling::None;
        self.rays.origin = departures.origin;
        self.rays.direction = directions.wi;
        self.rays.error = departures.error;
        self.rays.departed = departures.sphere;
        for lane in 0..LANES {
            self.throughput.set(lane, self.throughput.at(lane) * directions.weight.at(lane));
            self.sees_lights[lane] = !is_diffuse[lane] | by_chance;
            self.bounce[lane] += 1;
        }
        let counts = [false, true].map(|sees_lights| last_segment_counts(scene, sees_lights));
        let mut goes_on = directions.found;
        for lane in 0..LANES {
            let counts = if self.sees_lights[lane] { counts[1] } else { counts[0] };
            goes_on[lane] &= (self.bounce[lane] < options.max_bounces) | counts;
        }
        if const { E::EFFECTS.contains(Effects::ROULETTE) }
            && let Some(after) = options.roulette_after
        {
            for lane in Lanes::that(|lane| self.live[lane] & goes_on[lane] & (self.bounce[lane] > after)) {
                match survival::<R>(self.throughput.at(lane), roulette[lane]) {
                    Some(compensation) => self.throughput.set(lane, self.throughput.at(lane) * compensation),
                    None => goes_on[lane] = false,
                }
            }
        }
        for lane in Lanes::that(|lane| self.live[lane] & !goes_on[lane]) {
            self.end(lane, queue);
        }
    }

    #[inline(always)]
    fn end(&mut self, lane: usize, queue: &mut Queue<'_>) {
        self.live[lane] = false;
        queue.end(self.place[lane], to_sample::<R>(self.radiance.at(lane)));
    }
}
