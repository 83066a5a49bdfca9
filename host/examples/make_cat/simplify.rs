//! Mesh simplification by edge collapse with quadric errors (Garland and Heckbert, "Surface simplification using
//! quadric error metrics", SIGGRAPH 1997), so that a small mesh spends its triangles on ears, paws and face.
//!
//! Collapses keep the mesh a closed manifold of the same genus: an edge may go only if its ends have exactly two
//! neighbours in common.

use crate::mesh::Mesh;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Weight of an edge's length (fourth power) against the squared distance times area of the quadrics: it keeps
/// flat regions from being covered by a few long slivers.
const LENGTH_WEIGHT: f64 = 2e-3;

/// Collapses that would give a vertex more neighbours than this are refused.
const MOST_NEIGHBOURS: usize = 9;

/// Collapses that would leave a triangle less even than this (1 = equilateral) are refused, unless the
/// surroundings were worse before.
const LEAST_QUALITY: f64 = 0.12;

/// Sum of squared distances to planes, weighted by area: the symmetric matrix `a`, vector `b` and constant `c` of
/// `p . a p + 2 b . p + c`.
#[derive(Clone, Copy, Default)]
struct Quadric {
    /// xx, xy, xz, yy, yz, zz.
    a: [f64; 6],
    b: DVec3,
    c: f64,
}

impl Quadric {
    fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let n = normal;
        let d = -n.dot(point);
        let a = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z].map(|entry| entry * weight);
        Self { a, b: n * (d * weight), c: d * d * weight }
    }

    fn plus(self, other: Self) -> Self {
        let mut a = self.a;
        for (entry, addend) in a.iter_mut().zip(other.a) {
            *entry += addend;
        }
        Self { a, b: self.b + other.b, c: self.c + other.c }
    }

    fn times(self, point: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        DVec3::new(
            xx * point.x + xy * point.y + xz * point.z,
            xy * point.x + yy * point.y + yz * point.z,
            xz * point.x + yz * point.y + zz * point.z,
        )
    }

    fn error(self, point: DVec3) -> f64 {
        (point.dot(self.times(point)) + 2.0 * self.b.dot(point) + self.c).max(0.0)
    }

    /// The point of least error, if the planes are spread enough to fix one.
    fn minimum(self) -> Option<DVec3> {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let rows = [DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz)];
        let determinant = rows[0].dot(rows[1].cross(rows[2]));
        let trace = xx + yy + zz;
        if determinant <= 1e-4 * trace * trace * trace {
            return None;
        }
        let right = -self.b;
        let columns = rows[1].cross(rows[2]) * right.x + rows[2].cross(rows[0]) * right.y;
        Some((columns + rows[0].cross(rows[1]) * right.z) / determinant)
    }
}

/// An edge that may be collapsed, as it was when it was put into the queue.
struct Candidate {
    cost: f64,
    ends: [u32; 2],
    versions: [u32; 2],
    target: DVec3,
}

impl Ord for Candidate {
    /// The cheapest is the greatest, as the heap gives the greatest first; vertex numbers break ties.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.ends.cmp(&self.ends))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

struct Simplifier {
    positions: Vec<DVec3>,
    quadrics: Vec<Quadric>,
    versions: Vec<u32>,
    /// Vertices with an edge that was refused: it may be fine after a change next to it.
    waiting: Vec<bool>,
    triangles: Vec<[u32; 3]>,
    alive: Vec<bool>,
    /// Triangles around each vertex.
    fans: Vec<Vec<u32>>,
    queue: BinaryHeap<Candidate>,
}

/// Collapses edges of `mesh`, cheapest first, until `target` triangles are left or nothing more can go.
///
/// `detail` says how much an error matters at a place (1 = as usual).
pub(crate) fn simplify(mesh: Mesh, target: usize, detail: impl Fn(DVec3) -> f64) -> Mesh {
    let mut work = Simplifier::new(mesh, detail);
    let mut left = work.triangles.len();
    while left > target {
        let Some(candidate) = work.queue.pop() else { break };
        if !work.is_current(&candidate) {
            continue;
        }
        if work.collapse(&candidate) {
            left -= 2;
        } else {
            for vertex in candidate.ends {
                work.waiting[vertex as usize] = true;
            }
        }
    }
    work.finish()
}

impl Simplifier {
    fn new(mesh: Mesh, detail: impl Fn(DVec3) -> f64) -> Self {
        let count = mesh.positions.len();
        let mut quadrics = vec![Quadric::default(); count];
        let mut fans = vec![Vec::new(); count];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let normal = mesh.area_normal(index);
            let length = libm::sqrt(normal.dot(normal));
            let corner = mesh.positions[triangle[0] as usize];
            let weight = length * detail(corner);
            for &vertex in triangle {
                fans[vertex as usize].push(index as u32);
                if length > 0.0 {
                    let plane = Quadric::plane(normal / length, corner, weight);
                    quadrics[vertex as usize] = quadrics[vertex as usize].plus(plane);
                }
            }
        }
        let mut work = Self {
            positions: mesh.positions,
            quadrics,
            versions: vec![0; count],
            waiting: vec![false; count],
            alive: vec![true; mesh.triangles.len()],
            triangles: mesh.triangles,
            fans,
            queue: BinaryHeap::new(),
        };
        for vertex in 0..count as u32 {
            for other in work.ring(vertex) {
                if vertex < other {
                    work.enqueue(vertex, other);
                }
            }
        }
        work
    }

    /// Vertices joined to `vertex` by an edge, in rising order.
    fn ring(&self, vertex: u32) -> Vec<u32> {
        let fan = &self.fans[vertex as usize];
        let mut ring: Vec<u32> = fan.iter().flat_map(|&triangle| self.triangles[triangle as usize]).collect();
        ring.sort_unstable();
        ring.dedup();
        ring.retain(|&other| other != vertex);
        ring
    }

    fn enqueue(&mut self, a: u32, b: u32) {
        let ends = [a.min(b), a.max(b)];
        let [start, end] = ends.map(|vertex| self.positions[vertex as usize]);
        let quadric = self.quadrics[a as usize].plus(self.quadrics[b as usize]);
        let middle = (start + end) * 0.5;
        let edge = end - start;
        let squared_length = edge.dot(edge);
        let near = |point: &DVec3| (*point - middle).dot(*point - middle) < squared_length;
        let target = quadric.minimum().filter(near).unwrap_or(middle);
        let cost = quadric.error(target) + LENGTH_WEIGHT * squared_length * squared_length;
        let versions = ends.map(|vertex| self.versions[vertex as usize]);
        self.queue.push(Candidate { cost, ends, versions, target });
    }

    fn is_current(&self, candidate: &Candidate) -> bool {
        candidate.ends.map(|vertex| self.versions[vertex as usize]) == candidate.versions
    }

    /// Merges the candidate's ends at its target if the mesh stays a manifold without folds.
    fn collapse(&mut self, candidate: &Candidate) -> bool {
        let [keep, drop] = candidate.ends;
        let (ring, other_ring) = (self.ring(keep), self.ring(drop));
        let common = ring.iter().filter(|vertex| other_ring.binary_search(vertex).is_ok()).count();
        let merged = ring.len() + other_ring.len() - 4;
        if common != 2 || !(3..=MOST_NEIGHBOURS).contains(&merged) || !self.stays_even(candidate) {
            return false;
        }
        let moved = std::mem::take(&mut self.fans[drop as usize]);
        for triangle in moved {
            let corners = self.triangles[triangle as usize];
            if corners.contains(&keep) {
                self.alive[triangle as usize] = false;
                for vertex in corners {
                    self.fans[vertex as usize].retain(|&other| other != triangle);
                }
            } else {
                self.triangles[triangle as usize] = corners.map(|vertex| if vertex == drop { keep } else { vertex });
                self.fans[keep as usize].push(triangle);
            }
        }
        self.positions[keep as usize] = candidate.target;
        self.quadrics[keep as usize] = self.quadrics[keep as usize].plus(self.quadrics[drop as usize]);
        // A dropped vertex gets a new version too, so that its queued edges are no longer current.
        self.versions[keep as usize] += 1;
        self.versions[drop as usize] += 1;
        self.waiting[keep as usize] = false;
        for other in self.ring(keep) {
            self.enqueue(keep, other);
        }
        for vertex in self.ring(keep) {
            if std::mem::replace(&mut self.waiting[vertex as usize], false) {
                self.versions[vertex as usize] += 1;
                for other in self.ring(vertex) {
                    self.enqueue(vertex, other);
                }
            }
        }
        true
    }

    /// Whether no triangle around the edge turns over or becomes a sliver when its ends move to the target.
    fn stays_even(&self, candidate: &Candidate) -> bool {
        let [keep, drop] = candidate.ends;
        let (mut worst_before, mut worst_after) = (f64::INFINITY, f64::INFINITY);
        for end in candidate.ends {
            for &triangle in &self.fans[end as usize] {
                let corners = self.triangles[triangle as usize];
                let before = corners.map(|vertex| self.positions[vertex as usize]);
                worst_before = worst_before.min(quality(before));
                if corners.contains(&keep) && corners.contains(&drop) {
                    continue;
                }
                let index = corners.iter().position(|&vertex| vertex == end).unwrap_or(0);
                let mut after = before;
                after[index] = candidate.target;
                worst_after = worst_after.min(quality(after));
                let (old, new) = (normal(before), normal(after));
                let lengths = libm::sqrt(old.dot(old) * new.dot(new));
                // Tiny slivers of the raw mesh have no direction worth keeping.
                if quality(before) > 0.02 && old.dot(new) < 0.3 * lengths {
                    return false;
                }
            }
        }
        worst_after > LEAST_QUALITY.min(worst_before)
    }

    /// The mesh that is left, vertices renumbered in their old order.
    fn finish(self) -> Mesh {
        let mut number = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        for (vertex, fan) in self.fans.iter().enumerate() {
            if !fan.is_empty() {
                number[vertex] = positions.len() as u32;
                positions.push(self.positions[vertex]);
            }
        }
        let kept = self.triangles.iter().zip(&self.alive).filter(|&(_, &alive)| alive);
        let triangles = kept.map(|(corners, _)| corners.map(|vertex| number[vertex as usize])).collect();
        Mesh { positions, triangles }
    }
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// 1 for an equilateral triangle, 0 for a degenerate one.
fn quality(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let sides = [b - a, c - b, a - c].map(|side| side.dot(side));
    let sum = sides[0] + sides[1] + sides[2];
    let twice_area = normal(corners);
    if sum > 0.0 { 2.0 * 1.732_050_807_568_877_2 * libm::sqrt(twice_area.dot(twice_area)) / sum } else { 0.0 }
}
