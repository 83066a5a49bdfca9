//! The acceleration structures: none, one box and a hierarchy give the same bits; builds end, within bounds, on any
//! input; storages that are too small say so.

use std::collections::BTreeSet;

use ocellus_kernel::bvh::{
    self, Bounds, Branch, BuildItem, Bvh, BvhStorage, Child, Join, MAX_DEPTH, Structure, required_nodes,
};
use ocellus_kernel::error::{Capacity, CapacityError};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::shape::{Geometry, triangle};
use ocellus_kernel::{Hit, Ray, Scene};
use proptest::prelude::*;

use crate::support::in_both_precisions;
use crate::support::meshes::{Mesh, cube, soup};
use crate::support::property::for_all;
use crate::support::random::Random;
use crate::support::scene::{OwnedScene, Room, STRUCTURES, corners, v};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    structures_agree_bit_for_bit,
    coplanar_copies_go_to_the_lowest_primitive,
    occlusion_agrees_with_the_closest_hit,
    every_primitive_is_in_one_leaf_whose_boxes_hold_it,
    hostile_input_builds_within_the_depth_limit,
    storage_on_the_stack_equals_boxed_slices,
    threads_change_nothing,
    storage_that_is_too_small_is_named,
    required_nodes_are_enough,
    invalid_rays_miss,
);

/// Spheres from tiny to walls of radius 1e5, and the triangle soup.
fn mixture<R: Real>(random: &mut Random, spheres: usize, triangles: usize) -> OwnedScene<R> {
    let mut scene = OwnedScene::<R>::default();
    let grey = scene.diffuse(0.5, 0.0);
    for i in 0..spheres {
        match i % 5 {
            0 => {
                let mut center = [0.0; 3];
                center[random.below(3)] = if random.below(2) == 0 { 1e5 + 1.5 } else { -1e5 - 1.5 };
                scene.sphere(center, 1e5, grey);
            }
            1 if i > 1 => scene.spheres.push(scene.spheres[random.below(i)]),
            _ => {
                scene.sphere(random.in_cube(), libm::exp(random.between(-6.0, -0.5)), grey);
            }
        }
    }
    scene.mesh(&soup(random, triangles), grey);
    scene
}

/// A ray at something of the scene, along an axis, or anywhere, perhaps with an end.
fn any_ray<R: Real>(random: &mut Random, scene: &OwnedScene<R>) -> Ray<R> {
    let far = [1.0, 1.0, 10.0, 1000.0][random.below(4)];
    let mut origin = v::<R>(random.in_cube().map(|x| x * far));
    let mut direction = v::<R>(random.in_cube());
    match random.below(6) {
        0 | 1 if !scene.positions.is_empty() => {
            let corner = scene.positions[random.below(scene.positions.len())];
            if corner.is_finite() {
                direction = corner - origin;
            }
        }
        2 if !scene.spheres.is_empty() => direction = scene.spheres[random.below(scene.spheres.len())].center - origin,
        3 => {
            let zero = if random.below(2) == 0 { 0.0 } else { -0.0 };
            let mut along = [zero; 3];
            along[random.below(3)] = random.between(-2.0, 2.0);
            direction = v::<R>(along);
            origin = v::<R>(random.in_cube().map(|x| (x * 4.0).round() * 0.25));
        }
        4 => origin = v::<R>(random.in_cube().map(|x| (x * 4.0).round() * 0.25)),
        _ => {}
    }
    let tmax = if random.below(4) == 0 { R::from_f64(random.between(0.0, 3.0)) } else { R::MAX };
    Ray { tmax, ..Ray::new(origin, direction) }
}

/// A hit as bits, so that NaN and -0 would show.
fn bits<R: Real>(hit: Option<Hit<R>>) -> Option<([u64; 3], u32)> {
    hit.map(|hit| ([hit.t, hit.u, hit.v].map(|x| x.to_f64().to_bits()), hit.primitive))
}

fn structures_agree_bit_for_bit<R: Real>() {
    let scenes = trials(48 * 400) / 400;
    for_all(scenes, (any::<u64>(), 0usize..80, 0usize..150), |(seed, spheres, triangles)| {
        let mut random = Random::new(seed);
        let scene = mixture::<R>(&mut random, spheres, triangles);
        let rays: Vec<Ray<R>> = (0..400).map(|_| any_ray(&mut random, &scene)).collect();
        let answers = STRUCTURES.map(|structure| {
            scene.lend(structure, |scene| {
                rays.iter().map(|ray| (bits(scene.intersect(ray)), scene.occluded(ray))).collect::<Vec<_>>()
            })
        });
        for (i, ray) in rays.iter().enumerate() {
            prop_assert_eq!(answers[0][i], answers[1][i], "box: {:?}", ray);
            prop_assert_eq!(answers[0][i], answers[2][i], "hierarchy: {:?}", ray);
            prop_assert_eq!(answers[0][i].0.is_some(), answers[0][i].1, "occluded: {:?}", ray);
        }
        Ok(())
    });
    Trials::passed::<R>("N39", "rays at mixed scenes: all, box, BVH", scenes * 400);
}

/// The same triangles many times over, in shuffled order among others: ties are everywhere.
fn coplanar_copies_go_to_the_lowest_primitive<R: Real>() {
    let mut random = Random::new(21);
    let mut scene = OwnedScene::<R>::default();
    let grey = scene.diffuse(0.5, 0.0);
    for _ in 0..4 {
        scene.mesh(&cube(3), grey);
    }
    let each = cube(3).triangles.len() as u32;
    for structure in STRUCTURES {
        scene.lend(structure, |scene| {
            for _ in 0..3000 {
                let ray = crate::support::scene::ray::<R>(random.in_cube(), random.on_sphere());
                let hit = scene.intersect(&ray).expect("a closed cube");
                assert!(hit.primitive < each, "{structure:?} {ray:?}: {hit:?} is a copy");
            }
        });
    }
    Trials::passed::<R>("N39", "coplanar copies", 3 * 3000);
}

/// With the range ended at the closest hit there is one; ended just before it there is none.
fn occlusion_agrees_with_the_closest_hit<R: Real>() {
    let mut random = Random::new(22);
    let scene = mixture::<R>(&mut random, 8, 200);
    for structure in STRUCTURES {
        scene.lend(structure, |lent| {
            let mut hits = 0;
            for _ in 0..trials(20_000) {
                let ray = any_ray(&mut random, &scene);
                let hit = lent.intersect(&ray);
                assert_eq!(hit.is_some(), lent.occluded(&ray), "{structure:?} {ray:?}");
                let Some(hit) = hit else { continue };
                hits += 1;
                let upto = Ray { tmax: hit.t, ..ray };
                assert!(
                    lent.occluded(&upto) && bits(lent.intersect(&upto)) == bits(Some(hit)),
                    "{structure:?} {ray:?}"
                );
                let before = Ray { tmax: hit.t.next_down(), ..ray };
                assert!(!lent.occluded(&before), "{structure:?} {ray:?}");
            }
            assert!(hits > 5000, "only {hits} hits");
        });
    }
    Trials::passed::<R>("N40", "any hit against the closest, and ends at it", 3 * trials(20_000));
}

fn bounds<R: Real>(geometry: &Geometry<'_, R>, primitive: usize) -> Bounds<R> {
    match geometry.spheres().get(primitive) {
        Some(sphere) => sphere.bounds(),
        None => triangle::bounds(&corners(geometry, primitive - geometry.spheres().len())),
    }
}

/// Walks down; returns the depth of the deepest leaf.
fn check_hierarchy<R: Real>(scene: &Scene<'_, R>, bvh: &Bvh<'_, R>) -> usize {
    let geometry = scene.geometry();
    let holds = |outer: &Bounds<R>, inner: &Bounds<R>| {
        let empty = (0..3).any(|axis| inner.corners[0][axis] > inner.corners[1][axis]);
        empty
            || (0..3).all(|axis| {
                outer.corners[0][axis] <= inner.corners[0][axis] && inner.corners[1][axis] <= outer.corners[1][axis]
            })
    };
    let mut times = vec![0; geometry.len()];
    // The root is as large as it gets.
    let everywhere = Bounds { corners: [[-R::ONE / R::ZERO; 3], [R::ONE / R::ZERO; 3]] };
    let (mut waiting, mut deepest, mut visited) = (vec![(0usize, 1usize, everywhere)], 0, 0);
    while let Some((at, depth, around)) = waiting.pop() {
        let node = &bvh.nodes()[at];
        deepest = deepest.max(depth);
        visited += 1;
        for Branch { bounds: own, primitives: count, child } in bvh.children(node) {
            assert!(holds(&around, &own), "{child:?} of node {at} sticks out of it");
            let primitives: BTreeSet<u32> = match child {
                Child::Node(child) => {
                    assert_eq!(count, 0);
                    waiting.push((child, depth + 1, own));
                    continue;
                }
                Child::Triangles(range) => {
                    let triangles = bvh.triangle_quads()[range].iter().flat_map(|quad| quad.triangles());
                    triangles
                        .map(|(primitive, copied)| {
                            let corners = corners(geometry, primitive as usize - geometry.spheres().len());
                            let bits = |corner: Vec3<R>| corner.to_array().map(|x| x.to_f64().to_bits());
                            assert_eq!(copied.map(bits), corners.map(bits));
                            primitive
                        })
                        .collect()
                }
                Child::Spheres(range) => bvh.sphere_quads()[range].iter().flat_map(|quad| *quad.primitives()).collect(),
            };
            assert_eq!(primitives.len(), count);
            for primitive in primitives {
                times[primitive as usize] += 1;
                assert!(holds(&own, &bounds(geometry, primitive as usize)), "{primitive} sticks out of node {at}");
            }
        }
    }
    assert_eq!(visited, bvh.nodes().len());
    assert!(times.iter().all(|&times| times == 1), "a primitive is not in exactly one leaf");
    assert!(deepest <= MAX_DEPTH, "{deepest}");
    deepest
}

fn every_primitive_is_in_one_leaf_whose_boxes_hold_it<R: Real>() {
    for_all(64, (any::<u64>(), 0usize..20, 0usize..300), |(seed, spheres, triangles)| {
        let scene = mixture::<R>(&mut Random::new(seed), spheres, triangles);
        prop_assume!(spheres + triangles > 0);
        for structure in [Structure::Box, Structure::Bvh] {
            scene.lend(Some(structure), |scene| check_hierarchy(scene, scene.bvh().expect("a hierarchy")));
        }
        Ok(())
    });
}

/// Small triangles at the given places.
fn triangles_at(places: impl Iterator<Item = [f64; 3]>, size: impl Fn([f64; 3]) -> f64) -> Mesh {
    let mut mesh = Mesh { positions: vec![], triangles: vec![] };
    for p in places {
        let first = mesh.positions.len() as u32;
        let s = size(p);
        mesh.positions.extend([p, [p[0] + s, p[1], p[2]], [p[0], p[1] + s, p[2]]]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}

/// Chains that halve at every step, 100,000 triangles in one place, boxes that overflow: the build ends within the
/// depth that traversal has a stack for, and hits are those of brute force.
fn hostile_input_builds_within_the_depth_limit<R: Real>() {
    let steps = if R::WIDE_IS_SELF { 1000 } else { 120 };
    let power = |k: i32| libm::ldexp(1.0, -k);
    let chain = triangles_at((0..steps).map(|k| [power(k), 0.0, 0.0]), |p| p[0] * 0.25);
    let staircase =
        triangles_at((0..3 * steps).map(|k| std::array::from_fn(|i| power((k + 2 - i as i32) / 3))), |p| p[0] * 0.01);
    let huge = if R::WIDE_IS_SELF { 1e307 } else { 1e38 };
    let overflowing = triangles_at((0..200).map(|k| [huge * f64::from(k % 3 - 1), f64::from(k), -huge]), |_| huge);
    let infinite = triangles_at((0..100).map(|k| [f64::INFINITY, f64::from(k), f64::NEG_INFINITY]), |_| 1.0);
    let one_place = triangles_at((0..100_000).map(|_| [0.25; 3]), |_| 1.0);
    for (name, mesh) in [
        ("chain", chain),
        ("staircase", staircase),
        ("overflowing", overflowing),
        ("infinite", infinite),
        ("one place", one_place),
    ] {
        let mut owned = OwnedScene::<R>::default();
        let grey = owned.diffuse(0.5, 0.0);
        owned.mesh(&mesh, grey);
        let mut random = Random::new(23);
        let origins: Vec<_> = (0..20).map(|_| random.in_cube()).collect();
        let look = |scene: &Scene<'_, R>| -> Vec<_> {
            if let Some(bvh) = scene.bvh() {
                check_hierarchy(scene, bvh);
            }
            let rays = origins.iter().enumerate().map(|(i, origin)| {
                let [a, b, c] = corners(scene.geometry(), i * 7 % mesh.triangles.len());
                let origin = v::<R>([origin[0], origin[1], 2.0]);
                Ray::<R>::new(origin, (a + b + c) * R::from_f64(1.0 / 3.0) - origin)
            });
            rays.map(|ray| bits(scene.intersect(&ray))).collect()
        };
        assert_eq!(owned.lend(Some(Structure::Bvh), look), owned.lend(None, look), "{name}");
    }
    Trials::passed::<R>("N38", "hostile meshes: chain, staircase, overflow, infinite, one place", 5);
}

fn storage_on_the_stack_equals_boxed_slices<R: Real>() {
    const PRIMITIVES: usize = 96;
    let mut owned = OwnedScene::<R>::default();
    let grey = owned.diffuse(0.5, 0.0);
    owned.mesh(&soup(&mut Random::new(24), PRIMITIVES - 8), grey);
    for i in 0..8 {
        owned.sphere([f64::from(i), 0.0, 0.0], 0.4, grey);
    }
    let geometry = owned.geometry();
    for structure in [Structure::Box, Structure::Bvh] {
        let mut on_stack = BvhStorage::<R, { required_nodes(PRIMITIVES) }, 8, 70>::EMPTY;
        let mut scratch = [BuildItem::EMPTY; PRIMITIVES];
        let on_stack = on_stack.build(&geometry, structure, &mut scratch).expect("room for all");
        // Larger than needed, and dirty: neither may show.
        let mut room = Room::new([500, 100, 300, 200]);
        room.nodes.fill(*on_stack.nodes().last().expect("a node"));
        room.sphere_quads.fill(on_stack.sphere_quads()[0]);
        room.triangle_quads.fill(on_stack.triangle_quads()[0]);
        let boxed = room.build(&geometry, structure).expect("room for all");
        assert_eq!(boxed.nodes(), on_stack.nodes());
        let triangles = |bvh: Bvh<'_, R>| -> Vec<_> {
            bvh.triangle_quads().iter().map(|quad| quad.triangles().map(|it| it.0).collect::<Vec<_>>()).collect()
        };
        assert_eq!(triangles(boxed), triangles(on_stack));
        let spheres = |bvh: Bvh<'_, R>| bvh.sphere_quads().iter().map(|quad| *quad.primitives()).collect::<Vec<_>>();
        assert_eq!(spheres(boxed), spheres(on_stack));
    }
}

/// Two threads at most, for each two things that can be done at once; the second is begun first.
struct TwoThreads;

impl Join for TwoThreads {
    fn join<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        std::thread::scope(|scope| {
            let b = scope.spawn(b);
            (a(), b.join().expect("no panic"))
        })
    }
}

/// Enough spheres and triangles for subtrees to be put off, for work to be halved more than once, and for two threads to put
/// triangles into bins.
fn threads_change_nothing<R: Real>() {
    let mut random = Random::new(25);
    let mut owned = mixture::<R>(&mut random, 20_000, 30_000);
    let grey = owned.diffuse(0.5, 0.0);
    owned.mesh(&cube(105), grey);
    let geometry = owned.geometry();
    assert!(geometry.triangles().len() > 1 << 17);
    let [mut alone, mut together] = [0; 2].map(|_| Room::<R>::for_scene(&geometry));
    let alone = alone.build(&geometry, Structure::Bvh).expect("room for all");
    let Room { nodes, sphere_quads, triangle_quads, scratch } = &mut together;
    let plan = bvh::plan(&geometry, Structure::Bvh, nodes, scratch, &TwoThreads).expect("room for all");
    let together = plan.fill(sphere_quads, triangle_quads, &TwoThreads).expect("room for all");
    assert!(alone.nodes() == together.nodes());
    let primitives = |bvh: Bvh<'_, R>| -> (Vec<_>, Vec<_>) {
        let triangles = bvh.triangle_quads().iter().flat_map(|quad| quad.triangles().map(|it| it.0));
        (bvh.sphere_quads().iter().map(|quad| *quad.primitives()).collect(), triangles.collect())
    };
    assert!(primitives(alone) == primitives(together));
    owned.lend(Some(Structure::Bvh), |scene| check_hierarchy(scene, scene.bvh().expect("a hierarchy")));
}

fn storage_that_is_too_small_is_named<R: Real>() {
    let mut owned = OwnedScene::<R>::default();
    let grey = owned.diffuse(0.5, 0.0);
    owned.mesh(&cube(1), grey);
    owned.sphere([3.0; 3], 1.0, grey);
    let geometry = owned.geometry();
    let build = |structure, room| Room::new(room).build(&geometry, structure).map(|_| ());
    let error = |what, needed, capacity| Err(CapacityError { what, needed, capacity });
    let quads =
        |structure| owned.lend(Some(structure), |scene| scene.bvh().expect("a hierarchy").triangle_quads().len());
    // In one leaf, or in the leaves that suit them.
    assert!(quads(Structure::Box) == 3 && quads(Structure::Bvh) >= 3);
    for structure in [Structure::Box, Structure::Bvh] {
        let (nodes, quads) = (structure.required_nodes(&geometry), quads(structure));
        assert_eq!(build(structure, [nodes, 1, quads, 13]), Ok(()));
        assert_eq!(build(structure, [nodes - 1, 1, quads, 13]), error(Capacity::Nodes, nodes, nodes - 1));
        assert_eq!(build(structure, [nodes, 0, quads, 13]), error(Capacity::SphereQuads, 1, 0));
        assert_eq!(build(structure, [nodes, 1, quads - 1, 13]), error(Capacity::TriangleQuads, quads, quads - 1));
        assert_eq!(build(structure, [nodes, 1, quads, 0]), error(Capacity::Scratch, 13, 0));
    }
    let mut storage = BvhStorage::<R, 3, 1, 2>::EMPTY;
    let found = storage.build(&geometry, Structure::Box, &mut [BuildItem::EMPTY; 13]).map(|_| ());
    assert_eq!(found, error(Capacity::TriangleQuads, 3, 2));
}

fn required_nodes_are_enough<R: Real>() {
    let mut random = Random::new(25);
    let mut most = 0.0f64;
    for n in 0..200 {
        // Places far apart, at each of them four triangles in one spot and one in another: hardly worth a node, but
        // better than a leaf.
        let places: Vec<_> = (0..n).map(|_| random.in_cube().map(|x| x * 1e6)).collect();
        let place = |k: usize| {
            std::array::from_fn(|i| places[k / 5][i] + if k.is_multiple_of(5) && i == 0 { 1e3 } else { 0.0 })
        };
        let mut owned = OwnedScene::<R>::default();
        let grey = owned.diffuse(0.5, 0.0);
        owned.mesh(&triangles_at((0..n).map(place), |_| 1.0), grey);
        owned.lend(Some(Structure::Bvh), |scene| {
            let bvh = scene.bvh().expect("a hierarchy");
            assert_eq!(bvh.built_for(), [0, n]);
            assert!(bvh.nodes().len() <= required_nodes(n), "{} nodes for {n}", bvh.nodes().len());
            if n >= 40 {
                most = most.max(bvh.nodes().len() as f64 / required_nodes(n) as f64);
            }
        });
    }
    assert!(most > 0.9, "the limit was never near: {most} of it");
}

fn invalid_rays_miss<R: Real>() {
    let mut owned = OwnedScene::<R>::default();
    let grey = owned.diffuse(0.5, 0.0);
    owned.mesh(&cube(2), grey);
    owned.sphere([0.0; 3], 0.5, grey);
    let good = crate::support::scene::ray::<R>([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    let [nan, infinity] = [f64::NAN, f64::INFINITY].map(R::from_f64);
    let mut bad = vec![
        Ray { direction: v::<R>([0.0; 3]), ..good },
        Ray { direction: v::<R>([-0.0, 0.0, -0.0]), ..good },
        Ray { tmin: R::from_f64(-1.0), ..good },
        Ray { tmin: nan, ..good },
        Ray { tmax: nan, ..good },
        Ray { tmin: R::from_f64(6.0), tmax: R::from_f64(5.0), ..good },
        Ray { tmax: -R::ONE, ..good },
    ];
    for (axis, value) in (0..3).flat_map(|axis| [nan, infinity, -infinity].map(|value| (axis, value))) {
        let with = |v: R::Vec3| {
            let mut components = v.to_array();
            components[axis] = value;
            R::Vec3::from_array(components)
        };
        bad.push(Ray { origin: with(good.origin), ..good });
        bad.push(Ray { direction: with(good.direction), ..good });
    }
    // A few spheres alone are searched in a way of their own.
    let mut ball = OwnedScene::<R>::default();
    let grey = ball.diffuse(0.5, 0.0);
    ball.sphere([0.0; 3], 1.0, grey);
    for (scene, structure) in [&owned, &ball].into_iter().flat_map(|scene| STRUCTURES.map(|s| (scene, s))) {
        scene.lend(structure, |scene| {
            assert_eq!(scene.intersect(&good).map(|hit| hit.t), Some(R::from_f64(2.0)));
            let endless = Ray { tmax: infinity, ..good };
            assert_eq!(scene.intersect(&endless).map(|hit| hit.t), Some(R::from_f64(2.0)));
            for ray in &bad {
                assert!(!ray.is_valid() && scene.intersect(ray).is_none() && !scene.occluded(ray), "{ray:?}");
            }
        });
    }
    Trials::passed::<R>("N8", "rays that are no rays", 6 * bad.len() as u32);
}
