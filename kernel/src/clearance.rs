//! Where surfaces meet: rays that leave one of them start on the right side of the others, too.
//!
//! A point that a ray hits lies within an error of where it should, hence perhaps beyond a second surface that meets
//! the first one there, as walls do in the corner of a room. A ray that starts beyond it leaves the room, and its
//! shadow rays meet the wall from behind. But the ray that found the point came from somewhere on the right side of
//! every surface that is that close, so that is where the next one has to start.

use crate::bvh::{Bounds, any_triangle_near};
use crate::real::{Real, Vec3, Vector, WideVec3, greater, narrow, widen};
use crate::robust::triangle_point_error;
use crate::scene::Scene;
use crate::shape::triangle::normal;
use crate::surface::SurfacePoint;

/// How many planes beside the surface's own are minded: the corner of a room has two.
const PLANES: usize = 4;

/// A plane near a point, with all lengths times that of `n`.
struct Plane<R: Real> {
    /// Normal of any length, on the viewer's side.
    n: WideVec3<R>,
    /// How far the origin of a ray must lie from the point along `n`, at least.
    least: R::Wide,
}

/// A point that was seen from `viewer`, on a surface whose unit normal `ng` is on the viewer's side, and from which
/// rays would start `offset` away, straight above it.
pub(crate) struct Clearance<'a, R: Real> {
    pub(crate) scene: &'a Scene<'a, R>,
    pub(crate) point: &'a SurfacePoint<R>,
    pub(crate) primitive: u32,
    pub(crate) viewer: Vec3<R>,
    pub(crate) ng: Vec3<R>,
    pub(crate) offset: Vec3<R>,
    /// How far the point may be from where the ray should have met the surface, on each axis.
    pub(crate) error: Vec3<R>,
}

/// The larger of each component.
#[inline(always)]
fn larger<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    Vector::new(greater(a.x(), b.x()), greater(a.y(), b.y()), greater(a.z(), b.z()))
}

impl<R: Real> Clearance<'_, R> {
    /// Whether there is a triangle so near that rounding may have moved the origin of those rays beyond it.
    #[inline(always)]
    pub(crate) fn is_needed(&self) -> bool {
        let is_in_the_way = |index| self.plane(index).is_some();
        any_triangle_near(self.scene.geometry(), self.scene.bvh(), &self.place(), is_in_the_way)
    }

    /// The box in which other triangles matter.
    #[inline(always)]
    fn place(&self) -> Bounds<R> {
        let reach = self.error * R::from_f64(2.0);
        let mut place = Bounds::EMPTY;
        place.grow(self.point.p - reach);
        place.grow(self.point.p + reach);
        place
    }

    /// The plane of a triangle, if rays would start too near to it or beyond. `None` where the point is beyond it by
    /// more than its error: then it has a right to be.
    #[inline(always)]
    fn plane(&self, index: usize) -> Option<Plane<R>> {
        let geometry = self.scene.geometry();
        if index + geometry.spheres().len() == self.primitive as usize {
            return None;
        }
        let corners = geometry.corners(index);
        let corner = widen::<R>(corners[0]);
        let front = normal::<R>(&corners);
        let n = if front.dot(widen::<R>(self.viewer) - corner) < R::Wide::ZERO { -front } else { front };
        let height = n.dot(widen::<R>(self.point.p) - corner);
        // At least what a hit of that triangle at this point would be off by.
        let own = triangle_point_error::<R>(self.point.p.abs(), &corners);
        let error = n.abs().dot(widen::<R>(larger::<R>(self.error, own)));
        let least = error - height;
        let is_near = n.dot(widen::<R>(self.offset)) < least && least < error * R::Wide::from_f64(3.0);
        is_near.then_some(Plane { n, least })
    }

    /// Where rays start instead, as seen from the point.
    #[cold]
    #[inline(never)]
    pub(crate) fn offset(&self) -> Vec3<R> {
        // The lowest triangles in their order, whatever order they are found in.
        let mut nearby = [usize::MAX; PLANES];
        any_triangle_near(self.scene.geometry(), self.scene.bvh(), &self.place(), |mut index| {
            if self.plane(index).is_some() {
                for kept in &mut nearby {
                    if index < *kept {
                        core::mem::swap(kept, &mut index);
                    }
                }
            }
            false
        });
        let ng = widen::<R>(self.ng);
        let mut offset = widen::<R>(self.offset);
        // What is moved off one plane may come nearer to another: twice round is enough for the corner of a room.
        let found = nearby.into_iter().filter(|index| *index != usize::MAX);
        for Plane { n, least } in found.clone().chain(found).filter_map(|index| self.plane(index)) {
            let length = n.dot(n).sqrt();
            let n = n * (R::Wide::ONE / length);
            let lacking = least / length - offset.dot(n);
            if !(lacking > R::Wide::ZERO) {
                continue;
            }
            let along = n.dot(ng);
            let aside = n - ng * along;
            let square = aside.dot(aside);
            // Straight up where that adds to the surface's own offset; else within its plane, so that that stays.
            if along > R::Wide::from_f64(0.5) {
                offset = offset + n * lacking;
            } else if square > R::Wide::from_f64(1e-4) {
                offset = offset + aside * (lacking / square);
            }
        }
        narrow::<R>(offset)
    }
}
