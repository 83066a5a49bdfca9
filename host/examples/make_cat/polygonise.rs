//! Marching tetrahedra: the zero set of a field as a closed triangle mesh.
//!
//! Six tetrahedra per grid cell leave no ambiguous case, so the mesh is a closed manifold whatever the field.
//! Its triangles are many and uneven; `simplify` makes them few and even.

use crate::mesh::Mesh;
use glam::DVec3;

/// Corners of the six tetrahedra of a cell, as bit masks (1 = +x, 2 = +y, 4 = +z), each positively oriented.
///
/// Each is a path from corner 0 to corner 7 along three axes; neighbouring cells cut their shared faces alike.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 5, 1, 7], [0, 3, 2, 7], [0, 6, 4, 7]];

/// Even permutations of a tetrahedron's corners that bring corner `i` to the front.
const ONE_FIRST: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];

/// Even permutations that bring each pair of corners to the front.
const PAIR_FIRST: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];

/// Cuts nearer to a grid point than this fraction of an edge are moved away from it: no two vertices coincide.
const CUT_MARGIN: f64 = 0.05;

/// Fields may change by this much per unit of length, at most.
const STEEPEST: f64 = 2.0;

/// Zero set of `field` inside the box from `low` to about `high`, on a grid of cubes with edge `spacing`.
///
/// The field must be positive on the faces of the box, else the mesh is open there.
pub(crate) fn polygonise(field: impl Fn(DVec3) -> f64, (low, high): (DVec3, DVec3), spacing: f64) -> Mesh {
    let cells = [high.x - low.x, high.y - low.y, high.z - low.z].map(|extent| (extent / spacing) as usize + 1);
    let stride = [1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)];
    let place = |x: usize, y: usize, z: usize| low + DVec3::new(x as f64, y as f64, z as f64) * spacing;
    let mut values = Vec::with_capacity(stride[2] * (cells[2] + 1));
    for z in 0..=cells[2] {
        for y in 0..=cells[1] {
            let row_end = values.len() + cells[0] + 1;
            while values.len() < row_end {
                let value = field(place(values.len() + cells[0] + 1 - row_end, y, z));
                // Within |value| / STEEPEST the sign cannot change, and only signs matter away from the surface.
                let alike = (value.abs() / (STEEPEST * spacing)) as usize;
                values.resize((values.len() + alike.max(1)).min(row_end), value);
            }
        }
    }

    let offset = |corner: usize| (corner & 1) * stride[0] + (corner >> 1 & 1) * stride[1] + (corner >> 2) * stride[2];
    let step =
        |corner: usize| DVec3::new((corner & 1) as f64, (corner >> 1 & 1) as f64, (corner >> 2) as f64) * spacing;
    // Vertex on the edge that leaves a grid point in one of seven directions (a mask, so 0 is unused).
    let mut vertex_of_edge = vec![u32::MAX; values.len() * 8];
    let mut mesh = Mesh { positions: Vec::new(), triangles: Vec::new() };
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                let origin = x * stride[0] + y * stride[1] + z * stride[2];
                let inside_count = (0..8).filter(|&corner| values[origin + offset(corner)] < 0.0).count();
                if inside_count == 0 || inside_count == 8 {
                    continue;
                }
                let cell = place(x, y, z);
                for tetrahedron in TETRAHEDRA {
                    let mut cut = |a: usize, b: usize| {
                        let (from, to) = (tetrahedron[a.min(b)], tetrahedron[a.max(b)]);
                        // Along a path each corner's mask contains the one before it, except where the
                        // orientation swapped the two middle corners.
                        let (from, to) = if from & to == from { (from, to) } else { (to, from) };
                        let key = (origin + offset(from)) * 8 + (from ^ to);
                        if vertex_of_edge[key] == u32::MAX {
                            let (start, end) = (values[origin + offset(from)], values[origin + offset(to)]);
                            let share = (start / (start - end)).clamp(CUT_MARGIN, 1.0 - CUT_MARGIN);
                            vertex_of_edge[key] = mesh.positions.len() as u32;
                            mesh.positions.push(cell + step(from) + step(from ^ to) * share);
                        }
                        vertex_of_edge[key]
                    };
                    let inside = tetrahedron.map(|corner| values[origin + offset(corner)] < 0.0);
                    match inside.iter().filter(|&&is_inside| is_inside).count() {
                        count @ (1 | 3) => {
                            let odd = inside.iter().position(|&is_inside| is_inside == (count == 1)).unwrap_or(0);
                            let [a, b, c, d] = ONE_FIRST[odd];
                            let (c, d) = if count == 1 { (c, d) } else { (d, c) };
                            mesh.triangles.push([cut(a, b), cut(a, c), cut(a, d)]);
                        }
                        2 => {
                            for [a, b, c, d] in PAIR_FIRST {
                                if inside[a] && inside[b] {
                                    let quad = [cut(a, c), cut(a, d), cut(b, d), cut(b, c)];
                                    mesh.triangles.push([quad[0], quad[1], quad[2]]);
                                    mesh.triangles.push([quad[0], quad[2], quad[3]]);
                                }
                            }
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tetrahedron_is_positively_oriented_and_they_fill_the_cell() {
        let corner = |mask: usize| DVec3::new((mask & 1) as f64, (mask >> 1 & 1) as f64, (mask >> 2) as f64);
        let mut volume = 0.0;
        for [a, b, c, d] in TETRAHEDRA {
            let sides = [b, c, d].map(|other| corner(other) - corner(a));
            let six_volumes = sides[0].cross(sides[1]).dot(sides[2]);
            assert_eq!(six_volumes, 1.0);
            volume += six_volumes / 6.0;
        }
        assert!((volume - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_ball_has_its_volume_and_is_closed() {
        let bounds = (DVec3::splat(-1.3), DVec3::splat(1.3));
        let mesh = polygonise(|point| libm::sqrt(point.dot(point)) - 1.0, bounds, 0.1);
        let volume: f64 = (0..mesh.triangles.len())
            .map(|triangle| {
                let [a, b, c] = mesh.corners(triangle);
                a.cross(b).dot(c) / 6.0
            })
            .sum();
        let exact = 4.0 / 3.0 * core::f64::consts::PI;
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume}");
        let own = |(triangle, sides): (usize, &[u32; 3])| sides.contains(&(triangle as u32));
        assert!(!mesh.neighbours().iter().enumerate().any(own));
    }
}
