//! Hard cases of light, each under its number: chains of mirrors, refraction against exact arithmetic, furnaces far
//! from the origin, lights of triangles that are found by chance, ways to sample a light against each other.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use ocellus_kernel::camera::CameraSettings;
use ocellus_kernel::material::fresnel::{Interface, reflectance};
use ocellus_kernel::material::{Dielectric, Fresnel, Mirror, dielectric, mirror};
use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::sampler::AddressedSampler;
use ocellus_kernel::surface::SurfacePoint;
use ocellus_kernel::{Everything, Ray};

use crate::support::exact::{Exact, ExactVec, exact, root, roughly, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::{cube, floor, icosphere};
use crate::support::random::Random;
use crate::support::rays::magnitude;
use crate::support::scene::{CAMERA, OwnedScene, each_path, v, with_view};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    a_chain_of_mirrors_does_not_drift,
    paths_among_mirrors_lose_nothing,
    refraction_agrees_with_exact_arithmetic,
    moved_furnaces_stay_the_same,
    lights_that_touch_a_floor_light_it,
);

/// A point of a surface with this normal, seen from `wo`.
fn point<R: Real>(wo: Vec3<R>, n: Vec3<R>) -> SurfacePoint<R> {
    let zero = Vec3::<R>::ZERO;
    SurfacePoint { p: zero, p_error: zero, ng: n, ns: n, uv: [R::ZERO; 2], wo, material: 0 }
}

/// N29. A direction mirrored a thousand times keeps its length, and each time its angle to the mirror.
fn a_chain_of_mirrors_does_not_drift<R: Real>() {
    let mut random = Random::new(2901);
    let lengths = Trials::measured::<R>("N29", "1000 mirrors in a chain: length", tolerance::MIRRORED, "u");
    let angles = Trials::measured::<R>("N29", "1000 mirrors in a chain: r.n - i.n", tolerance::MIRRORED, "u");
    let white = Mirror::<R> { reflectance: Vec3::<R>::ONE };
    for _ in 0..trials(10_000) / 1000 {
        let mut wo = normalize::<R>(v::<R>(random.on_sphere()));
        for _ in 0..1000 {
            let n = normalize::<R>(v::<R>(random.on_sphere()));
            let wi = mirror::sample(wo, &point(wo, n).toward_viewer::<Everything>(), &white).wi;
            let words = || format!("{wo:?} at {n:?}: {wi:?}");
            let [i, unit, r] = [wo, n, wi].map(ExactVec::new::<R>);
            lengths.error(roughly(&(r.length() - exact(1.0))).abs() / u::<R>(), words);
            // Of the directions alone: what is wrong with their lengths was counted.
            let [i, unit, r] = [i, unit, r].map(|v| v.unit());
            angles.error(roughly(&(r.dot(&unit) - i.dot(&unit))).abs() / u::<R>(), words);
            wo = -wi;
        }
    }
    lengths.end(10_000);
    angles.end(10_000);
}

/// In the middle of things, looking askew.
const INSIDE: CameraSettings = CameraSettings { position: [0.2, -0.1, 0.3], look_at: [0.5, 0.4, -0.6], ..CAMERA };

/// N29. In a closed room of mirrors that emit, a path of 1000 bounces adds 1001 emissions, and every sum is exact.
fn paths_among_mirrors_lose_nothing<R: Real>() {
    let paths = Trials::of::<R>("N29", "paths of 1000 bounces in closed mirrors");
    let room = |place: &dyn Fn(&mut OwnedScene<R>, u32)| {
        let mut scene = OwnedScene::<R>::default();
        let mirror = scene.mirror(1.0);
        scene.materials[mirror as usize].emission = v::<R>([0.25; 3]);
        place(&mut scene, mirror);
        scene
    };
    for (name, scene) in [
        (
            "sphere",
            room(&|scene, mirror| {
                scene.sphere([0.0; 3], 1.0, mirror);
            }),
        ),
        ("cube", room(&|scene, mirror| scene.mesh(&cube(2), mirror))),
        ("facets", room(&|scene, mirror| scene.mesh(&icosphere(2), mirror))),
    ] {
        with_view(&scene, &INSIDE, &PathOptions { max_bounces: 1000, ..PathOptions::default() }, |view| {
            each_path::<R, Everything>(view, 1, &mut |radiance| {
                paths.holds(radiance == [1001.0 * 0.25; 3], || format!("{name}: {radiance:?}"));
            });
        });
    }
    paths.end(768);
}

/// By Snell's law, in exact arithmetic: the direction that a ray seen from `wo` goes on in through a surface with the
/// normal `n`, of any length and on either side, and the square of its cosine to it. That is negative, and the
/// direction without meaning, where all is reflected.
fn snell<R: Real>(wo: &ExactVec, n: &ExactVec, [ior_i, ior_t]: [R; 2]) -> (ExactVec, Exact) {
    let (w, n) = (wo.unit(), n.unit());
    let cos_i = w.dot(&n);
    let tangent = &w - &(&n * &cos_i);
    let eta = exact(ior_i.to_f64()) / exact(ior_t.to_f64());
    let square = exact(1.0) - &eta * &eta * tangent.dot(&tangent);
    let cos_t = if cos_i < exact(0.0) { root(&square) } else { -root(&square) };
    (&(&tangent * &-eta) + &(&n * &cos_t), square)
}

/// The angle between directions that hardly differ.
fn angle(a: &ExactVec, b: &ExactVec) -> f64 {
    if a.dot(b) > exact(0.0) { roughly(&(a.cross(b).length() / (a.length() * b.length()))) } else { PI }
}

/// Indices of refraction in front and behind, and an angle of arrival.
fn refraction_case(random: &mut Random, class: &str, unit: f64) -> ([f64; 2], f64) {
    let ior = [1.0001, 1.000293, 1.33, 1.5, 2.417][random.below(5)];
    let critical = libm::asin(1.0 / ior);
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    match class {
        "near the critical angle" => ([ior, 1.0], critical * (1.0 + sign * magnitude(random, -6.0, -2.0))),
        "at the critical angle" => {
            ([ior, 1.0], critical * (1.0 + sign * magnitude(random, libm::log10(unit), 0.5 * libm::log10(unit))))
        }
        "grazing" => ([1.0, ior], FRAC_PI_2 - magnitude(random, -6.0, -2.0)),
        "near the normal" => {
            let iors = if sign > 0.0 { [1.0, ior] } else { [ior, 1.0] };
            (iors, [0.0, 1e-7, 1e-4][random.below(3)])
        }
        _ => (if sign > 0.0 { [1.0, ior] } else { [ior, 1.0] }, random.between(0.0, FRAC_PI_2)),
    }
}

/// N30, N31, N33. Refracted directions as near to the exact ones as the problem allows; total reflection where it is
/// due; what is refracted finds its way back, and is reflected as much on the way back.
fn refraction_agrees_with_exact_arithmetic<R: Real>() {
    let classes = ["any angle", "near the critical angle", "at the critical angle", "grazing", "near the normal"];
    for class in classes {
        let mut random = Random::new(3001);
        let measured = |case, what, limit, unit| Trials::measured::<R>(case, &format!("{class}: {what}"), limit, unit);
        let angles = measured("N30", "refracted direction", tolerance::REFRACTED, "u/cos_t");
        let lengths = measured("N30", "its length", tolerance::unit_length::<R>(), "u");
        let decisions = Trials::of::<R>("N31", &format!("{class}: reflected or refracted"));
        let backs = measured("N31", "and back again", tolerance::REVERSED, "u/cos_t");
        let pairs = measured("N33", "reflectance from both sides", tolerance::RECIPROCAL, "u");
        let shares = measured("N33", "reflected share of both ways", tolerance::SHARES, "u/(cos_i cos_t)");
        for _ in 0..trials(4000) {
            let (iors, theta) = refraction_case(&mut random, class, u::<R>());
            let iors = iors.map(R::from_f64);
            let n = normalize::<R>(v::<R>(random.on_sphere()));
            // From the front, which is the exterior, or from behind.
            let front = random.below(2) == 0;
            let [exterior_ior, interior_ior] = if front { iors } else { [iors[1], iors[0]] };
            let glass = Dielectric { interior_ior, exterior_ior, transmittance: Vec3::<R>::ONE };
            let axis = n.to_array().map(|x| if front { x.to_f64() } else { -x.to_f64() });
            let across = normalize::<f64>(v::<f64>(axis).cross(v::<f64>(random.on_sphere())));
            let wo = v::<f64>(axis) * libm::cos(theta) + across * libm::sin(theta);
            let wo = normalize::<R>(v::<R>(wo.to_array()));
            let scatter = |wo: Vec3<R>, fresnel: Fresnel, choice: u32| {
                let at = point(wo, n);
                dielectric::sample(&at, &at.toward_viewer::<Everything>(), &glass, fresnel, choice).wi
            };
            let wi = scatter(wo, Fresnel::None, u32::MAX);

            let [i, normal, t] = [wo, n, wi].map(ExactVec::new::<R>);
            let (truth, square) = snell::<R>(&i, &normal, iors);
            let cosines = [&i, &t].map(|w| to_f64(&(w.dot(&normal.unit()))));
            // A ray along the surface has no side.
            if roughly(&square).abs() <= tolerance::UNDECIDED * u::<R>() || (cosines[0] > 0.0) != front {
                continue;
            }
            let words = || format!("{wo:?} at {n:?}, {iors:?}: {wi:?}, cosines {cosines:?}");
            let refracted = (cosines[0] > 0.0) != (cosines[1] > 0.0);
            decisions.holds(refracted == (square > exact(0.0)), words);
            lengths.error(roughly(&(t.length() - exact(1.0))).abs() / u::<R>(), words);
            if !refracted || square <= exact(0.0) {
                continue;
            }
            angles.error(angle(&t, &truth) * roughly(&root(&square)) / u::<R>(), words);

            let [cos_i, cos_t] = cosines.map(|cosine| R::from_f64(cosine.abs().min(1.0)));
            let there = Interface { cos_i, cos_t, ior_i: iors[0], ior_t: iors[1] };
            let again = Interface { cos_i: cos_t, cos_t: cos_i, ior_i: iors[1], ior_t: iors[0] };
            for model in [Fresnel::Schlick, Fresnel::Exact] {
                let [a, b] = [&there, &again].map(|at| reflectance(model, at).to_f64());
                pairs.error((a - b).abs() / u::<R>(), || format!("{model:?} {there:?}"));
            }

            // Back again, where the rounding of the direction does not decide whether there is a way.
            let reverse = roughly(&snell::<R>(&t, &normal, [iors[1], iors[0]]).1);
            if reverse <= tolerance::UNDECIDED * u::<R>() {
                continue;
            }
            let back = ExactVec::new::<R>(scatter(wi, Fresnel::None, u32::MAX));
            backs.error(angle(&back, &i) * cosines[0].abs() / u::<R>(), words);
            let [a, b] = [wo, wi].map(|w| {
                reflected_share(|choice| {
                    let out = scatter(w, Fresnel::Exact, choice);
                    (out.dot(n) > R::ZERO) == (w.dot(n) > R::ZERO)
                })
            });
            // Shares come in steps of 2^-32. What rounding `wi` does to the cosine of the way back grows with one
            // over that cosine, what it does to the share with one over the other.
            let apart = ((a - b).abs() - libm::ldexp(2.0, -32)).max(0.0);
            let cosines = (cosines[0] * cosines[1]).abs();
            shares.error(apart * cosines / u::<R>(), || format!("{a} and {b}: {}", words()));
        }
        [angles, lengths, decisions, backs, pairs, shares].into_iter().for_each(|trials| trials.end(1000));
    }
}

/// The share of numbers that choose reflection; these are the small ones.
fn reflected_share(reflects: impl Fn(u32) -> bool) -> f64 {
    let (mut below, mut above) = (0u64, 1u64 << 32);
    while below < above {
        let middle = (below + above) / 2;
        if reflects(middle as u32) { below = middle + 1 } else { above = middle }
    }
    libm::ldexp(below as f64, -32)
}

/// N46. A closed ball that emits is equally bright inside wherever it stands, path by path.
fn moved_furnaces_stay_the_same<R: Real>() {
    const BOUNCES: u32 = 7;
    let limit = tolerance::PER_BOUNCE * f64::from(BOUNCES + 1);
    let expected = 1.0 - libm::ldexp(1.0, -(BOUNCES as i32 + 1));
    for class in ["closed balls", "closed rooms"] {
        let errors = Trials::measured::<R>("N46", &format!("{class} moved by 2^k S: radiance"), limit, "u");
        for k in 0..=16 {
            let shift = [2.0, -1.0, 1.5].map(|x| libm::ldexp(x, k));
            let at = |p: [f64; 3]| std::array::from_fn(|i| p[i] + shift[i]);
            let mut scene = OwnedScene::<R>::default();
            let wall = scene.diffuse(0.5, 0.5);
            match class {
                "closed balls" => _ = scene.sphere(shift, 1.0, wall),
                _ => scene.mesh(&cube(2).inside_out().map(at), wall),
            }
            let [position, look_at] = [[0.25, -0.125, 0.5], [0.5, 0.25, -0.5]].map(at);
            let settings = CameraSettings { position, look_at, ..CAMERA };
            let options = PathOptions { max_bounces: BOUNCES, ..PathOptions::default() };
            with_view(&scene, &settings, &options, |view| {
                each_path::<R, Everything>(view, 4, &mut |radiance| {
                    errors.error((radiance[0] / expected - 1.0).abs() / u::<R>(), || format!("2^{k}: {radiance:?}"));
                });
            });
        }
        errors.end(17_000);
    }
}

/// N25. A ball that shines rests on a floor, as near as numbers allow: every ray from the floor to any point of it that
/// can be seen from there is free, also right beside where they touch.
fn lights_that_touch_a_floor_light_it<R: Real>() {
    let mut random = Random::new(2501);
    let lit = Trials::of::<R>("N25", "shadow rays to a light that touches the floor");
    for sample in 0..trials(20_000) {
        let size = magnitude(&mut random, -4.0, 4.0);
        let mut scene = OwnedScene::<R>::default();
        let grey = scene.diffuse(0.5, 0.0);
        scene.mesh(&floor(4.0).map(|p| p.map(|x| x * size)), grey);
        scene.sphere_light([0.0, size * (1.0 + 1e-6), 0.0], size, 1.0);
        let (aside, turn) = (magnitude(&mut random, -3.0, 0.0), random.between(0.0, TAU));
        // Under the ball, which is this high there, toward a point of the floor.
        let height = 0.25 * (1.0 - (1.0 - aside * aside).max(0.0).sqrt());
        let place = |r: f64, y: f64| v::<R>([r * libm::cos(turn), y, r * libm::sin(turn)].map(|x| x * size));
        let origin = place(1.5 * aside, height);
        let ray = Ray::new(origin, normalize::<R>(place(aside, 0.0) - origin));
        let options = PathOptions { max_bounces: 1, indirect: false, ..PathOptions::default() };
        let mut numbers = AddressedSampler::new(25, 0, 0, sample);
        scene.lend(None, |scene| {
            let found = radiance::<R, Everything>(scene, &options, ray, &mut numbers).radiance;
            lit.holds(found != Vec3::<R>::ZERO, || format!("{ray:?} {:?}", scene.geometry()));
        });
    }
    lit.end(20_000);
}
