//! Triangles: a watertight test (Woop, Benthin, Wald, JCGT 2:1, 2013) whose edge signs are exact.
//!
//! Edges shared by two triangles are computed from the same two sheared corners, so both see the same number; its
//! sign is that of the exact difference, because the products are formed in the wide precision. No ray that crosses
//! a closed mesh can pass between its triangles.

use super::PreparedRay;
use crate::accuracy::TriangleTest;
use crate::bvh::Bounds;
use crate::effects::{EffectSet, Everything};
use crate::lanes::Numbers;
use crate::real::{Real, Vec3, Vector, WideVec3, greater, widen};
use crate::robust::triangle_padding;

/// What a triangle has beside its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleAttributes {
    /// Vertex normals, by index; `None` for a flat triangle.
    pub normals: Option<[u32; 3]>,
    /// Texture coordinates, by index.
    pub uvs: Option<[u32; 3]>,
    /// Index of its material.
    pub material: u32,
}

/// The shear that takes a ray's direction to +z, with its axes permuted so that z is the largest.
#[derive(Clone, Copy, Debug)]
pub struct Shear<R: Real> {
    /// The axis along which the direction is longest.
    longest: Axis,
    pub(super) x: R,
    pub(super) y: R,
    pub(super) z: R,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
}

/// The components of `v` in the order (next, next but one, `longest`).
#[inline]
fn permute<R: Real>(v: Vec3<R>, longest: Axis) -> [R; 3] {
    match longest {
        Axis::X => [v.y(), v.z(), v.x()],
        Axis::Y => [v.z(), v.x(), v.y()],
        Axis::Z => [v.x(), v.y(), v.z()],
    }
}

impl<R: Real> Shear<R> {
    /// Stands where no triangle will be tested.
    pub(super) const NONE: Self = Self { longest: Axis::Z, x: R::ZERO, y: R::ZERO, z: R::ZERO };

    /// The shear of a direction, of which `inverse` holds one over each component.
    #[inline(always)]
    pub(super) fn new(direction: Vec3<R>, inverse: [R; 3]) -> Self {
        let size = direction.abs();
        let longest = if size.x() > size.y() {
            if size.x() > size.z() { Axis::X } else { Axis::Z }
        } else if size.y() > size.z() {
            Axis::Y
        } else {
            Axis::Z
        };
        let [x, y, z] = permute::<R>(direction, longest);
        Self { longest, x: x / z, y: y / z, z: inverse[longest as usize] }
    }

    /// The numbers of the axes in the order of [`permute`].
    #[inline(always)]
    pub(super) fn axes(&self) -> [usize; 3] {
        match self.longest {
            Axis::X => [1, 2, 0],
            Axis::Y => [2, 0, 1],
            Axis::Z => [0, 1, 2],
        }
    }
}

/// The box of a triangle, larger by [`triangle_padding`].
#[inline]
pub fn bounds<R: Real>(corners: &[Vec3<R>; 3]) -> Bounds<R> {
    let mut bounds = Bounds::EMPTY;
    for corner in corners {
        bounds.grow(*corner);
    }
    let [low, high] = bounds.corners;
    let extent = (0..3).fold(R::ZERO, |longest, axis| greater(longest, high[axis] - low[axis]));
    let padding = triangle_padding::<R>(extent);
    // Not where a corner is infinite, or so far off that the extent is.
    if padding.is_finite() {
        bounds.corners = [low.map(|low| low - padding), high.map(|high| high + padding)];
    }
    bounds
}

/// `(t, u, v)` in `tmin < t <= tmax`, with u and v the weights of the second and third corner.
///
/// Both sides count, edges and corners count. Triangles without area and with NaN corners do not.
#[inline]
pub fn intersect<R: Real>(corners: &[Vec3<R>; 3], ray: &PreparedRay<R>, tmax: R) -> Option<(R, R, R)> {
    test::<R, Everything, false>(corners, ray, tmax)
}

/// [`intersect`] as accurately as a kernel asks. With `ONCE`, in kernels of watertight triangles, each point of an edge or
/// a corner belongs to one of the triangles that share it.
#[inline(always)]
pub(super) fn test<R: Real, E: EffectSet, const ONCE: bool>(
    corners: &[Vec3<R>; 3],
    ray: &PreparedRay<R>,
    tmax: R,
) -> Option<(R, R, R)> {
    let origin = Vec3::<R>::from_array(ray.origin);
    let [t, u, v] = match const { E::ACCURACY.triangle } {
        TriangleTest::Fast => {
            let found = moller_trumbore(corners.map(Vector::to_array), ray.origin, ray.direction, R::ONE);
            is_inside(found[1], found[2]).then_some(found)?
        }
        TriangleTest::Narrow => {
            let to_corners = corners.map(|corner| corner - origin);
            woop::<ONCE, R, R>(to_corners, &ray.shear, rounded_difference, |x| x)?
        }
        TriangleTest::Watertight => {
            let to_corners = corners.map(|corner| corner - origin);
            woop::<ONCE, R, R::Wide>(to_corners, &ray.shear, R::difference_of_products, R::widen)?.map(R::narrow)
        }
        TriangleTest::Wide => {
            let to_corners = corners.map(|corner| widen::<R>(corner) - ray.wide_origin);
            woop::<ONCE, R::Wide, R::Wide>(to_corners, &ray.wide_shear, R::Wide::difference_of_products, |x| x)?
                .map(R::narrow)
        }
    };
    if !(t > ray.tmin && t <= tmax) {
        return None;
    }
    // The shear rounds each corner, so three that lie on one line may seem to span an area. They have no normal.
    let has_area =
        const { matches!(E::ACCURACY.triangle, TriangleTest::Fast) } || normal::<R>(corners) != WideVec3::<R>::ZERO;
    has_area.then_some((t, u, v))
}

/// `[t, u, v]` of a ray from whose origin the corners are given, by edges and sums in the precision of `edge` and
/// `wider`.
#[inline(always)]
fn woop<const ONCE: bool, C: Real, W: Real>(
    to_corners: [Vec3<C>; 3],
    shear: &Shear<C>,
    edge: impl Fn(C, C, C, C) -> W,
    wider: impl Fn(C) -> W,
) -> Option<[W; 3]> {
    // Each sheared corner depends on that corner and the ray alone.
    let [a, b, c] = to_corners.map(|corner| sheared(permute::<C>(corner, shear.longest), shear.x, shear.y));
    let u = edge(c[0], b[1], c[1], b[0]);
    let v = edge(a[0], c[1], a[1], c[0]);
    let w = edge(b[0], a[1], b[1], a[0]);
    let zero = W::ZERO;
    // Written so that a NaN fails both.
    if !((u >= zero && v >= zero && w >= zero) || (u <= zero && v <= zero && w <= zero)) {
        return None;
    }
    let determinant = u + v + w;
    if determinant == zero {
        return None;
    }
    let loop_of_edges = [(u, c, b), (v, a, c), (w, b, a)];
    if ONCE && !loop_of_edges.into_iter().all(|(value, from, to)| value != zero || owns(from, to, determinant > zero)) {
        return None;
    }
    let depth = u * wider(a[2]) + v * wider(b[2]) + w * wider(c[2]);
    // Behind the origin, and tmin is 0 or more: as t would say, but without the division. Rays that leave a mesh find it
    // there most often.
    if (depth < zero) ^ (shear.z < C::ZERO) ^ (determinant < zero) {
        return None;
    }
    let inverse = W::ONE / determinant;
    Some([depth * inverse * wider(shear.z), v * inverse, w * inverse])
}

/// Whether a triangle owns the points of its edge: of two that share it, and go along it in opposite directions or have
/// opposite signs, one does. As if the ray were moved aside by `(-e, -e^2)` for an infinitely small `e`, so that it
/// meets no edge and no corner.
#[inline(always)]
fn owns<C: Real>(from: [C; 3], to: [C; 3], positive: bool) -> bool {
    let (from, to) = if positive { (from, to) } else { (to, from) };
    to[1] > from[1] || (to[1] == from[1] && to[0] < from[0])
}

/// A corner, seen from the ray's origin and with its axes permuted, after the shear. Of one triangle or of several.
#[inline(always)]
pub(super) fn sheared<T: Numbers>([x, y, z]: [T; 3], shear_x: T, shear_y: T) -> [T; 3] {
    [x - shear_x * z, y - shear_y * z, z]
}

/// `a b - c d` with the roundings of both products.
#[inline(always)]
pub(super) fn rounded_difference<R: Real>(a: R, b: R, c: R, d: R) -> R {
    a * b - c * d
}

/// `[t, u, v]` of the line and the plane of a triangle, or of several.
#[inline(always)]
pub(super) fn moller_trumbore<T: Numbers>([a, b, c]: [[T; 3]; 3], origin: [T; 3], d: [T; 3], one: T) -> [T; 3] {
    let less = |p: [T; 3], q: [T; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: [T; 3], q: [T; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let cross =
        |p: [T; 3], q: [T; 3]| [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let (ab, ac, from_a) = (less(b, a), less(c, a), less(origin, a));
    let (p, q) = (cross(d, ac), cross(from_a, ab));
    let inverse = one / dot(ab, p);
    [dot(ac, q) * inverse, dot(from_a, p) * inverse, dot(d, q) * inverse]
}

/// Whether these are weights of a point of the triangle; not where one is NaN.
#[inline(always)]
pub(super) fn is_inside<R: Real>(u: R, v: R) -> bool {
    (u >= R::ZERO) & (v >= R::ZERO) & (u + v <= R::ONE)
}

/// A normal to the front, as long as twice the area; zero where there is none. In the wide precision, which needles
/// need.
#[inline]
pub(crate) fn normal<R: Real>(corners: &[Vec3<R>; 3]) -> WideVec3<R> {
    let [a, b, c] = corners.map(widen::<R>);
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3 as V;

    const CORNERS: [V; 3] = [V::new(0.0, 0.0, -4.0), V::new(2.0, 0.0, -4.0), V::new(0.0, 2.0, -4.0)];

    fn hit(corners: &[V; 3], origin: V, direction: V) -> Option<(f32, f32, f32)> {
        let ray = Ray::<f32>::new(origin, direction);
        intersect(corners, &PreparedRay::new(&ray), ray.tmax)
    }

    #[test]
    fn weights_belong_to_second_and_third_corner() {
        let found = hit(&CORNERS, V::new(0.5, 0.25, 0.0), V::new(0.0, 0.0, -2.0));
        assert_eq!(found, Some((2.0, 0.25, 0.125)));
        let back = hit(&CORNERS, V::new(0.5, 0.25, -8.0), V::new(0.0, 0.0, 1.0));
        assert_eq!(back, Some((4.0, 0.25, 0.125)));
    }

    #[test]
    fn corners_and_edges_are_inside() {
        for target in [CORNERS[0], CORNERS[1], CORNERS[2], (CORNERS[0] + CORNERS[1]) * 0.5] {
            assert!(hit(&CORNERS, V::ZERO, target).is_some(), "{target}");
        }
    }

    #[test]
    fn degenerate_triangles_are_never_hit() {
        let line = [CORNERS[0], CORNERS[1], (CORNERS[0] + CORNERS[1]) * 0.5];
        assert_eq!(hit(&line, V::ZERO, CORNERS[1]), None);
        assert_eq!(hit(&[CORNERS[0]; 3], V::ZERO, CORNERS[0]), None);
        // BadCases of pbrt-v4, shapes_test.cpp: two coordinates are the same at all corners.
        let upright = [-79.049614, -87.09227, -79.209015].map(|y| V::new(-1113.4546, y, -56.24319));
        let origin = V::new(-1081.4792, 99.999954, 87.77011);
        assert_eq!(hit(&upright, origin, V::new(-32.1073, -183.35587, -144.60764)), None);
        let nan = [CORNERS[0], CORNERS[1], V::new(f32::NAN, 2.0, -4.0)];
        assert_eq!(hit(&nan, V::new(0.5, 0.25, 0.0), V::new(0.0, 0.0, -1.0)), None);
    }
}
