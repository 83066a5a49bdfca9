//! The cat as a distance field: tapered capsules and ellipsoids, blended. It faces +x, y is up, the ground is
//! y = 0 and the cat's own right side is +z. Model units; the figure's scene scales them by 0.6.

use crate::shape::{Frame, ellipsoid, smooth_max, smooth_min, tapered_capsule, unit};
use glam::DVec3;

/// A ball of a limb: centre and radius.
type Joint = (DVec3, f64);

/// Box that holds the whole cat with room to spare: lowest and highest corner.
pub(crate) const BOUNDS: (DVec3, DVec3) = (DVec3::new(-37.0, -1.2, -9.0), DVec3::new(33.5, 48.0, 9.0));

/// Torso sections along the spine, as balls; they are squeezed sideways by [`TORSO_SQUEEZE`].
const TORSO: [(f64, f64, f64); 4] = [(11.8, 21.1, 6.8), (5.0, 21.4, 6.55), (-4.0, 22.0, 6.7), (-13.0, 22.5, 6.3)];
/// The body of a cat is deeper than it is wide.
const TORSO_SQUEEZE: f64 = 1.42;

/// Tail from root to tip: x, y and radius at the corners of a smooth curve.
const TAIL: [(f64, f64, f64); 5] =
    [(-16.0, 25.0, 2.6), (-22.5, 28.8, 2.0), (-27.2, 35.0, 1.5), (-30.4, 40.8, 1.2), (-33.6, 44.3, 0.85)];
/// Straight pieces that stand for the tail's curve.
const TAIL_PIECES: usize = 14;

/// The four legs, front ones first: side of the body (+1 is +z), and how far the paw stands in front of its usual place.
const STANCE: [(f64, f64); 4] = [(1.0, 0.0), (-1.0, 2.6), (1.0, 0.0), (-1.0, 2.8)];

/// What the surface at a point belongs to; the coat differs from part to part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    /// Skull, muzzle and ears.
    Head,
    /// Neck, chest, belly, back and the tops of the legs.
    Torso,
    /// A leg below the body.
    Leg,
    /// The tail.
    Tail,
}

struct Leg {
    joints: Vec<Joint>,
    /// How much the upper part is squeezed sideways, so that thigh and shoulder lie flat on the body.
    squeeze: f64,
    paw: DVec3,
}

impl Leg {
    fn front(side: f64, step: f64) -> Self {
        let joint = |x: f64, y: f64, z: f64| DVec3::new(x, y, side * z);
        let joints = vec![
            (joint(12.6 + 0.1 * step, 20.0, 3.0), 4.6),
            (joint(11.6 + 0.35 * step, 12.8, 3.1), 2.75),
            (joint(12.7 + 0.8 * step, 4.6, 2.7), 1.5),
            (joint(13.0 + step, 1.9, 2.7), 1.45),
        ];
        Self { joints, squeeze: 1.75, paw: joint(14.2 + step, 1.0, 2.75) }
    }

    fn hind(side: f64, step: f64) -> Self {
        let joint = |x: f64, y: f64, z: f64| DVec3::new(x, y, side * z);
        let joints = vec![
            (joint(-14.0 + 0.1 * step, 20.0, 2.9), 5.6),
            (joint(-12.8 + 0.3 * step, 12.4, 3.2), 3.5),
            (joint(-16.2 + 0.5 * step, 9.3, 3.0), 2.3),
            (joint(-18.0 + 0.7 * step, 6.9, 2.9), 1.75),
            (joint(-15.0 + step, 1.9, 2.8), 1.4),
        ];
        Self { joints, squeeze: 1.75, paw: joint(-12.9 + step, 1.0, 2.85) }
    }

    fn distance(&self, point: DVec3) -> f64 {
        let mut nearest = self.paw_distance(point);
        for (index, pair) in self.joints.windows(2).enumerate() {
            let piece = if index == 0 {
                let middle = pair[0].0.z;
                let squeezed = DVec3::new(point.x, point.y, middle + (point.z - middle) * self.squeeze);
                let low = (DVec3::new(pair[1].0.x, pair[1].0.y, middle), pair[1].1 * 1.15);
                tapered_capsule(squeezed, pair[0], low) / libm::sqrt(self.squeeze)
            } else {
                tapered_capsule(point, pair[0], pair[1])
            };
            nearest = smooth_min(nearest, piece, 1.0);
        }
        nearest
    }

    fn paw_distance(&self, point: DVec3) -> f64 {
        let pad = ellipsoid(point, self.paw, DVec3::new(2.3, 1.5, 1.75));
        let mut toes = f64::INFINITY;
        for (forward, sideways) in [(1.55, -1.05), (2.05, -0.38), (2.05, 0.38), (1.55, 1.05)] {
            let toe = self.paw + DVec3::new(forward, -0.35, sideways);
            toes = toes.min(ellipsoid(point, toe, DVec3::new(0.85, 0.85, 0.5)));
        }
        smooth_min(pad, toes, 0.55)
    }
}

/// The cat's shape; see the module.
pub(crate) struct Cat {
    legs: Vec<Leg>,
    tail: Vec<Joint>,
    head: Frame,
    ears: [Ear; 2],
}

/// An ear in the head's frame: a flattened cone with a hollow cut into its front.
struct Ear {
    frame: Frame,
}

/// Size of the unit that the head is described in.
const HEAD_SCALE: f64 = 1.12;

/// Height of an ear over its root.
const EAR_HEIGHT: f64 = 4.7;

impl Ear {
    fn new(side: f64) -> Self {
        // Local y runs from root to tip; local x is where the ear opens: forward and outward.
        let root = DVec3::new(-0.35, 2.1, side * 2.05);
        let tip_direction = DVec3::new(0.08, 1.0, side * 0.36);
        let opening = DVec3::new(1.0, 0.0, side * 0.55);
        let opening = opening - unit(tip_direction) * opening.dot(unit(tip_direction));
        Self { frame: Frame::new(root, opening, tip_direction) }
    }

    fn distance(&self, head_point: DVec3) -> f64 {
        let local = self.frame.to_local(head_point);
        // Squeezed front to back: an ear is a shell, not a horn.
        let squeezed = DVec3::new(local.x * 1.8, local.y, local.z);
        let cone = tapered_capsule(squeezed, (DVec3::ZERO, 2.35), (DVec3::new(0.0, EAR_HEIGHT, 0.0), 0.48)) / 1.4;
        smooth_max(cone, -self.hollow(head_point), 0.5)
    }

    fn hollow(&self, head_point: DVec3) -> f64 {
        let local = self.frame.to_local(head_point);
        let moved = DVec3::new((local.x - 1.05) * 1.5, local.y - 0.9, local.z);
        tapered_capsule(moved, (DVec3::ZERO, 1.75), (DVec3::new(0.0, EAR_HEIGHT - 1.6, 0.0), 0.12)) / 1.2
    }
}

impl Cat {
    pub(crate) fn new() -> Self {
        let [a, b, c, d] = STANCE;
        let legs = vec![Leg::front(a.0, a.1), Leg::front(b.0, b.1), Leg::hind(c.0, c.1), Leg::hind(d.0, d.1)];
        Self {
            legs,
            tail: tail_curve(),
            head: Frame::new(DVec3::new(24.4, 27.7, 0.0), DVec3::new(1.0, -0.1, 0.34), DVec3::Y),
            ears: [Ear::new(-1.0), Ear::new(1.0)],
        }
    }

    /// Signed distance from `point` to the cat, approximate but with the right sign and a usable gradient.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        let mut body = smooth_min(torso(point), self.neck(point), 3.0);
        for leg in &self.legs {
            body = smooth_min(body, leg.distance(point), 1.8);
        }
        body = smooth_min(body, self.tail_distance(point), 1.8);
        body = smooth_min(body, self.head_distance(point), 1.4);
        // The soles are flat: a standing cat touches the ground with more than four points.
        smooth_max(body, -point.y, 0.25)
    }

    /// Gradient of [`Cat::distance`] by central differences: not quite unit length.
    pub(crate) fn gradient(&self, point: DVec3) -> DVec3 {
        const STEP: f64 = 1e-4;
        let along = |axis: DVec3| self.distance(point + axis * STEP) - self.distance(point - axis * STEP);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)) / (2.0 * STEP)
    }

    /// The surface point that Newton steps from `point` lead to.
    pub(crate) fn project(&self, point: DVec3) -> DVec3 {
        let mut at = point;
        for _ in 0..4 {
            let gradient = self.gradient(at);
            let steepness = gradient.dot(gradient).max(1e-3);
            at -= gradient * (self.distance(at) / steepness).clamp(-0.3, 0.3);
        }
        at
    }

    /// `point` in the head's frame and unit: x to the nose, y to the crown, z to the cat's right.
    pub(crate) fn head_point(&self, point: DVec3) -> DVec3 {
        self.head.to_local(point) / HEAD_SCALE
    }

    /// Distance to the hollow of the nearer ear; small or negative on the skin inside the ear.
    pub(crate) fn ear_hollow(&self, point: DVec3) -> f64 {
        let local = self.head_point(point);
        self.ears[0].hollow(local).min(self.ears[1].hollow(local))
    }

    /// Where `point` is along the tail: 0 at the root, 1 at the tip.
    pub(crate) fn tail_station(&self, point: DVec3) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for (index, pair) in self.tail.windows(2).enumerate() {
            let axis = pair[1].0 - pair[0].0;
            let along = ((point - pair[0].0).dot(axis) / axis.dot(axis)).clamp(0.0, 1.0);
            let gap = point - pair[0].0 - axis * along;
            if gap.dot(gap) < best.0 {
                best = (gap.dot(gap), (index as f64 + along) / TAIL_PIECES as f64);
            }
        }
        best.1
    }

    /// The part of the cat nearest to `point`.
    pub(crate) fn part(&self, point: DVec3) -> Part {
        let leg = self.legs.iter().map(|leg| leg.distance(point)).fold(f64::INFINITY, f64::min);
        let torso = torso(point).min(self.neck(point));
        let mut best = (torso, Part::Torso);
        for candidate in
            [(leg, Part::Leg), (self.tail_distance(point), Part::Tail), (self.head_distance(point), Part::Head)]
        {
            if candidate.0 < best.0 {
                best = candidate;
            }
        }
        best.1
    }

    /// Distance from `point` to the nearest paw's centre.
    pub(crate) fn paw_gap(&self, point: DVec3) -> f64 {
        let gap = |leg: &Leg| {
            let offset = point - leg.paw;
            libm::sqrt(offset.dot(offset))
        };
        self.legs.iter().map(gap).fold(f64::INFINITY, f64::min)
    }

    fn neck(&self, point: DVec3) -> f64 {
        let nape = self.head.to_model(DVec3::new(-1.4, -0.6, 0.0));
        let squeezed = DVec3::new(point.x, point.y, point.z * 1.15);
        tapered_capsule(squeezed, (DVec3::new(13.6, 21.6, 0.0), 5.9), (nape, 3.7))
    }

    fn tail_distance(&self, point: DVec3) -> f64 {
        self.tail.windows(2).map(|pair| tapered_capsule(point, pair[0], pair[1])).fold(f64::INFINITY, f64::min)
    }

    fn head_distance(&self, point: DVec3) -> f64 {
        let local = self.head_point(point);
        // Both halves of the face are the same, up to the ears.
        let face = DVec3::new(local.x, local.y, local.z.abs());
        let mut head = ellipsoid(face, DVec3::ZERO, DVec3::new(4.2, 3.6, 3.75));
        let cheek = ellipsoid(face, DVec3::new(1.3, -1.5, 1.9), DVec3::new(2.1, 1.8, 2.0));
        head = smooth_min(head, cheek, 1.0);
        let bridge = tapered_capsule(face, (DVec3::new(2.6, 0.9, 0.0), 1.35), (DVec3::new(5.2, -0.75, 0.0), 0.55));
        head = smooth_min(head, bridge, 0.9);
        let chin = ellipsoid(face, DVec3::new(4.0, -2.55, 0.0), DVec3::new(1.15, 0.8, 1.0));
        head = smooth_min(head, chin, 0.6);
        let pad = ellipsoid(face, DVec3::new(4.55, -1.6, 0.72), DVec3::new(1.15, 0.95, 1.0));
        head = smooth_min(head, pad, 0.5);
        let eye = face - EYE;
        head = smooth_min(head, libm::sqrt(eye.dot(eye)) - EYE_RADIUS, 0.25);
        let ear = self.ears[0].distance(local).min(self.ears[1].distance(local));
        smooth_min(head, ear, 0.7) * HEAD_SCALE
    }
}

/// Centre of the cat's right eyeball in the head's frame; the left one is its mirror image in z.
pub(crate) const EYE: DVec3 = DVec3::new(2.85, 0.62, 1.72);
/// Radius of an eyeball.
pub(crate) const EYE_RADIUS: f64 = 1.12;

fn torso(point: DVec3) -> f64 {
    let squeezed = DVec3::new(point.x, point.y, point.z * TORSO_SQUEEZE);
    let ball = |(x, y, radius): (f64, f64, f64)| (DVec3::new(x, y, 0.0), radius);
    let pieces = TORSO.windows(2).map(|pair| tapered_capsule(squeezed, ball(pair[0]), ball(pair[1])));
    pieces.fold(f64::INFINITY, f64::min) / libm::sqrt(TORSO_SQUEEZE)
}

/// The tail's corners, smoothed: a uniform quadratic B-spline through the first and the last of them.
fn tail_curve() -> Vec<Joint> {
    let corner = |index: usize| {
        let (x, y, radius) = TAIL[index];
        (DVec3::new(x, y, 0.0), radius)
    };
    let between = |a: Joint, b: Joint, s: f64| (a.0 + (b.0 - a.0) * s, a.1 + (b.1 - a.1) * s);
    let spans = TAIL.len() - 2;
    let mut curve = Vec::with_capacity(TAIL_PIECES + 1);
    for step in 0..=TAIL_PIECES {
        let position = step as f64 / TAIL_PIECES as f64 * spans as f64;
        let span = (position as usize).min(spans - 1);
        let s = position - span as f64;
        let start = if span == 0 { corner(0) } else { between(corner(span), corner(span + 1), 0.5) };
        let end = if span == spans - 1 { corner(span + 2) } else { between(corner(span + 1), corner(span + 2), 0.5) };
        let bend = corner(span + 1);
        curve.push(between(between(start, bend, s), between(bend, end, s), s));
    }
    curve
}
