//! Hard cases of geometry, each under its number: boxes and rays without end, degenerate triangles between sound
//! ones, spheres seen from their centres and at extreme scales, meshes far from the origin.

use std::time::Instant;

use ocellus_kernel::bvh::{Bounds, Structure};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::shape::{PreparedRay, Sphere};
use ocellus_kernel::{Ray, Scene};

use crate::slabs::meets;
use crate::support::exact::{ExactVec, exact, roughly};
use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, cube, floor, icosphere};
use crate::support::random::Random;
use crate::support::rays::{SphereTruth, magnitude, place_of_triangle, sphere_case, sphere_truth};
use crate::support::scene::{corners, one_material, ray, v};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    infinite_boxes_are_hit_and_empty_ones_are_not,
    rays_that_are_no_rays_end_at_once,
    degenerate_triangles_between_others_open_no_gap,
    rays_from_the_centre_of_a_sphere_go_one_radius,
    rays_from_near_the_centre_of_a_sphere_keep_the_bound,
    spheres_at_extreme_scales_agree_with_exact_arithmetic,
    moved_meshes_are_hit_alike,
    a_grazed_floor_is_the_same_through_every_structure,
);

/// A vector with zeros of both signs among its components, but not only those.
fn with_zeros(random: &mut Random, vector: [f64; 3]) -> [f64; 3] {
    let kept = random.below(3);
    let mut index = 0;
    vector.map(|x| {
        index += 1;
        if index - 1 != kept && random.below(4) == 0 { if random.below(2) == 0 { 0.0 } else { -0.0 } } else { x }
    })
}

/// N7. No side of an infinite box can be missed, and nothing is in an empty one; where coordinates are so large that
/// their products overflow, boxes still lose no ray.
fn infinite_boxes_are_hit_and_empty_ones_are_not<R: Real>() {
    let mut random = Random::new(701);
    let infinity = f64::INFINITY;
    let trial = |class| Trials::of::<R>("N7", class);
    let (all, around, beside) = (trial("all sides infinite"), trial("around the origin"), trial("some sides infinite"));
    let (empty, large) = (trial("empty boxes"), trial("coordinates of 1e30 and 1e250"));
    let entry = |[low, high]: [[f64; 3]; 2], ray: &Ray<R>| {
        let bounds = Bounds { corners: [low, high].map(|corner| corner.map(R::from_f64)) };
        bounds.entry(&PreparedRay::new(ray), ray.tmax).map(Real::to_f64)
    };
    let mut missed = 0;
    for _ in 0..trials(20_000) {
        let size = magnitude(&mut random, -3.0, 3.0);
        let direction = random.on_sphere().map(|x| x * magnitude(&mut Random::new(size.to_bits()), -3.0, 3.0));
        let r = ray::<R>(random.in_cube().map(|x| x * size), with_zeros(&mut random, direction));
        let [origin, direction] = [r.origin, r.direction].map(|p| p.to_array().map(Real::to_f64));

        let found = entry([[-infinity; 3], [infinity; 3]], &r);
        all.holds(found == Some(0.0), || format!("{r:?}: {found:?}"));

        // Sides at the origin, beside it, or nowhere.
        let mut side = |x: f64, sign: f64| match random.below(3) {
            0 => x,
            1 => R::from_f64(x + sign * size * random.unit()).to_f64(),
            _ => sign * infinity,
        };
        let mut bounds = [-1.0, 1.0].map(|sign| origin.map(|x| side(x, sign)));
        let found = entry(bounds, &r);
        around.holds(found == Some(0.0), || format!("{r:?} in {bounds:?}: {found:?}"));

        // The same box with one axis turned inside out, by more than any padding.
        let axis = random.below(3);
        let gap = size * random.between(1e-3, 1.0);
        let at = origin[axis] + size * random.between(-2.0, 2.0);
        (bounds[0][axis], bounds[1][axis]) = (at + gap, at - gap);
        for nothing in [bounds, [[infinity; 3], [-infinity; 3]], Bounds::<R>::EMPTY.corners.map(|c| c.map(R::to_f64))] {
            let found = entry(nothing, &r);
            empty.holds(found.is_none(), || format!("{r:?} in {nothing:?}: {found:?}"));
        }

        // Boxes beside the ray, some of whose sides are infinite. What meets the part of one that is within reach
        // meets all of it.
        let [a, b] = [random.in_cube(), random.in_cube()].map(|p| p.map(|x| R::from_f64(2.0 * x * size).to_f64()));
        let mut bounds = [f64::min, f64::max].map(|pick| std::array::from_fn(|i| pick(a[i], b[i])));
        for (side, far) in [(0, -infinity), (1, infinity)] {
            let at: &mut [f64; 3] = &mut bounds[side];
            *at = at.map(|x| if random.below(4) == 0 { far } else { x });
        }
        let reach = bounds.map(|corner| corner.map(|x| x.clamp(-1e6, 1e6)));
        let found = entry(bounds, &r);
        let due = meets(&reach, origin, direction);
        beside.holds(if due { found.is_some() } else { !found.is_some_and(f64::is_nan) }, || {
            format!("{r:?} in {bounds:?}: {found:?}")
        });
        missed += u32::from(found.is_none());

        let scale = tolerance::by_precision::<R>(1e30, 1e250);
        let large_ray = ray::<R>(origin.map(|x| x / size * scale), direction.map(|x| x * scale));
        let [origin, direction] = [large_ray.origin, large_ray.direction].map(|p| p.to_array().map(Real::to_f64));
        let bounds = [f64::min, f64::max]
            .map(|pick| std::array::from_fn(|i| R::from_f64(pick(a[i], b[i]) / size * scale).to_f64()));
        let found = entry(bounds, &large_ray);
        let due = meets(&bounds, origin, direction);
        large.holds(if due { found.is_some() } else { !found.is_some_and(f64::is_nan) }, || {
            format!("{large_ray:?} in {bounds:?}: {found:?}")
        });
        missed += u32::from(found.is_none());
    }
    assert!(missed > 5000, "only {missed} boxes were missed");
    [all, around, beside, large].into_iter().for_each(|trials| trials.end(20_000));
    empty.end(60_000);
}

/// N8. A ray with a component that is not finite must not wander through a large hierarchy: it misses, in no more time
/// than a ray that hits. Embree allows it 2.5 times as much.
fn rays_that_are_no_rays_end_at_once<R: Real>() {
    let mut random = Random::new(801);
    let mut scene = one_material::<R>();
    scene.mesh(&cube(92), 0);
    assert!(scene.triangles.len() > 100_000);
    let good: Vec<_> = (0..1000).map(|_| ray::<R>(random.in_cube().map(|x| 0.9 * x), random.on_sphere())).collect();
    let poison = [f64::NAN, f64::INFINITY, -f64::INFINITY].map(R::from_f64);
    let poisoned = good.iter().enumerate().map(|(i, good)| {
        let mut parts = [good.origin, good.direction].map(Vector::to_array);
        parts[i % 2][i / 2 % 3] = poison[i / 6 % 3];
        let [origin, direction] = parts.map(Vec3::<R>::from_array);
        Ray::new(origin, direction)
    });
    let bad: Vec<_> = poisoned.collect();
    scene.lend(Some(Structure::Bvh), |scene| {
        let misses = Trials::of::<R>("N8", "rays with NaN or infinity miss 1e5 triangles");
        for ray in &bad {
            misses.holds(scene.intersect(ray).is_none() && !scene.occluded(ray), || format!("{ray:?}"));
        }
        misses.end(1000);
        // The best of many runs: whatever else the machine does only ever adds time.
        let time = |rays: &[Ray<R>], due: usize| {
            let run = |_| {
                let start = Instant::now();
                assert_eq!(rays.iter().filter(|ray| scene.intersect(ray).is_some()).count(), due);
                start.elapsed().as_secs_f64()
            };
            (0..20).map(run).fold(f64::INFINITY, f64::min)
        };
        let slower = Trials::measured::<R>("N8", "their time", tolerance::INVALID_TIME, "times that of good rays");
        slower.error(time(&bad, 0) / time(&good, 1000), || "1000 rays".to_owned());
        slower.end(1);
    });
}

/// N14. Before each triangle of a closed mesh lies one that is none: it is never hit, and its neighbours still close
/// the mesh. Coordinates are so short that the middle of an edge is exactly on it.
fn degenerate_triangles_between_others_open_no_gap<R: Real>() {
    let closed = icosphere(3).map(|p| p.map(|x| (x * 512.0).round() / 512.0));
    for class in ["one point", "repeated corner", "collinear corners", "NaN corner", "infinite corner"] {
        let mut random = Random::new(1401);
        let mut mesh = Mesh { positions: closed.positions.clone(), triangles: Vec::new() };
        for sound in &closed.triangles {
            let [a, b, _] = *sound;
            let next = mesh.positions.len() as u32;
            let [p, q] = [a, b].map(|corner| closed.positions[corner as usize]);
            let mut degenerate = match class {
                "one point" => [a; 3],
                "repeated corner" => [a, b, b],
                _ => {
                    let mut corner = std::array::from_fn(|i| 0.5 * (p[i] + q[i]));
                    match class {
                        "NaN corner" => corner[random.below(3)] = f64::NAN,
                        "infinite corner" => corner[random.below(3)] = f64::INFINITY,
                        _ => {}
                    }
                    mesh.positions.push(corner);
                    [a, b, next]
                }
            };
            degenerate.rotate_left(random.below(3));
            mesh.triangles.extend([degenerate, *sound]);
        }
        let mut scene = one_material::<R>();
        scene.mesh(&mesh, 0);
        let hits = Trials::of::<R>("N14", &format!("closed mesh, each triangle beside one of {class}"));
        let mut shoot = |scene: &Scene<'_, R>, rays: u32| {
            for i in 0..rays {
                let origin = v::<R>(random.in_cube().map(|x| 0.25 * x));
                let sound = 2 * random.below(closed.triangles.len()) + 1;
                let target = place_of_triangle::<R>(&mut random, i, corners(scene.geometry(), sound));
                let ray = Ray::new(origin, target - origin);
                let hit = scene.intersect(&ray);
                hits.holds(hit.is_some_and(|hit| hit.primitive % 2 == 1), || format!("{ray:?}: {hit:?}"));
            }
        };
        scene.lend(None, |scene| shoot(scene, 1000));
        scene.lend(Some(Structure::Bvh), |scene| shoot(scene, trials(40_000)));
        hits.end(41_000);
    }
}

/// N19. From the centre the way out is one radius, whatever the direction's length.
fn rays_from_the_centre_of_a_sphere_go_one_radius<R: Real>() {
    let mut random = Random::new(1901);
    let limit = tolerance::FROM_CENTRE;
    let errors = Trials::measured::<R>("N19", "rays from the centre of a sphere", limit, "u");
    for _ in 0..trials(20_000) {
        let (place, size) = (magnitude(&mut random, -4.0, 4.0), magnitude(&mut random, -4.0, 5.0));
        let length = magnitude(&mut random, -6.0, 6.0);
        let (center, direction) = (random.in_cube().map(|x| x * place), random.on_sphere());
        let direction = with_zeros(&mut random, direction).map(|x| x * length);
        let (ray, radius) = (ray::<R>(center, direction), R::from_f64(size));
        let mut scene = one_material::<R>();
        scene.spheres.push(Sphere { center: ray.origin, radius, material: 0, inverted: false });
        let truth = exact(radius.to_f64()) / ExactVec::new::<R>(ray.direction).length();
        for structure in [None, Some(Structure::Bvh)] {
            let t = scene.lend(structure, |scene| scene.intersect(&ray)).map_or(f64::NAN, |hit| hit.t.to_f64());
            // A NaN is no exact number, and fails as an infinite error does.
            let error = if t.is_finite() { roughly(&(exact(t) / &truth - exact(1.0))).abs() } else { f64::NAN };
            errors.error(error / u::<R>(), || format!("{ray:?}, radius {radius:?}: {t}"));
        }
    }
    errors.end(40_000);
}

/// N19. From near the centre neither root cancels, and both must be as exact as from far away.
fn rays_from_near_the_centre_of_a_sphere_keep_the_bound<R: Real>() {
    let mut random = Random::new(1902);
    let errors = Trials::measured::<R>("N19", "rays from near the centre of a sphere", 1.0, "of its bound");
    for _ in 0..trials(20_000) {
        let size = magnitude(&mut random, -4.0, 5.0);
        let (center, radius) = (v::<R>(random.in_cube()), R::from_f64(size));
        let away = random.on_sphere();
        let distance = size * magnitude(&mut random, -4.0, 0.0);
        let origin = center + v::<R>(away.map(|x| x * distance));
        // Outward as often as to the other side.
        let (aside, tilt) = (random.on_sphere(), magnitude(&mut random, -4.0, 1.0));
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let ray = Ray::<R>::new(origin, v::<R>(std::array::from_fn(|i| sign * (away[i] + tilt * aside[i]))));
        let mut scene = one_material::<R>();
        scene.spheres.push(Sphere { center, radius, material: 0, inverted: false });
        let Some(SphereTruth { t: Some(truth), condition }) = sphere_truth(center, radius, &ray) else { continue };
        let t = scene.lend(Some(Structure::Bvh), |scene| scene.intersect(&ray)).map_or(f64::NAN, |hit| hit.t.to_f64());
        let bound = tolerance::sphere_t::<R>(condition, truth);
        errors.error((t - truth).abs() / bound, || format!("{ray:?} in {center:?} {radius:?}: {t} {truth}"));
    }
    errors.end(15_000);
}

/// N20. Radii of 1e-20, whose squares vanish in f32, coordinates of 1e18, and directions of 1e-6 to 1e6: answers and
/// errors of t within the same bounds as at any other scale.
fn spheres_at_extreme_scales_agree_with_exact_arithmetic<R: Real>() {
    for class in ["1e-20 in size", "at coordinates of 1e18"] {
        let mut random = Random::new(2001);
        let right = Trials::of::<R>("N20", &format!("spheres {class}: hit or miss"));
        let errors = Trials::measured::<R>("N20", &format!("spheres {class}: t"), 1.0, "of its bound");
        for _ in 0..trials(10_000) {
            let (_, center, radius, origin, direction) = sphere_case(&mut random, u::<R>());
            let largest = [center, origin].concat().into_iter().map(f64::abs).fold(radius, f64::max);
            let scale = if class.starts_with("1e-20") { 1e-20 / radius } else { 1e18 / largest };
            let [center, origin] = [center, origin].map(|p| v::<R>(p.map(|x| x * scale)));
            let (ray, radius) = (Ray::<R>::new(origin, v::<R>(direction)), R::from_f64(radius * scale));
            let mut scene = one_material::<R>();
            scene.spheres.push(Sphere { center, radius, material: 0, inverted: false });
            let hits = [None, Some(Structure::Bvh)].map(|s| scene.lend(s, |scene| scene.intersect(&ray)));
            let words = || format!("{ray:?} at {center:?} {radius:?}: {hits:?}");

            let Some(SphereTruth { t: truth, condition }) = sphere_truth(center, radius, &ray) else { continue };
            right.holds(hits[0] == hits[1] && hits[0].is_some() == truth.is_some(), words);
            let (Some(hit), Some(truth)) = (hits[0], truth) else { continue };
            let bound = tolerance::sphere_t::<R>(condition, truth);
            errors.error((hit.t.to_f64() - truth).abs() / bound, words);
        }
        right.end(5000);
        errors.end(2000);
    }
}

/// N46. A closed mesh of size S moved by 2^k S, k = 0..=16, does not leak, and the ray hits the triangle it hit where
/// the mesh was. Where every coordinate stays as it is the answer is the same to the bit but for the barycentric point;
/// where coordinates round, rays that pass within 4 ulps of the largest one from an edge may hit its other side.
fn moved_meshes_are_hit_alike<R: Real>() {
    for (class, grid) in [("short coordinates", Some(32.0)), ("rounded coordinates", None)] {
        let mut random = Random::new(4601);
        let mesh = icosphere(1).map(|p| p.map(|x| grid.map_or(x, |grid: f64| (x * grid).round() / grid)));
        let leaks = Trials::of::<R>("N46", &format!("closed mesh moved by 2^k S, {class}: leaks"));
        let others = Trials::of::<R>("N46", &format!("closed mesh moved by 2^k S, {class}: other triangles"));
        let mut still = one_material::<R>();
        still.mesh(&mesh, 0);
        for k in 0..=16 {
            // Not along an axis, and exact in both precisions.
            let shift = [2.0, -1.0, 1.5].map(|x| libm::ldexp(x, k));
            let mut moved = one_material::<R>();
            moved.mesh(&mesh.clone().map(|p| std::array::from_fn(|i| p[i] + shift[i])), 0);
            let unit = 2.0 * u::<R>() * libm::ldexp(2.0, k);
            for i in 0..trials(17_000) / 17 {
                let origin = random.in_cube().map(|x| grid.map_or(0.25 * x, |grid| (0.25 * x * grid).round() / grid));
                let at = random.below(mesh.triangles.len());
                let target = place_of_triangle::<R>(&mut random, i, corners(&still.geometry(), at));
                let ray = Ray::new(v::<R>(origin), target - v::<R>(origin));
                let there = Ray { origin: v::<R>(std::array::from_fn(|i| origin[i] + shift[i])), ..ray };
                let [here, found] = [(&still, &ray), (&moved, &there)]
                    .map(|(scene, ray)| scene.lend(None, |scene| scene.intersect(ray)));
                leaks.holds(
                    here.is_some() && found.is_some_and(|hit| [hit.t, hit.u, hit.v].iter().all(|x| x.is_finite())),
                    || format!("2^{k}: {there:?}: {found:?}"),
                );
                let (Some(here), Some(found)) = (here, found) else { continue };
                let same = here.primitive == found.primitive;
                let beside = || {
                    grid.is_none()
                        && edge_distance(&ray, corners(&still.geometry(), here.primitive as usize)) <= 4.0 * unit
                };
                others.holds(same || beside(), || format!("2^{k}: {ray:?}: {found:?} and not {here:?}"));
                if grid.is_some() {
                    others.holds(here.t == found.t, || format!("2^{k}: {ray:?}: {found:?} and not {here:?}"));
                }
            }
        }
        leaks.end(17_000);
        others.end(17_000);
    }
}

/// How far the line of a ray passes from the nearest of a triangle's edges, in exact arithmetic.
fn edge_distance<R: Real>(ray: &Ray<R>, corners: [Vec3<R>; 3]) -> f64 {
    let (o, d) = (ExactVec::new::<R>(ray.origin), ExactVec::new::<R>(ray.direction));
    let [a, b, c] = corners.map(ExactVec::new::<R>);
    let distances = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| {
        let common = d.cross(&(q - p));
        roughly(&((p - &o).dot(&common) / common.length())).abs()
    });
    distances.into_iter().fold(f64::INFINITY, f64::min)
}

/// N39. A floor whose triangles are there twice, with cubes and balls that stand on it, and rays almost along it: at
/// every contact several surfaces are as near as each other, and boxes have no height.
fn a_grazed_floor_is_the_same_through_every_structure<R: Real>() {
    let mut random = Random::new(39);
    let mut scene = one_material::<R>();
    for _ in 0..2 {
        scene.mesh(&floor(8.0), 0);
        scene.mesh(&cube(2).map(|[x, y, z]| [x, y + 1.0, z - 3.0]), 0);
        scene.mesh(&cube(1).map(|[x, y, z]| [0.3 * x + 2.0, 0.3 * y + 0.3, 0.3 * z]), 0);
    }
    for (x, radius) in [(-2.0, 1.0), (-4.5, 0.5), (5.0, 0.1), (5.0, 0.1)] {
        scene.sphere([x, radius, 0.5 * x], radius, 0);
    }
    let rays: Vec<Ray<R>> = (0..trials(20_000))
        .map(|_| {
            let [x, _, z] = random.in_cube().map(|x| x * 10.0);
            let height = [0.0, magnitude(&mut random, -7.0, 0.0)][random.below(2)];
            // Toward one of those that stand there, or beside it.
            let [tx, tz] = [[-2.0, -1.0], [-4.5, -2.25], [5.0, 2.5], [0.0, -3.0], [2.0, 0.0]][random.below(5)];
            let [dx, _, dz] = random.in_cube();
            let [dx, dz] = [tx - x + dx, tz - z + dz];
            // Down, along or up by next to nothing.
            let slope = [0.0, -1.0, 1.0][random.below(3)] * magnitude(&mut random, -8.0, -1.0);
            ray::<R>([x, height, z], [dx, slope, dz])
        })
        .collect();
    let [none, one_box, bvh] = [None, Some(Structure::Box), Some(Structure::Bvh)].map(|structure| {
        scene.lend(structure, |scene| {
            rays.iter().map(|ray| (scene.intersect(ray), scene.occluded(ray))).collect::<Vec<_>>()
        })
    });
    let same = Trials::of::<R>("N39", "rays along a floor with contacts and copies: all, box, BVH");
    for (at, ray) in rays.iter().enumerate() {
        let agree = none[at] == one_box[at] && none[at] == bvh[at] && none[at].0.is_some() == none[at].1;
        same.holds(agree, || format!("{ray:?}: {:?}, {:?}, {:?}", none[at], one_box[at], bvh[at]));
    }
    assert!(none.iter().filter(|(hit, _)| hit.is_some()).count() > rays.len() / 4);
    same.end(20_000);
}
