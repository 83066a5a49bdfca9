//! The sets of rays, made once per mesh with Ocellus and given to all.

use crate::mesh::{Mesh, along, cross, dot, mix, sub, uniform, unit};
use crate::peer::{Answer, Peer, Ray};

/// Names of the sets, in the order of the tables.
pub(crate) const NAMES: [&str; 4] = ["primary", "diffuse", "shuffled", "shadow"];

/// How far off the surface bounces start, in radii of the mesh. Peers without a lower end of t (parry3d) need it.
const OFFSET: f64 = 1e-4;
/// Sine and tangent of half the angle of view, 20 degrees.
const HALF_VIEW: [f64; 2] = [0.342_020_143_325_668_7, 0.363_970_234_266_202_4];
/// Where the camera is, seen from the middle of the mesh.
const CAMERA: [f64; 3] = [0.45, 0.35, 1.0];
/// Where the light is, seen from the middle of the mesh, in radii.
const LIGHT: [f64; 3] = [1.5, 2.5, 1.0];
/// The light's radius, in radii of the mesh.
const LIGHT_RADIUS: f64 = 0.5;

/// Rays of one kind.
pub(crate) struct Set {
    /// The rays.
    pub(crate) rays: Vec<Ray>,
    /// Whether any hit will do.
    pub(crate) any: bool,
}

/// Numbers that look random and are always the same.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(1);
        mix(self.0)
    }

    fn below(&mut self, end: usize) -> usize {
        (uniform(self.next()) * end as f64) as usize
    }

    /// A point in the unit ball, from corners of its cube tried until one is inside.
    fn in_ball(&mut self) -> [f64; 3] {
        loop {
            let point = [0; 3].map(|_| uniform(self.next()) * 2.0 - 1.0);
            let square = dot(point, point);
            if square <= 1.0 && square > 1e-12 {
                return point;
            }
        }
    }
}

/// A surface that a primary ray met.
struct Place {
    /// A little off the surface.
    p: [f64; 3],
    /// The unit normal on the camera's side.
    n: [f64; 3],
}

/// The four sets of `count` rays each; of primary rays the largest square number that is not more.
pub(crate) fn sets(mesh: &Mesh, tracer: &dyn Peer, count: usize) -> Result<[Set; NAMES.len()], String> {
    let primary = primary(mesh, count);
    let mut answers = vec![Answer::MISS; primary.len()];
    tracer.closest(&primary, &mut answers);
    let (center, radius) = mesh.bounding_sphere();
    let hits = primary.iter().zip(&answers).filter(|(_, answer)| answer.is_hit());
    let places: Vec<Place> = hits.map(|(ray, answer)| place(mesh, ray, answer, OFFSET * radius)).collect();
    // Renderers do not ask about lights behind the surface.
    let light = along(center, LIGHT, radius);
    let lit: Vec<&Place> = places.iter().filter(|place| dot(sub(light, place.p), place.n) > 0.0).collect();
    if lit.is_empty() {
        return Err(format!("{}: no primary ray hits a lit side", mesh.name));
    }

    let mut random = Random(1 << 32);
    let diffuse: Vec<Ray> = (0..count)
        .map(|i| {
            // Normal plus a point of the sphere around it: the cosine's own distribution.
            let place = &places[i * places.len() / count];
            let direction = unit(along(place.n, unit(random.in_ball()), 1.0));
            Ray::new(place.p, direction, f32::MAX)
        })
        .collect();
    let mut shuffled = diffuse.clone();
    for end in (1..count).rev() {
        shuffled.swap(end, random.below(end + 1));
    }
    let shadow = (0..count)
        .map(|i| {
            let place = lit[i * lit.len() / count];
            let toward = sub(along(light, unit(random.in_ball()), LIGHT_RADIUS * radius), place.p);
            Ray::new(place.p, unit(toward), dot(toward, toward).sqrt() as f32)
        })
        .collect();
    let closest = |rays| Set { rays, any: false };
    Ok([closest(primary), closest(diffuse), closest(shuffled), Set { rays: shadow, any: true }])
}

/// A pinhole camera that sees the whole mesh in a square picture, row by row.
fn primary(mesh: &Mesh, count: usize) -> Vec<Ray> {
    let (center, radius) = mesh.bounding_sphere();
    let back = unit(CAMERA);
    let [sine, tangent] = HALF_VIEW;
    let eye = along(center, back, radius / sine);
    let right = unit(cross([0.0, 1.0, 0.0], back));
    let up = cross(back, right);
    let side = count.isqrt();
    let at = |pixel: usize| ((2 * pixel + 1) as f64 / side as f64 - 1.0) * tangent;
    let ray = |x, y| {
        let direction = along(along(back.map(|b| -b), right, at(x)), up, -at(y));
        Ray::new(eye, unit(direction), f32::MAX)
    };
    (0..side * side).map(|pixel| ray(pixel % side, pixel / side)).collect()
}

fn place(mesh: &Mesh, ray: &Ray, answer: &Answer, offset: f64) -> Place {
    let [a, b, c] = mesh.corners(answer.primitive);
    let direction = ray.direction.map(f64::from);
    let normal = unit(cross(sub(b, a), sub(c, a)));
    let n = if dot(normal, direction) > 0.0 { normal.map(|x| -x) } else { normal };
    let p = along(ray.origin.map(f64::from), direction, f64::from(answer.t));
    Place { p: along(p, n, offset), n }
}

/// Rays from around the middle of a closed mesh, in turns at corners and at edges: all of them hit. The direction of
/// every other pair is the exact difference of two points, so that tests of edges are left with zeros; the rest have
/// length 1.
pub(crate) fn at_corners_and_edges(mesh: &Mesh, count: usize) -> Set {
    let mut random = Random(2 << 32);
    let ray = |i: usize| {
        let origin = random.in_ball().map(|x| (0.1 * x) as f32);
        let corners = mesh.triangles[random.below(mesh.triangles.len())].map(|corner| mesh.positions[corner as usize]);
        let share = uniform(random.next()) as f32;
        let [a, b, _] = corners;
        let target =
            [0, 1, 2].map(|axis| if i.is_multiple_of(2) { a[axis] } else { a[axis] + (b[axis] - a[axis]) * share });
        let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
        let direction = if i % 4 < 2 { direction } else { unit(direction.map(f64::from)).map(|x| x as f32) };
        Ray { origin, tnear: 0.0, direction, tfar: f32::MAX }
    };
    Set { rays: (0..count).map(ray).collect(), any: false }
}
