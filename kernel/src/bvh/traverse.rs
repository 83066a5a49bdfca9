//! Traversal: [`intersect`] (the closest hit) and [`occluded`] (is there any).
//!
//! Both are generic over how primitives are found: all of them, or through a hierarchy. The answer is the same bits
//! either way; see `Geometry::test_all`.

use super::node::{ChildBits, decode};
use super::split::MAX_ROOT_QUADS;
use super::{Bounds, Bvh, Child, MAX_WAITING, WIDTH};
use crate::departure::Departure;
use crate::effects::{EffectSet, TrianglesOf};
use crate::lanes::set_bits;
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::Real;
use crate::shape::{Geometry, PreparedRay, test_triangles};

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
/// since it cannot be met: so nothing changes but the time. And so is the light that it ends before, which rounding alone
/// could put in its way.
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
        Some(bvh) if bvh.nodes.is_empty() => return None,
        Some(bvh) => {
            let ray = &PreparedRay::new_in::<E, true>(ray, from);
            let root = Waiting { near: ray.tmin, child: 0 };
            best = descend::<R, E, ANY, FEW>(geometry, bvh, ray, &[root], best);
        }
    }
    (best.primitive != NO_PRIMITIVE).then_some(best)
}

/// The part of a hierarchy with triangles in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglesBelow<'a, R: Real> {
    bvh: &'a Bvh<'a, R>,
    /// A box around all of it.
    pub(crate) bounds: Bounds<R>,
    /// Where to start: at the only child of the root that has some, or at the root.
    start: ChildBits,
}

impl<'a, R: Real> TrianglesBelow<'a, R> {
    /// Looks at the children of the root.
    pub(crate) fn new(bvh: &'a Bvh<'a, R>) -> Self {
        let mut below = Self { bvh, bounds: Bounds::EMPTY, start: 0 };
        let Some(root) = bvh.nodes.first() else { return below };
        let mut count = 0;
        for lane in 0..root.len() {
            let child = root.child(lane);
            if !matches!(decode(child, bvh.quads()), Child::Spheres(_)) {
                below.bounds = below.bounds.union(&root.bounds(lane));
                below.start = child;
                count += 1;
            }
        }
        if count != 1 {
            below.start = 0;
        }
        below
    }

    /// Goes on with a search that found `best` so far, or nothing. The ray must be valid and start at t = 0.
    #[inline(always)]
    pub(crate) fn search<E: EffectSet, const ANY: bool>(
        &self,
        geometry: &Geometry<'_, R>,
        ray: &Ray<R>,
        from: &Departure<R>,
        best: Hit<R>,
    ) -> Hit<R> {
        let ray = &PreparedRay::new_in::<TrianglesOf<E>, true>(ray, from);
        let start = Waiting { near: ray.tmin, child: self.start };
        descend::<R, TrianglesOf<E>, ANY, FEW>(geometry, self.bvh, ray, &[start], best)
    }
}

/// Whether all there is are a few spheres in one leaf: a look at its box would cost about as much as they do.
#[inline(always)]
fn is_small<R: Real>(bvh: &Bvh<'_, R>) -> bool {
    bvh.triangle_quads.is_empty() && bvh.nodes.len() == 1 && bvh.sphere_quads.len() <= MAX_ROOT_QUADS
}

/// A child that waits, with where the ray enters it.
#[derive(Clone, Copy, Debug)]
struct Waiting<R> {
    near: R,
    child: ChildBits,
}

/// How many children can wait before the search goes on with a stack of full size. Clearing that would take as long as
/// a few nodes do, and hardly a ray needs it.
const FEW: usize = 32;

/// The children that wait, the next on top.
struct Stack<R, const ROOM: usize> {
    waiting: [Waiting<R>; ROOM],
    top: usize,
}

impl<R: Real, const ROOM: usize> Stack<R, ROOM> {
    #[inline(always)]
    fn new(waiting: &[Waiting<R>]) -> Self {
        let mut stack = Self { waiting: [Waiting { near: R::ZERO, child: 0 }; ROOM], top: waiting.len() };
        stack.waiting[..waiting.len()].copy_from_slice(waiting);
        stack
    }

    /// Whether the children of one more node may be too many.
    #[inline(always)]
    fn is_full(&self) -> bool {
        ROOM < MAX_WAITING && self.top + WIDTH > ROOM
    }

    /// Adds a child below those above `first` that are nearer.
    #[inline(always)]
    fn insert(&mut self, first: usize, child: Waiting<R>) {
        let mut at = self.top;
        while at > first && self.waiting[at - 1].near < child.near {
            self.waiting[at] = self.waiting[at - 1];
            at -= 1;
        }
        self.waiting[at] = child;
        self.top += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Waiting<R>> {
        self.top = self.top.checked_sub(1)?;
        Some(self.waiting[self.top])
    }
}

/// Searches what `waiting` holds, and what lies below.
#[inline(always)]
fn descend<R: Real, E: EffectSet, const ANY: bool, const ROOM: usize>(
    geometry: &Geometry<'_, R>,
    bvh: &Bvh<'_, R>,
    ray: &PreparedRay<R>,
    waiting: &[Waiting<R>],
    mut best: Hit<R>,
) -> Hit<R> {
    let mut stack = Stack::<R, ROOM>::new(waiting);
    'pop: while let Some(Waiting { near, mut child }) = stack.pop() {
        // Not what lies beyond the best hit; what is entered exactly there may hold a lower number.
        if !ANY && near > best.t {
            continue;
        }
        loop {
            match decode(child, bvh.quads()) {
                Child::Node(node) => {
                    if stack.is_full() {
                        stack.insert(stack.top, Waiting { near: ray.tmin, child });
                        return descend_deep::<R, E, ANY>(geometry, bvh, *ray, &stack.waiting[..stack.top], best);
                    }
                    let node = &bvh.nodes[node];
                    let (near, met) = node.entries(&ray.slabs, ray.tmin, best.t);
                    let mut all = set_bits(met).map(|lane| {
                        let lane = lane % WIDTH;
                        Waiting { near: near[lane / 4][lane % 4], child: node.child(lane) }
                    });
                    // The nearest is next. (What is nearest does not matter to a search for any.)
                    let Some(mut nearest) = all.next() else { continue 'pop };
                    let first = stack.top;
                    for mut other in all {
                        if !ANY && other.near < nearest.near {
                            core::mem::swap(&mut other, &mut nearest);
                        }
                        bvh.prefetch::<E>(other.child);
                        stack.insert(if ANY { stack.top } else { first }, other);
                    }
                    child = nearest.child;
                    continue;
                }
                Child::Triangles(quads) => {
                    test_triangles::<R, E, ANY>(ray, &bvh.triangle_quads[quads], &mut best);
                }
                Child::Spheres(quads) => {
                    geometry.test_spheres::<E, ANY, true>(ray, &bvh.sphere_quads[quads], &mut best);
                }
            }
            if ANY && best.primitive != NO_PRIMITIVE {
                return best;
            }
            break;
        }
    }
    best
}

/// The rest of a search in which many wait. The ray by value: in the search before, it need not be in memory.
#[cold]
#[inline(never)]
fn descend_deep<R: Real, E: EffectSet, const ANY: bool>(
    geometry: &Geometry<'_, R>,
    bvh: &Bvh<'_, R>,
    ray: PreparedRay<R>,
    waiting: &[Waiting<R>],
    best: Hit<R>,
) -> Hit<R> {
    descend::<R, E, ANY, MAX_WAITING>(geometry, bvh, &ray, waiting, best)
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
