//! What is asked of every peer.

use crate::isa::Isa;

/// The part `tnear..tfar` of a line.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    /// Where t = 0.
    pub(crate) origin: [f32; 3],
    /// Where t begins.
    pub(crate) tnear: f32,
    /// Of length 1, except for some of the rays that look for leaks.
    pub(crate) direction: [f32; 3],
    /// Where t ends.
    pub(crate) tfar: f32,
}

impl Ray {
    /// From `origin` on.
    pub(crate) fn new(origin: [f64; 3], direction: [f64; 3], tfar: f32) -> Self {
        Self { origin: origin.map(|x| x as f32), tnear: 0.0, direction: direction.map(|x| x as f32), tfar }
    }
}

/// What a peer says of a ray. Weights are left at zero by those that find a hit without them; of queries for any hit
/// only t counts, and only whether it is finite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// Where the hit is; infinite if there is none.
    pub(crate) t: f32,
    /// The weight of the second corner.
    pub(crate) u: f32,
    /// The weight of the third corner.
    pub(crate) v: f32,
    /// The triangle.
    pub(crate) primitive: u32,
}

impl Answer {
    /// No hit.
    pub(crate) const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: u32::MAX };

    /// Whether there is a hit.
    pub(crate) fn is_hit(&self) -> bool {
        self.t < f32::INFINITY
    }

    /// The answer to a query for any hit.
    pub(crate) fn any(hit: bool) -> Self {
        Self { t: if hit { 0.0 } else { f32::INFINITY }, ..Self::MISS }
    }
}

/// Someone who answers rays, one after the other on one thread.
pub(crate) trait Peer {
    /// The closest hit of each ray.
    fn closest(&self, rays: &[Ray], answers: &mut [Answer]);

    /// Whether each ray hits anything.
    fn any(&self, rays: &[Ray], answers: &mut [Answer]);
}

/// A peer with what it took to make it ready.
pub(crate) struct Row<'a> {
    /// The peer and its settings.
    pub(crate) name: &'static str,
    /// The instructions it may use.
    pub(crate) isa: Isa,
    /// Seconds from the arrays of the mesh to the first ray on one thread, and on two if it can use them.
    pub(crate) build_seconds: [Option<f64>; 2],
    /// What it keeps beside the mesh's own arrays, per triangle.
    pub(crate) bytes_per_triangle: f64,
    /// Who answers.
    pub(crate) peer: Box<dyn Peer + 'a>,
}

impl Row<'_> {
    /// Name and instructions, as `--only` looks for them.
    pub(crate) fn title(name: &str, isa: Isa) -> String {
        format!("{name} {isa}")
    }
}
