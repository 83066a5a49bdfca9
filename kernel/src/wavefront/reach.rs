//! Between which bounds a ray meets a sphere, by rounded numbers alone.
//!
//! All lengths are distances along the ray: values of t times the length of its direction. `F` is the distance of the
//! sphere's centre from the origin, `r` its radius, `foot` where the ray is nearest to the centre, `u` the unit roundoff.
//! What is computed is off by (all is counted up):
//!
//! - the squared length of the direction by u, the length by 2 u, one over it by 3 u, the unit direction by 4 u;
//! - `foot` by 8 u F: the unit direction, the difference of the points, and three roundings of the dot product; its square by
//!   17 u F^2;
//! - `F^2` by 6 u and `r^2` by u of itself; so `r^2 - F^2` by 7 u F^2 + 2 u r^2, and half a chord's square, with one more
//!   rounding, by 25 u F^2 + 3 u r^2;
//! - the end of the ray, `tmax` times the length, by 3 u of itself. Where that lies before `foot`, and so within F, their
//!   difference is off by 12 u F, and its square by 26 u F^2. That an exact t is rounded to `tmax` adds 2 u F^2.
//!
//! `gamma(64) (F^2 + r^2)` covers what squares are off by, and `gamma(20) (|foot| + r)` what roots of exact squares would be:
//! `F <= |foot| + r` where the ray meets the sphere. Both cover the roundings of what is computed from them, and those of the
//! exact test, which are wide but for the last. The smallest doubt, some `MIN_POSITIVE`, covers squares that underflow; where
//! more than that is left of a square, lengths are so large that nothing else does. Squared lengths of directions and origins
//! are in the range that [`crate::shape::PreparedRay::square_in_range`] asks for.

use crate::real::{Real, Vec3, Vector, greater};
use crate::robust::gamma;

/// What bounds need of a ray.
#[derive(Clone, Copy)]
pub(super) struct Line<R: Real> {
    pub(super) origin: Vec3<R>,
    /// Of length one.
    pub(super) direction: Vec3<R>,
    /// How far the origin may be from where it should.
    pub(super) error: R,
}

/// How far ahead a ray meets a sphere, as `Sphere::intersect` finds it.
#[derive(Clone, Copy)]
pub(super) struct Reach<R> {
    /// Not before; infinite where it certainly does not.
    pub(super) earliest: R,
    /// No later; infinite where it may not meet it.
    pub(super) latest: R,
}

/// A sphere seen from the origin of a ray.
struct Seen<R> {
    foot: R,
    radius: R,
    /// How deep in the sphere the origin is: `r^2 - F^2`.
    depth: R,
    /// Half the chord, squared; below zero beside the sphere.
    half_square: R,
    /// What both squares are off by, at most.
    doubt: R,
    /// What distances are off by besides, at most.
    slack: R,
}

#[inline(always)]
fn see<R: Real>(center: Vec3<R>, radius: R, line: &Line<R>) -> Seen<R> {
    let to_center = center - line.origin;
    let foot = to_center.dot(line.direction);
    let distance_square = to_center.dot(to_center);
    // All that the radius stands in alone is worked out once for many rays.
    let radius_square = radius * radius;
    let least_doubt = radius_square * gamma::<R>(64) + R::MIN_POSITIVE * R::from_f64(64.0);
    let least_slack = radius * gamma::<R>(20);
    let depth = radius_square - distance_square;
    Seen {
        foot,
        radius,
        depth,
        half_square: depth + foot * foot,
        doubt: distance_square * gamma::<R>(64) + least_doubt,
        slack: foot.abs() * gamma::<R>(20) + least_slack,
    }
}

impl<R: Real> Seen<R> {
    /// Whether the exact test certainly takes the origin for one outside of the sphere.
    #[inline(always)]
    fn is_outside(&self) -> bool {
        self.depth < -self.doubt
    }

    /// Whether the exact test certainly takes the origin for one inside, as far as its own error lets it.
    #[inline(always)]
    fn is_inside(&self, line: &Line<R>) -> bool {
        // A margin of twice the radius and the error, rounded; and it needs room for its own rounding.
        let margin = (self.radius * R::from_f64(4.0)) * line.error;
        self.depth > self.doubt + margin
    }

    /// Whether the sphere's own box is met there without doubt: a quarter of what `Sphere::has_in_box` asks for.
    #[inline(always)]
    fn has_in_box(&self, distance: R) -> bool {
        distance < self.radius * R::from_f64(f64::from(1u32 << 18))
    }
}

/// Bounds on the nearest hit.
#[inline(always)]
pub(super) fn reach<R: Real>(center: Vec3<R>, radius: R, line: &Line<R>) -> Reach<R> {
    let seen = see::<R>(center, radius, line);
    let Seen { foot, half_square, doubt, slack, .. } = seen;
    let (most, least) = (half_square + doubt, half_square - doubt);
    let outer = greater(most, R::ZERO).sqrt() + slack;
    let inner = greater(least, R::ZERO).sqrt() - slack;
    // Both roots lie between these.
    let near = [foot - outer, foot - inner];
    let far = [foot + inner, foot + outer];

    let possible = (most >= R::ZERO) & (far[1] > R::ZERO);
    // The exact test drops what lies behind an origin outside of the sphere. From inside, or where the middle of the chord
    // lies ahead, it finds one of the roots.
    let certain = (least > R::ZERO) & ((foot > slack) | seen.is_inside(line));
    let earliest = greater(if near[1] > R::ZERO { near[0] } else { far[0] }, R::ZERO);
    let latest = if near[0] > R::ZERO { near[1] } else { far[1] };
    Reach {
        earliest: if possible { earliest } else { R::INFINITY },
        latest: if certain & seen.has_in_box(latest) { latest } else { R::INFINITY },
    }
}

/// Whether a ray may meet a sphere up to a distance of `end`, and whether it certainly does. Without a root: of hits only
/// those are certain whose ray comes from outside, enters and passes the middle of its chord before the end.
#[inline(always)]
pub(super) fn occlusion<R: Real>(center: Vec3<R>, radius: R, line: &Line<R>, end: R) -> (bool, bool) {
    let seen = see::<R>(center, radius, line);
    let Seen { foot, half_square, doubt, slack, .. } = seen;
    let outside = seen.is_outside();
    let beside = half_square + doubt < R::ZERO;
    let behind = outside & (foot < -slack);
    // The squared distance of the centre from the end of the ray; beyond it lies what has yet to be reached there.
    let left = foot - end;
    let beyond = (half_square + doubt < left * left) & (left > slack);
    let certain = outside & (half_square > doubt) & (foot > slack) & (foot + slack < end) & seen.has_in_box(foot);
    (!(beside | behind | beyond), certain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::departure::Departure;
    use crate::effects::Everything;
    use crate::ray::Ray;
    use crate::robust::{normalize, shadow_tmax};
    use crate::shape::{PreparedRay, Sphere};
    use glam::Vec3 as V;

    /// Numbers in -1..1 that look random.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) as f32 / (1u64 << 23) as f32) - 1.0
        }
    }

    #[test]
    fn bounds_hold_what_the_exact_test_finds_and_are_seldom_doubtful() {
        let mut next = numbers();
        let (mut rays, mut certain) = (0, 0);
        for (radius, distance) in [(1.0, 3.0), (1.0, 0.9), (1.0, 1.0), (940.0, 960.0), (1e-3, 50.0), (10.0, 0.01)] {
            for scale in [1e-6f32, 1e-2, 1.0, 1e5] {
                for k in 0..4000 {
                    let (radius, distance) = (radius * scale, distance * scale);
                    let mut any = || normalize::<f32>(V::new(next(), next(), next()));
                    // From the origin of coordinates, or from near it.
                    let origin = any() * if k % 5 < 3 { 0.0 } else { distance * 0.1 };
                    let center = any() * distance;
                    let (aside, free) = (any(), any());
                    // At random; at the rim, give or take little; along what touches the sphere at the origin.
                    let rim = center + normalize::<f32>(aside.cross(center)) * (radius * (1.0 + next() * 1e-6));
                    let direction = match k % 4 {
                        0 => free,
                        1 => center + free * radius,
                        2 => rim,
                        _ => normalize::<f32>(aside.cross(center)) + center * (next() * 1e-7 / distance),
                    };
                    let direction = direction * if k % 8 < 4 { 1.0 / direction.length() } else { 1.0 };
                    let center = origin + center;
                    let sphere = Sphere { center, radius, material: 0, inverted: false };
                    // As from its surface, on a side that rounding decides.
                    let error = if k % 3 == 0 { radius * 1e-6 } else { 0.0 };
                    let ray = Ray::<f32>::new(origin, direction);
                    let Some(square) = PreparedRay::square_in_range(&ray) else { continue };
                    let length = square.sqrt();
                    let from = Departure { error, ..Departure::exactly(ray.origin) };
                    let prepared = PreparedRay::new_in::<Everything, false>(&ray, &from);
                    let line = Line { origin: ray.origin, direction: direction * (1.0 / length), error };
                    // Without a rounding.
                    let exact_length = direction.as_dvec3().length();
                    let bounds = reach::<f32>(center, radius, &line);
                    let found = sphere.intersect_in::<Everything>(&prepared, f32::MAX);
                    let what = (&sphere, &ray, found, bounds.earliest, bounds.latest);
                    match found {
                        Some(t) => {
                            let distance = f64::from(t) * exact_length;
                            assert!(f64::from(bounds.earliest) <= distance, "{what:?}");
                            assert!(distance <= f64::from(bounds.latest), "{what:?}");
                            assert!(bounds.latest.is_infinite() || sphere.has_in_box(&prepared, t), "{what:?}");
                        }
                        None => assert!(bounds.latest.is_infinite(), "{what:?}"),
                    }
                    let near = found.map_or([2.0, 3.0], |t| [t, t.next_down()]);
                    for tmax in [0.5, 1.0, shadow_tmax::<f32>(), near[0], near[1], f32::MAX] {
                        let (possible, sure) = occlusion::<f32>(center, radius, &line, tmax * length);
                        let found = sphere.intersect_in::<Everything>(&prepared, tmax);
                        let met = found.is_some_and(|t| sphere.has_in_box(&prepared, t));
                        assert!((possible || !met) && (met || !sure), "{what:?} {tmax} {possible} {sure}");
                    }
                    if k % 4 < 2 {
                        rays += 1;
                        certain += u32::from(found.is_some() != bounds.earliest.is_infinite())
                            * u32::from(found.is_none() || bounds.latest.is_finite());
                    }
                }
            }
        }
        assert!(certain > rays / 5 * 4, "{certain} of {rays} are certain");
    }
}
