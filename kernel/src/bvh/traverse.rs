//! Traversal: [`intersect`] (the closest hit) and [`occluded`] (is there any).
//!
//! Both are generic over how primitives are found: all of them, or through a hierarchy. The answer is the same bits
//! either way; see `Geometry::test_all`.

use super::{Bvh, MAX_DEPTH};
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
    search::<R, E, false>(geometry, bvh, ray)
}

/// Whether anything is hit in `tmin < t <= tmax`.
#[inline]
pub fn occluded<R: Real, E: EffectSet>(geometry: &Geometry<'_, R>, bvh: Option<&Bvh<'_, R>>, ray: &Ray<R>) -> bool {
    search::<R, E, true>(geometry, bvh, ray).is_some()
}

/// The search behind both: with `ANY` it ends at the first hit.
#[inline(always)]
fn search<R: Real, E: EffectSet, const ANY: bool>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    ray: &Ray<R>,
) -> Option<Hit<R>> {
    if !ray.is_valid() {
        return None;
    }
    let mut best = Hit::none(ray.tmax);
    match bvh.filter(|bvh| bvh.order.len() == geometry.len() && !is_small(geometry, bvh)) {
        None => geometry.test_all::<E, ANY>(&PreparedRay::new_in::<E, false>(ray), &mut best),
        Some(bvh) => descend::<R, E, ANY>(geometry, bvh, &PreparedRay::new_in::<E, true>(ray), &mut best),
    }
    (best.primitive != NO_PRIMITIVE).then_some(best)
}

/// Whether all there is are a few spheres in one leaf: a look at its box would cost about as much as they do.
#[inline(always)]
fn is_small<R: Real>(geometry: &Geometry<'_, R>, bvh: &Bvh<'_, R>) -> bool {
    geometry.triangles().is_empty() && bvh.nodes.len() == 1 && geometry.len() <= 16
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
        if node.count > 0 {
            let first = node.first as usize;
            geometry.test_leaf::<E, ANY>(ray, &bvh.order[first..first + node.count as usize], best);
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
