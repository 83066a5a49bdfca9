//! Vectors, frames and ray origins: what every other bound stands on.

use ocellus_kernel::ray::Ray;
use ocellus_kernel::real::{Vec3, Vector};
use ocellus_kernel::robust::{normalize, offset_ray_origin};
use ocellus_kernel::shape::Sphere;
use ocellus_kernel::surface::SurfacePoint;
use ocellus_kernel::{Real, Scene};
use proptest::prelude::*;

use crate::support::exact::{Exact, ExactVec, exact, roughly, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::Mesh;
use crate::support::property::{component, direction, for_all, power_of_two};
use crate::support::random::Random;
use crate::support::scene::{OwnedScene, STRUCTURES, corners, v};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    dot_and_cross_keep_their_order,
    differences_of_products_have_the_exact_sign,
    normalize_is_unit_and_keeps_the_direction,
    frames_are_orthonormal_and_right_handed,
    spawned_rays_leave_triangles,
    spawned_rays_leave_spheres,
    offsets_are_a_few_ulps,
);

/// The order of every sum is part of the promise of equal bits.
fn dot_and_cross_keep_their_order<R: Real>() {
    for_all(2000, (direction(), direction()), |(a, b)| {
        let ([ax, ay, az], [bx, by, bz]) = (a.map(R::from_f64), b.map(R::from_f64));
        let (a, b) = (v::<R>(a), v::<R>(b));
        prop_assert_eq!(a.dot(b), (ax * bx + ay * by) + az * bz);
        let cross = [ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay];
        prop_assert_eq!(a.cross(b).to_array(), cross);
        Ok(())
    });
}

/// Products that nearly cancel, as at the edges of triangles.
fn differences_of_products_have_the_exact_sign<R: Real>() {
    let steps = prop::array::uniform4(-3i32..=3);
    for_all(5000, (component(), component(), power_of_two(-40..40), steps), |(a, b, scale, steps)| {
        let step = |x: R, n: i32| (0..n.abs()).fold(x, |x, _| if n < 0 { x.next_down() } else { x.next_up() });
        let factors = [a, b, a * scale, b / scale].map(R::from_f64);
        let [a, b, c, d]: [R; 4] = std::array::from_fn(|i| step(factors[i], steps[i]));
        let underflows =
            |x: R, y: R| x != R::ZERO && y != R::ZERO && (x * y).abs().to_f64() < tolerance::NORMAL_PRODUCT;
        if R::WIDE_IS_SELF && (underflows(a, b) || underflows(c, d)) {
            return Ok(());
        }
        let found = R::difference_of_products(a, b, c, d).to_f64();
        let [ea, eb, ec, ed] = [a, b, c, d].map(|x| exact(x.to_f64()));
        let truth: Exact = ea * eb - ec * ed;
        let zero = exact(0.0);
        prop_assert_eq!(found > 0.0, truth > zero, "{:?} {} {}", [a, b, c, d], found, to_f64(&truth));
        prop_assert_eq!(found < 0.0, truth < zero, "{:?} {} {}", [a, b, c, d], found, to_f64(&truth));
        Ok(())
    });
}

fn normalize_is_unit_and_keeps_the_direction<R: Real>() {
    let exponents = if R::WIDE_IS_SELF { -450..500 } else { -126..127 };
    let limit = tolerance::unit_length::<R>();
    let errors = Trials::measured::<R>("N28", "length and direction of normalised vectors", limit, "u");
    for_all(trials(3000), (direction(), power_of_two(exponents)), |(direction, scale)| {
        let given: Vec3<R> = v::<R>(direction.map(|x| x * scale));
        // What is so short that its square is no normal number in the wide precision has no direction there.
        prop_assume!(given.abs().max_component().to_f64() > tolerance::SHORTEST);
        let unit = ExactVec::new::<R>(normalize::<R>(given));
        let length_error = roughly(&(unit.length() - exact(1.0))).abs();
        let direction_error = roughly(&(&unit - &ExactVec::new::<R>(given).unit()).length());
        errors.error(length_error.max(direction_error) / u::<R>(), || format!("{given:?}"));
        Ok(())
    });
    errors.end(3000);
    assert_eq!(normalize::<R>(Vec3::<R>::ZERO), Vec3::<R>::ZERO);
}

fn frames_are_orthonormal_and_right_handed<R: Real>() {
    let near_poles = (power_of_two(-27..-3), 0.0..std::f64::consts::TAU, any::<bool>()).prop_map(|(sine, turn, up)| {
        let z = (1.0 - sine * sine).sqrt();
        [sine * libm::cos(turn), sine * libm::sin(turn), if up { z } else { -z }]
    });
    let bad = prop::sample::select(vec![
        // Duff et al. 2017, section 2: where Frisvad's frame fails.
        [0.00038527316, 0.00038460016, -0.99999988079],
        [-0.00019813581, -0.00008946839, -0.99999988079],
        [1.0, 0.0, -0.0],
        [0.0, 0.0, -1.0],
        [0.0, -0.0, 1.0],
    ]);
    let errors = Trials::measured::<R>("N27", "length and dot of frames", tolerance::FRAME, "u");
    for_all(trials(3000), prop_oneof![direction(), near_poles, bad], |n| {
        let n = normalize::<R>(v::<R>(n));
        let [x, y] = ocellus_kernel::warp::frame::<R>(n);
        let axes = [x, y, n].map(ExactVec::new::<R>);
        for i in 0..3 {
            let length = roughly(&(axes[i].length() - exact(1.0))).abs();
            let dot = roughly(&axes[i].dot(&axes[(i + 1) % 3])).abs();
            errors.error(length.max(dot) / u::<R>(), || format!("{n:?}"));
        }
        prop_assert!(axes[0].cross(&axes[1]).dot(&axes[2]) > exact(0.0));
        Ok(())
    });
    errors.end(9000);
}

/// A random triangle of size `size`, moved away by up to 1e5 times that; or one that lies in a plane of the axes or
/// hardly leaves it, as floors do: there the coordinate along the normal is no measure of the error.
fn triangle(random: &mut Random, size: f64) -> Mesh {
    let far = if random.below(2) == 0 { 0.0 } else { size * libm::exp(random.between(0.0, 11.5)) };
    let center = random.in_cube().map(|x| x * far);
    let flat = [1.0, 1.0, 0.0, 1e-6, 1e-3][random.below(5)];
    let axis = random.below(3);
    let positions = (0..3).map(|_| {
        let offset = random.in_cube();
        std::array::from_fn(|i| (center[i] + size * offset[i]) * if i == axis { flat } else { 1.0 })
    });
    Mesh { positions: positions.collect(), triangles: vec![[0, 1, 2]] }
}

/// A direction whose cosine with `n` lies between 1e-5 and 1, on either side.
fn leaving<R: Real>(random: &mut Random, n: Vec3<R>) -> Vec3<R> {
    let cosine = libm::exp(random.between(-11.5, 0.0)) * if random.below(2) == 0 { 1.0 } else { -1.0 };
    let turn = random.between(0.0, std::f64::consts::TAU);
    let sine = (1.0 - cosine * cosine).sqrt();
    let local = v::<R>([sine * libm::cos(turn), sine * libm::sin(turn), cosine]);
    ocellus_kernel::warp::to_world::<R>(n, local)
}

/// Hits a primitive near `target`, and spawns a ray there: the primitive, the point, the ray.
fn spawn<R: Real>(
    random: &mut Random,
    scene: &Scene<'_, R>,
    target: Vec3<R>,
    reach: f64,
) -> Option<(u32, SurfacePoint<R>, Ray<R>)> {
    let to = random.on_sphere().map(|x| x * reach);
    let first = Ray::new(target - v::<R>(to), v::<R>(to));
    let hit = scene.intersect(&first)?;
    let point = scene.surface_point(&first, &hit).expect("a hit of this scene");
    let wi = leaving::<R>(random, point.ng);
    let ray = Ray::new(offset_ray_origin::<R>(point.p, point.p_error, point.ng, wi), wi);
    Some((hit.primitive, point, ray))
}

/// Oracle: a ray that leaves a plane never meets it again.
fn spawned_rays_leave_triangles<R: Real>() {
    let mut random = Random::new(1);
    let met = Trials::of::<R>("N21", "rays that leave triangles");
    let wanted = trials(100_000);
    // Not every ray meets the triangle in the first place.
    for _ in (0..2 * wanted).take_while(|_| met.count() < wanted.into()) {
        let size = libm::exp(random.between(-9.2, 13.8));
        let mut scene = OwnedScene::<R>::default();
        let grey = scene.diffuse(0.5, 0.0);
        scene.mesh(&triangle(&mut random, size), grey);
        let weights = random.barycentric().map(R::from_f64);
        let [a, b, c] = corners(&scene.geometry(), 0);
        let target = a * weights[0] + b * weights[1] + c * weights[2];
        scene.lend(None, |scene| {
            let Some((_, _, ray)) = spawn::<R>(&mut random, scene, target, size) else { return };
            let again = scene.intersect(&ray);
            met.holds(again.is_none(), || format!("{ray:?} meets {:?}: {again:?}", corners(scene.geometry(), 0)));
        });
    }
    met.end(wanted.into());
}

/// Oracle: a ray that leaves a sphere outward never meets it again; one that goes inward crosses the whole chord, or
/// meets another sphere on the way.
fn spawned_rays_leave_spheres<R: Real>() {
    const SPHERES: usize = 6;
    let wanted = trials(30_000);
    for (structure, name) in STRUCTURES.into_iter().zip(["all", "box", "BVH"]) {
        let mut random = Random::new(2);
        let met = Trials::of::<R>("N22", &format!("rays that leave spheres among others, outward and inward, {name}"));
        for _ in (0..wanted).take_while(|_| met.count() < wanted.into()) {
            let size = libm::exp(random.between(-9.2, 13.8));
            let mut scene = OwnedScene::<R>::default();
            let grey = scene.diffuse(0.5, 0.0);
            let far = if random.below(2) == 0 { 0.0 } else { size * libm::exp(random.between(0.0, 9.0)) };
            let center = random.in_cube().map(|x| x * far);
            for at in 0..SPHERES {
                let offset = random.in_cube();
                let share = if at == 0 { 1.0 } else { libm::exp(random.between(-4.0, 0.0)) };
                scene.sphere(std::array::from_fn(|i| center[i] + 2.0 * size * offset[i]), size * share, grey);
            }
            scene.lend(structure, |scene| {
                for _ in 0..32 {
                    let spheres = scene.geometry().spheres();
                    let Sphere { center, radius, .. } = spheres[random.below(SPHERES)];
                    let target = center + v::<R>(random.in_cube()) * (radius * R::from_f64(0.5));
                    let found = spawn::<R>(&mut random, scene, target, size * 8.0);
                    let (own, point, ray) = found.expect("a sphere is hit");
                    let radius = spheres[own as usize].radius.to_f64();
                    let cosine = ray.direction.dot(point.ng).to_f64();
                    let coordinates = point.p.abs().max_component().to_f64().max(radius);
                    if cosine.abs() < tolerance::GRAZING * u::<R>() * coordinates / radius {
                        continue;
                    }
                    let again = scene.intersect(&ray);
                    let itself = again.filter(|hit| hit.primitive == own).map(|hit| hit.t.to_f64());
                    let right = if cosine > 0.0 {
                        itself.is_none()
                    } else {
                        let chord = -2.0 * cosine * radius;
                        // A ray that starts `depth` under the surface goes further than the chord by no more than the
                        // square root. Nothing beyond the far side can be seen from there.
                        let depth = 2.0 * tolerance::OFFSET * u::<R>() * coordinates;
                        let longest = 1.01 * (chord + (2.0 * radius * depth).sqrt());
                        again.is_some_and(|hit| hit.t.to_f64() < longest) && itself.is_none_or(|t| t > 0.5 * chord)
                    };
                    met.holds(right, || format!("{ray:?} leaves {own} of {spheres:?}, cosine {cosine}: {again:?}"));
                }
            });
        }
        met.end(wanted.into());
    }
}

/// The offset must not eat gaps: it stays within a fixed number of roundings of the coordinates at every scale.
fn offsets_are_a_few_ulps<R: Real>() {
    let mut random = Random::new(3);
    // A gap that is as wide as the offset is kept; that of N23 is 64 ulps.
    let moves = Trials::measured::<R>("N23", "offsets", tolerance::OFFSET, "u M");
    let wanted = trials(100_000);
    for _ in (0..2 * wanted).take_while(|_| moves.count() < wanted.into()) {
        let size = libm::exp(random.between(-9.2, 13.8));
        let mut scene = OwnedScene::<R>::default();
        let grey = scene.diffuse(0.5, 0.0);
        scene.mesh(&triangle(&mut random, size), grey);
        let [a, b, c] = corners(&scene.geometry(), 0);
        let target = (a + b + c) * R::from_f64(1.0 / 3.0);
        scene.lend(None, |scene| {
            let Some((_, point, ray)) = spawn::<R>(&mut random, scene, target, size) else { return };
            let moved = (ray.origin - point.p).abs().max_component().to_f64();
            let largest = [a, b, c].map(|corner| corner.abs().max_component().to_f64());
            let largest = largest.into_iter().fold(0.0, f64::max);
            moves.error(moved / (u::<R>() * largest), || format!("{point:?}"));
        });
    }
    moves.end(wanted.into());
}

/// N26. Numbers in order are integers in order: the bits of the magnitude, with the sign before them. A neighbour is one
/// further, but infinity is the last, both zeros are the same place, and a NaN has none.
#[test]
fn neighbours_are_one_place_apart() {
    let mut random = Random::new(26);
    let single = [0, 1, 0x007F_FFFF, 0x0080_0000, 0x3F80_0000, 0x7F7F_FFFF, 0x7F80_0000, 0x7FC0_0000];
    let double = [0, 1, (1 << 52) - 1, 1 << 52, 0x3FF0 << 48, (0x7FF0 << 48) - 1, 0x7FF0 << 48, 0x7FF8 << 48];
    for case in 0..100_000 {
        let bits = single.get(case).copied().unwrap_or_else(|| random.bits() as u32);
        for x in [f32::from_bits(bits), f32::from_bits(bits ^ 1 << 31)] {
            let place = |x: f32| i64::from(x.to_bits() & 0x7FFF_FFFF) * if x.is_sign_negative() { -1 } else { 1 };
            assert_neighbours(x, |x| place(x).into());
        }
        let bits = double.get(case).copied().unwrap_or_else(|| random.bits());
        for x in [f64::from_bits(bits), f64::from_bits(bits ^ 1 << 63)] {
            let place = |x: f64| i128::from(x.to_bits() & !(1 << 63)) * if x.is_sign_negative() { -1 } else { 1 };
            assert_neighbours(x, place);
        }
    }
    Trials::passed::<f32>("N26", "neighbours of numbers, both precisions", 200_000);
}

#[track_caller]
fn assert_neighbours<R: Real>(x: R, place: impl Fn(R) -> i128) {
    let (up, down) = (x.next_up(), x.next_down());
    if x.to_f64().is_nan() {
        assert!(up.to_f64().is_nan() && down.to_f64().is_nan(), "{x:?}: {down:?} {up:?}");
        return;
    }
    let last = |infinity: f64| i128::from(x.to_f64() != infinity);
    assert_eq!(place(up), place(x) + last(f64::INFINITY), "above {x:?}");
    assert_eq!(place(down), place(x) - last(-f64::INFINITY), "below {x:?}");
}
