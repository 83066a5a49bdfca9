//! All that a ray crosses: each surface exactly once, edges and corners too.

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::real::Real;
use ocellus_kernel::shape::Sphere;
use ocellus_kernel::{Hit, Ray, Scene};

use crate::support::in_both_precisions;
use crate::support::meshes::cube;
use crate::support::random::Random;
use crate::support::rays::{closed_meshes, ray_at_mesh};
use crate::support::scene::{STRUCTURES, corners, one_material, ray, v};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    closed_meshes_are_left_an_odd_number_of_times,
    rays_along_a_grid_leave_a_cube_once,
    structures_find_the_same_crossings,
);

fn crossings<R: Real>(scene: &Scene<'_, R>, ray: &Ray<R>) -> Vec<Hit<R>> {
    let mut found = Vec::new();
    scene.crossings(ray, |hit| found.push(hit));
    found
}

/// N12. From inside at corners, edges and faces the number is odd; from beyond them it is even.
fn closed_meshes_are_left_an_odd_number_of_times<R: Real>() {
    for (name, mesh, center, radius) in closed_meshes() {
        let mut random = Random::new(12);
        let from_center = |p: &[f64; 3]| (0..3).map(|i| (p[i] - center[i]).abs()).sum::<f64>();
        let size = mesh.positions.iter().map(from_center).fold(0.0, f64::max);
        let mut scene = one_material::<R>();
        scene.mesh(&mesh, 0);
        let mut shoot = |scene: &Scene<'_, R>, structure: &str, rays: u32| {
            let inside = Trials::of::<R>("N12", &format!("crossings from inside, {name}, {structure}"));
            let outside = Trials::of::<R>("N12", &format!("crossings from outside, {name}, {structure}"));
            for i in 0..rays {
                let of_mesh = |triangle| corners(scene.geometry(), triangle);
                let ray = ray_at_mesh::<R>(&mut random, i, center, radius, of_mesh, mesh.triangles.len());
                let found = crossings(scene, &ray);
                inside.holds(found.len() % 2 == 1, || format!("{ray:?}: {found:?}"));
                // From beyond the mesh, back through where the first ray started and on.
                let away = ocellus_kernel::robust::normalize::<R>(ray.direction);
                let back = Ray::new(ray.origin + away * R::from_f64(2.0 * size), -ray.direction);
                let found = crossings(scene, &back);
                outside.holds(found.len().is_multiple_of(2) && found.len() >= 2, || format!("{back:?}: {found:?}"));
            }
            inside.end(rays.into());
            outside.end(rays.into());
        };
        scene.lend(None, |scene| shoot(scene, "all", trials(100_000) / 100));
        scene.lend(Some(Structure::Bvh), |scene| shoot(scene, "BVH", trials(100_000) / 2));
    }
}

/// N12. Exactly through edges and corners, along axes and diagonals of faces: once each.
fn rays_along_a_grid_leave_a_cube_once<R: Real>() {
    let once = Trials::of::<R>("N12", "crossings along the grid of a cube");
    let mut scene = one_material::<R>();
    scene.mesh(&cube(8), 0);
    for structure in STRUCTURES {
        scene.lend(structure, |scene| {
            let grid = || (-7..8).map(|i| f64::from(i) / 8.0);
            for (a, b) in grid().flat_map(|a| grid().map(move |b| (a, b))) {
                for (axis, sign) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
                    for slope in [[0.0, -0.0], [0.125, 0.125], [0.25, -0.25]] {
                        let (mut origin, mut direction) = ([a, b, 0.125], [slope[0], slope[1], sign]);
                        origin.rotate_right(axis);
                        direction.rotate_right(axis);
                        let ray = ray::<R>(origin, direction);
                        let found = crossings(scene, &ray);
                        once.holds(found.len() == 1, || format!("{ray:?}: {found:?}"));
                    }
                }
            }
        });
    }
    once.end(3 * 225 * 6 * 3);
}

/// The closest crossing is the closest hit, unless they touch an edge; spheres are entered and left.
fn structures_find_the_same_crossings<R: Real>() {
    let mut random = Random::new(13);
    let mut scene = one_material::<R>();
    scene.mesh(&cube(3), 0);
    for _ in 0..40 {
        let (center, radius) = (v::<R>(random.in_cube()), R::from_f64(random.between(0.01, 0.3)));
        scene.spheres.push(Sphere { center, radius, material: 0, inverted: false });
    }
    let rays: Vec<_> = (0..2000).map(|_| ray::<R>(random.in_cube().map(|x| 2.0 * x), random.in_cube())).collect();
    let [none, one_box, bvh] = STRUCTURES.map(|structure| {
        scene.lend(structure, |scene| {
            let sorted = |ray| {
                let mut found = crossings(scene, ray);
                found.sort_by(|a, b| a.t.to_f64().total_cmp(&b.t.to_f64()).then(a.primitive.cmp(&b.primitive)));
                let closest = scene.intersect(ray).map(|hit| hit.t);
                assert_eq!(found.first().map(|hit| hit.t), closest, "{ray:?}");
                found
            };
            rays.iter().map(sorted).collect::<Vec<_>>()
        })
    });
    let same = Trials::of::<R>("N12", "crossings of spheres and a cube: all, box, BVH");
    for at in 0..rays.len() {
        same.holds(none[at] == one_box[at] && none[at] == bvh[at], || format!("{:?}: {:?}", rays[at], none[at]));
    }
    let count: usize = none.iter().map(Vec::len).sum();
    assert!(count > 1000, "only {count} crossings");
    same.end(2000);
}
