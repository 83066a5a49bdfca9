//! Lights over a floor, against their form factors and each other: A5, A6, A9.

use std::f64::consts::{PI, TAU};

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::light::LightSampling;
use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::sampler::{AddressedSampler, Block, Sampler};
use ocellus_kernel::{Everything, Ray};

use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, floor};
use crate::support::random::Random;
use crate::support::scene::{OwnedScene, v};
use crate::support::statistics::Moments;
use crate::support::tolerance::{self, u};
use crate::support::trials::Trials;

in_both_precisions!(polygon_lights_have_their_form_factor, coaxial_discs_have_their_form_factor, estimators_agree,);

const ALBEDO: f64 = 0.7;
const EMISSION: f64 = 1.25;

/// A grey floor at y = 0, so small that roundings of its points are nothing against the height of a light.
fn ground<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let grey = scene.diffuse(ALBEDO, 0.0);
    scene.mesh(&floor(2.0), grey);
    scene
}

/// Numbers of which the two that choose a direction fall into one cell of a square of cells by cells each.
struct Stratified {
    numbers: AddressedSampler,
    cell: [u32; 2],
    cells: u32,
}

impl Sampler for Stratified {
    fn begin_vertex(&mut self, vertex: u32) {
        self.numbers.begin_vertex(vertex);
    }

    fn numbers(&self, block: Block) -> [u32; 4] {
        let [u, v, w, x] = self.numbers.numbers(block);
        let within =
            |cell: u32, number: u32| ((u64::from(cell) << 32 | u64::from(number)) / u64::from(self.cells)) as u32;
        if block == Block::Scatter { [within(self.cell[0], u), within(self.cell[1], v), w, x] } else { [u, v, w, x] }
    }
}

/// Radiance that leaves the floor straight up from points just below `place`, by light found by chance: the means of 200
/// runs, each of whose 10,000 directions go to a cell of their own.
fn found_by_chance<R: Real>(scene: &OwnedScene<R>, place: &mut dyn FnMut() -> [f64; 3]) -> Moments {
    const CELLS: u32 = 100;
    let options = PathOptions { max_bounces: 1, light_sampling: LightSampling::None, ..PathOptions::default() };
    let mut moments = Moments::default();
    scene.lend(Some(Structure::Bvh), |scene| {
        for run in 0..200 {
            let mut sum = 0.0;
            for at in 0..CELLS * CELLS {
                let ray = Ray::new(v::<R>(place()), v::<R>([0.0, -1.0, 0.0]));
                let numbers = AddressedSampler::new(options.seed, run, 0, at);
                let mut sampler = Stratified { numbers, cell: [at % CELLS, at / CELLS], cells: CELLS };
                sampler.begin_vertex(0);
                sum += radiance::<R, Everything>(scene, &options, ray, &mut sampler).radiance.x().to_f64();
            }
            moments.add(sum / f64::from(CELLS * CELLS));
        }
    });
    moments
}

/// Radiance that leaves the floor straight up from points just below `place`.
fn reflected<R: Real>(
    scene: &OwnedScene<R>,
    light_sampling: LightSampling,
    samples: u32,
    place: &mut dyn FnMut() -> [f64; 3],
) -> Moments {
    let seed = 99 + light_sampling as u64;
    let options = PathOptions { max_bounces: 1, light_sampling, seed, ..PathOptions::default() };
    let mut moments = Moments::default();
    scene.lend(Some(Structure::Bvh), |scene| {
        for sample in 0..samples {
            let ray = Ray::new(v::<R>(place()), v::<R>([0.0, -1.0, 0.0]));
            let mut sampler = AddressedSampler::new(options.seed, 0, 0, sample);
            sampler.begin_vertex(0);
            moments.add(radiance::<R, Everything>(scene, &options, ray, &mut sampler).radiance.x().to_f64());
        }
    });
    moments
}

/// Adds a polygon that emits, star-shaped about its first corner.
fn add_polygon<R: Real>(scene: &mut OwnedScene<R>, corners: &[[f64; 3]]) {
    let black = scene.diffuse(0.0, EMISSION);
    let triangles = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
    scene.mesh(&Mesh { positions: corners.to_vec(), triangles }, black);
}

/// Fails where a mean is not the expected one, or not known well enough to tell.
fn check(case: &Trials, what: &str, moments: &Moments, expected: f64, rounding: f64) {
    case.error(moments.deviations(expected, rounding), || format!("{what}: {} is not {expected}", moments.mean()));
    moments.assert_precise(what, tolerance::BY_CHANCE);
}

/// A5. `E = L/2 |sum of gamma_i (v_i x v_(i+1)) / |v_i x v_(i+1)| . n|`, for polygons above the horizon that paths
/// find by chance.
fn polygon_lights_have_their_form_factor<R: Real>() {
    let case = Trials::measured::<R>("A5", "polygon lights", tolerance::DEVIATIONS, "standard errors");
    for (what, corners) in [
        ("triangle", vec![[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [0.0, 1.5, 1.2]]),
        ("wall", vec![[0.75, 0.125, -2.0], [0.75, 0.125, 2.0], [0.75, 2.0, 2.0], [0.75, 2.0, -2.0]]),
        ("ceiling", vec![[-2.0, 0.5, -2.0], [2.0, 0.5, -2.0], [2.0, 0.5, 2.0], [-2.0, 0.5, 2.0]]),
        (
            "an L",
            [[1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]
                .map(|[x, z]| [x - 0.5, 0.75 + 0.25 * x, z - 0.5])
                .to_vec(),
        ),
    ] {
        let mut scene = ground::<R>();
        add_polygon(&mut scene, &corners);
        let sum: f64 = (0..corners.len())
            .map(|i| {
                let [a, b] = [i, (i + 1) % corners.len()].map(|i| normalize::<f64>(v::<f64>(corners[i])));
                let cross = a.cross(b);
                let sine = cross.dot(cross).sqrt();
                libm::atan2(sine, a.dot(b)) * cross.y() / sine
            })
            .sum();
        let expected = ALBEDO / PI * EMISSION * 0.5 * sum.abs();
        let moments = found_by_chance(&scene, &mut || [0.0, 0.0625, 0.0]);
        check(&case, what, &moments, expected, tolerance::LIT_PLANE * u::<R>());
    }
    case.end(4);
}

/// A6. The share of a disc's light that reaches another on the same axis, which is the mean irradiance on it.
fn coaxial_discs_have_their_form_factor<R: Real>() {
    let case = Trials::measured::<R>("A6", "coaxial discs", tolerance::DEVIATIONS, "standard errors");
    for (receiver, emitter, height) in [(1.0, 1.5, 0.7), (1.0, 1.0, 1.0), (1.5, 1.0, 0.5)] {
        const SIDES: u32 = 1024;
        let mut scene = ground::<R>();
        let rim = |i: u32| {
            let turn = TAU * f64::from(i) / f64::from(SIDES);
            [emitter * libm::cos(turn), height, emitter * libm::sin(turn)]
        };
        add_polygon(&mut scene, &[vec![[0.0, height, 0.0]], (0..=SIDES).map(rim).collect()].concat());
        let [near, far]: [f64; 2] = [receiver / height, emitter / height];
        let x = 1.0 + (1.0 + far * far) / (near * near);
        let factor = 0.5 * (x - (x * x - 4.0 * (emitter / receiver) * (emitter / receiver)).sqrt());
        let mut random = Random::new(601);
        let moments = found_by_chance(&scene, &mut || {
            let (r, turn) = (receiver * random.unit().sqrt(), TAU * random.unit());
            [r * libm::cos(turn), 0.0625, r * libm::sin(turn)]
        });
        let what = format!("discs of {receiver} and {emitter} at {height}");
        let rounding = tolerance::LIT_PLANE * u::<R>() + tolerance::polygon_for_disc(SIDES);
        check(&case, &what, &moments, ALBEDO * EMISSION * factor, rounding);
    }
    case.end(3);
}

/// A9. A spherical light sampled by its cone, by a hemisphere of it, or found by chance: the same mean, wherever it
/// stands, cut by the horizon or not.
fn estimators_agree<R: Real>() {
    let case =
        Trials::measured::<R>("A9", "ways to sample a light, in pairs", tolerance::DEVIATIONS, "standard errors");
    for (distance, cosine) in [(3.0, 1.0), (2.0, 0.6), (1.5, 0.0), (1.5, -0.3)] {
        let mut scene = ground::<R>();
        let sine: f64 = (1.0f64 - cosine * cosine).sqrt();
        scene.sphere_light([sine * distance, cosine * distance, 0.0], 1.0, EMISSION);
        let ways = [LightSampling::Cone, LightSampling::Hemisphere, LightSampling::None].map(|way| {
            let samples = if way == LightSampling::Cone { 1_000_000 } else { 300_000 };
            let moments = reflected(&scene, way, samples, &mut || [0.0, 0.0625, 0.0]);
            let waste = 1.0 + 4.0 * f64::from(cosine * distance < 1.0);
            moments.assert_precise(&format!("{way:?}"), waste * tolerance::bias(way));
            (way, moments)
        });
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let [(one, a), (other, b)] = [&ways[i], &ways[j]];
            case.error(a.deviations_from(b), || format!("distance {distance}, cosine {cosine}: {one:?} and {other:?}"));
        }
    }
    case.end(12);
}
