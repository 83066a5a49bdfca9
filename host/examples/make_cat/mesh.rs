//! The bare triangle mesh that the steps hand to one another.

use glam::DVec3;

/// Closed triangle mesh; triangles are counter-clockwise seen from outside.
pub(crate) struct Mesh {
    /// Vertex positions in model units.
    pub(crate) positions: Vec<DVec3>,
    /// Three vertex indices per triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Normal of a triangle, as long as twice its area.
    pub(crate) fn area_normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Moves each vertex part of the way towards the mean of its neighbours, but only along the surface, whose normal
    /// (of any length) `normal` gives.
    pub(crate) fn relax(&mut self, normal: impl Fn(DVec3) -> DVec3) {
        const SHARE: f64 = 0.4;
        let mut sums = vec![(DVec3::ZERO, 0.0); self.positions.len()];
        for corners in &self.triangles {
            // In a closed mesh each edge leaves its start in one triangle only, so each neighbour counts once.
            for side in 0..3 {
                let sum = &mut sums[corners[side] as usize];
                sum.0 += self.positions[corners[(side + 1) % 3] as usize];
                sum.1 += 1.0;
            }
        }
        for (position, (sum, count)) in self.positions.iter_mut().zip(sums) {
            let across = normal(*position);
            let pull = (sum / count - *position) * SHARE;
            *position += pull - across * (pull.dot(across) / across.dot(across).max(f64::MIN_POSITIVE));
        }
    }

    /// For each triangle its neighbour over each side (side `i` runs from corner `i` to the next one).
    ///
    /// The mesh must be closed; a side without a partner is its own neighbour.
    pub(crate) fn neighbours(&self) -> Vec<[u32; 3]> {
        let mut sides = Vec::with_capacity(self.triangles.len() * 3);
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for side in 0..3 {
                let (a, b) = (corners[side], corners[(side + 1) % 3]);
                sides.push((a.min(b), a.max(b), triangle as u32, side));
            }
        }
        sides.sort_unstable();
        let mut neighbours: Vec<[u32; 3]> = (0..self.triangles.len() as u32).map(|own| [own; 3]).collect();
        for pair in sides.windows(2) {
            if (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1) {
                neighbours[pair[0].2 as usize][pair[0].3] = pair[1].2;
                neighbours[pair[1].2 as usize][pair[1].3] = pair[0].2;
            }
        }
        neighbours
    }
}
