//! Meshes in f64, to be rounded to the precision under test.

use std::collections::HashMap;

use super::random::Random;

/// Positions and counter-clockwise triangles.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Every position sent through `place`.
    pub(crate) fn map(mut self, place: impl FnMut([f64; 3]) -> [f64; 3]) -> Self {
        self.positions = self.positions.into_iter().map(place).collect();
        self
    }

    /// Facing the other way.
    pub(crate) fn inside_out(mut self) -> Self {
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self
    }
}

/// A sphere of radius 1: an icosahedron, each face cut in four `levels` times.
pub(crate) fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let unit = |p: [f64; 3]| {
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| x / length)
    };
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(-1.0, -g), (-1.0, g), (1.0, -g), (1.0, g)] {
        positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(unit));
    }
    // The faces are the triples of neighbours, turned to face outward.
    let near = |a: usize, b: usize, positions: &[[f64; 3]]| {
        let dot: f64 = (0..3).map(|i| positions[a][i] * positions[b][i]).sum();
        a != b && dot > 0.4
    };
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b, &positions) && near(b, c, &positions) && near(a, c, &positions) {
                    let [p, q, r] = [a, b, c].map(|i| positions[i]);
                    let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    triangles.push(if volume > 0.0 { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::with_capacity(triangles.len() * 4);
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let sum = std::array::from_fn(|k| positions[i as usize][k] + positions[j as usize][k]);
                    positions.push(unit(sum));
                    positions.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Mesh { positions, triangles }
}

/// The cube -1..1, each face a grid of `n` by `n` squares of two triangles; corners and edges are shared.
pub(crate) fn cube(n: u32) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let mut known = HashMap::new();
    for (axis, end) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 0), (axis, n)]) {
        let mut corner = |i: u32, j: u32| {
            let mut at = [0; 3];
            at[axis] = end;
            at[(axis + 1) % 3] = i;
            at[(axis + 2) % 3] = j;
            *known.entry(at).or_insert_with(|| {
                positions.push(at.map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0));
                positions.len() as u32 - 1
            })
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.extend(if end == n { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    Mesh { positions, triangles }
}

/// A square in the plane y = 0 with its front up, `2 half` wide.
pub(crate) fn floor(half: f64) -> Mesh {
    let positions = vec![[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]];
    Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

/// Triangles of all sizes without any order, and among them the ones that break hierarchies: copies, flat ones that
/// share a plane, ones without area, and ones with a corner that is not a number.
pub(crate) fn soup(random: &mut Random, count: usize) -> Mesh {
    let mut mesh = Mesh { positions: Vec::new(), triangles: Vec::new() };
    for _ in 0..count {
        let center = random.in_cube();
        let size = libm::exp(random.between(-5.0, 0.0));
        let mut corners: [[f64; 3]; 3] = std::array::from_fn(|_| {
            let offset = random.in_cube();
            std::array::from_fn(|i| center[i] + size * offset[i])
        });
        match random.below(8) {
            0 if !mesh.triangles.is_empty() => {
                let earlier = mesh.triangles[random.below(mesh.triangles.len())];
                corners = earlier.map(|corner| mesh.positions[corner as usize]);
            }
            1 => corners.iter_mut().for_each(|corner| corner[1] = 0.25),
            2 => corners[2] = corners[random.below(2)],
            3 => corners[random.below(3)][random.below(3)] = f64::NAN,
            4 => corners = corners.map(|corner| corner.map(|x| (x * 4.0).round() / 4.0)),
            _ => {}
        }
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}
