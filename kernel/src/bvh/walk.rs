//! A walk over all leaves of a hierarchy that may matter, in no order of distance.

use super::node::decode;
use super::{Bvh, Child, MAX_DEPTH, Node, WIDTH};
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
        let Some(root) = self.nodes.first() else { return false };
        let (mut node, mut left) = (root, matter(root));
        // Most points have nothing near them: for those no stack is made.
        if left == 0 {
            return false;
        }
        let mut waiting = [(0u32, 0u32); MAX_DEPTH];
        let (mut number, mut top) = (0, 0);
        loop {
            while left == 0 {
                if top == 0 {
                    return false;
                }
                top -= 1;
                (number, left) = waiting[top];
                node = &self.nodes[number as usize];
            }
            let child = node.child(left.trailing_zeros() as usize % WIDTH);
            left &= left - 1;
            let seen = match decode(child, self.quads()) {
                // Lanes without a child may matter where all of space does; no child is the root.
                Child::Node(0) => false,
                Child::Node(next) => {
                    let below = matter(&self.nodes[next]);
                    if below != 0 {
                        waiting[top] = (number, left);
                        top += usize::from(left != 0);
                        (node, number, left) = (&self.nodes[next], next as u32, below);
                    }
                    false
                }
                Child::Spheres(quads) => see(Leaf::Spheres(&self.sphere_quads[quads])),
                Child::Triangles(quads) => see(Leaf::Triangles(&self.triangle_quads[quads])),
            };
            if seen {
                return true;
            }
        }
    }
}
