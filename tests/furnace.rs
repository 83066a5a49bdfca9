//! Mirrors and glass: what lossless surfaces do to a path's weight, path by path, and how glass shares light.

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::camera::CameraSettings;
use ocellus_kernel::material::fresnel::{Fresnel, Interface, reflectance};
use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::sampler::AddressedSampler;
use ocellus_kernel::{Everything, Ray};
use proptest::prelude::*;

use crate::support::exact::{Exact, exact, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::{cube, floor, icosphere};
use crate::support::property::for_all;
use crate::support::random::Random;
use crate::support::scene::{CAMERA, OwnedScene, corners, each_path, v, with_view};
use crate::support::statistics::Moments;
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    every_path_in_a_furnace_weighs_one,
    glass_is_entered_as_often_as_it_is_left,
    glass_aimed_at_its_edges_is_nearly_always_left,
    the_centre_of_a_glass_ball_sees_the_furnace,
    glass_reflects_what_fresnel_says,
    reflectance_is_a_fraction_that_equals_its_oracle,
    power_of_two_scales_change_no_bit,
);

const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;
/// The first channel of a path counts crossings of outer surfaces, the second those of inner ones.
const OUTER: [f64; 3] = [0.5, 1.0, 1.0];
const INNER: [f64; 3] = [1.0, 0.5, 1.0];
const CLEAR: [f64; 3] = [1.0; 3];

/// Bodies of glass of each kind in a furnace; each surface passes the given fraction.
fn bodies<R: Real>(outer: [f64; 3], inner: [f64; 3]) -> Vec<(&'static str, OwnedScene<R>)> {
    let furnace = || OwnedScene::<R> { background: [1.0; 3], ..OwnedScene::default() };
    let ball = |radius: f64| {
        let mut scene = furnace();
        let glass = scene.glass(GLASS, 1.0, outer);
        scene.sphere([0.0; 3], radius, glass);
        scene
    };
    // A shell: the inner wall's normal points into the hollow.
    let hollow = |inner_radius: f64| {
        let mut scene = ball(1.0);
        let wall = scene.glass(GLASS, 1.0, inner);
        let at = scene.sphere([0.0; 3], inner_radius, wall);
        scene.spheres[at as usize].inverted = true;
        scene
    };
    // A drop in glass: the surface between names both.
    let mut drop = ball(1.0);
    let water = drop.glass(WATER, GLASS, inner);
    drop.sphere([0.2, 0.1, 0.0], 0.6, water);
    let mut block = furnace();
    let glass = block.glass(GLASS, 1.0, outer);
    block.mesh(&cube(2).map(|[x, y, z]| [0.8 * x + 0.3 * y, 0.8 * y - 0.3 * x, 0.8 * z]), glass);
    let mut facets = furnace();
    let glass = facets.glass(GLASS, 1.0, outer);
    facets.mesh(&icosphere(1), glass);
    let wall = facets.glass(GLASS, 1.0, inner);
    facets.mesh(&icosphere(1).map(|p| p.map(|x| 0.5 * x)).inside_out(), wall);
    vec![
        ("solid ball", ball(1.0)),
        ("hollow ball", hollow(0.7)),
        ("thin shell", hollow(1.0 - 1e-4)),
        ("drop in glass", drop),
        ("block", block),
        ("hollow facets", facets),
    ]
}

/// Enough bounces for all but a few paths to find their way out.
const LONG: PathOptions = PathOptions {
    max_bounces: 200,
    indirect: true,
    light_sampling: ocellus_kernel::light::LightSampling::Cone,
    fresnel: Fresnel::Exact,
    roulette_after: None,
    aim: false,
    sampler: ocellus_kernel::SamplerKind::Independent,
    seed: 3,
};

const NEAR: CameraSettings = CameraSettings { field_of_view: 0.45, width: 32, height: 32, ..CAMERA };

/// N33. A lossless body in a furnace cannot be seen: whatever a path does, it weighs exactly 1 when it gets out.
fn every_path_in_a_furnace_weighs_one<R: Real>() {
    let mut scenes = bodies::<R>(CLEAR, CLEAR);
    let mut mirrors = OwnedScene::<R> { background: [1.0; 3], ..OwnedScene::default() };
    let mirror = mirrors.mirror(1.0);
    for center in [[-0.6, 0.0, 0.0], [0.6, 0.0, 0.0], [0.0, 0.9, 0.5]] {
        mirrors.sphere(center, 0.5, mirror);
    }
    mirrors.mesh(&floor(3.0).map(|[x, _, z]| [x, -1.0, z]), mirror);
    scenes.push(("mirrors", mirrors));
    for ((name, scene), fresnel) in
        scenes.iter().flat_map(|scene| [Fresnel::None, Fresnel::Schlick, Fresnel::Exact].map(|f| (scene, f)))
    {
        let (mut paths, mut trapped) = (0, 0);
        with_view(scene, &NEAR, &PathOptions { fresnel, ..LONG }, |view| {
            each_path::<R, Everything>(view, 16, &mut |radiance| {
                paths += 1;
                if radiance == [0.0; 3] {
                    trapped += 1;
                } else {
                    assert_eq!(radiance, [1.0; 3], "{name} {fresnel:?}");
                }
            });
        });
        assert!(
            f64::from(trapped) <= tolerance::TRAPPED * f64::from(paths),
            "{name} {fresnel:?}: {trapped} of {paths}"
        );
        for case in ["N33", "A7"] {
            Trials::passed::<R>(case, &format!("paths of weight 1: {name}, Fresnel {fresnel:?}"), paths);
        }
    }
}

/// N24. Every path starts and ends in air, so it crosses each closed surface an even number of times: one lost or
/// doubled interface shows as an odd power of the transmittance.
fn glass_is_entered_as_often_as_it_is_left<R: Real>() {
    // At least 30,000 of so many paths go through.
    let samples = 64 * trials(30_000).div_ceil(30_000);
    for (name, scene) in bodies::<R>(OUTER, INNER) {
        let (mut through, mut inner_through) = (0, 0);
        with_view(&scene, &NEAR, &LONG, |view| {
            each_path::<R, Everything>(view, samples, &mut |[outer, inner, rest]| {
                if rest == 0.0 {
                    return;
                }
                let crossings = [outer, inner].map(|weight| -libm::log2(weight));
                assert!(crossings.iter().all(|n| n % 2.0 == 0.0), "{name}: {crossings:?} crossings");
                through += u32::from(crossings[0] > 0.0);
                inner_through += u32::from(crossings[1] > 0.0);
            });
        });
        let has_inside = !matches!(name, "solid ball" | "block");
        assert!(through > 10_000 && (inner_through > 1000) == has_inside, "{name}: {through}, {inner_through}");
        Trials::passed::<R>("N24", &format!("paths cross surfaces an even number of times: {name}"), through);
    }
}

/// The same for rays at the edges of bodies of triangles, where their points lie within rounding of two faces or more.
/// OPEN: 0.85 % of them, not 0, are odd.
fn glass_aimed_at_its_edges_is_nearly_always_left<R: Real>() {
    let scenes = bodies::<R>(OUTER, INNER);
    for (name, scene) in scenes.iter().filter(|(_, scene)| !scene.triangles.is_empty()) {
        let mut random = Random::new(2402);
        let (mut paths, mut odd) = (0u32, 0u32);
        scene.lend(Some(Structure::Bvh), |lent| {
            for sample in 0..trials(20_000) {
                let [a, b, _] = corners(lent.geometry(), random.below(scene.triangles.len()));
                let target = a + (b - a) * R::from_f64(random.unit());
                let origin = v::<R>(random.on_sphere().map(|x| 3.0 * x));
                let ray = Ray::new(origin, normalize::<R>(target - origin));
                let mut numbers = AddressedSampler::new(24, 0, 0, sample);
                let light = radiance::<R, Everything>(lent, &LONG, ray, &mut numbers).radiance.to_array();
                let [outer, inner, rest] = light.map(Real::to_f64);
                if rest != 0.0 {
                    let crossings = [outer, inner].map(|weight| -libm::log2(weight));
                    paths += 1;
                    odd += u32::from(crossings.iter().any(|n| n % 2.0 != 0.0));
                }
            }
        });
        println!("{name}: {odd} of {paths} paths at edges");
        assert!(paths > 10_000 && odd < paths / 100, "{name}: {odd} of {paths}");
    }
}

/// Radiance is basic radiance: the same 1 inside as outside, and not n^2.
fn the_centre_of_a_glass_ball_sees_the_furnace<R: Real>() {
    let scene = &bodies::<R>(CLEAR, CLEAR)[0].1;
    let settings = CameraSettings { position: [0.0; 3], look_at: [0.3, -0.2, 1.0], field_of_view: 2.0, ..CAMERA };
    with_view(scene, &settings, &LONG, |view| {
        each_path::<R, Everything>(view, 16, &mut |radiance| assert_eq!(radiance, [1.0; 3]));
    });
    Trials::passed::<R>("A11", "paths from the centre of a glass ball", 16 * 16 * 16);
}

/// The Fresnel equations in another form: sines and tangents of sums and differences of the angles.
fn fresnel_by_angles(ior_i: f64, ior_t: f64, angle_i: f64) -> f64 {
    let sine_t = ior_i / ior_t * libm::sin(angle_i);
    if sine_t >= 1.0 {
        return 1.0;
    }
    let angle_t = libm::asin(sine_t);
    let (sum, difference) = (angle_i + angle_t, angle_i - angle_t);
    let s = libm::sin(difference) / libm::sin(sum);
    let p = libm::tan(difference) / libm::tan(sum);
    0.5 * (s * s + p * p)
}

/// The picture of a plane that lets nothing through is its reflectance, seen from in front and from behind.
fn glass_reflects_what_fresnel_says<R: Real>() {
    let mut scene = OwnedScene::<R> { background: [1.0; 3], ..OwnedScene::default() };
    let glass = scene.glass(GLASS, 1.0, [0.0; 3]);
    scene.mesh(&floor(100.0), glass);
    let schlick = |cosine: f64| {
        let r = (GLASS - 1.0) / (GLASS + 1.0);
        r * r + (1.0 - r * r) * libm::pow(1.0 - cosine, 5.0)
    };
    for (degrees, side) in [5.0f64, 30.0, 40.0, 42.5, 56.3, 75.0, 88.0].into_iter().flat_map(|d| [(d, 1.0), (d, -1.0)])
    {
        let angle = degrees.to_radians();
        let (ior_i, ior_t) = if side > 0.0 { (1.0, GLASS) } else { (GLASS, 1.0) };
        let position = [3.0 * libm::sin(angle), 3.0 * side * libm::cos(angle), 0.0];
        let settings =
            CameraSettings { position, up: [0.0, 0.0, 1.0], width: 1, height: 1, field_of_view: 1e-3, ..CAMERA };
        let total = ior_i / ior_t * libm::sin(angle) >= 1.0;
        let thin = if side > 0.0 { angle } else { libm::asin((GLASS * libm::sin(angle)).min(1.0)) };
        for (fresnel, expected) in [
            (Fresnel::None, 0.0),
            (Fresnel::Schlick, schlick(libm::cos(thin))),
            (Fresnel::Exact, fresnel_by_angles(ior_i, ior_t, angle)),
        ] {
            let expected = if total { 1.0 } else { expected };
            let mut moments = Moments::default();
            with_view(&scene, &settings, &PathOptions { fresnel, ..LONG }, |view| {
                each_path::<R, Everything>(view, 200_000, &mut |radiance| moments.add(radiance[0]));
            });
            moments.assert_mean(
                &format!("{degrees} degrees, side {side}, {fresnel:?}"),
                expected,
                tolerance::FRESNEL * u::<R>(),
            );
        }
    }
    Trials::passed::<R>("N31", "reflected shares, total ones too, from both sides", 14 * 3);
}

/// In 0..=1 for every model, at every angle and index; the exact one against [`fresnel_by_angles`].
fn reflectance_is_a_fraction_that_equals_its_oracle<R: Real>() {
    let indices = index;
    let sines = prop_oneof![0.0..1.0, Just(0.0), Just(1.0), (1e-9..1e-2).prop_map(|x: f64| 1.0 - x)];
    let of_cosines =
        |class: &str, limit| Trials::measured::<R>("N32", &format!("reflectance of cosines, {class}"), limit, "u");
    let given = of_cosines("away from grazing and critical angles", tolerance::FRESNEL_GIVEN);
    let edge = of_cosines("near those", tolerance::FRESNEL_EDGE);
    let errors = Trials::measured::<R>("N32", "reflectance of angles", tolerance::FRESNEL, "u");
    for_all(trials(20_000), (indices(), indices(), sines), |(ior_i, ior_t, sine)| {
        let ratio = ior_i / ior_t;
        let sine = if ratio > 1.0 { sine / ratio } else { sine };
        let cosine = |sine: f64| (1.0 - sine * sine).max(0.0).sqrt();
        let at = Interface {
            cos_i: R::from_f64(cosine(sine)),
            cos_t: R::from_f64(cosine((ratio * sine).min(1.0))),
            ior_i: R::from_f64(ior_i),
            ior_t: R::from_f64(ior_t),
        };
        // A refraction has a cosine on both sides, unless nothing refracts.
        prop_assume!(at.cos_i + at.cos_t > R::ZERO);
        for model in [Fresnel::None, Fresnel::Schlick, Fresnel::Exact] {
            let reflected = reflectance(model, &at);
            prop_assert!(reflected >= R::ZERO && reflected <= R::ONE, "{:?} {:?}: {:?}", model, at, reflected);
        }
        let [cos_i, cos_t, exact_i, exact_t] = [at.cos_i, at.cos_t, at.ior_i, at.ior_t].map(|x| exact(x.to_f64()));
        let amplitude = |a: Exact, b: Exact| (&a - &b) / (&a + &b);
        let s = amplitude(&exact_i * &cos_i, &exact_t * &cos_t);
        let p = amplitude(&exact_t * &cos_i, &exact_i * &cos_t);
        let truth = to_f64(&((&s * &s + &p * &p) / exact(2.0)));
        let error = (reflectance(Fresnel::Exact, &at).to_f64() - truth).abs();
        let class = if at.cos_i.to_f64().min(at.cos_t.to_f64()) > 0.14 { &given } else { &edge };
        class.error(error / u::<R>(), || format!("{at:?}"));
        if sine > 0.01 && sine < 0.99 && ratio * sine < 0.99 && ior_i != ior_t {
            let by_angles = fresnel_by_angles(ior_i, ior_t, libm::asin(sine));
            let error = (reflectance(Fresnel::Exact, &at).to_f64() - by_angles).abs();
            errors.error(error / u::<R>(), || format!("{at:?}"));
        }
        Ok(())
    });
    given.end(5000);
    edge.end(500);
    errors.end(4000);
}

/// Indices of refraction from air to diamond, and equal ones.
fn index() -> impl Strategy<Value = f64> {
    prop_oneof![1.0..2.5, prop::sample::select(vec![1.0, 1.000293, 1.33, 1.5, 2.417])]
}

/// N45. A scene times 2^k, and intensities times 4^k, is the same picture bit for bit: no length is built in.
fn power_of_two_scales_change_no_bit<R: Real>() {
    let look = |k: i32| {
        let scale = libm::ldexp(1.0, k);
        let at = |p: [f64; 3]| p.map(|x| x * scale);
        let mut scene = OwnedScene::<R> { background: [0.1; 3], ..OwnedScene::default() };
        let [grey, mirror, glass] = [scene.diffuse(0.6, 0.0), scene.mirror(0.9), scene.glass(GLASS, 1.0, CLEAR)];
        scene.mesh(&floor(4.0).map(|[x, _, z]| at([x + 0.1, -1.05, z])), grey);
        scene.mesh(&cube(1).map(|[x, y, z]| at([0.4 * x - 1.0, 0.4 * y, 0.4 * z + 0.3 * x])), glass);
        scene.sphere(at([0.6, -0.3, 0.1]), 0.7 * scale, glass);
        scene.sphere(at([0.1, 0.2, -1.5]), 0.6 * scale, mirror);
        scene.sphere_light(at([1.0, 2.5, 0.5]), 0.3 * scale, 20.0);
        scene.point_light(at([-2.0, 1.5, 1.0]), 8.0 * scale * scale);
        let settings = CameraSettings {
            position: at([0.3, 0.7, 5.0]),
            aperture_radius: 0.05 * scale,
            focal_distance: 5.0 * scale,
            ..CAMERA
        };
        let mut paths = Vec::new();
        with_view(&scene, &settings, &PathOptions { max_bounces: 8, ..LONG }, |view| {
            each_path::<R, Everything>(view, 8, &mut |radiance| paths.push(radiance));
        });
        paths
    };
    let unscaled = look(0);
    assert!(unscaled.iter().any(|radiance| radiance[0] > 0.2), "nothing is lit");
    for k in [-30, -11, 7, 30] {
        assert!(look(k) == unscaled, "2^{k}");
    }
    // The direction of a normalized vector is as indifferent.
    let unit = normalize::<R>(v::<R>([3.0, -4.0, 12.0]));
    assert_eq!(normalize::<R>(v::<R>([3.0, -4.0, 12.0].map(|x| libm::ldexp(x, -60)))).to_array(), unit.to_array());
    Trials::passed::<R>("N45", "paths at scales 2^-30 to 2^30", 4 * unscaled.len() as u32);
}
