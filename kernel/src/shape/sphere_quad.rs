//! Four spheres at once: which of them a ray may hit. Conservative, so that only [`Sphere::intersect`] decides.

use super::{PreparedRay, REACH, Sphere};
use crate::lanes::Lanes;
use crate::real::{Real, Vector};
use crate::robust::gamma;

/// Up to four spheres of a leaf, side by side.
#[derive(Clone, Copy, Debug)]
pub struct SphereQuad<R: Real> {
    /// Centres, scene units; NaN where squares of distances could overflow.
    center: [R::Lanes; 3],
    /// Squared radii, enlarged as [`SphereQuad::candidates`] says: for what lies behind, and for all else.
    behind_square: R::Lanes,
    reach_square: R::Lanes,
    /// Primitive numbers; where there are fewer than four, the first again.
    primitives: [u32; 4],
}

impl<R: Real> SphereQuad<R> {
    /// One of a storage that holds nothing yet.
    pub const EMPTY: Self = Self {
        center: [R::Lanes::ZERO; 3],
        behind_square: R::Lanes::ZERO,
        reach_square: R::Lanes::ZERO,
        primitives: [0; 4],
    };

    /// Of the first one to four `primitives`, which must be numbers of `spheres`.
    pub(crate) fn new(spheres: &[Sphere<R>], primitives: &[u32]) -> Self {
        let primitive = |lane: usize| *primitives.get(lane).unwrap_or(&primitives[0]);
        let primitives_of_lanes = core::array::from_fn(primitive);
        let four = primitives_of_lanes.map(|primitive| &spheres[primitive as usize]);
        let enlarged = |roundings: u32, least: f64| {
            R::Lanes::new(core::array::from_fn(|lane| {
                let radius = four[lane].radius.widen();
                let square = radius * radius * (R::Wide::ONE + gamma::<R>(roundings).widen());
                // No line comes this near to where there is no sphere. (A NaN does, and finds the first sphere again.)
                let nothing = lane >= primitives.len();
                if nothing { R::LOWEST } else { R::narrow(square) + R::MIN_POSITIVE * R::from_f64(least) }
            }))
        };
        Self {
            center: core::array::from_fn(|axis| {
                R::Lanes::new(four.map(|sphere| {
                    let near = sphere.center.abs().max_component() < R::from_f64(REACH);
                    if near { sphere.center.to_array()[axis] } else { R::NAN }
                }))
            }),
            behind_square: enlarged(8, 1.0),
            reach_square: enlarged(64, 8.0),
            primitives: primitives_of_lanes,
        }
    }

    /// Primitive numbers of its spheres; where it has fewer than four, the first again.
    #[inline]
    pub fn primitives(&self) -> &[u32; 4] {
        &self.primitives
    }

    /// Primitive numbers of its spheres, each once.
    #[inline]
    pub(crate) fn distinct(&self) -> impl Iterator<Item = u32> {
        let [first, ..] = self.primitives;
        self.primitives.into_iter().enumerate().filter(move |(at, index)| *at == 0 || *index != first).map(|it| it.1)
    }

    /// Bit k is set unless the ray certainly misses sphere k in `0 < t <= tmax`: the sphere is beside the line, or
    /// behind an origin that is outside of it, or beyond `tmax`, where the ray has yet to reach it. `None` for a
    /// `tmax` that is not worth a look.
    ///
    /// With `F` the distance of the centre from the origin, `r` the radius, `u` the unit roundoff and everything
    /// divided by the squared length of the direction where that is due: `F^2` is off by at most `gamma(6) F^2`, so
    /// with `gamma(8)` of both squares an origin outside of the sphere is known to be, and an f64 ray that was put off
    /// a sphere's surface is certainly outside of it. The squared distance of the centre from the line is off by at
    /// most `gamma(19) F^2`: 12 u F^2 from the square of the projection, one rounding for the difference. Where the
    /// centre is ahead of the point at `tmax`, `tmax` is at most `F`, and the squared distance from there is off by at
    /// most `gamma(30) F^2`. `gamma(64)` of both squares covers both, with the roundings of the enlarged squares
    /// themselves. The signs of the projections need no margin: one that is wrong is less than `gamma(8) F`, and then
    /// the centre is as far from the line as from the point.
    ///
    /// A NaN keeps the sphere. [`PreparedRay`] has NaN here for directions so short or long that products underflow, and
    /// for origins so far off that they overflow; for others `MIN_POSITIVE` covers what underflow can take away.
    #[inline(always)]
    pub(crate) fn candidates(&self, ray: &PreparedRay<R>, tmax: Option<R>) -> u32 {
        let splat = R::Lanes::splat;
        let [ox, oy, oz] = ray.origin.map(splat);
        let [dx, dy, dz] = ray.direction.map(splat);
        let zero = R::Lanes::ZERO;
        let [x, y, z] = self.center;
        let (fx, fy, fz) = (x - ox, y - oy, z - oz);
        let along = fx * dx + fy * dy + fz * dz;
        let distance_square = fx * fx + fy * fy + fz * fz;

        let t = along * splat(ray.inverse_square);
        let least = distance_square * splat(R::ONE - gamma::<R>(64));
        let beside = (least - along * t, self.reach_square);
        let outside = (distance_square * splat(R::ONE - gamma::<R>(8)), self.behind_square);
        let missed = [[beside, beside], [outside, (zero, t)]];
        let Some(tmax) = tmax else { return !R::Lanes::both_greater(missed) & 0b1111 };
        let along_from_end = along - splat(tmax * ray.square);
        let beyond = (least - splat(tmax) * (along + along_from_end), self.reach_square);
        !R::Lanes::both_greater([missed[0], missed[1], [beyond, (along_from_end, zero)]]) & 0b1111
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3 as V;

    fn candidates(ray: &Ray<f32>, spheres: &[Sphere<f32>]) -> u32 {
        let numbers: [u32; 4] = core::array::from_fn(|at| at as u32);
        SphereQuad::new(spheres, &numbers[..spheres.len()]).candidates(&PreparedRay::new(ray), Some(ray.tmax))
    }

    #[test]
    fn certain_misses_are_dropped_and_nothing_else() {
        let sphere = |x, y, z, radius| Sphere::<f32> { center: V::new(x, y, z), radius, material: 0, inverted: false };
        let ahead = sphere(0.0, 0.5, -5.0, 1.0);
        let behind = sphere(0.0, 0.5, 5.0, 1.0);
        let beside = sphere(0.0, 2.0, -5.0, 1.0);
        let around = sphere(0.0, 0.0, 1.0, 4.0);
        let ray = Ray::new(V::ZERO, V::new(0.0, 0.0, -3.0));
        assert_eq!(candidates(&ray, &[ahead, behind, beside, around]), 0b1001);
        let touching = sphere(0.0, 1.0, -5.0, 1.0);
        let nearly = sphere(0.0, 1.0 + 1e-7, -5.0, 1.0);
        assert_eq!(candidates(&ray, &[touching, nearly, behind, beside]), 0b0011);
        assert_eq!(candidates(&Ray { tmax: 1.0, ..ray }, &[touching, ahead, around]), 0b0100);
    }

    #[test]
    fn spheres_too_far_off_for_squares_are_kept() {
        let far = Sphere::<f32> { center: V::new(-4.4e19, 0.0, -1e19), radius: 1.8e19, material: 0, inverted: false };
        let near = Sphere { center: V::ZERO, radius: 1.0, ..far };
        let across = V::new(0.0, 1.0, 0.0);
        assert_eq!(candidates(&Ray::new(V::ZERO, across), &[far]) & 1, 1);
        assert_eq!(candidates(&Ray::new(V::new(-6.4e19, 0.0, 0.0), across), &[near]) & 1, 1);
    }

    #[test]
    fn lanes_without_a_sphere_are_no_candidates() {
        let sphere = Sphere::<f32> { center: V::ZERO, radius: 2.0, material: 0, inverted: false };
        for origin in [V::ZERO, V::new(0.0, 0.0, 5.0), V::new(1e10, 0.0, 0.0)] {
            assert_eq!(candidates(&Ray::new(origin, -origin + V::Z * 1e-3), &[sphere]) & 0b1110, 0, "{origin}");
        }
    }
}
