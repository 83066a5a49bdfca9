//! Diffuse directions that aim at light, and at what gathers it.
//!
//! What a mirror or a lens throws onto a diffuse surface (a caustic), and a light behind glass, is only found by
//! directions that happen to lead there: few, each worth much, which is noise. Here one direction in four is sent there,
//! uniformly over the cones that spheres around such objects fill. A direction is weighed by the density of both ways to
//! choose it (the balance heuristic for one sample, Veach 1997, section 9.2.4): the mean is the same whatever spheres
//! are aimed at, and no weight is more than 4/3 of what it is without.

use crate::material::{BsdfSample, diffuse};
use crate::real::{Real, Vec3, Vector};
use crate::surface::{Facing, SurfacePoint};
use crate::warp::{cone_of_versine, to_world};

/// A direction in `2^AIMED_BITS` is aimed. With one in two the others lack samples, one in eight finds less.
const AIMED_BITS: u32 = 2;

/// A sphere around something that shines, or that gathers light: a mirror or glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim<R: Real> {
    /// Centre, scene units.
    pub center: Vec3<R>,
    /// Radius, scene units.
    pub radius: R,
    /// How many of the aimed directions go there per solid angle, relative to other spheres: above 0, up to 1.
    ///
    /// The best is the root of the share of the sphere's disk that looks bright (it makes the derivative of the variance
    /// the same for all): 1 for a light, about half the angle that the light's diameter fills for a ball that mirrors it.
    pub worth: R,
}

/// The cone that a sphere fills, seen from outside.
struct Cone<R: Real> {
    /// To the centre, scene units.
    axis: Vec3<R>,
    /// Length of `axis`.
    distance: R,
    /// Squared radius of the sphere.
    radius_square: R,
    /// 1 - cos of half its angle.
    versine: R,
    /// Its share of the aimed directions, relative to others.
    share: R,
}

impl<R: Real> Aim<R> {
    /// Whether all is finite, radius and worth are above zero, and the worth is at most 1.
    pub fn is_valid(&self) -> bool {
        let positive = self.radius > R::ZERO && self.worth > R::ZERO;
        positive && self.center.is_finite() && self.radius.is_finite() && self.worth <= R::ONE
    }

    /// Seen from `p`; `None` from inside, or where it is too far or too small to be seen.
    #[inline]
    fn cone(&self, p: Vec3<R>) -> Option<Cone<R>> {
        let axis = self.center - p;
        let square = axis.dot(axis);
        let radius_square = self.radius * self.radius;
        let tangent = (square - radius_square).sqrt();
        let distance = square.sqrt();
        // 1 - cos = sin^2 / (1 + cos), with both over the distance.
        let versine = radius_square / (distance * (distance + tangent));
        let share = self.worth * versine;
        // Nor where one of them is not a number.
        (tangent > R::ZERO && share > R::ZERO).then_some(Cone { axis, distance, radius_square, versine, share })
    }
}

/// A direction for a diffuse surface; the weight is the albedo, times how often it is chosen without aim over how often
/// it is with. `None` where it would pass the surface.
#[inline]
pub(crate) fn sample<R: Real>(
    aims: &[Aim<R>],
    point: &SurfacePoint<R>,
    facing: &Facing<R>,
    albedo: Vec3<R>,
    numbers: [u32; 4],
) -> Option<BsdfSample<R>> {
    let [u, v] = [numbers[0], numbers[1]].map(R::from_unit_bits);
    let mut shares = R::ZERO;
    for cone in aims.iter().filter_map(|aim| aim.cone(point.p)) {
        shares = shares + cone.share;
    }
    if !(shares > R::ZERO) {
        return diffuse::sample(facing, albedo, u, v);
    }
    // The highest bits say whether to aim, the others at which.
    let (wi, chosen) = if numbers[2] >> (32 - AIMED_BITS) == 0 {
        toward(aims, point.p, R::from_unit_bits(numbers[2] << AIMED_BITS) * shares, u, v)?
    } else {
        (diffuse::sample(facing, albedo, u, v)?.wi, usize::MAX)
    };
    let cosine = diffuse::cosine(facing, wi);
    if cosine == R::ZERO {
        return None;
    }
    let mut worth = R::ZERO;
    for (index, aim) in aims.iter().enumerate() {
        // Whether it meets the sphere: by a cross product, since cosines of narrow cones are all 1.
        let within = |cone: Cone<R>| {
            let off = cone.axis.cross(wi);
            cone.axis.dot(wi) > R::ZERO && off.dot(off) <= cone.radius_square
        };
        // The chosen one holds it, whatever rounding says.
        if index == chosen || aim.cone(point.p).is_some_and(within) {
            worth = worth + aim.worth;
        }
    }
    let aimed = R::from_f64(1.0 / f64::from(1 << AIMED_BITS));
    let rest = R::ONE - aimed;
    let odds = if worth > R::ZERO {
        // Densities: cos / pi, and the worth of the cones that hold the direction / (2 pi shares).
        let scaled = R::from_f64(2.0) * cosine * shares;
        scaled / (rest * scaled + aimed * worth)
    } else {
        R::ONE / rest
    };
    Some(BsdfSample { wi, weight: albedo * odds, delta: false })
}

/// A direction of one of the cones and which it is: that where `place` falls, of all their shares side by side.
#[inline]
fn toward<R: Real>(aims: &[Aim<R>], p: Vec3<R>, place: R, u: R, v: R) -> Option<(Vec3<R>, usize)> {
    let mut left = place;
    let mut found = None;
    for (index, aim) in aims.iter().enumerate() {
        let Some(cone) = aim.cone(p) else { continue };
        let here = left < cone.share;
        left = left - cone.share;
        // The last one, where rounding leaves a rest.
        found = Some((cone, index));
        if here {
            break;
        }
    }
    let (cone, index) = found?;
    let sampled = cone_of_versine(cone.versine, u);
    let (sine, cosine) = v.sin_cos_turns();
    let local = Vector::new(cosine * sampled.sine, sine * sampled.sine, sampled.cosine);
    Some((to_world::<R>(cone.axis * (R::ONE / cone.distance), local), index))
}
