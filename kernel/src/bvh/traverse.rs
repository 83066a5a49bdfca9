//! Traversal: [`intersect`] (the closest hit) and [`occluded`] (is there any).
//!
//! Both are generic over how primitives are found: all of them, or through a hierarchy. The answer is the same bits
//! either way; see `Geometry::test_all`.

use super::{Bvh, Leaf, MAX_DEPTH};
use crate::departure::Departure;
use crate::effects::EffectSet;
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::Real;
use crate::shape::{Geometry, PreparedRay};

/// The closest hit in `tmin < t <= tmax`; of equally close ones the lowest primitive. `bvh` = `None` tests all.
///
/// Rays that are not valid ([`Ray::is_valid`]) miss. A hierarchy over another number of primitives is not used.
#[inline]
pub fn intersect<R: Real, E: EffectSet>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    ray: &Ray<R>,
) -> Option<Hit<R>> {
    search::<R, E, false>(geometry, bvh, ray, &Departure::exactly(ray.origin))
}

/// Whether anything is hit in `tmin < t <= tmax`.
#[inline]
pub fn occluded<R: Real, E: EffectSet>(geometry: &Geometry<'_, R>, bvh: Option<&Bvh<'_, R>>, ray: &Ray<R>) -> bool {
    search::<R, E, true>(geometry, bvh, ray, &Departure::exactly(ray.origin)).is_some()
}

/// The search behind both: with `ANY` it ends at the first hit. The sphere on whose outside the ray starts is left out,
/// since it cannot be met: so nothing changes but the time.
#[inline(always)]
pub(crate) fn search<R: Real, E: EffectSet, const ANY: bool>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    ray: &Ray<R>,
    from: &Departure<R>,
) -> Option<Hit<R>> {
    // All that the test of a sphere asks for: it finds nothing where something is not finite.
    if !ray.has_range() {
        return None;
    }
    let mut best = Hit::none(ray.tmax);
    match bvh.filter(|bvh| bvh.fits(geometry)) {
        Some(bvh) if is_small(bvh) => {
            let ray = PreparedRay::new_in::<E, false>(ray, from);
            geometry.test_spheres::<E, ANY, ANY>(&ray, bvh.sphere_quads, &mut best);
        }
        _ if !ray.is_valid() => return None,
        None => geometry.test_all::<E, ANY>(&PreparedRay::new_in::<E, false>(ray, from), &mut best),
        Some(bvh) => descend::<R, E, ANY>(geometry, bvh, &PreparedRay::new_in::<E, true>(ray, from), &mut best),
    }
    (best.primitive != NO_PRIMITIVE).then_some(best)
}

/// Whether all there is are a few spheres in one leaf: a look at its box would cost about as much as they do.
#[inline(always)]
fn is_small<R: Real>(bvh: &Bvh<'_, R>) -> bool {
    bvh.triangle_order.is_empty() && bvh.nodes.len() == 1 && bvh.sphere_quads.len() <= 4
}

#[inline(always)]
fn descend<R: Real, E: EffectSet, const ANY: bool>(
    geometry: &Geometry<'_, R>,
    bvh: &Bvh<'_, R>,
    ray: &PreparedRay<R>,
    best: &mut Hit<R>,
) {
    let Some(mut node) = bvh.nodes.first() else { return };
    if node.bounds.entry(ray, best.t).is_none() {
        return;
    }
    // Nodes that wait, with where the ray enters them. One waits per level, so the stack cannot overflow.
    let mut waiting = [(0u32, R::ZERO); MAX_DEPTH];
    let mut top = 0;
    loop {
        if let Some(leaf) = node.leaf() {
            match leaf {
                Leaf::Spheres(range) => geometry.test_spheres::<E, ANY, true>(ray, &bvh.sphere_quads[range], best),
                Leaf::Triangles(range) => geometry.test_triangles::<E, ANY>(ray, &bvh.triangle_order[range], best),
            }
            if ANY && best.primitive != NO_PRIMITIVE {
                return;
            }
        } else {
            let left = node.first;
            let pair = &bvh.nodes[left as usize..left as usize + 2];
            let entries = (pair[0].bounds.entry(ray, best.t), pair[1].bounds.entry(ray, best.t));
            match entries {
                (Some(near_left), Some(near_right)) => {
                    let right_first = near_right < near_left;
                    let later = if right_first { (left, near_left) } else { (left + 1, near_right) };
                    waiting[top] = later;
                    top += 1;
                    node = &pair[usize::from(right_first)];
                    continue;
                }
                (Some(_), None) => {
                    node = &pair[0];
                    continue;
                }
                (None, Some(_)) => {
                    node = &pair[1];
                    continue;
                }
                (None, None) => {}
            }
        }
        // The next one that waits and is not beyond the best hit; one entered exactly there may hold a lower number.
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            let (next, near) = waiting[top];
            if near <= best.t {
                node = &bvh.nodes[next as usize];
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Everything;
    use crate::real::{Vec3, Vector, vec3_from_f64};
    use crate::robust::{normalize, offset_ray_origin};
    use crate::shape::Sphere;

    /// Numbers in -1..1 that look random.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn leaving_out_the_departed_sphere_changes_nothing<R: Real>() {
        let mut next = numbers();
        for (distance, radius) in [(0.0, 1.0), (3.0, 1e-3), (1000.0, 940.0), (1e5, 1e5 - 1.0), (1e4, 10.0)] {
            let center = vec3_from_f64::<R>([distance, 0.1 * distance, 0.0]);
            let spheres = [Sphere { center, radius: R::from_f64(radius), material: 0, inverted: false }];
            let geometry = Geometry::new(&spheres, &[], &[]).unwrap();
            for k in 0..2000 {
                let mut direction = || normalize::<R>(vec3_from_f64::<R>([next(), next(), next()]));
                let outward = direction();
                let origin = center + outward * R::from_f64(radius * 3.0);
                let Some(hit) = intersect::<R, Everything>(&geometry, None, &Ray::new(origin, -outward)) else {
                    panic!("{outward:?} misses");
                };
                let point = spheres[0].point_at(&Ray::new(origin, -outward), hit.t);
                let from = offset_ray_origin::<R>(point.p, point.p_error, point.outward, point.outward);
                // Every other one leaves along the surface, or nearly so.
                let aside = point.outward.cross(direction());
                let graze = R::from_f64(if k % 4 == 1 { 1e-7 } else { 0.0 });
                let any = direction();
                let wi: Vec3<R> = match k % 2 {
                    0 if any.dot(point.outward) < R::ZERO => -any,
                    0 => any,
                    _ => normalize::<R>(aside + point.outward * graze),
                };
                if !(wi.dot(point.outward) > R::ZERO) {
                    continue;
                }
                let ray = Ray::new(from, wi);
                assert_eq!(intersect::<R, Everything>(&geometry, None, &ray), None, "{ray:?}");
                let departure = Departure { sphere: 0, ..Departure::exactly(from) };
                assert_eq!(search::<R, Everything, false>(&geometry, None, &ray, &departure), None);
            }
        }
    }

    #[test]
    fn leaving_out_the_departed_sphere_changes_nothing_f32() {
        leaving_out_the_departed_sphere_changes_nothing::<f32>();
    }

    #[test]
    fn leaving_out_the_departed_sphere_changes_nothing_f64() {
        leaving_out_the_departed_sphere_changes_nothing::<f64>();
    }
}
