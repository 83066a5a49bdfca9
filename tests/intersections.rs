//! Spheres and triangles against exact arithmetic, and meshes that must not leak.
//!
//! The floats of a case are the problem; what is measured is the distance of the answer from the exact one, in units
//! of roundoff times what the problem itself magnifies.

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::shape::Sphere;
use ocellus_kernel::{Hit, Ray, Scene};

use crate::support::exact::{ExactVec, exact, root, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, cube, icosphere};
use crate::support::random::Random;
use crate::support::scene::{OwnedScene, corners, v};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    spheres_agree_with_exact_arithmetic,
    triangles_agree_with_exact_arithmetic,
    triangle_points_lie_within_their_error_bound,
    closed_meshes_do_not_leak,
    rays_along_the_grid_of_a_cube_do_not_leak,
    rays_toward_triangle_corners_and_edges_hit_behind_boxes,
);

/// `10^x` with x uniform.
pub(crate) fn magnitude(random: &mut Random, low: f64, high: f64) -> f64 {
    libm::exp10(random.between(low, high))
}

/// A ray of any length of direction at a sphere: far, grazing, tiny, huge, from inside, from hardly inside or outside.
pub(crate) fn sphere_case(random: &mut Random, unit: f64) -> (usize, [f64; 3], f64, [f64; 3], [f64; 3]) {
    let radius = magnitude(random, -4.0, 5.0);
    let place = random.below(6);
    let distance = radius
        * match place {
            0 => magnitude(random, 2.0, 6.0),
            1 => random.between(1.1, 4.0),
            2 => random.between(0.0, 0.9),
            3 => 1.0 - magnitude(random, libm::log10(40.0 * unit), -2.0),
            4 => 1.0 + magnitude(random, libm::log10(40.0 * unit), -2.0),
            _ => 1.0 + magnitude(random, -4.0, 0.0),
        };
    let center = random.in_cube().map(|x| x * radius * 3.0 * random.below(2) as f64);
    let [away, across] = [random.on_sphere(), random.on_sphere()];
    // Impact parameter: anything, or grazing from within and without.
    let graze = random.below(3);
    let impact = match graze {
        0 => random.between(0.0, 1.5),
        1 => 1.0 - magnitude(random, -6.0, -2.0),
        _ => 1.001,
    };
    let along = (0..3).map(|i| away[i] * across[i]).sum::<f64>();
    let origin = std::array::from_fn(|i| center[i] + away[i] * distance);
    let target: [f64; 3] = std::array::from_fn(|i| center[i] + (across[i] - along * away[i]) * radius * impact);
    // Away from the middle, too.
    let sign = if random.below(4) == 0 { -1.0 } else { 1.0 };
    let length = sign * magnitude(random, -6.0, 6.0) / distance;
    // N19 starts inside or on the surface, N17 grazes, N16 is far away; all the rest is small or large, N18.
    let class = match (place, graze) {
        (2..=4, _) => 3,
        (_, 1 | 2) => 1,
        (0, _) => 0,
        _ => 2,
    };
    (class, center, radius, origin, std::array::from_fn(|i| (target[i] - origin[i]) * length))
}

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

        let [c, o, d] = [center, origin, direction].map(ExactVec::new::<R>);
        let r = exact(radius.to_f64());
        let to_center = &c - &o;
        let square = d.dot(&d);
        let t_foot = to_center.dot(&d) / &square;
        let foot = (&to_center - &(&d * &t_foot)).length();
        let half = root(&((&r - &foot) * (&r + &foot) / &square));
        let [far_t, near_t] = [&t_foot + &half, &t_foot - &half].map(|t| to_f64(&t));
        let [big_d, r, l, h, length] =
            [&to_center.length(), &r, &foot, &(&half * root(&square)), &root(&square)].map(to_f64);

        let margin = tolerance::UNDECIDED * u::<R>() * (big_d + r);
        if (l - r).abs() <= margin || (big_d - r).abs() <= margin {
            continue;
        }
        let truth = if l > r || far_t <= 0.0 { None } else { Some(if near_t > 0.0 { near_t } else { far_t }) };
        assert_eq!(hit.is_some(), truth.is_some(), "{ray:?} at {center:?} {radius:?}: {hit:?} is not {truth:?}");
        let (Some(hit), Some(truth)) = (hit, truth) else { continue };
        // The root nearer to the origin is what a small difference of distances leaves over.
        let cancelled = if truth <= near_t.abs().min(far_t.abs()) { big_d / (big_d - r).abs() } else { 0.0 };
        let condition = truth * (1.0 + cancelled) + big_d * l / (h * length);
        // What the wide precision does to the problem, and the rounding of its answer where it is wider.
        let bound = tolerance::SPHERE_T * u::<R::Wide>() * condition
            + tolerance::by_precision::<R>(tolerance::ROUNDED, 0.0) * u::<R>() * truth;
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
        let off = (ExactVec::new::<R>(point.p) - c).length() - exact(radius.to_f64());
        let bound = ExactVec::new::<R>(point.ng.abs()).dot(&ExactVec::new::<R>(point.p_error));
        assert!(to_f64(&off).abs() <= to_f64(&bound), "{point:?} is {} off {center:?} {radius:?}", to_f64(&off));
    }
    classes.into_iter().for_each(|errors| errors.end(300));
}

impl std::ops::Sub for ExactVec {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        &self - &other
    }
}

pub(crate) fn one_material<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    scene.diffuse(0.5, 0.0);
    scene
}

/// One of the hard classes of triangles, with a ray at or beside it.
fn triangle_case(random: &mut Random) -> ([[f64; 3]; 3], [f64; 3], [f64; 3]) {
    let mut corners: [[f64; 3]; 3] = std::array::from_fn(|_| random.in_cube());
    let mut distance = random.between(0.5, 3.0);
    let mut shift = [0.0; 3];
    match random.below(8) {
        0 => {}
        1 => distance = magnitude(random, 2.0, 5.0),
        2 => shift = random.in_cube().map(|x| x * 1e4),
        // A sliver.
        3 => {
            let offset = random.in_cube();
            corners[2] = std::array::from_fn(|i| 0.5 * (corners[0][i] + corners[1][i]) + 1e-4 * offset[i]);
        }
        // Almost in a plane of the axes.
        4 => corners.iter_mut().for_each(|corner| corner[2] *= 1e-6),
        5 => corners = corners.map(|corner| corner.map(|x| x * 1e-6)),
        6 => {
            let scale = magnitude(random, -8.0, 8.0);
            corners = corners.map(|corner| corner.map(|x| x * scale));
            distance *= scale;
        }
        _ => corners = corners.map(|corner| corner.map(|x| (x * 2.0).round() * 0.5)),
    }
    corners = corners.map(|corner| std::array::from_fn(|i| corner[i] + shift[i]));
    let weights = random.barycentric().map(|w| if random.below(8) == 0 { -0.1 * w } else { w });
    let target: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| corners[k][i] * weights[k]).sum());
    let away = random.on_sphere();
    let origin = std::array::from_fn(|i| target[i] + away[i] * distance);
    let length = magnitude(random, -6.0, 6.0);
    (corners, origin, std::array::from_fn(|i| (target[i] - origin[i]) * length))
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

        let [a, b, c] = corners.map(ExactVec::new::<R>);
        let (o, d) = (ExactVec::new::<R>(ray.origin), ExactVec::new::<R>(ray.direction));
        let n = (&b - &a).cross(&(&c - &a));
        let steep = d.dot(&n);
        if n.length() == exact(0.0) || steep == exact(0.0) {
            continue;
        }
        let largest = corners.iter().chain([&ray.origin]).map(|p| p.abs().max_component().to_f64()).fold(0.0, f64::max);
        let unit = u::<R>() * largest;
        let t = (&a - &o).dot(&n) / &steep;
        // Signed distance of the ray's line from each edge's line, positive inside.
        let edges = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| {
            let edge = q - p;
            let common = d.cross(&edge);
            let moment = (p - &o).dot(&common);
            let distance = to_f64(&(moment / common.length()));
            if steep > exact(0.0) { -distance } else { distance }
        });
        let inside = edges.into_iter().fold(f64::INFINITY, f64::min);
        let behind = to_f64(&t) <= 0.0;
        if inside > tolerance::TRIANGLE_EDGE * unit && !behind {
            assert!(hit.is_some(), "{ray:?} passes {} u M inside of {corners:?} and is lost", inside / unit);
        }
        if inside < -tolerance::TRIANGLE_EDGE * unit || behind {
            assert!(hit.is_none(), "{ray:?} passes {} u M outside of {corners:?} and hits", -inside / unit);
            misses += 1;
        }
        let Some(hit) = hit else { continue };
        let t_error = (exact(hit.t.to_f64()) - t) * &steep / n.length();
        let t_error = to_f64(&t_error).abs() / unit;
        across.error(t_error, || format!("{ray:?} {corners:?}"));

        let weights = [R::ONE.to_f64() - hit.u.to_f64() - hit.v.to_f64(), hit.u.to_f64(), hit.v.to_f64()].map(exact);
        let p = &(&(&a * &weights[0]) + &(&b * &weights[1])) + &(&c * &weights[2]);
        let beside = to_f64(&((&p - &o).cross(&d).length() / d.length())) / unit;
        along.error(beside, || format!("{ray:?} {corners:?}"));
    }
    assert!(misses > 1000, "only {misses} misses");
    across.end(10_000);
    along.end(10_000);
}

fn scene_of<R: Real>(corners: [Vec3<R>; 3]) -> OwnedScene<R> {
    let mut scene = one_material::<R>();
    scene.mesh(&Mesh { positions: vec![], triangles: vec![[0, 1, 2]] }, 0);
    scene.positions = corners.to_vec();
    scene
}

fn intersect_alone<R: Real>(corners: [Vec3<R>; 3], ray: &Ray<R>) -> Option<Hit<R>> {
    scene_of(corners).lend(None, |scene| scene.intersect(ray))
}

/// The bound that spawned rays rely on, across the plane.
fn triangle_points_lie_within_their_error_bound<R: Real>() {
    let mut random = Random::new(13);
    let errors = Trials::measured::<R>("N13", "points of triangles, off the plane", 1.0, "of the bound");
    for _ in 0..trials(20_000) {
        let (corners, origin, direction) = triangle_case(&mut random);
        let corners = corners.map(v::<R>);
        let ray = Ray::<R>::new(v::<R>(origin), v::<R>(direction));
        scene_of(corners).lend(None, |scene| {
            let Some(hit) = scene.intersect(&ray) else { return };
            let point = scene.surface_point(&ray, &hit).expect("a hit of this scene");
            let [a, b, c] = corners.map(ExactVec::new::<R>);
            let n = (&b - &a).cross(&(&c - &a)).unit();
            let off = to_f64(&(&ExactVec::new::<R>(point.p) - &a).dot(&n)).abs();
            let bound: f64 = (0..3).map(|i| to_f64(&n.0[i]).abs() * point.p_error.to_array()[i].to_f64()).sum();
            // Without area there is no plane.
            let share = if off == 0.0 { 0.0 } else { off / bound };
            errors.error(share, || format!("{point:?} is {off} off its plane"));
        });
    }
    errors.end(5000);
}

/// Meshes whose neighbourhood of the centre stays inside whatever the rounding of their corners.
fn closed_meshes() -> Vec<(&'static str, Mesh, [f64; 3], f64)> {
    let jitter = || {
        let mut random = Random::new(14);
        icosphere(3).map(move |p| {
            let radius = random.between(1.0, 6.0);
            p.map(|x| x * radius)
        })
    };
    let placed =
        |mesh: Mesh, center: [f64; 3], radius: f64| mesh.map(|p| std::array::from_fn(|i| center[i] + radius * p[i]));
    let origin = [0.0; 3];
    // Where Embree's own test of this kind puts its sphere.
    let embree = [148_376.0, 1234.0, -223_423.0];
    vec![
        ("plain", icosphere(3), origin, 0.5),
        ("jittered", jitter(), origin, 0.5),
        ("at Embree's place", placed(icosphere(3), embree, 2.0), embree, 1.0),
        ("at 1e4", placed(jitter(), [1e4, -1e4, 1e4], 1.0), [1e4, -1e4, 1e4], 0.5),
        ("1e-4 in size", placed(jitter(), origin, 1e-4), origin, 0.5e-4),
        ("1e-12 in size", placed(jitter(), origin, 1e-12), origin, 0.5e-12),
        ("1e6 in size", placed(jitter(), origin, 1e6), origin, 0.5e6),
        ("needles", icosphere(3).map(|[x, y, z]| [x, 1e-3 * y, 1e3 * z]), origin, 0.5e-3),
    ]
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
                let origin = random.in_cube();
                let origin = v::<R>(std::array::from_fn(|k| center[k] + 0.5 * radius * origin[k]));
                let [a, b, c] = corners(scene.geometry(), random.below(mesh.triangles.len()));
                let w = random.barycentric().map(R::from_f64);
                let target = match i % 3 {
                    0 => a,
                    1 => a + (b - a) * w[0],
                    _ => a * w[0] + b * w[1] + c * w[2],
                };
                let mut direction = target - origin;
                if i % 2 == 0 {
                    direction = ocellus_kernel::robust::normalize::<R>(direction);
                }
                let ray = Ray::new(origin, direction);
                hits.holds(scene.intersect(&ray).is_some(), || format!("{ray:?} leaks"));
            }
            hits.end(rays.into());
        };
        // All of 1280 triangles take a hundred times longer.
        scene.lend(None, |scene| shoot(scene, "all", trials(100_000) / 10));
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
        let scale = magnitude(&mut random, -3.0, 5.0);
        let mut corners: [[f64; 3]; 3] = std::array::from_fn(|_| random.in_cube().map(|x| x * scale));
        if case % 2 == 0 {
            let axis = random.below(3);
            corners.iter_mut().for_each(|corner| corner[axis] = scale * 0.3);
        }
        let corners = corners.map(v::<R>);
        let origin = v::<R>(random.in_cube().map(|x| x * scale * 10.0));
        let weight = R::from_f64(random.unit());
        let target = if case % 3 == 0 { corners[0] } else { corners[0] + (corners[1] - corners[0]) * weight };
        let ray = Ray::<R>::new(origin, target - origin);
        let prepared = ocellus_kernel::shape::PreparedRay::new(&ray);
        let own = ocellus_kernel::shape::triangle::intersect(&corners, &prepared, ray.tmax);
        let alone = intersect_alone(corners, &ray);
        kept.holds(own.is_some() == alone.is_some(), || format!("{ray:?} {corners:?}"));
    }
    kept.end(100_000);
}
