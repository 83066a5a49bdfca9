//! Lights over a floor, against their form factors and each other: A4, A5, A6, A9.

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
use crate::support::scene::{OwnedScene, v};
use crate::support::statistics::Moments;
use crate::support::tolerance::{self, u};
use crate::support::trials::Trials;

in_both_precisions!(
    a_sphere_light_over_a_plane_has_its_form_factor,
    a_plane_inside_a_sphere_light_gets_all_of_it,
    lights_add_up,
    polygon_lights_have_their_form_factor,
    coaxial_discs_have_their_form_factor,
    estimators_agree,
);

const ALBEDO: f64 = 0.7;
const EMISSION: f64 = 1.25;
const WAYS: [LightSampling; 3] = [LightSampling::Cone, LightSampling::Hemisphere, LightSampling::None];

/// A grey floor at y = 0, so small that roundings of its points are nothing against the height of a light.
fn ground<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let grey = scene.diffuse(ALBEDO, 0.0);
    scene.mesh(&floor(2.0), grey);
    scene
}

/// Numbers of which the two that choose a direction, and the two that choose a point of a light, fall into one cell of a
/// square of cells by cells each.
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
        [within(self.cell[0], u), within(self.cell[1], v), w, x]
    }
}

/// Radiance that leaves the floor straight up from points just below `place`: the means of runs, each of whose paths
/// go to a cell of their own, which leaves of their variance what the edge of a light makes in the cells on it. As many
/// runs as make the mean [`tolerance::PRECISE`].
fn reflected<R: Real>(
    scene: &OwnedScene<R>,
    light_sampling: LightSampling,
    place: &mut dyn FnMut() -> [f64; 3],
) -> Moments {
    // The edge of a light that is found by chance weighs most, that of a cone least.
    let cells = match light_sampling {
        LightSampling::Cone => 50,
        LightSampling::Hemisphere => 150,
        LightSampling::None => 300,
    };
    let seed = 99 + light_sampling as u64;
    let options = PathOptions { max_bounces: 1, light_sampling, seed, ..PathOptions::default() };
    let mut moments = Moments::default();
    scene.lend(Some(Structure::Bvh), |scene| {
        let mut run = 0;
        while run < 30 || (run < 300 && moments.relative_error() > tolerance::PRECISE) {
            let mut sum = 0.0;
            for at in 0..cells * cells {
                let ray = Ray::new(v::<R>(place()), v::<R>([0.0, -1.0, 0.0]));
                let numbers = AddressedSampler::new(options.seed, run, 0, at);
                let mut sampler = Stratified { numbers, cell: [at % cells, at / cells], cells };
                sampler.begin_vertex(0);
                sum += radiance::<R, Everything>(scene, &options, ray, &mut sampler).radiance.x().to_f64();
            }
            moments.add(sum / f64::from(cells * cells));
            run += 1;
        }
    });
    moments
}

/// Just above the middle of the floor.
const NEAR_ORIGIN: [f64; 3] = [0.0, 1.0 / 1024.0, 0.0];

/// Irradiance over radiance from a sphere of radius `r` at distance `d`, `cosine` from the normal; where the
/// horizon cuts it, the part above.
fn form_factor(r: f64, d: f64, cosine: f64) -> f64 {
    let s = (r / d) * (r / d);
    if cosine * d >= r {
        return PI * s * cosine;
    }
    if cosine * d <= -r {
        return 0.0;
    }
    let sine = (1.0 - cosine * cosine).sqrt();
    let x = (1.0 / s - 1.0).sqrt();
    let y = -x * cosine / sine;
    let q = sine * (1.0 - y * y).sqrt();
    (cosine * libm::acos(y) - x * q) * s + libm::atan(q / x)
}

/// A4 by each way to sample the light, and by not sampling it at all.
fn a_sphere_light_over_a_plane_has_its_form_factor<R: Real>() {
    let case =
        Trials::measured::<R>("A4", "lights: cone, hemisphere, chance", tolerance::DEVIATIONS, "standard errors");
    for (radius, distance, cosine) in [
        (1.0, 3.0, 1.0),
        (1.0, 3.0, 0.6),
        (1.0, 2.0, 0.3),
        (1.0, 1.5, 0.0),
        (1.0, 1.5, -0.3),
        (0.5, 0.51, 0.8),
        (0.5, 0.6, 0.8),
        (1.0, 300.0, 0.5),
        (1e-3, 300.0, 0.5),
    ] {
        let mut scene = ground::<R>();
        let sine: f64 = (1.0f64 - cosine * cosine).sqrt();
        scene.sphere_light([sine * distance, cosine * distance, 0.0], radius, EMISSION);
        let expected = ALBEDO / PI * EMISSION * form_factor(radius, distance, cosine);
        for way in WAYS {
            // Few paths find a small light by chance, and few points of a light that is almost touched give most of its
            // light: no mean of these becomes precise.
            let (small, touched) = (expected < 0.01, distance - radius < 0.1 * radius);
            if (small && way == LightSampling::None) || (touched && way == LightSampling::Hemisphere) {
                continue;
            }
            let moments = reflected(&scene, way, &mut || NEAR_ORIGIN);
            let what = format!("radius {radius} distance {distance} cosine {cosine} {way:?}");
            check(&case, &what, &moments, expected, tolerance::LIT_PLANE * u::<R>());
        }
    }
    case.end(24);
}

/// From inside, the light is everywhere: `E = pi L`.
fn a_plane_inside_a_sphere_light_gets_all_of_it<R: Real>() {
    let case = Trials::measured::<R>("A4", "inside the light", tolerance::DEVIATIONS, "standard errors");
    let mut scene = ground::<R>();
    scene.sphere_light([0.5, 2.0, -1.0], 10.0, EMISSION);
    for way in WAYS {
        let moments = reflected(&scene, way, &mut || NEAR_ORIGIN);
        check(&case, &format!("{way:?}"), &moments, ALBEDO * EMISSION, tolerance::LIT_PLANE * u::<R>());
    }
    case.end(3);
}

/// Several lights of both kinds give the sum of what each gives alone.
fn lights_add_up<R: Real>() {
    let case = Trials::measured::<R>("A4", "five lights", tolerance::DEVIATIONS, "standard errors");
    let mut scene = ground::<R>();
    let mut expected = 0.0;
    // None of them before another.
    for (radius, distance, cosine, turn) in [(1.0, 3.0, 0.6, 0.2), (0.5, 4.0, 0.3, 1.8), (0.7, 5.0, 0.2, 4.5)] {
        let reach = distance * (1.0f64 - cosine * cosine).sqrt();
        scene.sphere_light([reach * libm::cos(turn), cosine * distance, reach * libm::sin(turn)], radius, EMISSION);
        expected += EMISSION * form_factor(radius, distance, cosine);
    }
    for height in [2.0, 3.0] {
        scene.point_light([0.0, height, 0.0], 1.0);
        expected += 1.0 / (height * height);
    }
    for way in [LightSampling::Cone, LightSampling::Hemisphere] {
        let moments = reflected(&scene, way, &mut || NEAR_ORIGIN);
        check(&case, &format!("{way:?}"), &moments, ALBEDO / PI * expected, tolerance::LIT_PLANE * u::<R>());
    }
    case.end(2);
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
    moments.assert_precise(what, tolerance::PRECISE);
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
        let moments = reflected(&scene, LightSampling::None, &mut || [0.0, 0.0625, 0.0]);
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
        // An additive recurrence by the powers of the plastic number spreads the places evenly (M. Roberts, 2018).
        let mut place = [0.5, 0.5];
        let moments = reflected(&scene, LightSampling::None, &mut || {
            place = [place[0] + 0.754_877_666_246_692_7, place[1] + 0.569_840_290_998_053_2].map(|x| x % 1.0);
            let (r, turn) = (receiver * place[0].sqrt(), TAU * place[1]);
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
        let ways = WAYS.map(|way| {
            let moments = reflected(&scene, way, &mut || [0.0, 0.0625, 0.0]);
            moments.assert_precise(&format!("{way:?}"), tolerance::PRECISE);
            (way, moments)
        });
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let [(one, a), (other, b)] = [&ways[i], &ways[j]];
            case.error(a.deviations_from(b), || format!("distance {distance}, cosine {cosine}: {one:?} and {other:?}"));
        }
    }
    case.end(12);
}
