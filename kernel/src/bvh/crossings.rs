//! All that a ray crosses, each surface exactly once.

use super::Bvh;
use super::walk::Leaf;
#[cfg(doc)]
use crate::accuracy::TriangleTest;
use crate::departure::Departure;
use crate::effects::EffectSet;
use crate::ray::{Hit, Ray};
use crate::real::Real;
use crate::shape::{Geometry, PreparedRay};

/// Shows `see` every crossing of the ray with a primitive in `tmin < t <= tmax`, in an order that depends on the
/// structure. From inside of a closed mesh of triangles that all have an area their number is odd, from outside it is
/// even.
///
/// A sphere is crossed where the ray enters it and where it leaves. A point on an edge or a corner belongs to just one
/// of the triangles that share it there, unlike in [`super::intersect`], where it belongs to each of them; so a ray that
/// lies in the plane of a triangle does not cross it. (Not in kernels of [`TriangleTest::Fast`], which knows no owner.)
/// Rays that are not valid ([`Ray::is_valid`]) cross nothing.
#[inline]
pub fn crossings<R: Real, E: EffectSet>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    ray: &Ray<R>,
    mut see: impl FnMut(Hit<R>),
) {
    if !ray.is_valid() {
        return;
    }
    let prepared = PreparedRay::new_in::<E, true>(ray, &Departure::exactly(ray.origin));
    let Some(bvh) = bvh.filter(|bvh| bvh.fits(geometry)) else {
        return (0..geometry.len() as u32).for_each(|index| geometry.cross::<E>(&prepared, ray.tmax, index, &mut see));
    };
    bvh.walk(
        |node| node.entries(&prepared.slabs, prepared.tmin, ray.tmax).1,
        |leaf| {
            let mut cross = |index| geometry.cross::<E>(&prepared, ray.tmax, index, &mut see);
            match leaf {
                Leaf::Triangles(quads) => {
                    quads.iter().flat_map(|quad| quad.triangles()).for_each(|(index, _)| cross(index));
                }
                Leaf::Spheres(quads) => quads.iter().flat_map(|quad| quad.distinct()).for_each(&mut cross),
            }
            false
        },
    );
}
