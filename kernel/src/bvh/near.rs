//! The triangles whose boxes meet a small box: who else is at a point of a surface.

use super::{Bounds, Bvh, Leaf};
use crate::real::Real;
use crate::shape::Geometry;
use crate::shape::triangle::bounds;

/// Whether `is_it` holds for the index of any triangle (counted without the spheres) whose own box meets `place`. Those
/// are asked until one says yes, in an order that depends on the structure.
#[inline(always)]
pub(crate) fn any_triangle_near<R: Real>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    place: &Bounds<R>,
    mut is_it: impl FnMut(usize) -> bool,
) -> bool {
    if geometry.triangles().is_empty() {
        return false;
    }
    let mut is_near = |index: usize| bounds::<R>(&geometry.corners(index)).meets(place) && is_it(index);
    let Some(bvh) = bvh.filter(|bvh| bvh.fits(geometry)) else {
        return (0..geometry.triangles().len()).any(is_near);
    };
    let spheres = geometry.spheres().len();
    bvh.walk(
        |around| around.meets(place),
        |leaf| match leaf {
            Leaf::Triangles(range) => {
                bvh.triangle_order[range].iter().any(|&primitive| is_near(primitive as usize - spheres))
            }
            Leaf::Spheres(_) => false,
        },
    )
}
