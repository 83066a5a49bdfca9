//! From the unit square to directions and points, and the frame they stand in.

use crate::real::{Real, Vec3, Vector, lesser};

/// Cosine-weighted direction about +z from two numbers in `0 <= u, v < 1`; pdf = z / pi per steradian.
///
/// `(cos(2 pi u) sqrt(1 - v), sin(2 pi u) sqrt(1 - v), sqrt(v))`, as in the report.
#[inline(always)]
pub fn cosine_hemisphere<R: Real>(u: R, v: R) -> Vec3<R> {
    let (sine, cosine) = u.sin_cos_turns();
    let radius = (R::ONE - v).sqrt();
    Vector::new(cosine * radius, sine * radius, v.sqrt())
}

/// Uniform point of the unit disk; pdf = 1 / pi per area.
#[inline(always)]
pub fn disk<R: Real>(u: R, v: R) -> [R; 2] {
    let (sine, cosine) = u.sin_cos_turns();
    let radius = v.sqrt();
    [cosine * radius, sine * radius]
}

/// Two independent normal numbers of standard deviation 1 (Box and Muller 1958). The logarithm's argument is
/// `1 - v`, which is never 0.
#[inline]
pub fn gaussian<R: Real>(u: R, v: R) -> [R; 2] {
    let (sine, cosine) = u.sin_cos_turns();
    let minus_two_ln = (R::ONE - v).ln() * R::from_f64(-2.0);
    // -2 ln(1) is -0; its root must not become the sign of the offset.
    let radius = minus_two_ln.abs().sqrt();
    [cosine * radius, sine * radius]
}

/// A number in -1..1 with the density of a tent, `1 - |x|`.
#[inline]
pub fn tent<R: Real>(u: R) -> R {
    let double = u + u;
    if double < R::ONE { double.sqrt() - R::ONE } else { R::ONE - (R::from_f64(2.0) - double).sqrt() }
}

/// A right-handed frame whose z is the unit vector `n`: its x and y
/// (Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6:1, 2017).
#[inline]
pub fn frame<R: Real>(n: Vec3<R>) -> [Vec3<R>; 2] {
    let sign = R::ONE.copysign(n.z());
    let a = -(R::ONE / (sign + n.z()));
    let b = n.x() * n.y() * a;
    [
        Vector::new(R::ONE + sign * n.x() * n.x() * a, sign * b, -(sign * n.x())),
        Vector::new(b, sign + n.y() * n.y() * a, -n.y()),
    ]
}

/// `local` (about +z) in the [`frame`] of the unit vector `n`, multiplied out.
#[inline(always)]
pub fn to_world<R: Real>(n: Vec3<R>, local: Vec3<R>) -> Vec3<R> {
    let sign = R::ONE.copysign(n.z());
    let across = sign * n.x() * local.x() + n.y() * local.y();
    let along = local.z() - across / (sign + n.z());
    Vector::new(local.x() + n.x() * along, sign * local.y() + n.y() * along, n.z() * local.z() - across)
}

/// Cosine of the angle from the axis, its sine, and the solid angle of a cone of directions, all without
/// cancellation: a uniform direction of the cone around +z that a sphere fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeSample<R: Real> {
    /// Cosine of the angle from the axis.
    pub cosine: R,
    /// Sine of the angle from the axis.
    pub sine: R,
    /// The square of that.
    pub sine_square: R,
    /// Solid angle of the whole cone, steradians: one over the pdf.
    pub solid_angle: R,
}

/// A uniform direction of the cone whose half angle has the squared sine `sine_square`; all directions where that
/// is 1 or more. `1 - cos` is formed as `sin^2 / (1 + cos)`.
#[inline]
pub fn cone<R: Real>(sine_square: R, u: R) -> ConeSample<R> {
    let versine =
        if sine_square < R::ONE { sine_square / (R::ONE + (R::ONE - sine_square).sqrt()) } else { R::from_f64(2.0) };
    cone_of_versine(versine, u)
}

/// [`cone`] whose half angle has the versine (1 - cos) `versine`, 0..=2.
#[inline(always)]
pub fn cone_of_versine<R: Real>(versine: R, u: R) -> ConeSample<R> {
    let drop = u * versine;
    let sine_square = lesser(drop * (R::from_f64(2.0) - drop), R::ONE);
    ConeSample {
        cosine: R::ONE - drop,
        sine: sine_square.sqrt(),
        sine_square,
        solid_angle: versine * R::from_f64(core::f64::consts::TAU),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3 as V;

    const LAST: f32 = 1.0 - f32::EPSILON * 0.5;

    #[test]
    fn corners_of_the_square_give_finite_unit_directions() {
        for u in [0.0, 0.25, 0.5, LAST] {
            for v in [0.0, 1e-30, 0.5, LAST, 1.0] {
                let d = cosine_hemisphere::<f32>(u, v);
                assert!((d.dot(d) - 1.0).abs() < 4e-7 && d.z >= 0.0, "{u} {v} {d}");
            }
            for v in [0.0, 0.5, LAST] {
                assert!(gaussian(u, v).iter().all(|x| x.is_finite() && x.abs() < 6.0), "{u} {v}");
            }
            assert!(tent(u).abs() <= 1.0);
        }
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed_at_the_poles() {
        for z in [-1.0f32, -0.999_999_94, -0.0, 0.0, 0.3, 1.0] {
            let n = V::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
            let [x, y] = frame::<f32>(n);
            assert!((x.cross(y) - n).abs().max_component() < 1e-6, "{n} {x} {y}");
            assert!(x.dot(y).abs() < 1e-6 && (x.dot(x) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn far_cones_keep_their_solid_angle() {
        let s: f32 = 1e-6;
        let exact = core::f64::consts::PI * 1e-12;
        assert!((f64::from(cone(s * s, 0.5).solid_angle) / exact - 1.0).abs() < 1e-6);
        let all = cone(1.5f32, 1.0);
        assert_eq!(all.cosine, -1.0);
    }
}
