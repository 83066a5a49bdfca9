//! Four spheres at once: which of them a ray may hit. Conservative, so that only [`Sphere::intersect`] decides.

use super::{PreparedRay, Sphere};
use crate::lanes::Lanes;
use crate::real::{Real, Vector};
use crate::robust::gamma;

/// Bit k is set unless the ray certainly misses sphere k: beside the line, or behind an origin outside of it.
///
/// With `F` the distance of the centre and `u` the unit roundoff, the foot of the centre's perpendicular is off by at
/// most `gamma(12) F` and the ray parameter's sign is certain beyond `gamma(4) F |d|`; both are taken with
/// `gamma(16)` and with sums of magnitudes in place of lengths. A NaN or an overflow keeps the sphere.
#[inline(always)]
pub fn candidates<R: Real>(ray: &PreparedRay<R>, spheres: [&Sphere<R>; 4]) -> u32 {
    let splat = R::Lanes::splat;
    let rows = spheres.map(|sphere| {
        let [x, y, z] = sphere.center.to_array();
        [x, y, z, sphere.radius]
    });
    let [x, y, z, radius] = R::Lanes::transpose(rows);
    let [ox, oy, oz] = ray.origin.map(splat);
    let [dx, dy, dz] = ray.direction.map(splat);
    let (fx, fy, fz) = (x - ox, y - oy, z - oz);
    let along = fx * dx + fy * dy + fz * dz;
    let t = along * splat(ray.inverse_square);
    let (lx, ly, lz) = (fx - dx * t, fy - dy * t, fz - dz * t);
    let foot_square = lx * lx + ly * ly + lz * lz;
    let distance_square = fx * fx + fy * fy + fz * fz;
    let distance_sum = fx.abs() + fy.abs() + fz.abs();

    let error = splat(gamma::<R>(16));
    let tiny = splat(R::MIN_POSITIVE);
    let reach = radius + (radius + distance_sum) * error;
    let beside = foot_square.greater(reach * reach + tiny);
    let rim = radius + radius * error;
    let outside = distance_square.greater(rim * rim + tiny);
    let behind = splat(R::ZERO).greater(along + distance_sum * splat(ray.direction_sum) * error);
    !(beside | (outside & behind)) & 0b1111
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
        assert_eq!(candidates(&PreparedRay::new(&ray), [&ahead, &behind, &beside, &around]), 0b1001);
        let touching = sphere(0.0, 1.0, -5.0, 1.0);
        let nearly = sphere(0.0, 1.0 + 1e-7, -5.0, 1.0);
        assert_eq!(candidates(&PreparedRay::new(&ray), [&touching, &nearly, &behind, &beside]), 0b0011);
    }
}
