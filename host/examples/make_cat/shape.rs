//! Signed distances of simple shapes and the blends that join them: negative inside, positive outside,
//! in model units. Only `+ - * /` and square roots are used, so every machine gets the same bits.

use glam::DVec3;

/// Distance to a capsule that tapers from a ball (`a`, `radius_a`) to a ball (`b`, `radius_b`).
pub(crate) fn tapered_capsule(point: DVec3, (a, radius_a): (DVec3, f64), (b, radius_b): (DVec3, f64)) -> f64 {
    let axis = b - a;
    let length = libm::sqrt(axis.dot(axis));
    let from_a = point - a;
    let along = from_a.dot(axis) / length;
    let across = libm::sqrt((from_a.dot(from_a) - along * along).max(0.0));
    // The nearest ball of the family is not the one straight below the point but shifted towards the
    // thicker end, by the tangent of the cone's half angle.
    let sine = (radius_a - radius_b) / length;
    let tangent = sine / libm::sqrt((1.0 - sine * sine).max(1e-9));
    let station = ((along - across * tangent) / length).clamp(0.0, 1.0);
    let gap = from_a - axis * station;
    libm::sqrt(gap.dot(gap)) - (radius_a + (radius_b - radius_a) * station)
}

/// Approximate distance to an ellipsoid with its axes along x, y, z: exact on the surface, first order near it.
pub(crate) fn ellipsoid(point: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    let scaled = (point - centre) / radii;
    let slope = scaled / radii;
    let slope_length = libm::sqrt(slope.dot(slope));
    if slope_length == 0.0 {
        return -radii.min_element();
    }
    let size = libm::sqrt(scaled.dot(scaled));
    size * (size - 1.0) / slope_length
}

/// Union of two shapes with a fillet about `width` wide.
pub(crate) fn smooth_min(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0);
    a.min(b) - overlap * overlap / (4.0 * width)
}

/// Intersection of two shapes with an edge rounded over about `width`.
pub(crate) fn smooth_max(a: f64, b: f64, width: f64) -> f64 {
    -smooth_min(-a, -b, width)
}

/// `vector` scaled to length 1; it must not be zero.
pub(crate) fn unit(vector: DVec3) -> DVec3 {
    vector / libm::sqrt(vector.dot(vector))
}

/// A right-handed local frame; local x points along `forward`, local y as close to `up` as possible.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    origin: DVec3,
    axes: [DVec3; 3],
}

impl Frame {
    pub(crate) fn new(origin: DVec3, forward: DVec3, up: DVec3) -> Self {
        let x = unit(forward);
        let z = unit(x.cross(up));
        Self { origin, axes: [x, z.cross(x), z] }
    }

    pub(crate) fn to_local(self, point: DVec3) -> DVec3 {
        let offset = point - self.origin;
        DVec3::new(offset.dot(self.axes[0]), offset.dot(self.axes[1]), offset.dot(self.axes[2]))
    }

    pub(crate) fn to_model(self, local: DVec3) -> DVec3 {
        self.origin + self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tapered_capsule_touches_both_end_balls_and_the_common_tangent() {
        let (a, b) = ((DVec3::ZERO, 2.0), (DVec3::new(10.0, 0.0, 0.0), 1.0));
        assert!((tapered_capsule(DVec3::new(-5.0, 0.0, 0.0), a, b) - 3.0).abs() < 1e-12);
        assert!((tapered_capsule(DVec3::new(14.0, 0.0, 0.0), a, b) - 3.0).abs() < 1e-12);
        // A point on the cone: the tangent of both balls leaves the axis at the sine (2 - 1) / 10.
        let sine = 0.1;
        let normal = DVec3::new(sine, libm::sqrt(1.0 - sine * sine), 0.0);
        let middle = DVec3::new(5.0, 0.0, 0.0) + normal * 1.5;
        assert!(tapered_capsule(middle, a, b).abs() < 1e-12);
        assert!((tapered_capsule(middle + normal * 4.0, a, b) - 4.0).abs() < 1e-9);
    }

    #[test]
    fn an_ellipsoid_is_zero_on_its_surface_and_defined_at_its_centre() {
        let radii = DVec3::new(3.0, 2.0, 1.0);
        assert!(ellipsoid(DVec3::new(1.0, 4.0, 0.0), DVec3::new(1.0, 2.0, 0.0), radii).abs() < 1e-12);
        assert_eq!(ellipsoid(DVec3::ZERO, DVec3::ZERO, radii), -1.0);
    }

    #[test]
    fn blends_only_act_near_the_seam() {
        assert_eq!(smooth_min(1.0, 5.0, 2.0), 1.0);
        assert_eq!(smooth_min(1.0, 1.0, 2.0), 0.5);
        assert_eq!(smooth_max(1.0, 1.0, 2.0), 1.5);
    }

    #[test]
    fn a_frame_goes_there_and_back() {
        let frame = Frame::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 0.2, 0.3), DVec3::Y);
        let point = DVec3::new(-4.0, 5.0, 6.0);
        assert!((frame.to_model(frame.to_local(point)) - point).length() < 1e-12);
    }
}
