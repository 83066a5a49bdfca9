//! A walk over all leaves of a hierarchy that may matter, in no order of distance.

use super::node::decode;
use super::{Bvh, Child, MAX_WAITING, Node};
use crate::lanes::set_bits;
use crate::real::Real;
use crate::shape::{SphereQuad, TriangleQuad};

/// A leaf that a walk comes by.
pub(crate) enum Leaf<'a, R: Real> {
    Spheres(&'a [SphereQuad<R>]),
    Triangles(&'a [TriangleQuad<R>]),
}

impl<'a, R: Real> Bvh<'a, R> {
    /// Shows `see` the leaves below nodes whose children `matter` (a bit for each), until it says that it has seen
    /// enough. Whether it has.
    #[inline(always)]
    pub(crate) fn walk(&self, matter: impl Fn(&Node<R>) -> u32, mut see: impl FnMut(Leaf<'a, R>) -> bool) -> bool {
        let mut waiting = [0u32; MAX_WAITING];
        let mut top = 0;
        let Some(mut node) = self.nodes.first() else { return false };
        loop {
            // Lanes without a child may matter where all of space does; no child is the root.
            for child in set_bits(matter(node)).map(|lane| node.child(lane)).filter(|child| *child != 0) {
                waiting[top] = child;
                top += 1;
            }
            node = loop {
                if top == 0 {
                    return false;
                }
                top -= 1;
                let seen = match decode(waiting[top], self.quads()) {
                    Child::Node(next) => break &self.nodes[next],
                    Child::Spheres(quads) => see(Leaf::Spheres(&self.sphere_quads[quads])),
                    Child::Triangles(quads) => see(Leaf::Triangles(&self.triangle_quads[quads])),
                };
                if seen {
                    return true;
                }
            };
        }
    }
}
