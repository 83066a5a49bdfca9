//! One ray against one sphere, triangle and box of any bits: no panic, and what is returned lies within the ray's ends.

use crate::numbers::{AnyRay, Float, Number, vector};
use arbitrary::{Arbitrary, Result, Unstructured};
use ocellus_kernel::bvh::{self, Bounds};
use ocellus_kernel::shape::{Geometry, PreparedRay, Sphere, triangle};
use ocellus_kernel::{Everything, Ray};

#[derive(Debug)]
struct Case {
    ray: AnyRay,
    center: [Number; 3],
    radius: Number,
    corners: [[Number; 3]; 3],
    bounds: [[Number; 3]; 2],
}

impl<'a> Arbitrary<'a> for Case {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        Ok(Self {
            ray: bytes.arbitrary()?,
            center: bytes.arbitrary()?,
            radius: bytes.arbitrary()?,
            corners: bytes.arbitrary()?,
            bounds: bytes.arbitrary()?,
        })
    }
}

/// Checks the ray and the shapes that `data` describes, in both precisions.
pub fn check(data: &[u8]) {
    // Bytes that run out are zeros, so there is always a case.
    let Ok(case) = Case::arbitrary(&mut Unstructured::new(data)) else { return };
    check_in::<f32>(&case);
    check_in::<f64>(&case);
}

fn check_in<R: Float>(case: &Case) {
    let corners = case.corners.map(vector::<R>);
    let sphere = Sphere { center: vector::<R>(case.center), radius: case.radius.real(), material: 0, inverted: false };
    let ray: Ray<R> = case.ray.ray(&[corners[0], corners[1], corners[2], sphere.center]);
    let prepared = PreparedRay::new(&ray);

    // A NaN fails each of these comparisons.
    let within = |t: R| t > ray.tmin && t <= ray.tmax;
    if let Some(t) = sphere.intersect(&prepared, ray.tmax) {
        assert!(within(t), "{t:?} of {ray:?} {sphere:?}");
    }
    if let Some((t, u, v)) = triangle::intersect(&corners, &prepared, ray.tmax) {
        assert!(within(t), "{t:?} of {ray:?} {corners:?}");
        // Weights of at most a rounding more than 1, unless the hit itself is out of range.
        let is_weight = |w: R| w >= R::ZERO && w <= R::ONE.next_up();
        let usable = ray.is_valid() && t.is_finite();
        assert!(!usable || (is_weight(u) && is_weight(v)), "{u:?} {v:?} of {ray:?} {corners:?}");
    }
    for bounds in [Bounds { corners: case.bounds.map(|corner| corner.map(Number::real)) }, triangle::bounds(&corners)] {
        if let Some(near) = bounds.entry(&prepared, ray.tmax) {
            assert!(near >= ray.tmin && near <= ray.tmax, "{near:?} of {ray:?} {bounds:?}");
        }
    }

    let spheres = [sphere];
    let triangles = [[0, 1, 2]];
    // Both, or the triangle alone where the sphere is none.
    let geometry = Geometry::new(&spheres, &corners, &triangles).or_else(|_| Geometry::new(&[], &corners, &triangles));
    let geometry = geometry.expect("a triangle may be anything");
    let hit = bvh::intersect::<R, Everything>(&geometry, None, &ray);
    assert_eq!(hit.is_some(), bvh::occluded::<R, Everything>(&geometry, None, &ray), "{ray:?}");
    if let Some(hit) = hit {
        assert!(ray.is_valid() && within(hit.t), "{hit:?} of {ray:?}");
    }
}
