//! The one table of tolerances, each with its reason. `u` is the unit roundoff of the precision under test, `M` the
//! largest coordinate of a query.

use ocellus_kernel::Real;

/// The unit roundoff as f64.
pub(crate) fn u<R: Real>() -> f64 {
    R::UNIT_ROUNDOFF.to_f64()
}

/// Picks a tolerance by precision: f32 forms much in f64, where f64 has nothing wider.
pub(crate) fn by_precision<R: Real>(single: f64, double: f64) -> f64 {
    if R::WIDE_IS_SELF { double } else { single }
}

/// Chance of one statistical test to fail for no reason: 1e-4 for the suite, shared by at most 200 tests (Sidak's
/// correction is the same to this many digits).
pub(crate) const SIGNIFICANCE: f64 = 1e-4 / 200.0;

/// Error in u of the length and the direction of a normalized vector. f32: one rounding of an f64 result. f64: what
/// the rest did to the length is known to 0.5 u and taken off, which rounds each component once more, its direction with
/// it by 2 u at most.
pub(crate) fn unit_length<R: Real>() -> f64 {
    by_precision::<R>(1.01, 2.0)
}

/// Length of the shortest vector that can be normalized: its square is a normal number in f64.
pub(crate) const SHORTEST: f64 = 1e-153;

/// Error in u of the lengths and scalar products of a frame: Duff et al. measured 2.9 u in f32 for an exact normal,
/// 5.4 u in f64; a normal that is itself [`unit_length`] off adds to that.
pub(crate) const FRAME: f64 = 6.0;

/// Below this many u M / r a ray grazes its sphere: the side on which it leaves is not decided by its bits.
pub(crate) const GRAZING: f64 = 64.0;

/// Distance in u M from a point to the origin of a ray spawned there: the bound on its error (gamma(7) of the
/// barycentric sum, gamma(3) of the plane, and two roundings: 12 u M per axis, times |n|_1 <= sqrt 3) and two more.
pub(crate) const OFFSET: f64 = 24.0;

/// Above this a product of two f64 and its rounding error (2^-106 times smaller) are both normal numbers.
pub(crate) const NORMAL_PRODUCT: f64 = 1e-270;

/// Error in u of a component of the view axis: computed in f64, rounded, normalized again.
pub(crate) const CAMERA_AXIS: f64 = 6.0;

/// Error in u of a component of a pixel's direction: position on the film 2 u, axes exact, length 3 u; in f64 the
/// tangent of the oracle adds its own.
pub(crate) const CAMERA_PIXEL: f64 = 4.0;

/// Distance in u of the scene's size between rays of one pixel where they should meet: direction 5 u, lens point
/// 3 u, and the test's own intersection with the plane.
pub(crate) const FOCUS: f64 = 16.0;

/// Error in u, in pixels, of a film position found back from a direction of the 16 by 16 camera: 8 pixels over a
/// tangent of 0.42, times the error of a direction.
pub(crate) const FILM_POSITION: f64 = 150.0;

/// Within this many u (D + r) of touching a sphere, or of starting on it, a ray may hit it or not: the exact answer
/// changes if the inputs move by a few roundings.
pub(crate) const UNDECIDED: f64 = 16.0;

/// Error of a sphere's t in u of the wide precision times its condition number, counted in millions of trials: the
/// stable test rounds half a chord by 3 u and the sum by one more where that precision adds no bits. Where it does, the
/// rounding of the answer hides it.
pub(crate) const SPHERE_T: f64 = 4.0;

/// What t of a sphere may be off by: what the wide precision does to a problem of this condition, and the rounding of
/// the answer where that precision is wider.
pub(crate) fn sphere_t<R: Real>(condition: f64, t: f64) -> f64 {
    SPHERE_T * u::<R::Wide>() * condition + by_precision::<R>(ROUNDED, 0.0) * u::<R>() * t
}

/// Error in u of a number that is rounded once.
pub(crate) const ROUNDED: f64 = 1.0;

/// Error in u of t from the centre of a sphere. f32: one rounding of an f64 result. f64: the squared
/// length of the direction and the quotient 1 u each, halved by the root, and the root 1 u.
pub(crate) const FROM_CENTRE: f64 = 2.0;

/// How many times as long as a good ray one that is not finite may take: what Embree asks of itself.
pub(crate) const INVALID_TIME: f64 = 2.5;

/// Distance in u M from an edge within which a triangle may be hit or missed: the shear of its corners.
pub(crate) const TRIANGLE_EDGE: f64 = 16.0;

/// Distance in u M of a hit from the triangle's plane, measured across it.
pub(crate) const TRIANGLE_T: f64 = 8.0;

/// Distance in u M of the barycentric point from the ray.
pub(crate) const BARYCENTRIC: f64 = 8.0;

/// Error in u of the squared length of a direction, or of the radius of a point, made from two numbers: sine and
/// cosine 1 u each, two roots, products and a frame.
pub(crate) const UNIT_SAMPLE: f64 = 8.0;

/// Relative error in u of the solid angle of a cone.
pub(crate) const SOLID_ANGLE: f64 = 8.0;

/// Relative error in u of a path's radiance for each scattering event: the throughput's product, the sum, and the
/// rounding of albedo and emission to the precision.
pub(crate) const PER_BOUNCE: f64 = 4.0;

/// Relative error in u of the direct light of a point light on a sphere around it: the point 2 u, hence 4 u in its
/// squared distance, and the cosine, the intensity and the products.
pub(crate) const LIT_SURFACE: f64 = 16.0;

/// The same on a plane, where the point is off by a few u of the plane's size (here 13 times the light's height), and
/// the inverse cube of the distance magnifies that.
pub(crate) const LIT_PLANE: f64 = 128.0;

/// Share of paths that may still be inside of a body of glass after 200 scattering events.
pub(crate) const TRAPPED: f64 = 1e-3;

/// Error in u of a reflectance of given cosines: away from angles at which all is reflected, and near them, where
/// amplitudes of nearly 1 are each off by up to 4 u, hence their squares by twice that.
pub(crate) const FRESNEL_GIVEN: f64 = 4.0;
pub(crate) const FRESNEL_EDGE: f64 = 8.0;

/// Error in u of a reflectance of an angle whose cosines are rounded first: magnified up to 5 times where refraction
/// nears its end (sine 0.99), squared; and the oracle's.
pub(crate) const FRESNEL: f64 = 64.0;

/// Error of a variance, in f64 epsilons of the sum of squares: that sum grows by one rounding per sample, here at
/// most 200.
pub(crate) const VARIANCE: f64 = 400.0;

/// Error in u of the length of a mirrored direction, and of its cosine: a scalar product, its double and a difference
/// round once each for a component, and normalizing takes off what that did to the length.
pub(crate) const MIRRORED: f64 = 4.0;

/// Error in u / cos_t of a refracted direction: Snell's law magnifies by 1 / cos_t what the sine is off, which is the
/// normal's and the direction's own rounding and a few products.
pub(crate) const REFRACTED: f64 = 6.0;

/// The same after refraction there and back: the error there, magnified by the ratio of the indices, and the one back.
pub(crate) const REVERSED: f64 = 16.0;

/// Difference in u between reflectances from both sides of one refraction: eight roundings each.
pub(crate) const RECIPROCAL: f64 = 16.0;

/// Beyond N33, which asks for [`RECIPROCAL`] of one pair of directions: difference in u / (cos_i cos_t) between the shares
/// reflected on the way there and, after the direction was rounded, on the way back: the cosine of that is [`REVERSED`] u / cos_i off, and a share changes by at most 4 / cos_t of it.
pub(crate) const SHARES: f64 = 4.0 * REVERSED;

/// How many standard errors a mean may be from what it should be: 4 come about by chance once in 16,000 times, and
/// seeds are fixed.
pub(crate) const DEVIATIONS: f64 = 4.0;

/// Relative standard error that a mean must reach: [`DEVIATIONS`] of them are 0.1 %, the smallest bias that a test of a
/// mean must notice.
pub(crate) const PRECISE: f64 = 2.5e-4;

/// The same where roulette makes up for what it ends, which varies path by path: half a million of them.
pub(crate) const ROULETTE: f64 = 1e-3;

/// Relative error of a form factor if a polygon stands for the disc around it: it holds the disc of cos(pi / n) times
/// the radius, and form factors grow no faster than the area.
pub(crate) fn polygon_for_disc(sides: u32) -> f64 {
    let half_angle = std::f64::consts::PI / f64::from(sides);
    half_angle * half_angle
}

/// Error of a reflectance of glass formed from exact cosines that are then rounded. The square of an amplitude r changes
/// by `r (1 - r^2) <= 0.39` times what a cosine is off by relative to itself, the mean of two squares too, and there are
/// two cosines of 1 u each: 0.8 u. In f64 it is the oracle that is off: a cosine formed from a sine loses `1 / cos^2`,
/// which is up to 10^6 where a million rays are spread evenly over the hemisphere.
pub(crate) fn reflected_share<R: Real>() -> f64 {
    by_precision::<R>(f64::from(f32::EPSILON) / 2.0, 1e-9)
}

/// Distance of an 8-bit code from its place on the curve, in codes: half a code, and where two are as near as each other
/// the roundings of f64 (a power and five operations, at 255 codes) that may decide for the other.
pub(crate) const CODE: f64 = 0.5 + 1e-12;

/// Relative difference between the mean light of a picture by the robust kernel and by one of the alternatives: none of
/// them loses more than rays at edges, at seams and within a thousandth of a scene unit from a surface, here at most
/// one in fifty.
pub(crate) const ALTERNATIVE_MEAN: f32 = 0.02;
