//! Rays at spheres, triangles and meshes that are hard to get right, and what the right answer is.

use ocellus_kernel::Ray;
use ocellus_kernel::real::{Real, Vec3, Vector, vec3_from_f64};
use ocellus_kernel::robust::normalize;

use super::exact::{Exact, ExactVec, exact, root, roughly, to_f64};
use super::meshes::{Mesh, cube, icosphere};
use super::random::Random;
use super::tolerance::{self, u};

/// `10^x` with x uniform.
pub(crate) fn magnitude(random: &mut Random, low: f64, high: f64) -> f64 {
    libm::exp10(random.between(low, high))
}

/// A ray of any length of direction at a sphere: far, grazing, tiny, huge, from inside, from hardly inside or outside.
pub(crate) fn sphere_case(random: &mut Random, unit: f64) -> (usize, [f64; 3], f64, [f64; 3], [f64; 3]) {
    let radius = magnitude(random, -4.0, 5.0);
    let place = random.below(6);
    let distance = radius
        * match place {
            0 => magnitude(random, 2.0, 6.0),
            1 => random.between(1.1, 4.0),
            2 => random.between(0.0, 0.9),
            3 => 1.0 - magnitude(random, libm::log10(40.0 * unit), -2.0),
            4 => 1.0 + magnitude(random, libm::log10(40.0 * unit), -2.0),
            _ => 1.0 + magnitude(random, -4.0, 0.0),
        };
    let center = random.in_cube().map(|x| x * radius * 3.0 * random.below(2) as f64);
    let [away, across] = [random.on_sphere(), random.on_sphere()];
    // Impact parameter: anything, or grazing from within and without.
    let graze = random.below(3);
    let impact = match graze {
        0 => random.between(0.0, 1.5),
        1 => 1.0 - magnitude(random, -6.0, -2.0),
        _ => 1.001,
    };
    let along = (0..3).map(|i| away[i] * across[i]).sum::<f64>();
    let origin = std::array::from_fn(|i| center[i] + away[i] * distance);
    let target: [f64; 3] = std::array::from_fn(|i| center[i] + (across[i] - along * away[i]) * radius * impact);
    // Away from the middle, too.
    let sign = if random.below(4) == 0 { -1.0 } else { 1.0 };
    let length = sign * magnitude(random, -6.0, 6.0) / distance;
    // N19 starts inside or on the surface, N17 grazes, N16 is far away; all the rest is small or large, N18.
    let class = match (place, graze) {
        (2..=4, _) => 3,
        (_, 1 | 2) => 1,
        (0, _) => 0,
        _ => 2,
    };
    (class, center, radius, origin, std::array::from_fn(|i| (target[i] - origin[i]) * length))
}

/// What exact arithmetic says of a ray and a sphere.
pub(crate) struct SphereTruth {
    /// The nearest t, if there is one.
    pub(crate) t: Option<f64>,
    /// By how much the problem magnifies an error of its input, times t: u times this is what to expect.
    pub(crate) condition: f64,
}

/// `None` where the answer changes if the input moves by a few roundings.
pub(crate) fn sphere_truth<R: Real>(center: Vec3<R>, radius: R, ray: &Ray<R>) -> Option<SphereTruth> {
    let [c, o, d] = [center, ray.origin, ray.direction].map(ExactVec::new::<R>);
    let r = exact(radius.to_f64());
    let to_center = &c - &o;
    let square = d.dot(&d);
    let t_foot = to_center.dot(&d) / &square;
    let foot = (&to_center - &(&d * &t_foot)).length();
    let half = root(&((&r - &foot) * (&r + &foot) / &square));
    let [far, near] = [&t_foot + &half, &t_foot - &half].map(|t| to_f64(&t));
    let [distance, r, l, h, length] =
        [&to_center.length(), &r, &foot, &(&half * root(&square)), &root(&square)].map(to_f64);
    let margin = tolerance::UNDECIDED * u::<R>() * (distance + r);
    if (l - r).abs() <= margin || (distance - r).abs() <= margin {
        return None;
    }
    let t = if l > r || far <= 0.0 { None } else { Some(if near > 0.0 { near } else { far }) };
    // The root nearer to the origin is what a small difference of distances leaves over.
    let of = t.unwrap_or(0.0);
    let cancelled = if of <= near.abs().min(far.abs()) { distance / (distance - r).abs() } else { 0.0 };
    Some(SphereTruth { t, condition: of * (1.0 + cancelled) + distance * l / (h * length) })
}

/// One of the hard classes of triangles, with a ray at or beside it.
pub(crate) fn triangle_case(random: &mut Random) -> ([[f64; 3]; 3], [f64; 3], [f64; 3]) {
    let mut corners: [[f64; 3]; 3] = std::array::from_fn(|_| random.in_cube());
    let mut distance = random.between(0.5, 3.0);
    let mut shift = [0.0; 3];
    match random.below(8) {
        0 => {}
        1 => distance = magnitude(random, 2.0, 5.0),
        2 => shift = random.in_cube().map(|x| x * 1e4),
        // A sliver.
        3 => {
            let offset = random.in_cube();
            corners[2] = std::array::from_fn(|i| 0.5 * (corners[0][i] + corners[1][i]) + 1e-4 * offset[i]);
        }
        // Almost in a plane of the axes.
        4 => corners.iter_mut().for_each(|corner| corner[2] *= 1e-6),
        5 => corners = corners.map(|corner| corner.map(|x| x * 1e-6)),
        6 => {
            let scale = magnitude(random, -8.0, 8.0);
            corners = corners.map(|corner| corner.map(|x| x * scale));
            distance *= scale;
        }
        _ => corners = corners.map(|corner| corner.map(|x| (x * 2.0).round() * 0.5)),
    }
    corners = corners.map(|corner| std::array::from_fn(|i| corner[i] + shift[i]));
    let weights = random.barycentric().map(|w| if random.below(8) == 0 { -0.1 * w } else { w });
    let target: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| corners[k][i] * weights[k]).sum());
    let away = random.on_sphere();
    let origin = std::array::from_fn(|i| target[i] + away[i] * distance);
    let length = magnitude(random, -6.0, 6.0);
    (corners, origin, std::array::from_fn(|i| (target[i] - origin[i]) * length))
}

/// What exact arithmetic says of a ray and a triangle.
pub(crate) struct TriangleTruth {
    /// How far inside of all edges the line passes, in u M; negative outside.
    pub(crate) inside: f64,
    /// Whether the plane lies behind the origin.
    pub(crate) behind: bool,
    /// One u M: the largest coordinate times the unit roundoff.
    unit: f64,
    t: Exact,
    /// The direction's share of the normal, relative to the normal's length.
    steepness: Exact,
}

impl TriangleTruth {
    /// How far from the plane the ray is at `t`, in u M.
    pub(crate) fn error<R: Real>(&self, t: R) -> f64 {
        roughly(&((exact(t.to_f64()) - &self.t) * &self.steepness)).abs() / self.unit
    }

    /// A length in u M.
    pub(crate) fn in_units(&self, length: &Exact) -> f64 {
        roughly(length) / self.unit
    }
}

/// `None` for a triangle without area, and a ray in its plane.
pub(crate) fn triangle_truth<R: Real>(corners: &[Vec3<R>; 3], ray: &Ray<R>) -> Option<TriangleTruth> {
    let [a, b, c] = corners.map(ExactVec::new::<R>);
    let (o, d) = (ExactVec::new::<R>(ray.origin), ExactVec::new::<R>(ray.direction));
    let n = (&b - &a).cross(&(&c - &a));
    let steep = d.dot(&n);
    if n.length() == exact(0.0) || steep == exact(0.0) {
        return None;
    }
    let largest = corners.iter().chain([&ray.origin]).map(|p| p.abs().max_component().to_f64()).fold(0.0, f64::max);
    let unit = u::<R>() * largest;
    let t = (&a - &o).dot(&n) / &steep;
    // Signed distance of the ray's line from each edge's line, positive inside.
    let edges = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| {
        let edge = q - p;
        let common = d.cross(&edge);
        let moment = (p - &o).dot(&common);
        let distance = roughly(&(moment / common.length()));
        if steep > exact(0.0) { -distance } else { distance }
    });
    let inside = edges.into_iter().fold(f64::INFINITY, f64::min) / unit;
    let steepness = &steep / n.length();
    Some(TriangleTruth { inside, behind: t <= exact(0.0), unit, t, steepness })
}

/// The name of a closed mesh so small that products of its coordinates are zero in f32.
pub(crate) const VANISHING: &str = "1e-25 in size";

/// Meshes whose neighbourhood of the centre stays inside whatever the rounding of their corners.
pub(crate) fn closed_meshes() -> Vec<(&'static str, Mesh, [f64; 3], f64)> {
    let jitter = || {
        let mut random = Random::new(14);
        icosphere(3).map(move |p| {
            let radius = random.between(1.0, 6.0);
            p.map(|x| x * radius)
        })
    };
    let placed =
        |mesh: Mesh, center: [f64; 3], radius: f64| mesh.map(|p| std::array::from_fn(|i| center[i] + radius * p[i]));
    let origin = [0.0; 3];
    // Where Embree's own test of this kind puts its sphere.
    let embree = [148_376.0, 1234.0, -223_423.0];
    vec![
        ("plain", icosphere(3), origin, 0.5),
        ("jittered", jitter(), origin, 0.5),
        ("at Embree's place", placed(icosphere(3), embree, 2.0), embree, 1.0),
        ("at 1e4", placed(jitter(), [1e4, -1e4, 1e4], 1.0), [1e4, -1e4, 1e4], 0.5),
        ("1e-4 in size", placed(jitter(), origin, 1e-4), origin, 0.5e-4),
        ("1e-12 in size", placed(jitter(), origin, 1e-12), origin, 0.5e-12),
        (VANISHING, placed(jitter(), origin, 1e-25), origin, 0.5e-25),
        ("100 in size at 1e6", placed(jitter(), [1e6, -1e6, 1e6], 100.0), [1e6, -1e6, 1e6], 50.0),
        ("1e6 in size", placed(jitter(), origin, 1e6), origin, 0.5e6),
        ("needles", icosphere(3).map(|[x, y, z]| [x, 1e-3 * y, 1e3 * z]), origin, 0.5e-3),
    ]
}

/// By `i`, in turn: a corner of a triangle, a point of an edge, one of its face.
pub(crate) fn place_of_triangle<R: Real>(random: &mut Random, i: u32, [a, b, c]: [Vec3<R>; 3]) -> Vec3<R> {
    let w = random.barycentric().map(R::from_f64);
    match i % 3 {
        0 => a,
        1 => a + (b - a) * w[0],
        _ => a * w[0] + b * w[1] + c * w[2],
    }
}

/// Ray number `i` from near the middle of such a mesh at a corner, an edge or a face, every other one normalized.
pub(crate) fn ray_at_mesh<R: Real>(
    random: &mut Random,
    i: u32,
    center: [f64; 3],
    radius: f64,
    corners: impl FnOnce(usize) -> [Vec3<R>; 3],
    triangles: usize,
) -> Ray<R> {
    let origin = random.in_cube();
    let origin = vec3_from_f64::<R>(std::array::from_fn(|k| center[k] + 0.5 * radius * origin[k]));
    let of = corners(random.below(triangles));
    let direction = place_of_triangle::<R>(random, i, of) - origin;
    Ray::new(origin, if i.is_multiple_of(2) { normalize::<R>(direction) } else { direction })
}

/// A closed box of any size anywhere, so thin that it is 64 to a million ulps of its largest coordinate thick, but no
/// thicker than wide. Each face is a grid of `n` by `n` squares.
pub(crate) fn flat_box<R: Real>(random: &mut Random, n: u32) -> Mesh {
    let size = magnitude(random, -4.0, 6.0);
    let far = if random.below(2) == 0 { 0.0 } else { size * magnitude(random, 0.0, 5.0) };
    let center = random.in_cube().map(|x| x * far);
    let largest = R::from_f64(center.iter().map(|x| x.abs()).fold(0.0, f64::max) + size);
    let ulp = (largest.next_up() - largest).to_f64();
    // Each side may be rounded towards the other by half an ulp.
    let thickness = (65.0 * magnitude(random, 0.0, 4.2) * ulp).min(2.0 * size);
    let axis = random.below(3);
    let half: [f64; 3] = std::array::from_fn(|i| if i == axis { 0.5 * thickness } else { size });
    let mesh = cube(n).map(|p| std::array::from_fn(|i| center[i] + half[i] * p[i]));
    let along = mesh.positions.iter().map(|p| R::from_f64(p[axis]).to_f64());
    let (low, high) = along.fold((f64::INFINITY, -f64::INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    assert!(high - low >= 64.0 * ulp, "{} ulps", (high - low) / ulp);
    mesh
}

/// A ray in any direction from the middle half of the box around all `positions`.
pub(crate) fn ray_in_box<R: Real>(random: &mut Random, positions: &[Vec3<R>]) -> Ray<R> {
    let end = |pick: fn(f64, f64) -> f64| -> [f64; 3] {
        let corners = positions.iter().map(|p| p.to_array().map(Real::to_f64));
        corners.reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i]))).expect("a position")
    };
    let (low, high) = (end(f64::min), end(f64::max));
    let origin = std::array::from_fn(|i| low[i] + (high[i] - low[i]) * random.between(0.25, 0.75));
    Ray::new(vec3_from_f64::<R>(origin), normalize::<R>(vec3_from_f64::<R>(random.on_sphere())))
}

/// Triangle number `case` of a size, half of them flat.
pub(crate) fn box_triangle<R: Real>(random: &mut Random, case: u32, scale: f64) -> [Vec3<R>; 3] {
    let mut corners: [[f64; 3]; 3] = std::array::from_fn(|_| random.in_cube().map(|x| x * scale));
    if case.is_multiple_of(2) {
        let axis = random.below(3);
        corners.iter_mut().for_each(|corner| corner[axis] = scale * 0.3);
    }
    corners.map(vec3_from_f64::<R>)
}

/// A ray at a corner or an edge of it, where its box may end.
pub(crate) fn ray_at_box<R: Real>(random: &mut Random, case: u32, scale: f64, [a, b, _]: &[Vec3<R>; 3]) -> Ray<R> {
    let origin = vec3_from_f64::<R>(random.in_cube().map(|x| x * scale * 10.0));
    let weight = R::from_f64(random.unit());
    let target = if case.is_multiple_of(3) { *a } else { *a + (*b - *a) * weight };
    Ray::new(origin, target - origin)
}

/// Such a triangle of any size and a ray at it.
pub(crate) fn box_case<R: Real>(random: &mut Random, case: u32) -> ([Vec3<R>; 3], Ray<R>) {
    let scale = magnitude(random, -3.0, 5.0);
    let corners = box_triangle::<R>(random, case, scale);
    (corners, ray_at_box::<R>(random, case, scale, &corners))
}
