//! Every error bound of the kernel, each derived from unit roundoff; none is tuned.

use crate::real::{Real, Vec3, Vector, WideVec3, greater, narrow, widen};

/// `n u / (1 - n u)`, the bound on the relative error of `n` roundings (Higham 2002, section 3.1).
#[inline(always)]
pub fn gamma<R: Real>(n: u32) -> R {
    let nu = R::from_f64(f64::from(n)) * R::UNIT_ROUNDOFF;
    nu / (R::ONE - nu)
}

/// Factor that makes the far side of a slab conservative: `1 + 2 gamma(5)`.
///
/// The test itself rounds four times on either side of its comparison, the padding of the reciprocal included: `8 u` (Ize
/// 2013 has `2 gamma(3)` for one rounding less). The rest, with [`triangle_padding`], is for triangles: their test moves
/// the ray by `6 u`, seen from either side of the box.
#[inline]
pub fn slab_far_padding<R: Real>() -> R {
    R::ONE + gamma::<R>(5) + gamma::<R>(5)
}

/// Factor that makes the near side of a slab conservative: `1 - 2 gamma(5)`.
#[inline]
pub fn slab_near_padding<R: Real>() -> R {
    R::ONE - gamma::<R>(5) - gamma::<R>(5)
}

/// By how much the box of a triangle is larger than the triangle, whose longest side along an axis is `extent`: no ray
/// that hits the triangle may miss the box.
///
/// The watertight test decides by sheared corners, `x' = X - S Z` with `X` and `Z` from the origin of the ray and
/// `|S| <= 1`. Each is off by at most `2 u |X| + 4 u |S Z|`. Where the ray crosses the triangle these errors come in
/// with the weights of the corners: as corners may lie on both sides of the origin, the weighted `|X|` is at most that
/// of the crossing and twice the extent. So a ray that misses the triangle by `6 u |X| + 12 u extent` may be said to hit
/// it, and by `2 u extent` more where products of sheared corners are rounded.
#[inline]
pub fn triangle_padding<R: Real>(extent: R) -> R {
    extent * gamma::<R>(16)
}

/// Largest parameter of a shadow ray that runs from t = 0 to its light at t = 1.
#[inline(always)]
pub fn shadow_tmax<R: Real>() -> R {
    R::ONE - gamma::<R>(4) - gamma::<R>(4)
}

/// `v` at length 1, formed in the wide precision. The zero vector stays zero. What is so short that the wide precision
/// has its square only as a denormal number (1.5e-154, much shorter than any f32) loses digits.
#[inline(always)]
pub fn normalize<R: Real>(v: Vec3<R>) -> Vec3<R> {
    narrow::<R>(normalize_wide::<R>(widen::<R>(v)))
}

/// [`normalize`] of a vector that already is in the wide precision.
#[inline(always)]
pub fn normalize_wide<R: Real>(v: WideVec3<R>) -> WideVec3<R> {
    if R::WIDE_IS_SELF {
        // No bits to spare: what roundings did to the length is taken off again, and only the last of them remains.
        let square = |v: WideVec3<R>| R::squared_length(narrow::<R>(v).to_array());
        let length = square(v).sqrt();
        let unit: WideVec3<R> = Vector::from_array(v.to_array().map(|x| x / length));
        let off = (R::Wide::ONE - square(unit)) * R::Wide::from_f64(0.5);
        return if length > R::Wide::ZERO { unit + unit * off } else { v };
    }
    let square = v.dot(v);
    if square > R::Wide::ZERO { v * (R::Wide::ONE / square.sqrt()) } else { v }
}

/// A point off the surface at `p`, on the side that `w` leaves to, beyond the error box `p_error` of `p`
/// (Pharr, Jakob, Humphreys, PBR 4ed, section 6.8.6). `ng` is the geometric normal, either side.
///
/// A ray that starts there cannot meet the plane it left, and starts O(u |p|) away from it at any scale. Instead of
/// stepping to the next number after the sum, the box is grown by the sum's own rounding, at most `u |p + offset|` on
/// each axis, and by those of the products before it; no branch depends on the signs of a normal.
#[inline]
pub fn offset_ray_origin<R: Real>(p: Vec3<R>, p_error: Vec3<R>, ng: Vec3<R>, w: Vec3<R>) -> Vec3<R> {
    p + ng * offset_distance::<R>(p, p_error, ng).copysign(w.dot(ng))
}

/// How far an origin put off a surface at `p` can be from the exact point that a ray of unit direction first meets.
///
/// No further than the offset and the diagonal of the error box, neither of them more than the sum of the box's sides
/// and their rounding; and than the roundings of two distances `t`, since of two surfaces that lie closer together than
/// that either may be said to be the first.
#[inline(always)]
pub(crate) fn origin_error<R: Real>(p: Vec3<R>, p_error: Vec3<R>, t: R) -> R {
    let sides = error_box::<R>(p, p_error);
    sides.dot(Vec3::<R>::splat(R::from_f64(2.0) + gamma::<R>(16))) + distance_error::<R>(t)
}

/// How far a point of a triangle, the weighted sum of its `corners`, may be from the triangle, on each axis; `terms` are
/// the magnitudes of the summands together.
///
/// PBR 4ed, section 6.8.5, and what the rounding of t can add: that comes from all axes of the corners, so it counts on
/// each, also along the normal of a plane in which one coordinate is 0.
#[inline]
pub fn triangle_point_error<R: Real>(terms: Vec3<R>, corners: &[Vec3<R>; 3]) -> Vec3<R> {
    let [a, b, c] = corners.map(|corner| Vector::<R>::abs(corner).max_component());
    terms * gamma::<R>(7) + Vec3::<R>::splat(greater(greater(a, b), c) * gamma::<R>(3))
}

/// How far from its sphere the stable test may put a hit. It is off by at most 4u of the distance to the centre and of
/// the radius together; this is that for distances of up to three radii.
#[inline]
pub(crate) fn stable_sphere_error<C: Real>(radius: C) -> C {
    radius * gamma::<C>(16)
}

/// How many times the error of a point it may be beyond another surface that it belongs before.
///
/// Once for the point: it is within its error, at most [`error_box`] and [`distance_error`], of where the ray met its own
/// surface. And once for the other surface: a ray that is said to hit one of two surfaces, and not the other one before
/// it, tells them apart no better than by the error of a hit of the other, [`triangle_point_error`]; whoever uses this
/// takes the larger of both errors. What is further beyond was rightly found to be there.
pub(crate) const ERRORS_BEYOND: u32 = 2;

/// What two distances `t` of a ray of unit direction may be off by together: of two surfaces that lie closer together
/// than that, either may be said to be the first.
#[inline(always)]
pub(crate) fn distance_error<R: Real>(t: R) -> R {
    t * gamma::<R>(4)
}

/// Half the sides of the box around `p` that an offset has to leave: the errors of `p`, and the rounding of the offset
/// itself.
#[inline(always)]
pub(crate) fn error_box<R: Real>(p: Vec3<R>, p_error: Vec3<R>) -> Vec3<R> {
    p_error * (R::ONE + gamma::<R>(8)) + p.abs() * gamma::<R>(2)
}

/// How far rays start from the surface at `p`, along its normal.
#[inline(always)]
pub(crate) fn offset_distance<R: Real>(p: Vec3<R>, p_error: Vec3<R>, ng: Vec3<R>) -> R {
    ng.abs().dot(error_box::<R>(p, p_error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3 as V;

    #[test]
    fn offset_leaves_to_the_side_of_the_direction() {
        let p = V::new(1e4, -3.0, 0.0);
        let error = p.abs() * gamma::<f32>(7);
        let ng = normalize::<f32>(V::new(1.0, 2.0, -0.5));
        for w in [ng, -ng] {
            let moved = offset_ray_origin::<f32>(p, error, ng, w);
            assert!((moved - p).dot(w) > 0.0);
            assert!((moved - p).abs().max_component() < 1e-2);
        }
    }

    #[test]
    fn normalize_is_unit_at_every_scale_f64_can_square() {
        for k in -30..30 {
            let v = V::new(3.0, -4.0, 12.0) * libm::ldexpf(1.0, k);
            assert!((normalize::<f32>(v) - V::new(3.0, -4.0, 12.0) * (1.0 / 13.0)).abs().max_component() < 1e-7);
        }
        assert_eq!(normalize::<f32>(V::ZERO), V::ZERO);
    }
}
