//! Four triangles at once: which of them a ray may hit, by the same formulas that decide for each.

use super::PreparedRay;
use super::triangle::{Shear, moller_trumbore, sheared};
use crate::accuracy::TriangleTest;
use crate::bvh::Bounds;
use crate::effects::EffectSet;
use crate::lanes::{Lanes, Numbers};
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3, Vector};
use crate::robust::{gamma, triangle_padding};

/// Up to four triangles of a leaf, side by side. 160 bytes in f32.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct TriangleQuad<R: Real> {
    /// Coordinates by axis and corner, scene units; NaN where there is no triangle.
    corners: [[R::Lanes; 3]; 3],
    /// Primitive numbers; [`NO_PRIMITIVE`] where there is none.
    primitives: [u32; 4],
}

impl<R: Real> TriangleQuad<R> {
    /// One without triangles.
    pub const EMPTY: Self = Self { corners: [[R::Lanes::NAN; 3]; 3], primitives: [NO_PRIMITIVE; 4] };

    /// Of up to four triangles: their numbers and corners.
    pub(crate) fn new(triangles: impl Iterator<Item = (u32, [Vec3<R>; 3])>) -> Self {
        let mut corners = [[[R::NAN; 4]; 3]; 3];
        let mut primitives = [NO_PRIMITIVE; 4];
        for (lane, (primitive, positions)) in triangles.enumerate() {
            primitives[lane] = primitive;
            for (corner, position) in positions.into_iter().enumerate() {
                for (axis, value) in position.to_array().into_iter().enumerate() {
                    corners[axis][corner][lane] = value;
                }
            }
        }
        Self { corners: corners.map(|axis| axis.map(R::Lanes::new)), primitives }
    }

    /// Primitive numbers and corners of its triangles.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3<R>; 3])> {
        (0..4).map(|lane| self.triangle(lane)).filter(|(primitive, _)| *primitive != NO_PRIMITIVE)
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> (u32, [Vec3<R>; 3]) {
        let coordinate = |axis: usize, k: usize| self.corners[axis][k].to_array()[lane];
        let corner = |k: usize| Vector::new(coordinate(0, k), coordinate(1, k), coordinate(2, k));
        (self.primitives[lane], [corner(0), corner(1), corner(2)])
    }

    /// A bit for each triangle whose own box, [`bounds`](super::triangle::bounds), has a point in common with `place`. (It
    /// may be set for one whose size overflows, and not be for one with corners that are no numbers: that has no plane.)
    #[inline(always)]
    pub(crate) fn meeting(&self, place: &Bounds<R>) -> u32 {
        let low = self.corners.map(|[a, b, c]| a.lesser(b).lesser(c));
        let high = self.corners.map(|[a, b, c]| a.greater(b).greater(c));
        let extent = |axis: usize| high[axis] - low[axis];
        let padding = extent(0).greater(extent(1)).greater(extent(2)) * R::Lanes::splat(triangle_padding::<R>(R::ONE));
        let [place_low, place_high] = place.corners.map(|corner| corner.map(R::Lanes::splat));
        let below = |axis: usize| (low[axis] - padding, place_high[axis]);
        let above = |axis: usize| (place_low[axis], high[axis] + padding);
        R::Lanes::all_at_most([below(0), above(0), below(1), above(1), below(2), above(2)])
    }

    /// Bit k is set unless the ray misses triangle k, however far it goes. (It may be set for some that it hardly misses.)
    #[inline(always)]
    pub(crate) fn candidates<E: EffectSet>(&self, ray: &PreparedRay<R>) -> u32 {
        match const { E::ACCURACY.triangle } {
            TriangleTest::Fast => self.met_by_moller_trumbore(ray),
            TriangleTest::Narrow | TriangleTest::Watertight => self.met(&ray.shear, ray.origin, |corners| corners),
            TriangleTest::Wide => self.met(&ray.wide_shear, ray.wide_origin.to_array(), |corners| {
                <R::Wide as Real>::Lanes::new(corners.to_array().map(R::widen))
            }),
        }
    }

    /// A triangle is met where none of its three differences of products is negative, or none is positive. Rounding keeps
    /// order: where the rounded products differ the exact ones do, and in the same sense. So the signs that are found here
    /// are those of exact products, except where rounded ones are equal: those count as both.
    #[inline(always)]
    fn met<C: Real>(&self, shear: &Shear<C>, origin: [C; 3], convert: impl Fn(R::Lanes) -> C::Lanes) -> u32 {
        let [x, y, z] = shear.axes();
        let [shear_x, shear_y] = [shear.x, shear.y].map(C::Lanes::splat);
        let origin = origin.map(C::Lanes::splat);
        let corner = |k: usize| {
            let from_origin = |axis: usize| convert(self.corners[axis][k]) - origin[axis];
            sheared([from_origin(x), from_origin(y), from_origin(z)], shear_x, shear_y)
        };
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (corner(0), corner(1), corner(2));
        // Where the wide precision adds no bits, exact products are sums of two numbers, of which the smaller may be lost
        // below the range of numbers.
        let least = C::Lanes::splat(C::MIN_POSITIVE * C::from_f64(4.0));
        let wider = |product: C::Lanes| if C::WIDE_IS_SELF { product + least } else { product };
        let products = [(cx * by, cy * bx), (ax * cy, ay * cx), (bx * ay, by * ax)];
        let back = C::Lanes::all_at_most(products.map(|(p, q)| (p, wider(q))));
        let front = C::Lanes::all_at_most(products.map(|(p, q)| (q, wider(p))));
        if back | front == 0 {
            return 0;
        }
        let depth = Depth::<C>::of(products, [az, bz, cz]);
        let (plus, minus) = if shear.z < C::ZERO { (back, front) } else { (front, back) };
        (plus & depth.at_least_zero()) | (minus & depth.at_most_zero())
    }

    #[inline(always)]
    fn met_by_moller_trumbore(&self, ray: &PreparedRay<R>) -> u32 {
        let corner = |k: usize| [self.corners[0][k], self.corners[1][k], self.corners[2][k]];
        let [origin, direction] = [ray.origin, ray.direction].map(|v| v.map(R::Lanes::splat));
        let (zero, one) = (R::Lanes::ZERO, R::Lanes::splat(R::ONE));
        let [_, u, v] = moller_trumbore([corner(0), corner(1), corner(2)], origin, direction, one);
        R::Lanes::all_at_most([(zero, u), (zero, v), (u + v, one)])
    }
}

/// The sum of three differences of products, each times a number: how far off a triangle is, times its size.
struct Depth<C: Real> {
    sum: C::Lanes,
    /// What it may be off by.
    error: C::Lanes,
}

impl<C: Real> Depth<C> {
    /// A difference of rounded products is off by u of both products and by u of itself, its product and the sums by 3 u
    /// more: together 5 u of the magnitudes of all products. The exact test rounds, too, where the wide precision adds no
    /// bits, as often; so `gamma(10)` of those magnitudes, whose sum here takes up to eight roundings of its own, decides
    /// like it: `gamma(12)`. Where numbers are so small that rounding is no longer relative it adds at most five of the
    /// smallest ones; `MIN_POSITIVE` among the magnitudes makes six.
    #[inline(always)]
    fn of(products: [(C::Lanes, C::Lanes); 3], factors: [C::Lanes; 3]) -> Self {
        let least = C::Lanes::splat(C::MIN_POSITIVE);
        let [(a, b), (c, d), (e, f)] = products;
        let [x, y, z] = factors;
        let sum = (a - b) * x + (c - d) * y + (e - f) * z;
        let magnitude = |p: C::Lanes, q: C::Lanes, factor: C::Lanes| (p.abs() + q.abs() + least) * factor.abs();
        let magnitudes = magnitude(a, b, x) + magnitude(c, d, y) + magnitude(e, f, z);
        Self { sum, error: magnitudes * C::Lanes::splat(gamma::<C>(12)) + least }
    }

    /// A bit for each lane in which the exact sum may be zero or more; also where something is not a number.
    #[inline(always)]
    fn at_least_zero(&self) -> u32 {
        !C::Lanes::both_greater([[(C::Lanes::ZERO - self.error, self.sum); 2]])
    }

    /// A bit for each lane in which the exact sum may be zero or less; also where something is not a number.
    #[inline(always)]
    fn at_most_zero(&self) -> u32 {
        !C::Lanes::both_greater([[(self.sum, self.error); 2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Everything;
    use crate::ray::Ray;
    use glam::Vec3 as V;

    /// What a lane without a triangle holds.
    const NOTHING: (u32, [V; 3]) = (NO_PRIMITIVE, [V::NAN; 3]);

    #[test]
    fn misses_and_empty_lanes_are_no_candidates() {
        let [a, b, c] = [V::new(0.0, 0.0, -4.0), V::new(2.0, 0.0, -4.0), V::new(0.0, 2.0, -4.0)];
        assert_eq!(TriangleQuad::<f32>::EMPTY.triangles().count(), 0);
        let moved = [a, c, b].map(|corner| corner + V::X);
        let quad = TriangleQuad::<f32>::new([NOTHING, (7, [a, b, c]), (9, moved)].into_iter());
        assert!(quad.triangles().eq([quad.triangle(1), quad.triangle(2)]));
        for (x, found) in [(-0.1, 0b000), (0.5, 0b010), (1.0, 0b110), (1.25, 0b110), (2.5, 0b100), (3.5, 0)] {
            for (z, along, found) in [(0.0, -1.0, found), (-8.0, 1.0, found), (0.0, 1.0, 0), (-8.0, -1.0, 0)] {
                let ray = Ray::<f32>::new(V::new(x, 0.5, z), V::new(0.0, 0.0, along));
                assert_eq!(quad.candidates::<Everything>(&PreparedRay::new(&ray)), found, "{x} {z} {along}");
            }
        }
    }

    #[test]
    fn triangles_near_a_place_are_those_whose_own_boxes_meet_it() {
        let corners = [V::new(0.5, -1.0, 3.0), V::new(-2.0, 0.25, 3.0), V::new(1.0, 4.0, 3.0)];
        let moved = |lane, shift| (lane, corners.map(|corner| corner + shift));
        let far = V::new(0.0, 1e6, 0.0);
        let quad = TriangleQuad::<f32>::new([moved(0, V::ZERO), moved(1, V::X), NOTHING, moved(3, far)].into_iter());
        let mut found = [0; 4];
        // Around the corners of the boxes, which are wider than the triangles by some units in the last place.
        for (lane, (_, triangle)) in [0, 1, 3].into_iter().map(|lane| (lane, quad.triangle(lane))) {
            for (corner, ulps) in triangle.into_iter().flat_map(|corner| (-12..12).map(move |ulps| (corner, ulps))) {
                let nudge = |x: f32| x + ulps as f32 * (x.abs().next_up() - x.abs());
                let mut place = Bounds::EMPTY;
                place.grow(V::new(nudge(corner.x), nudge(corner.y), nudge(corner.z)));
                let own = |lane: usize| super::super::triangle::bounds::<f32>(&quad.triangle(lane).1);
                let due = [0, 1, 3].into_iter().filter(|&lane| own(lane).meets(&place));
                assert_eq!(quad.meeting(&place), due.map(|lane| 1 << lane).sum::<u32>());
                found[lane] += quad.meeting(&place).count_ones();
            }
        }
        assert!(found.iter().enumerate().all(|(lane, &found)| (found > 0) == (lane != 2)), "{found:?}");
    }

    /// The second of two exact products is lost below the range of numbers: their difference is then not below zero where
    /// it should be, and that is what decides.
    #[test]
    fn edges_too_small_for_exact_products_are_met_alike() {
        let power = |significand: f64, exponent: i32| significand * libm::ldexp(1.0, exponent);
        let x = f64::from_bits(0x3ff8_b6c9_99e7_f678);
        let y = f64::from_bits(0x3ff4_0253_0592_579c);
        let (p, q) = (f64::from_bits(0x3ffa_0020_d981_d1f5), f64::from_bits(0x3ff5_0cf7_8182_21fb));
        let corners = [
            glam::DVec3::new(1.0, 0.0, -2.0),
            glam::DVec3::new(power(x, -523), -power(y, -523), -2.0),
            glam::DVec3::new(-power(p, -524), power(q, -524), -2.0),
        ];
        let quad = TriangleQuad::<f64>::new([(0, corners)].into_iter());
        let ray = Ray::<f64>::new(glam::DVec3::ZERO, glam::DVec3::new(0.0, 0.0, -1.0));
        let prepared = PreparedRay::new(&ray);
        assert!(crate::shape::triangle::intersect(&corners, &prepared, ray.tmax).is_some());
        assert_eq!(quad.candidates::<Everything>(&prepared), 1);
    }
}
