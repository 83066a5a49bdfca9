//! The triangles whose boxes meet a small box: who else is at a point of a surface.

use super::walk::Leaf;
use super::{Bounds, Bvh};
use crate::lanes::set_bits;
use crate::real::{Real, Vec3};
use crate::shape::Geometry;
use crate::shape::triangle::bounds;

/// Whether `is_it` holds for any triangle whose own box meets `place`: its primitive number and its corners. Those are
/// asked until one says yes, in an order that depends on the structure.
#[inline(always)]
pub(crate) fn any_triangle_near<R: Real>(
    geometry: &Geometry<'_, R>,
    bvh: Option<&Bvh<'_, R>>,
    place: &Bounds<R>,
    mut is_it: impl FnMut(u32, &[Vec3<R>; 3]) -> bool,
) -> bool {
    if geometry.triangles().is_empty() {
        return false;
    }
    let Some(bvh) = bvh.filter(|bvh| bvh.fits(geometry)) else {
        for primitive in geometry.spheres().len()..geometry.len() {
            if is_near(place, primitive as u32, &geometry.corners(primitive), &mut is_it) {
                return true;
            }
        }
        return false;
    };
    bvh.walk(
        #[inline(always)]
        |node| node.meeting(place),
        #[inline(always)]
        |leaf| {
            let Leaf::Triangles(quads) = leaf else { return false };
            // Loops, not `any`: the compiler may make a function of its own of that, for the baseline instruction set.
            for quad in quads {
                for lane in set_bits(quad.meeting(place)) {
                    let (primitive, corners) = quad.triangle(lane);
                    if is_near(place, primitive, &corners, &mut is_it) {
                        return true;
                    }
                }
            }
            false
        },
    )
}

/// Whether the triangle's own box meets `place`, and `is_it` holds for it.
#[inline(always)]
fn is_near<R: Real>(
    place: &Bounds<R>,
    primitive: u32,
    corners: &[Vec3<R>; 3],
    is_it: &mut impl FnMut(u32, &[Vec3<R>; 3]) -> bool,
) -> bool {
    bounds::<R>(corners).meets(place) && is_it(primitive, corners)
}
