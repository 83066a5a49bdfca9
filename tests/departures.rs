//! Rays that leave surfaces among others, through every structure: they never meet the surface that they left, and
//! nothing that is close to it lets them through. N21 to N23 with the offset that the kernel has by default.

use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::sampler::AddressedSampler;
use ocellus_kernel::{Everything, Ray, Scene};

use crate::support::exact::{Exact, ExactVec, exact};
use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, cube, icosphere};
use crate::support::random::Random;
use crate::support::rays::{flat_box, magnitude, place_of_triangle, ray_in_box};
use crate::support::scene::{OwnedScene, STRUCTURES, corners, v};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    rays_that_leave_triangles_among_others_never_meet_their_plane,
    rays_that_leave_a_convex_mesh_meet_nothing,
    rays_that_leave_spheres_among_others_never_meet_them,
    nothing_leaves_a_box_as_thin_as_64_ulps,
    a_hit_infinitely_far_along_the_ray_is_left,
);

/// Paths in one scene: many, so that its hierarchy is worth building.
const PATHS: u32 = 64;

/// What primitive `k` emits: each its own, so that the light of a path of one bounce, `e_i + e_j / 2`, says which two
/// it met, without any rounding.
fn emission(k: usize) -> f64 {
    1.0 + k as f64 / 64.0
}

/// The radiance of a path of so many bounces.
fn light<R: Real>(scene: &Scene<'_, R>, max_bounces: u32, ray: Ray<R>, sample: u32) -> f64 {
    let options = PathOptions { max_bounces, ..PathOptions::default() };
    let mut numbers = AddressedSampler::new(2, 0, 0, sample);
    radiance::<R, Everything>(scene, &options, ray, &mut numbers).radiance.x().to_f64()
}

/// The primitives that a path of one bounce meets: the one it bounces off, and what comes after that.
fn met_by_path<R: Real>(scene: &Scene<'_, R>, ray: Ray<R>, sample: u32) -> Option<(usize, Option<usize>)> {
    let first = scene.intersect(&ray)?.primitive as usize;
    let second = 2.0 * (light(scene, 1, ray, sample) - emission(first));
    Some((first, (second != 0.0).then_some((64.0 * (second - 1.0)) as usize)))
}

/// A ray from outside of everything at a place.
fn from_afar<R: Real>(random: &mut Random, target: Vec3<R>, reach: f64) -> Ray<R> {
    let origin = target - v::<R>(random.on_sphere().map(|x| x * reach));
    Ray::new(origin, normalize::<R>(target - origin))
}

/// Runs as many paths as are asked for through each structure, each scene made by `scene` for some of them; `path` is
/// `None` for a path that tells nothing, else whether it went right.
fn through_each_structure<R: Real>(
    case: &str,
    class: &str,
    mut scene: impl FnMut(&mut Random) -> OwnedScene<R>,
    mut path: impl FnMut(&mut Random, &Scene<'_, R>, u32) -> Option<bool>,
) {
    let wanted = trials(20_000);
    for (structure, name) in STRUCTURES.into_iter().zip(["all", "box", "BVH"]) {
        let right = Trials::of::<R>(case, &format!("{class}, {name}"));
        let mut random = Random::new(2100);
        // Half of the paths may tell nothing.
        for first in (0..2 * wanted).step_by(PATHS as usize) {
            if right.count() >= wanted.into() {
                break;
            }
            scene(&mut random).lend(structure, |scene| {
                for sample in first..first + PATHS {
                    let before = random.clone();
                    if let Some(success) = path(&mut random, scene, sample) {
                        right.holds(success, || format!("path {sample} of {before:?} in {:?}", scene.geometry()));
                    }
                }
            });
        }
        right.end(wanted.into());
    }
}

/// A size from 1e-4 to 1e6, and a place up to 10^`far` times that from the origin.
fn size_and_place(random: &mut Random, far: f64) -> (f64, [f64; 3]) {
    let size = magnitude(random, -4.0, 6.0);
    let away = if random.below(2) == 0 { 0.0 } else { size * magnitude(random, 0.0, far) };
    (size, random.in_cube().map(|x| x * away))
}

/// How high `p` is over the plane of a triangle, as a multiple of its area, in exact arithmetic.
fn height<R: Real>(corners: [Vec3<R>; 3], p: Vec3<R>) -> Exact {
    let [a, b, c, p] = [corners[0], corners[1], corners[2], p].map(ExactVec::new::<R>);
    (&p - &a).dot(&(&b - &a).cross(&(&c - &a)))
}

/// N21. Triangles that share corners, edges and planes, cross each other, and are there several times.
fn rays_that_leave_triangles_among_others_never_meet_their_plane<R: Real>() {
    let scene = |random: &mut Random| {
        let (size, center) = size_and_place(random, 5.0);
        let mut scene = OwnedScene::<R>::default();
        // Some lie in a plane of the axes, and some hardly leave it.
        let (axis, flat) = (random.below(3), [1.0, 1.0, 0.0, 1e-6, 1e-3][random.below(5)]);
        let positions: Vec<[f64; 3]> = (0..7)
            .map(|_| {
                let offset = random.in_cube();
                std::array::from_fn(|i| (center[i] + size * offset[i]) * if i == axis { flat } else { 1.0 })
            })
            .collect();
        for k in 0..24 {
            let first = random.below(7);
            let (second, third) = (1 + random.below(3), 4 + random.below(3));
            let triangle = [first, (first + second) % 7, (first + third) % 7].map(|corner| corner as u32);
            let material = scene.diffuse(0.5, emission(k));
            let positions = if k == 0 { positions.clone() } else { vec![] };
            // All of them share the corners of the first.
            let from = scene.positions.len() as u32;
            scene.mesh(&Mesh { positions, triangles: vec![triangle] }, material);
            scene.triangles[k] = scene.triangles[k].map(|corner| corner - from);
        }
        scene
    };
    let class = "paths off triangles among others, back to their plane";
    through_each_structure::<R>("N21", class, scene, |random, scene, sample| {
        let geometry = scene.geometry();
        let of = corners(geometry, random.below(24));
        let size = of.map(|p| (p - of[0]).abs().max_component().to_f64()).into_iter().fold(0.0, f64::max);
        let target = place_of_triangle::<R>(random, sample, of);
        let ray = from_afar::<R>(random, target, 4.0 * size);
        let (first, second) = met_by_path(scene, ray, sample)?;
        let plane = corners(geometry, first);
        let is_in_plane = |second| corners(geometry, second).iter().all(|p| height::<R>(plane, *p) == exact(0.0));
        Some(!second.is_some_and(is_in_plane))
    });
}

/// N21. Whatever leaves the outside of a convex body never meets it again: not the triangle that it left, none of those
/// beside it, and none in its plane.
fn rays_that_leave_a_convex_mesh_meet_nothing<R: Real>() {
    let scene = |random: &mut Random| {
        let mut scene = OwnedScene::<R> { background: [0.0; 3], ..OwnedScene::default() };
        let grey = scene.diffuse(0.5, emission(0));
        // Powers of two and whole numbers: what was flat and convex still is when it is rounded.
        let size = libm::ldexp(1.0, random.below(34) as i32 - 13);
        let far = if random.below(2) == 0 { 0.0 } else { magnitude(random, 0.0, 3.0) };
        let center = random.in_cube().map(|x| (x * far).round() * size);
        let mesh = if random.below(2) == 0 { icosphere(1) } else { cube(4) };
        scene.mesh(&mesh.map(|p| std::array::from_fn(|i| center[i] + size * p[i])), grey);
        scene
    };
    let class = "paths off the outside of convex meshes";
    through_each_structure::<R>("N21", class, scene, |random, scene, sample| {
        let geometry = scene.geometry();
        let of = corners(geometry, random.below(geometry.triangles().len()));
        let size = (of[0] - of[1]).abs().max_component().to_f64();
        let target = place_of_triangle::<R>(random, sample, of);
        let ray = from_afar::<R>(random, target, 16.0 * size);
        // At its rim a body may be said to be hit in a face that looks away: from there a path goes on inside.
        let seen = corners(geometry, scene.intersect(&ray)?.primitive as usize);
        (height::<R>(seen, ray.origin) > exact(0.0)).then(|| light(scene, 1, ray, sample) == emission(0))
    });
}

/// N22. Spheres of all sizes that overlap, with triangles among them, seen from outside of all.
fn rays_that_leave_spheres_among_others_never_meet_them<R: Real>() {
    const SPHERES: usize = 12;
    let scene = |random: &mut Random| {
        let (size, center) = size_and_place(random, 4.0);
        let mut scene = OwnedScene::<R>::default();
        let place = |random: &mut Random| {
            let offset = random.in_cube();
            std::array::from_fn(|i| center[i] + size * offset[i])
        };
        for k in 0..SPHERES {
            let material = scene.diffuse(0.5, emission(k));
            scene.sphere(place(random), size * magnitude(random, -3.0, 0.0), material);
        }
        for k in SPHERES..SPHERES + 6 {
            let material = scene.diffuse(0.5, emission(k));
            let positions = (0..3).map(|_| place(random)).collect();
            scene.mesh(&Mesh { positions, triangles: vec![[0, 1, 2]] }, material);
        }
        scene
    };
    let class = "paths off spheres among others, back to them";
    through_each_structure::<R>("N22", class, scene, |random, scene, sample| {
        let spheres = scene.geometry().spheres();
        let sphere = spheres[random.below(SPHERES)];
        let size = spheres.iter().map(|other| (other.center - sphere.center).abs().max_component().to_f64());
        let size = size.fold(spheres.iter().map(|other| other.radius.to_f64()).fold(0.0, f64::max), f64::max);
        let target = sphere.center + v::<R>(random.in_cube()) * sphere.radius;
        let ray = from_afar::<R>(random, target, 8.0 * size);
        let (first, second) = met_by_path(scene, ray, sample)?;
        (first < SPHERES).then_some(second != Some(first))
    });
}

/// N23. Closed boxes down to 64 ulps of their largest coordinate thick, their sides cut into several triangles.
fn nothing_leaves_a_box_as_thin_as_64_ulps<R: Real>() {
    let scene = |random: &mut Random| {
        let mut scene = OwnedScene::<R> { background: [1.0; 3], ..OwnedScene::default() };
        let grey = scene.diffuse(0.5, 0.0);
        let squares = [1, 4][random.below(2)];
        scene.mesh(&flat_box::<R>(random, squares), grey);
        scene
    };
    through_each_structure::<R>("N23", "paths of three bounces in thin boxes", scene, |random, scene, sample| {
        let ray = ray_in_box::<R>(random, scene.geometry().positions());
        Some(light(scene, 3, ray, sample) == 0.0)
    });
}

/// A direction so short that t is infinite: then all of space may be near the hit, the lanes of a node that hold no child
/// included.
fn a_hit_infinitely_far_along_the_ray_is_left<R: Real>() {
    let short = if R::WIDE_IS_SELF { 1e-300 } else { 1e-30 };
    let size = if R::WIDE_IS_SELF { 1e100 } else { 1e10 };
    let mut scene = OwnedScene::<R>::default();
    let grey = scene.diffuse(0.5, 0.0);
    let corners = [[-1.0, -1.0, -1.0], [2.0, -1.0, -1.0], [-1.0, 2.0, -1.0]];
    let positions = corners.map(|corner| corner.map(|x| x * size)).to_vec();
    scene.mesh(&Mesh { positions, triangles: vec![[0, 1, 2]] }, grey);
    let ray = Ray { tmax: R::ONE / R::ZERO, ..Ray::new(v::<R>([0.0; 3]), v::<R>([0.0, 0.0, -short])) };
    let options = PathOptions { max_bounces: 2, ..PathOptions::default() };
    for structure in STRUCTURES {
        scene.lend(structure, |scene| {
            assert!(scene.intersect(&ray).is_some_and(|hit| !hit.t.is_finite()), "{structure:?}");
            let mut numbers = AddressedSampler::new(1, 0, 0, 0);
            radiance::<R, Everything>(scene, &options, ray, &mut numbers);
        });
    }
}
