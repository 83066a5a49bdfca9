//! Four spheres at once: which of them a ray may hit. Conservative, so that only [`Sphere::intersect`] decides.

use super::{PreparedRay, Sphere};
use crate::lanes::Lanes;
use crate::real::{Real, Vector};
use crate::robust::gamma;

/// Bit k is set unless the ray certainly misses sphere k in `0 < t <= tmax`: the sphere is beside the line, or behind
/// an origin that is outside of it, or beyond `tmax`, where the ray has yet to reach it. `None` for a `tmax` that is
/// not worth a look.
///
/// With `F` the distance of the centre from the origin, `r` the radius, `u` the unit roundoff and everything divided
/// by the squared length of the direction where that is due: `F^2 - r^2` is off by at most
/// `gamma(6) F^2 + gamma(2) r^2`; with `gamma(8)` of both squares an f64 ray that was put off a sphere's surface is
/// certainly outside of it. The squared distance of the centre from the line less `r^2` is off by at most
/// `gamma(19) F^2 + gamma(3) r^2`: 12 u F^2 from the square of the projection, one rounding for the difference. Where
/// the centre is ahead of the point at `tmax`, `tmax` is at most `F`, and the squared distance from there less `r^2`
/// is off by at most `gamma(30) F^2 + gamma(4) r^2`. `gamma(64)` of both squares covers both with their own rounding.
/// The signs of the projections need no margin: one that is wrong is less than `gamma(8) F`, and then the centre is
/// as far from the line as from the point.
///
/// A NaN keeps the sphere. [`PreparedRay`] has NaN here for directions so short or long that products underflow; for
/// others `MIN_POSITIVE` covers what underflow can take away.
#[inline(always)]
pub fn candidates<R: Real>(ray: &PreparedRay<R>, spheres: [&Sphere<R>; 4], tmax: Option<R>) -> u32 {
    let splat = R::Lanes::splat;
    let rows = spheres.map(|sphere| {
        let [x, y, z] = sphere.center.to_array();
        [x, y, z, sphere.radius]
    });
    let [x, y, z, radius] = R::Lanes::transpose(rows);
    let [ox, oy, oz] = ray.origin.map(splat);
    let [dx, dy, dz] = ray.direction.map(splat);
    let zero = splat(R::ZERO);
    let (fx, fy, fz) = (x - ox, y - oy, z - oz);
    let along = fx * dx + fy * dy + fz * dz;
    let distance_square = fx * fx + fy * fy + fz * fz;
    let radius_square = radius * radius;
    let small_error = (distance_square + radius_square) * splat(gamma::<R>(8)) + splat(R::MIN_POSITIVE);
    let error = small_error * splat(R::from_f64(8.0));

    let t = along * splat(ray.inverse_square);
    let from_origin = distance_square - radius_square;
    let from_line = from_origin - along * t;
    let missed = from_line.greater(error) | (from_origin.greater(small_error) & zero.greater(t));
    let Some(tmax) = tmax else { return !missed & 0b1111 };
    let along_from_end = along - splat(tmax * ray.square);
    let from_end = from_origin - splat(tmax) * (along + along_from_end);
    !(missed | (from_end.greater(error) & along_from_end.greater(zero))) & 0b1111
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3 as V;

    #[test]
    fn certain_misses_are_dropped_and_nothing_else() {
        let sphere = |x, y, z, radius| Sphere::<f32> { center: V::new(x, y, z), radius, material: 0, inverted: false };
        let ahead = sphere(0.0, 0.5, -5.0, 1.0);
        let behind = sphere(0.0, 0.5, 5.0, 1.0);
        let beside = sphere(0.0, 2.0, -5.0, 1.0);
        let around = sphere(0.0, 0.0, 1.0, 4.0);
        let ray = Ray::new(V::ZERO, V::new(0.0, 0.0, -3.0));
        assert_eq!(candidates(&PreparedRay::new(&ray), [&ahead, &behind, &beside, &around], Some(ray.tmax)), 0b1001);
        let touching = sphere(0.0, 1.0, -5.0, 1.0);
        let nearly = sphere(0.0, 1.0 + 1e-7, -5.0, 1.0);
        assert_eq!(candidates(&PreparedRay::new(&ray), [&touching, &nearly, &behind, &beside], Some(ray.tmax)), 0b0011);
    }
}
