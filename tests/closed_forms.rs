//! Scenes whose radiance has a closed form: a closed diffuse sphere, point lights, sphere lights. Where every path
//! must find the same value, every path is checked; else the mean, with a z-test.

use std::f64::consts::PI;

use ocellus_kernel::camera::CameraSettings;
use ocellus_kernel::light::LightSampling;
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::{Everything, View};

use crate::support::in_both_precisions;
use crate::support::meshes::{cube, floor};
use crate::support::scene::{CAMERA, OwnedScene, each_path, picture, with_view};
use crate::support::statistics::Moments;
use crate::support::tolerance::{self, u};
use crate::support::trials::Trials;

in_both_precisions!(
    a_closed_emitter_is_a_geometric_series,
    a_lamp_in_a_closed_sphere_is_a_geometric_series,
    a_point_light_over_a_plane_falls_with_cosine_and_square,
    walls_stop_light_and_open_air_does_not,
    roulette_keeps_the_mean,
    aim_keeps_the_mean,
    bounces_are_counted_as_documented,
    indirect_off_leaves_direct_light,
);

const ALBEDO: f64 = 0.7;
const EMISSION: f64 = 1.25;

/// `1 + a + ... + a^k`.
fn series(albedo: f64, bounces: u32) -> f64 {
    (0..=bounces).map(|k| libm::pow(albedo, f64::from(k))).sum()
}

fn options(max_bounces: u32) -> PathOptions {
    PathOptions { max_bounces, seed: 99, ..PathOptions::default() }
}

/// In the middle of things, looking askew.
const INSIDE: CameraSettings = CameraSettings { position: [0.2, -0.1, 0.3], look_at: [0.5, 0.4, -0.6], ..CAMERA };

#[track_caller]
fn assert_each_path<R: Real>(view: &View<'_, R>, samples: u32, expected: f64, roundings: f64) {
    let bound = roundings * u::<R>() * expected;
    each_path::<R, Everything>(view, samples, &mut |radiance| {
        let error = radiance.map(|c| (c - expected).abs()).into_iter().fold(0.0, f64::max);
        assert!(error <= bound, "{radiance:?} is not {expected}: {} u", error / (u::<R>() * expected));
    });
    // And the film: its mean of equal samples is one of them, rounded to f32.
    for pixel in picture::<R, Everything>(view, 0..4) {
        let bound = bound + expected * f64::from(f32::EPSILON);
        assert!((f64::from(pixel.mean()[0]) - expected).abs() <= bound && pixel.count() == 4, "{:?}", pixel.mean());
    }
}

/// A1. Every wall emits and reflects: each path finds `Le (1 + a + ... + a^k)`, whichever way it goes. A path that
/// leaked or lost a bounce would find less.
fn a_closed_emitter_is_a_geometric_series<R: Real>() {
    let mut sphere = OwnedScene::<R>::default();
    let wall = sphere.diffuse(ALBEDO, EMISSION);
    sphere.sphere([0.0; 3], 1.0, wall);
    let mut hall = OwnedScene::<R>::default();
    let wall = hall.diffuse(ALBEDO, EMISSION);
    hall.mesh(&cube(2).inside_out(), wall);
    let mut huge = OwnedScene::<R>::default();
    let wall = huge.diffuse(ALBEDO, EMISSION);
    huge.sphere([3e4, -2e4, 5e4], 1e5, wall);
    for (scene, bounces) in [&sphere, &hall, &huge].into_iter().flat_map(|scene| [0, 1, 2, 7, 30].map(|k| (scene, k))) {
        let roundings = tolerance::PER_BOUNCE * f64::from(bounces + 1);
        with_view(scene, &INSIDE, &options(bounces), |view| {
            assert_each_path(view, 8, EMISSION * series(ALBEDO, bounces), roundings);
        });
    }
    Trials::passed::<R>("A1", "paths, each within 4 u per bounce", 3 * 5 * 8 * 256);
}

/// A2. A point light in the centre: direct light `a I / (pi R^2)` everywhere on the wall, hence a geometric series.
fn a_lamp_in_a_closed_sphere_is_a_geometric_series<R: Real>() {
    for (center, radius) in [([0.0; 3], 1.0), ([0.1, -0.2, 0.3], 2.0), ([1.0, 2.0, 3.0], 50.0)] {
        let mut scene = OwnedScene::<R>::default();
        let wall = scene.diffuse(ALBEDO, 0.0);
        scene.sphere(center, radius, wall);
        scene.point_light(center, PI);
        for bounces in [1, 2, 7, 30] {
            let roundings = tolerance::LIT_SURFACE + tolerance::PER_BOUNCE * f64::from(bounces);
            with_view(&scene, &INSIDE, &options(bounces), |view| {
                let direct = ALBEDO / (radius * radius);
                assert_each_path(view, 8, direct * series(ALBEDO, bounces - 1), roundings);
            });
        }
    }
    Trials::passed::<R>("A2", "paths, each within 16 u and 4 u per bounce", 3 * 4 * 8 * 256);
}

/// A3. `L = (a / pi) I cos / d^2` at the point that each pixel sees, over six orders of magnitude of size.
fn a_point_light_over_a_plane_falls_with_cosine_and_square<R: Real>() {
    let errors = Trials::measured::<R>("A3", "points of a plane", tolerance::LIT_PLANE, "u");
    for size in [1e-3, 1.0, 1e3] {
        let mut scene = OwnedScene::<R>::default();
        let grey = scene.diffuse(ALBEDO, 0.0);
        scene.mesh(&floor(10.0 * size), grey);
        let (light, intensity) = ([0.5 * size, 0.75 * size, -0.25 * size], 3.0 * size * size);
        scene.point_light(light, intensity);
        let settings = CameraSettings { position: [size, 2.0 * size, 3.0 * size], field_of_view: 0.5, ..CAMERA };
        with_view(&scene, &settings, &options(1), |view| {
            for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
                let ray = view.camera.ray::<Everything>(x, y, [0; 4]);
                let [[ox, oy, oz], [dx, dy, dz]] =
                    [ray.origin, ray.direction].map(|p| p.to_array().map(|c| c.to_f64()));
                let t = -oy / dy;
                let to_light = [light[0] - (ox + t * dx), light[1], light[2] - (oz + t * dz)];
                let square: f64 = to_light.iter().map(|x| x * x).sum();
                let expected = ALBEDO / PI * intensity * light[1] / (square * square.sqrt());
                let found = view.sample::<Everything>(x, y, 0).radiance.x().to_f64();
                let error = (found / expected - 1.0).abs() / u::<R>();
                errors.error(error, || format!("{x} {y}: {found} is not {expected}"));
            }
        });
    }
    errors.end(3 * 256);
}

/// Looks at the origin from a side where no light stands in the way.
const AT_ORIGIN: CameraSettings =
    CameraSettings { position: [-3.0, 3.0, 0.5], field_of_view: 1e-3, width: 1, height: 1, ..CAMERA };

fn plane<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let grey = scene.diffuse(ALBEDO, 0.0);
    scene.mesh(&floor(1000.0), grey);
    scene
}

/// A wall of 64 ulps stops all light; a light almost on the floor, and a wall just behind a light, stop none.
fn walls_stop_light_and_open_air_does_not<R: Real>() {
    let thin = 64.0 * 2.0 * u::<R>();
    let wall_at = |height: f64| floor(50.0).map(|[x, _, z]| [x, height, z]);
    for (heights, light, lit) in [
        (vec![1.0, 1.0 + thin], 2.0, false),
        (vec![0.01], 0.02, false),
        (vec![1.0 + thin], 1.0, true),
        (vec![1e-3], 0.5e-3, true),
        (vec![], 1e-3, true),
    ] {
        let mut scene = plane::<R>();
        let grey = scene.diffuse(0.0, 0.0);
        heights.iter().for_each(|height| scene.mesh(&wall_at(*height), grey));
        scene.point_light([0.0, light, 0.0], light * light);
        // From below the wall, on to a patch around the light's foot.
        let lowest = heights.iter().chain([&light]).copied().fold(f64::INFINITY, f64::min);
        let settings = CameraSettings {
            position: [-0.8 * lowest, 0.4 * lowest, 0.1 * lowest],
            look_at: [0.0; 3],
            field_of_view: 0.2,
            ..CAMERA
        };
        with_view(&scene, &settings, &options(1), |view| {
            each_path::<R, Everything>(view, 1, &mut |radiance| {
                assert_eq!(radiance[0] > 0.0, lit, "walls at {heights:?}, light at {light}: {radiance:?}");
            });
        });
    }
    Trials::passed::<R>("N25", "shadow rays past and through walls", 5 * 256);
}

/// Roulette ends paths at random and makes up for it: the mean stays, in the closed sphere known exactly.
fn roulette_keeps_the_mean<R: Real>() {
    let mut scene = OwnedScene::<R>::default();
    let wall = scene.diffuse(0.4, EMISSION);
    scene.sphere([0.0; 3], 1.0, wall);
    for (after, bounces) in [(0, 6), (2, 12)] {
        let on = PathOptions { roulette_after: Some(after), ..options(bounces) };
        let mut moments = Moments::default();
        with_view(&scene, &INSIDE, &on, |view| {
            each_path::<R, Everything>(view, 2000, &mut |radiance| moments.add(radiance[0]));
        });
        let expected = EMISSION * series(0.4, bounces);
        moments.assert_mean("closed sphere", expected, tolerance::PER_BOUNCE * u::<R>() * f64::from(bounces));
        moments.assert_precise("closed sphere", tolerance::ROULETTE);
        assert!(moments.spread() > 0.0, "roulette ended no path after {after} events");
    }

    // A hall with a lamp, where a path's worth varies: on against off.
    let mut hall = OwnedScene::<R>::default();
    let wall = hall.diffuse(0.6, 0.0);
    hall.mesh(&cube(1).inside_out(), wall);
    hall.sphere_light([0.2, 0.6, 0.1], 0.2, EMISSION);
    let measure = |roulette_after| {
        let mut moments = Moments::default();
        with_view(&hall, &INSIDE, &PathOptions { roulette_after, ..options(8) }, |view| {
            each_path::<R, Everything>(view, 400, &mut |radiance| moments.add(radiance[1]));
        });
        moments
    };
    measure(Some(1)).assert_same_mean("hall", &measure(None));
    Trials::passed::<R>("A10", "mean with roulette", 1);
}

/// Directions are aimed at spheres wherever they are, and weighed for it: the mean stays.
fn aim_keeps_the_mean<R: Real>() {
    let aimed = |mut scene: OwnedScene<R>| {
        // Two that overlap, one around where paths start and one that walls cut.
        scene.aim([0.3, 0.2, 0.1], 0.2, 1.0);
        scene.aim([0.4, 0.3, 0.0], 0.3, 0.3);
        scene.aim([0.0; 3], 0.5, 1.0);
        scene.aim([0.0, -0.9, 0.3], 0.4, 0.1);
        scene
    };
    let mut ball = OwnedScene::<R>::default();
    let wall = ball.diffuse(0.4, EMISSION);
    ball.sphere([0.0; 3], 1.0, wall);
    let ball = aimed(ball);
    for (roulette_after, bounces) in [(None, 1), (None, 6), (Some(0), 6)] {
        let on = PathOptions { aim: true, roulette_after, ..options(bounces) };
        let mut moments = Moments::default();
        with_view(&ball, &INSIDE, &on, |view| {
            each_path::<R, Everything>(view, 4000, &mut |radiance| moments.add(radiance[0]));
        });
        let expected = EMISSION * series(0.4, bounces);
        moments.assert_mean("closed sphere", expected, tolerance::PER_BOUNCE * u::<R>() * f64::from(bounces));
        moments.assert_precise("closed sphere", tolerance::ROULETTE);
        assert!(moments.spread() > 0.0, "no direction was aimed");
    }

    // A hall with a lamp that paths find by themselves, and a ball of glass: on against off.
    let mut hall = OwnedScene::<R>::default();
    let (wall, glass) = (hall.diffuse(0.6, 0.0), hall.glass(1.5, 1.0, [1.0; 3]));
    hall.mesh(&cube(1).inside_out(), wall);
    hall.sphere([-0.3, -0.4, 0.2], 0.3, glass);
    hall.sphere_light([0.2, 0.6, 0.1], 0.2, EMISSION);
    hall.aim([-0.3, -0.4, 0.2], 0.3, 0.2);
    hall.aim([0.2, 0.6, 0.1], 0.2, 1.0);
    for (light_sampling, share) in [(LightSampling::None, 0.9), (LightSampling::Cone, f64::INFINITY)] {
        let measure = |aim| {
            let mut moments = Moments::default();
            with_view(&hall, &INSIDE, &PathOptions { aim, light_sampling, ..options(6) }, |view| {
                each_path::<R, Everything>(view, 1000, &mut |radiance| moments.add(radiance[1]));
            });
            moments
        };
        let (with, without) = (measure(true), measure(false));
        with.assert_same_mean("hall", &without);
        assert!(with.relative_error() < share * without.relative_error(), "aim finds no more of the light");
    }
    Trials::passed::<R>("A10", "mean with aim", 1);
}

/// 0 bounces show emitters only, 1 direct light; a light reached after the last bounce still counts.
fn bounces_are_counted_as_documented<R: Real>() {
    let mut lit = plane::<R>();
    lit.point_light([0.0, 2.0, 0.0], 1.0);
    let paths = |scene: &OwnedScene<R>, bounces| {
        let mut values = Vec::new();
        with_view(scene, &AT_ORIGIN, &options(bounces), |view| {
            each_path::<R, Everything>(view, 64, &mut |radiance| values.push(radiance[0]));
        });
        values
    };
    assert!(paths(&lit, 0).iter().all(|&radiance| radiance == 0.0));
    assert!(paths(&lit, 1).iter().all(|&radiance| radiance > 0.0));
    // A plane under a bright sky: the sky is reached after the one bounce there may be, never with none.
    let sky = OwnedScene { background: [EMISSION; 3], ..plane::<R>() };
    assert!(paths(&sky, 0).iter().all(|&radiance| radiance == 0.0));
    let expected = R::from_f64(ALBEDO) * R::from_f64(EMISSION);
    assert!(paths(&sky, 1).iter().all(|&radiance| radiance == expected.to_f64()));
    // A lamp seen directly and in a mirror.
    let mut mirrored = OwnedScene::<R>::default();
    let mirror = mirrored.mirror(1.0);
    mirrored.mesh(&floor(10.0), mirror);
    mirrored.sphere_light([3.0, 3.0, -0.5], 1.0, EMISSION);
    assert!(paths(&mirrored, 0).iter().all(|&radiance| radiance == 0.0));
    assert!(paths(&mirrored, 1).iter().all(|&radiance| radiance == EMISSION));
    Trials::passed::<R>("A10", "depths", 1);
}

/// `indirect = false` is direct light alone: what one bounce would give, and behind a mirror what two would.
fn indirect_off_leaves_direct_light<R: Real>() {
    let mut scene = OwnedScene::<R>::default();
    let wall = scene.diffuse(ALBEDO, 0.0);
    scene.sphere([0.0; 3], 1.0, wall);
    scene.point_light([0.0; 3], PI);
    let direct = PathOptions { indirect: false, ..options(20) };
    with_view(&scene, &INSIDE, &direct, |view| {
        assert_each_path(view, 4, ALBEDO, tolerance::LIT_SURFACE);
    });
}
