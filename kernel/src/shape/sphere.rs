//! Spheres: a quadratic that does not cancel (Haines, Günther, Akenine-Möller, Ray Tracing Gems 2019, chapter 7).

use super::PreparedRay;
use crate::accuracy::SphereTest;
use crate::bvh::Bounds;
use crate::effects::{EffectSet, Everything};
use crate::real::{Real, Vec3, Vector, WideVec3, narrow, widen};
use crate::robust::{gamma, normalize_wide, stable_sphere_error};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<R: Real> {
    /// Centre, scene units.
    pub center: Vec3<R>,
    /// Radius, scene units; positive.
    pub radius: R,
    /// Index of its material.
    pub material: u32,
    /// Whether its normal points to the centre: the inner wall of a hollow shell.
    pub inverted: bool,
}

/// A point on a sphere.
pub(crate) struct SpherePoint<R: Real> {
    pub(crate) p: Vec3<R>,
    pub(crate) p_error: Vec3<R>,
    /// Unit, away from the centre.
    pub(crate) outward: Vec3<R>,
}

impl<R: Real> Sphere<R> {
    /// Whether squares of distances from it do not overflow, even over those of the directions of
    /// [`PreparedRay::square_in_range`].
    #[inline]
    pub(crate) fn is_near(&self) -> bool {
        let near = R::from_f64(super::NEAR);
        self.center.abs().max_component() < near && self.radius < near
    }

    /// Its box, wider than computed by what the roundings of its corners can take away.
    #[inline]
    pub fn bounds(&self) -> Bounds<R> {
        let pad = gamma::<R>(4);
        let center = self.center.to_array();
        let half = center.map(|c| self.radius + (c.abs() + self.radius) * pad);
        Bounds {
            corners: [
                core::array::from_fn(|axis| center[axis] - half[axis]),
                core::array::from_fn(|axis| center[axis] + half[axis]),
            ],
        }
    }

    /// Whether it is certain that the slab test of [`Sphere::bounds`] finds the ray to enter that box no later than at
    /// `t`, a hit of this sphere, and to leave it no earlier.
    ///
    /// Let f32 hits lie within `2^19 r` of the origin. In f64 both roots then put the ray within `2^-28 r` of the
    /// sphere, and the box is wider than the sphere by at least `u r`: the exact ray is in the box at both. The slab
    /// test finds the entry at most `(1 + u)^4 (1 - 10 u)` times as far as it is, and `t` is rounded by at most `u`. No
    /// axis overflows: the reciprocal of one that the ray has yet to enter is less than `2^85`. So it takes the wide
    /// test, in a precision that adds bits, and padded boxes.
    #[inline(always)]
    pub(crate) fn has_in_box(&self, ray: &PreparedRay<R>, t: R) -> bool {
        let reach = self.radius * R::from_f64((1u32 << 19) as f64);
        // Not where either product over- or underflows, and not where the ray's square is NaN.
        t * t * ray.square < reach * reach
    }

    /// The nearest t in `tmin < t <= tmax`.
    ///
    /// The distance of the centre from the line is measured at the foot of its perpendicular, so that neither a far
    /// origin nor a huge radius cancels; all in the wide precision.
    #[inline]
    pub fn intersect(&self, ray: &PreparedRay<R>, tmax: R) -> Option<R> {
        self.intersect_in::<Everything>(ray, tmax)
    }

    /// [`Sphere::intersect`] as accurately as a kernel asks.
    #[inline(always)]
    pub(crate) fn intersect_in<E: EffectSet>(&self, ray: &PreparedRay<R>, tmax: R) -> Option<R> {
        let [near, far] = self.crossings::<E>(ray)?;
        let t = if near > ray.tmin { near } else { far };
        if t > ray.tmin && t <= tmax { Some(t) } else { None }
    }

    /// Where the line enters and leaves the sphere; `None` where it does not, or where that is behind the origin.
    #[inline(always)]
    pub(super) fn crossings<E: EffectSet>(&self, ray: &PreparedRay<R>) -> Option<[R; 2]> {
        if const { matches!(E::ACCURACY.sphere, SphereTest::Narrow) } {
            let [origin, direction] = [ray.origin, ray.direction].map(Vec3::<R>::from_array);
            let squares = [ray.wide_square, ray.wide_inverse_square].map(R::narrow);
            roots(self.center - origin, self.radius, direction, squares, R::narrow(ray.error), true)
        } else {
            let to_center = widen::<R>(self.center) - ray.wide_origin;
            let (d, squares) = (ray.wide_direction, [ray.wide_square, ray.wide_inverse_square]);
            let wide = roots(to_center, self.radius.widen(), d, squares, ray.error, R::WIDE_IS_SELF)?;
            Some(wide.map(R::narrow))
        }
    }

    /// The point of the sphere in the direction of `from_center` (wide, any length).
    ///
    /// The point is put on the sphere again, so that its error does not depend on how far the ray came
    /// (PBR 4ed, section 6.8.5): five roundings in the wide precision, and that of the point itself.
    #[inline(always)]
    pub(crate) fn point_toward(&self, from_center: WideVec3<R>) -> SpherePoint<R> {
        let outward = normalize_wide::<R>(from_center);
        let offset = outward * self.radius.widen();
        let p = narrow::<R>(widen::<R>(self.center) + offset);
        let wide_error = R::narrow(gamma::<R::Wide>(5));
        let p_error = (self.center.abs() + narrow::<R>(offset).abs()) * wide_error + p.abs() * gamma::<R>(1);
        SpherePoint { p, p_error, outward: narrow::<R>(outward) }
    }

    /// The point where `ray` is at `t`.
    #[inline(always)]
    pub(crate) fn point_at(&self, ray: &crate::ray::Ray<R>, t: R) -> SpherePoint<R> {
        let from_center = widen::<R>(ray.origin) - widen::<R>(self.center);
        self.point_toward(from_center + widen::<R>(ray.direction) * t.widen())
    }
}

/// Where a line meets a sphere, the nearer first. `None` where it does not, or where the sphere lies behind the origin.
///
/// In a precision that is not wider than the input's it has to be `stable`: then the foot is refined once, the root that
/// would cancel is taken from the product of the roots, and half a chord is rounded as seldom as can be. With `u` each
/// for the squared radius, the difference, the squared length of the direction and the quotient, halved by the root, and
/// for the root itself it is off by `3 u`, and t by one more. (Near the rim, where squares would cancel, sum times
/// difference takes one rounding more: less than what the foot is off by.)
#[inline(always)]
fn roots<C: Real>(
    to_center: Vec3<C>,
    radius: C,
    d: Vec3<C>,
    [square, inverse_square]: [C; 2],
    error: C,
    stable: bool,
) -> Option<[C; 2]> {
    let radius_square = radius * radius;
    let along = to_center.dot(d);
    // Behind an origin outside of the sphere, or not inside by more than its error: where two walls meet, a ray that
    // leaves one must not start behind the other. Which of them was met first this test decided, with roundings of the
    // size of the sphere itself.
    let own = if stable && error > C::ZERO { stable_sphere_error(radius) } else { C::ZERO };
    let doubtful = radius * (error + error + own);
    if along < C::ZERO && to_center.dot(to_center) + doubtful > radius_square {
        return None;
    }
    let mut t_foot = along * inverse_square;
    let mut foot = to_center - d * t_foot;
    if stable {
        let correction = foot.dot(d) * inverse_square;
        t_foot = t_foot + correction;
        foot = foot - d * correction;
    }
    let foot_square = foot.dot(foot);
    if !(foot_square <= radius_square) {
        return None;
    }
    if !stable {
        let half = ((radius_square - foot_square) * inverse_square).sqrt();
        return Some([t_foot - half, t_foot + half]);
    }
    let half_square = if foot_square * C::from_f64(4.0) < radius_square && radius_square.is_finite() {
        radius_square - foot_square
    } else {
        let foot_length = foot_square.sqrt();
        (radius - foot_length) * (radius + foot_length)
    };
    let mut quotient = half_square / square;
    if foot_square == C::ZERO {
        // From the centre nothing else is rounded: t within 2 u.
        let refined = quotient + C::narrow(C::difference_of_products(radius, radius, quotient, square)) / square;
        quotient = if refined.is_finite() { refined } else { quotient };
    }
    let half = quotient.sqrt();
    // Not by the sign of zero: at the centre neither root is the larger, and the one ahead is half a chord.
    let larger = if t_foot < C::ZERO { t_foot - half } else { t_foot + half };
    let other = if t_foot.abs() * C::from_f64(4.0) < half {
        // Hardly anything cancels, and the product would round more often.
        if t_foot < C::ZERO { t_foot + half } else { t_foot - half }
    } else {
        let distance = to_center.dot(to_center).sqrt();
        let product = (distance - radius) * (distance + radius) / square;
        if larger == C::ZERO { C::ZERO } else { product / larger }
    };
    Some(if larger < other { [larger, other] } else { [other, larger] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::{DVec3, Vec3 as V};

    fn hit(sphere: &Sphere<f32>, ray: &Ray<f32>) -> Option<f32> {
        sphere.intersect(&PreparedRay::new(ray), ray.tmax)
    }

    #[test]
    fn front_inside_behind_and_beside() {
        let sphere = Sphere { center: V::new(0.0, 0.0, -5.0), radius: 2.0, material: 0, inverted: false };
        let toward = |origin| hit(&sphere, &Ray::new(origin, V::new(0.0, 0.0, -2.0)));
        assert_eq!(toward(V::ZERO), Some(1.5));
        assert_eq!(toward(V::new(0.0, 0.0, -5.0)), Some(1.0));
        assert_eq!(toward(V::new(0.0, 0.0, -8.0)), None);
        assert_eq!(toward(V::new(2.5, 0.0, 0.0)), None);
        let short = Ray { tmax: 1.25, ..Ray::new(V::ZERO, V::new(0.0, 0.0, -2.0)) };
        assert_eq!(hit(&sphere, &short), None);
    }

    #[test]
    fn far_and_huge_spheres_do_not_cancel() {
        for (distance, radius) in [(1e6, 1.0), (1000.0, 940.0), (1e5 + 1.0, 1e5)] {
            let sphere = Sphere::<f32> { center: V::new(0.0, 0.0, -distance), radius, material: 0, inverted: false };
            let t = hit(&sphere, &Ray::new(V::ZERO, V::new(0.0, 0.0, -1.0))).unwrap();
            assert!((t - (distance - radius)).abs() <= f32::EPSILON * (distance - radius), "{distance} {radius} {t}");
            let sphere = Sphere::<f64> {
                center: DVec3::new(0.0, 0.0, -f64::from(distance)),
                radius: f64::from(radius),
                material: 0,
                inverted: false,
            };
            let ray = Ray::<f64>::new(DVec3::new(0.0, 0.1, 0.0), DVec3::new(0.0, 0.0, -1.0));
            let t = sphere.intersect(&PreparedRay::new(&ray), ray.tmax).unwrap();
            let exact = f64::from(distance) - (sphere.radius * sphere.radius - 0.01).sqrt();
            assert!((t - exact).abs() <= 4.0 * f64::EPSILON * f64::from(distance), "{distance} {radius} {t}");
        }
    }
}
