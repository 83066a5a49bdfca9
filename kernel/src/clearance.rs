//! Where surfaces meet: rays that leave one of them start on the right side of the others, too.
//!
//! A point that a ray hits lies within an error of where it should, hence perhaps beyond a second surface that meets
//! the first one there, as walls do in the corner of a room. A ray that starts beyond it leaves the room, and its
//! shadow rays meet the wall from behind. But the ray that found the point came from somewhere on the right side of
//! every surface that is that close, so that is where the next one has to start.

use crate::bvh::{Bounds, any_triangle_near};
use crate::real::{Real, Vec3, Vector, WideVec3, greater, narrow, widen};
use crate::robust::{ERRORS_BEYOND, triangle_point_error};
use crate::scene::Scene;
use crate::shape::triangle::normal;
use crate::surface::SurfacePoint;

// Every bound on an error comes from `robust`; the four numbers here are no bounds but limits of effort and of what
// counts as what. Other values would be as right, and clear other corners.

/// How many triangles are minded, one after the other: the corner of a room has two walls beside the surface's own, each
/// perhaps cut into a few triangles that meet there.
const TRIANGLES: usize = 16;

/// How often all of them are gone through: what is moved off one plane may come nearer to another.
const ROUNDS: u32 = 2;

/// Square of the sine of the angle below which two planes count as one: 0.6 degrees.
const PARALLEL: f64 = 1e-4;

/// Cosine of the angle between two normals up to which an origin is moved off the other plane within its own: 60
/// degrees. Closer to each other, straight off the other plane is also off the own one, and shorter.
const ASIDE: f64 = 0.5;

/// A plane near a point.
struct Plane<R: Real> {
    /// Unit normal on the viewer's side.
    n: WideVec3<R>,
    /// How much too near to it, or beyond, the origin of a ray is.
    lacking: R::Wide,
}

/// A point that was seen from `viewer`, or from anywhere else on the right side of what is near, on a surface whose unit
/// normal `ng` is on the side that rays leave to.
pub(crate) struct Clearance<'a, R: Real> {
    pub(crate) scene: &'a Scene<'a, R>,
    pub(crate) point: &'a SurfacePoint<R>,
    pub(crate) viewer: Vec3<R>,
    pub(crate) ng: Vec3<R>,
    /// How far the point may be from where the ray should have met the surface: on each axis, and along the surface.
    pub(crate) error: Vec3<R>,
    pub(crate) along: R,
}

impl<R: Real> Clearance<'_, R> {
    /// Whether there is a triangle so near that an origin `offset` from the point is on the wrong side of it.
    #[inline(always)]
    pub(crate) fn is_needed(&self, offset: Vec3<R>) -> bool {
        let offset = widen::<R>(offset);
        any_triangle_near(
            self.scene.geometry(),
            self.scene.bvh(),
            &place::<R>(self.point.p, self.error, self.along),
            #[inline(always)]
            |_, corners| self.plane(corners, offset).is_some(),
        )
    }

    /// The plane of a triangle, if `offset` from the point is too near to it or beyond. `None` where the point itself is
    /// beyond it by more than [`ERRORS_BEYOND`] times its error: then it has a right to be. None, too, for the
    /// surface's own plane, in which its neighbours lie and perhaps copies of it: nothing can be moved off that but by
    /// its own offset.
    #[inline(always)]
    fn plane(&self, corners: &[Vec3<R>; 3], offset: WideVec3<R>) -> Option<Plane<R>> {
        let corner = widen::<R>(corners[0]);
        let front = normal::<R>(corners);
        let ng = widen::<R>(self.ng);
        let square = front.dot(front);
        let aside = front - ng * front.dot(ng);
        let aside_square = aside.dot(aside);
        if !(aside_square > square * R::Wide::from_f64(PARALLEL)) {
            return None;
        }
        let n = if front.dot(widen::<R>(self.viewer) - corner) < R::Wide::ZERO { -front } else { front };
        let height = n.dot(widen::<R>(self.point.p) - corner);
        // At least what a hit of that triangle at this point would be off by.
        let own = triangle_point_error::<R>(self.point.p.abs(), corners);
        let error = n.abs().dot(widen::<R>(larger::<R>(self.error, own))) + aside_square.sqrt() * self.along.widen();
        let least = error - height;
        let lacking = least - n.dot(offset);
        // That is, its height is above so many errors below zero.
        let is_near = lacking > R::Wide::ZERO && least < error * R::Wide::from_f64(f64::from(1 + ERRORS_BEYOND));
        let inverse_length = R::Wide::ONE / square.sqrt();
        is_near.then(|| Plane { n: n * inverse_length, lacking: lacking * inverse_length })
    }

    /// Where rays start instead, as seen from the point, if not `offset` from it.
    #[cold]
    #[inline(never)]
    pub(crate) fn cleared(&self, offset: Vec3<R>) -> Vec3<R> {
        let ng = widen::<R>(self.ng);
        let mut offset = widen::<R>(offset);
        // From the lowest triangle to the highest, whatever order they are found in; and once more.
        let place = place::<R>(self.point.p, self.error, self.along);
        let (mut next, mut rounds) = (0, 0);
        for _ in 0..TRIANGLES {
            let mut lowest: Option<(u32, Plane<R>)> = None;
            any_triangle_near(self.scene.geometry(), self.scene.bvh(), &place, |index, corners| {
                if index >= next
                    && lowest.as_ref().is_none_or(|(found, _)| index < *found)
                    && let Some(plane) = self.plane(corners, offset)
                {
                    lowest = Some((index, plane));
                }
                false
            });
            let Some((index, Plane { n, lacking })) = lowest else {
                rounds += 1;
                if rounds == ROUNDS {
                    break;
                }
                next = 0;
                continue;
            };
            next = index + 1;
            let along = n.dot(ng);
            // Straight away from it where that adds to the surface's own offset; else within its plane, so that that stays.
            if along > R::Wide::from_f64(ASIDE) {
                offset = offset + n * lacking;
            } else {
                let aside = n - ng * along;
                offset = offset + aside * (lacking / aside.dot(aside));
            }
        }
        narrow::<R>(offset)
    }
}

/// The box around a point in which other triangles matter: no further than the point can be beyond them, by its `error` on
/// each axis and `along` the surface.
#[inline(always)]
pub(crate) fn place<R: Real>(p: Vec3<R>, error: Vec3<R>, along: R) -> Bounds<R> {
    let reach = (error + Vec3::<R>::splat(along)) * R::from_f64(f64::from(ERRORS_BEYOND));
    let mut place = Bounds::EMPTY;
    place.grow(p - reach);
    place.grow(p + reach);
    place
}

/// The larger of each component.
#[inline(always)]
fn larger<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    Vector::new(greater(a.x(), b.x()), greater(a.y(), b.y()), greater(a.z(), b.z()))
}
