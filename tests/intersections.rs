//! Spheres and triangles against exact arithmetic, and meshes that must not leak.
//!
//! The floats of a case are the problem; what is measured is the distance of the answer from the exact one, in units
//! of roundoff times what the problem itself magnifies.

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::shape::{PreparedRay, Sphere, triangle};
use ocellus_kernel::{Hit, Ray, Scene};

use crate::support::exact::{ExactVec, exact, roughly, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, cube};
use crate::support::random::Random;
use crate::support::rays::{
    SphereTruth, box_case, box_triangle, closed_meshes, magnitude, ray_at_box, ray_at_mesh, sphere_case, sphere_truth,
    triangle_case, triangle_truth,
};
use crate::support::scene::{OwnedScene, STRUCTURES, corners, one_material, one_triangle, v};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    spheres_agree_with_exact_arithmetic,
    triangles_agree_with_exact_arithmetic,
    triangle_points_lie_within_their_error_bound,
    closed_meshes_do_not_leak,
    rays_along_the_grid_of_a_cube_do_not_leak,
    rays_toward_triangle_corners_and_edges_hit_behind_boxes,
    no_structure_loses_what_a_triangle_of_many_would_hit,
);

/// Wrong answers only where the exact one is within roundoff of changing; t as good as the problem is conditioned.
fn spheres_agree_with_exact_arithmetic<R: Real>() {
    let mut random = Random::new(11);
    let name = "t, hit or miss, point within its bound";
    let classes =
        ["N16", "N17", "N18", "N19", "N20"].map(|case| Trials::measured::<R>(case, name, 1.0, "of the bound"));
    for case in 0..trials(20_000) {
        let (class, center, radius, origin, direction) = sphere_case(&mut random, u::<R>());
        // Every problem at another scale, too: bounds are relative, so none may change.
        let errors = if case % 2 == 0 { &classes[class] } else { &classes[4] };
        let scale = if case % 2 == 0 { 1.0 } else { libm::ldexp(1.0, 8 * (random.below(13) as i32 - 6)) };
        let [center, origin, direction] = [center, origin, direction].map(|p| v::<R>(p.map(|x| x * scale)));
        let radius = R::from_f64(radius * scale);
        let scene = OwnedScene {
            spheres: vec![Sphere { center, radius, material: 0, inverted: false }],
            ..one_material::<R>()
        };
        let ray = Ray::<R>::new(origin, direction);
        let hit = scene.lend(None, |scene| scene.intersect(&ray));

        let Some(SphereTruth { t: truth, condition }) = sphere_truth(center, radius, &ray) else { continue };
        assert_eq!(hit.is_some(), truth.is_some(), "{ray:?} at {center:?} {radius:?}: {hit:?} is not {truth:?}");
        let (Some(hit), Some(truth)) = (hit, truth) else { continue };
        let bound = tolerance::sphere_t::<R>(condition, truth);
        let error = (hit.t.to_f64() - truth).abs();
        errors.error(error / bound, || {
            format!("{ray:?} at {center:?} {radius:?}: t off by {} u", error / (u::<R>() * truth))
        });

        // An end at the hit keeps it, and one before it does not.
        let [at, before] = [hit.t, hit.t.next_down()].map(|tmax| Ray { tmax, ..ray });
        scene.lend(None, |scene| {
            assert!(scene.intersect(&at) == Some(hit) && scene.occluded(&at), "{ray:?} ended at its hit {hit:?}");
            assert!(scene.intersect(&before).is_none(), "{ray:?} ended before its hit {hit:?}");
        });

        // The point: on the sphere within the bound that rays are spawned by.
        let point = scene.lend(None, |scene| scene.surface_point(&ray, &hit).expect("a hit of this scene"));
        let off = (&ExactVec::new::<R>(point.p) - &ExactVec::new::<R>(center)).length() - exact(radius.to_f64());
        let bound = ExactVec::new::<R>(point.ng.abs()).dot(&ExactVec::new::<R>(point.p_error));
        let off = roughly(&off).abs();
        assert!(off <= to_f64(&bound), "{point:?} is {off} off {center:?} {radius:?}");
    }
    classes.into_iter().for_each(|errors| errors.end(300));
}

/// Hits and misses are right beyond a few ulps of the edges; t is near the plane's; the barycentric coordinates name
/// a point on the ray.
fn triangles_agree_with_exact_arithmetic<R: Real>() {
    let mut random = Random::new(12);
    let across = Trials::measured::<R>("N13", "t of triangles, from the plane", tolerance::TRIANGLE_T, "u M");
    let along = Trials::measured::<R>("N13", "barycentric point, from the ray", tolerance::BARYCENTRIC, "u M");
    let mut misses = 0;
    for _ in 0..trials(20_000) {
        let (corners, origin, direction) = triangle_case(&mut random);
        let corners = corners.map(v::<R>);
        let ray = Ray::<R>::new(v::<R>(origin), v::<R>(direction));
        let hit = intersect_alone(corners, &ray);

        let Some(truth) = triangle_truth(&corners, &ray) else { continue };
        let inside = truth.inside;
        if inside > tolerance::TRIANGLE_EDGE && !truth.behind {
            assert!(hit.is_some(), "{ray:?} passes {inside} u M inside of {corners:?} and is lost");
        }
        if inside < -tolerance::TRIANGLE_EDGE || truth.behind {
            assert!(hit.is_none(), "{ray:?} passes {} u M outside of {corners:?} and hits", -inside);
            misses += 1;
        }
        let Some(hit) = hit else { continue };
        across.error(truth.error(hit.t), || format!("{ray:?} {corners:?}"));

        let [a, b, c] = corners.map(ExactVec::new::<R>);
        let (o, d) = (ExactVec::new::<R>(ray.origin), ExactVec::new::<R>(ray.direction));
        let weights = [R::ONE.to_f64() - hit.u.to_f64() - hit.v.to_f64(), hit.u.to_f64(), hit.v.to_f64()].map(exact);
        let p = &(&(&a * &weights[0]) + &(&b * &weights[1])) + &(&c * &weights[2]);
        let beside = truth.in_units(&((&p - &o).cross(&d).length() / d.length()));
        along.error(beside, || format!("{ray:?} {corners:?}"));
    }
    assert!(misses > 1000, "only {misses} misses");
    across.end(10_000);
    along.end(10_000);
}

fn intersect_alone<R: Real>(corners: [Vec3<R>; 3], ray: &Ray<R>) -> Option<Hit<R>> {
    one_triangle(corners).lend(None, |scene| scene.intersect(ray))
}

/// The bound that spawned rays rely on, across the plane.
fn triangle_points_lie_within_their_error_bound<R: Real>() {
    let mut random = Random::new(13);
    let errors = Trials::measured::<R>("N13", "points of triangles, off the plane", 1.0, "of the bound");
    for _ in 0..trials(20_000) {
        let (corners, origin, direction) = triangle_case(&mut random);
        let corners = corners.map(v::<R>);
        let ray = Ray::<R>::new(v::<R>(origin), v::<R>(direction));
        one_triangle(corners).lend(None, |scene| {
            let Some(hit) = scene.intersect(&ray) else { return };
            let point = scene.surface_point(&ray, &hit).expect("a hit of this scene");
            let [a, b, c] = corners.map(ExactVec::new::<R>);
            let n = (&b - &a).cross(&(&c - &a)).unit();
            let off = roughly(&(&ExactVec::new::<R>(point.p) - &a).dot(&n)).abs();
            let bound: f64 = (0..3).map(|i| to_f64(&n.0[i]).abs() * point.p_error.to_array()[i].to_f64()).sum();
            // Without area there is no plane.
            let share = if off == 0.0 { 0.0 } else { off / bound };
            errors.error(share, || format!("{point:?} is {off} off its plane"));
        });
    }
    errors.end(5000);
}

/// Rays from inside at corners, edges and faces, half of them normalized: brute force and hierarchy hit every time.
fn closed_meshes_do_not_leak<R: Real>() {
    for (name, mesh, center, radius) in closed_meshes() {
        let mut random = Random::new(15);
        let mut scene = one_material::<R>();
        scene.mesh(&mesh, 0);
        let mut shoot = |scene: &Scene<'_, R>, structure: &str, rays: u32| {
            let hits = Trials::of::<R>("N9", &format!("closed mesh, {name}, {structure}"));
            for i in 0..rays {
                let of_mesh = |triangle| corners(scene.geometry(), triangle);
                let ray = ray_at_mesh::<R>(&mut random, i, center, radius, of_mesh, mesh.triangles.len());
                hits.holds(scene.intersect(&ray).is_some(), || format!("{ray:?} leaks"));
            }
            hits.end(rays.into());
        };
        // All of 1280 triangles take a hundred times longer.
        scene.lend(None, |scene| shoot(scene, "all", trials(10_000)));
        scene.lend(Some(Structure::Bvh), |scene| shoot(scene, "BVH", trials(100_000)));
    }
}

/// Directions with zeros of both signs, through planes, edges and corners that are exactly on the ray.
fn rays_along_the_grid_of_a_cube_do_not_leak<R: Real>() {
    let mut scene = one_material::<R>();
    scene.mesh(&cube(8), 0);
    for structure in [None, Some(Structure::Bvh)] {
        scene.lend(structure, |scene| {
            let grid = || (-7..8).map(|i| f64::from(i) / 8.0);
            for (a, b) in grid().flat_map(|a| grid().map(move |b| (a, b))) {
                for (axis, sign) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
                    for zero in [0.0, -0.0] {
                        let (mut origin, mut direction) = ([a, b, 0.125], [zero; 3]);
                        origin.rotate_right(axis);
                        direction[(axis + 2) % 3] = sign;
                        let ray = crate::support::scene::ray::<R>(origin, direction);
                        let t = scene.intersect(&ray).map(|hit| hit.t.to_f64());
                        assert_eq!(t, Some(1.0 - 0.125 * sign), "{structure:?} {ray:?}");
                    }
                }
            }
        });
    }
    Trials::passed::<R>("N11", "rays along the grid of a cube", 2 * 225 * 6 * 2);
}

/// A triangle that its own test hits must not be lost because its box is missed.
fn rays_toward_triangle_corners_and_edges_hit_behind_boxes<R: Real>() {
    let mut random = Random::new(16);
    let kept = Trials::of::<R>("N6", "triangles behind their boxes");
    for case in 0..trials(100_000) {
        let (corners, ray) = box_case::<R>(&mut random, case);
        let prepared = PreparedRay::new(&ray);
        let own = triangle::intersect(&corners, &prepared, ray.tmax);
        let alone = intersect_alone(corners, &ray);
        kept.holds(own.is_some() == alone.is_some(), || format!("{ray:?} {corners:?}"));
    }
    kept.end(100_000);
}

/// The same among many, behind the boxes of a hierarchy: whatever the test of any triangle hits is hit, and nothing is
/// nearer than what is found. N5 is here, too, since boxes of triangles end at these corners and edges.
fn no_structure_loses_what_a_triangle_of_many_would_hit<R: Real>() {
    const EACH: u32 = 32;
    let classes = ["all", "box", "BVH"].map(|structure| {
        ["N5", "N6"]
            .map(|case| Trials::of::<R>(case, &format!("corners and edges of triangles among others, {structure}")))
    });
    let mut random = Random::new(17);
    let wanted = trials(20_000);
    for first in (0..u32::MAX).step_by(EACH as usize) {
        if classes[0][0].count() >= wanted.into() {
            break;
        }
        let scale = magnitude(&mut random, -3.0, 5.0);
        let triangles: Vec<_> = (first..first + EACH).map(|case| box_triangle::<R>(&mut random, case, scale)).collect();
        let rays = triangles.iter().zip(first..).map(|(of, case)| ray_at_box::<R>(&mut random, case, scale, of));
        let rays: Vec<Ray<R>> = rays.collect();
        let mut scene = one_material::<R>();
        let alone = (0..3 * EACH).collect::<Vec<_>>().chunks(3).map(|of| [of[0], of[1], of[2]]).collect();
        scene.mesh(&Mesh { positions: vec![], triangles: alone }, 0);
        scene.positions = triangles.concat();
        let mut due = Vec::new();
        for ray in &rays {
            // Where each that its own test hits is hit alone, behind its own box; a NaN for one that is lost there.
            let prepared = PreparedRay::new(ray);
            let hits = triangles.iter().filter(|of| triangle::intersect(of, &prepared, ray.tmax).is_some());
            let hits: Vec<f64> =
                hits.map(|of| intersect_alone(*of, ray).map_or(f64::NAN, |hit| hit.t.to_f64())).collect();
            due.push(hits.into_iter().reduce(|a, b| if a.is_nan() || a <= b { a } else { b }));
        }
        for (structure, class) in STRUCTURES.into_iter().zip(&classes) {
            scene.lend(structure, |scene| {
                for (ray, due) in rays.iter().zip(&due) {
                    let hit = scene.intersect(ray).map(|hit| hit.t.to_f64());
                    assert!(due.is_some() || hit.is_none(), "{ray:?} hits what no triangle is hit by: {hit:?}");
                    for trials in class.iter().filter(|_| due.is_some()) {
                        trials.holds(hit == *due && scene.occluded(ray), || format!("{ray:?}: {hit:?}, not {due:?}"));
                    }
                }
            });
        }
    }
    classes.into_iter().flatten().for_each(|trials| trials.end(wanted.into()));
}
