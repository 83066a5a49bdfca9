//! Texture coordinates: the surface is cut into charts that face one of the six axis directions, each chart is
//! projected flat along its direction, and the charts are packed into the unit square. v points up.

use crate::mesh::Mesh;
use crate::pack::{Chart, pack};
use crate::raster::for_each_cell;
use glam::DVec3;

/// Texture coordinates and, for each triangle, which of them its corners use.
pub(crate) struct Unwrapping {
    pub(crate) coordinates: Vec<[f64; 2]>,
    pub(crate) corners: Vec<[u32; 3]>,
}

/// Directions charts may face: outward normal, then the axes that become u and v (right-handed, so that nothing
/// is mirrored).
const DIRECTIONS: [(DVec3, DVec3, DVec3); 6] = [
    (DVec3::Z, DVec3::X, DVec3::Y),
    (DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y),
    (DVec3::X, DVec3::NEG_Z, DVec3::Y),
    (DVec3::NEG_X, DVec3::Z, DVec3::Y),
    (DVec3::Y, DVec3::X, DVec3::NEG_Z),
    (DVec3::NEG_Y, DVec3::X, DVec3::Z),
];

/// Directions that get more than their share of the surface: a body's flanks, where the coat is easiest to read, and
/// the front of a head, so that no seam runs through an eye.
const FLANK_BONUS: [f64; 6] = [0.15, 0.15, 0.0, 0.0, 0.0, 0.0];
const FACE_BONUS: [f64; 6] = [0.0, 0.0, 0.25, 0.0, 0.0, 0.0];

/// A triangle joins its neighbours' chart only if it faces that chart's direction at least this much.
const LEAST_FACING: f64 = 0.2;

/// Charts smaller than this, in square model units, are given to their neighbours where possible.
const SMALL_CHART: f64 = 6.0;

/// Cell of the grid on which charts are checked for triangles that hide each other, in the chart's unit.
const OVERLAP_CELL: f64 = 0.12;

/// A triangle's class: a direction, plus this many if it is on the head, plus twice this many for each layer of its
/// chart that lies below it.
const CLASSES: usize = DIRECTIONS.len();

/// Texture density of the head relative to the body: faces are looked at.
const HEAD_DENSITY: f64 = 2.0;

/// Cuts, flattens and packs; `is_head` says which places get the finer texture.
pub(crate) fn unwrap(mesh: &Mesh, is_head: impl Fn(DVec3) -> bool) -> Unwrapping {
    let neighbours = mesh.neighbours();
    let mut classes = classify(mesh, &neighbours, is_head);
    let mut members = components(&neighbours, &classes).1;
    while separate_layers(mesh, &members, &mut classes) {
        members = components(&neighbours, &classes).1;
    }
    let charts: Vec<Chart> = members
        .iter()
        .map(|triangles| Chart {
            triangles: triangles.iter().map(|&triangle| flat(mesh, triangle, classes[triangle])).collect(),
        })
        .collect();
    let placed = pack(&charts);

    // One coordinate for each vertex of each chart: vertices on a seam have several.
    let mut unwrapping = Unwrapping { coordinates: Vec::new(), corners: vec![[0; 3]; mesh.triangles.len()] };
    let mut coordinate_of = vec![(u32::MAX, 0); mesh.positions.len()];
    for (label, triangles) in members.iter().enumerate() {
        for (index, &triangle) in triangles.iter().enumerate() {
            for corner in 0..3 {
                let known = &mut coordinate_of[mesh.triangles[triangle][corner] as usize];
                if known.0 != label as u32 {
                    *known = (label as u32, unwrapping.coordinates.len() as u32);
                    unwrapping.coordinates.push(placed[label].place(charts[label].triangles[index][corner]));
                }
                unwrapping.corners[triangle][corner] = known.1;
            }
        }
    }
    unwrapping
}

/// Corners of a triangle in its chart's plane and unit.
fn flat(mesh: &Mesh, triangle: usize, class: usize) -> [[f64; 2]; 3] {
    let (_, right, up) = DIRECTIONS[class % CLASSES];
    let density = if (class / CLASSES).is_multiple_of(2) { 1.0 } else { HEAD_DENSITY };
    mesh.corners(triangle).map(|corner| [corner.dot(right) * density, corner.dot(up) * density])
}

/// Moves triangles that would cover others of their chart (an ear in front of the other, say) to a layer of their
/// own; returns whether there were any.
fn separate_layers(mesh: &Mesh, members: &[Vec<usize>], classes: &mut [usize]) -> bool {
    let mut found = false;
    for triangles in members {
        let corners: Vec<_> = triangles.iter().map(|&triangle| flat(mesh, triangle, classes[triangle])).collect();
        let extreme = |axis: usize, pick: fn(f64, f64) -> f64| {
            corners.iter().flatten().map(|corner| corner[axis]).reduce(pick).unwrap_or(0.0)
        };
        let low = [extreme(0, f64::min), extreme(1, f64::min)];
        let size = [0, 1].map(|axis| ((extreme(axis, f64::max) - low[axis]) / OVERLAP_CELL) as usize + 2);
        let mut taken = vec![false; size[0] * size[1]];
        for (&triangle, corners) in triangles.iter().zip(&corners) {
            let in_cells = corners.map(|[x, y]| [(x - low[0]) / OVERLAP_CELL, (y - low[1]) / OVERLAP_CELL]);
            let mut is_free = true;
            // Cells on a shared side belong to both triangles and prove nothing.
            let is_inner = |weights: [f64; 3]| weights.iter().all(|&weight| weight > 1e-6);
            for_each_cell(in_cells, size, |column, row, weights| {
                is_free &= !(is_inner(weights) && taken[row * size[0] + column]);
            });
            if is_free {
                for_each_cell(in_cells, size, |column, row, weights| {
                    taken[row * size[0] + column] |= is_inner(weights);
                });
            } else {
                classes[triangle] += 2 * CLASSES;
                found = true;
            }
        }
    }
    found
}

/// The class of each triangle, before layers.
fn classify(mesh: &Mesh, neighbours: &[[u32; 3]], is_head: impl Fn(DVec3) -> bool) -> Vec<usize> {
    let normals: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|triangle| {
            let normal = mesh.area_normal(triangle);
            normal / libm::sqrt(normal.dot(normal)).max(f64::MIN_POSITIVE)
        })
        .collect();
    let facing = |triangle: usize, class: usize| normals[triangle].dot(DIRECTIONS[class % CLASSES].0);
    let mut classes = Vec::with_capacity(mesh.triangles.len());
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        let (bonus, first) = if is_head((a + b + c) / 3.0) { (FACE_BONUS, CLASSES) } else { (FLANK_BONUS, 0) };
        let score = |class: usize| facing(triangle, class) + bonus[class];
        let best = (0..CLASSES).fold(0, |best, class| if score(class) > score(best) { class } else { best });
        classes.push(first + best);
    }

    // Straighten the seams: a triangle with two neighbours of one other class joins them.
    for _ in 0..6 {
        for triangle in 0..classes.len() {
            let around = neighbours[triangle].map(|other| classes[other as usize]);
            for (one, other) in [(0, 1), (1, 2), (2, 0)] {
                if around[one] == around[other] && facing(triangle, around[one]) > LEAST_FACING {
                    classes[triangle] = around[one];
                }
            }
        }
    }
    // Give small charts away, triangle by triangle from their border inwards.
    for _ in 0..12 {
        let (labels, members) = components(neighbours, &classes);
        let mut areas = vec![0.0; members.len()];
        for (triangle, &label) in labels.iter().enumerate() {
            let normal = mesh.area_normal(triangle);
            areas[label as usize] += 0.5 * libm::sqrt(normal.dot(normal));
        }
        let before = classes.clone();
        for triangle in 0..classes.len() {
            let area = areas[labels[triangle] as usize];
            let mut best = LEAST_FACING;
            for other in neighbours[triangle].map(|other| other as usize) {
                let class = before[other];
                let is_larger = areas[labels[other] as usize] > area;
                if area < SMALL_CHART && is_larger && facing(triangle, class) > best {
                    best = facing(triangle, class);
                    classes[triangle] = class;
                }
            }
        }
    }
    classes
}

/// Connected regions of one class: the region of each triangle, and the triangles of each region in the order a walk
/// from neighbour to neighbour reaches them.
fn components(neighbours: &[[u32; 3]], classes: &[usize]) -> (Vec<u32>, Vec<Vec<usize>>) {
    let mut labels = vec![u32::MAX; classes.len()];
    let mut members = Vec::new();
    for start in 0..classes.len() {
        if labels[start] != u32::MAX {
            continue;
        }
        let label = members.len() as u32;
        labels[start] = label;
        let mut region = vec![start];
        let mut next = 0;
        while next < region.len() {
            for other in neighbours[region[next]].map(|other| other as usize) {
                if labels[other] == u32::MAX && classes[other] == classes[start] {
                    labels[other] = label;
                    region.push(other);
                }
            }
            next += 1;
        }
        members.push(region);
    }
    (labels, members)
}
