//! A bounding volume hierarchy in arrays that the caller owns.

mod bounds;
mod build;
mod crossings;
mod near;
mod node;
mod traverse;
mod walk;

pub use bounds::{Bounds, Slabs};
pub use build::{BuildItem, Structure, build};
pub use crossings::crossings;
pub(crate) use near::any_triangle_near;
pub use node::{Leaf, Node};
pub(crate) use traverse::search;
pub use traverse::{intersect, occluded};

use crate::error::CapacityError;
use crate::real::Real;
use crate::shape::{Geometry, SphereQuad};

/// The deepest a leaf can lie below the root (depth 0). The builder keeps to it, so traversal has a stack of this
/// size that cannot overflow.
pub const MAX_DEPTH: usize = 64;

/// How many nodes the hierarchy of `primitives` can need: every leaf holds at least one.
pub const fn required_nodes(primitives: usize) -> usize {
    match primitives {
        0 => 0,
        n => 2 * n - 1,
    }
}

/// A hierarchy over the primitives of one [`Geometry`], borrowed from the caller. Made by [`build`].
///
/// Spheres and triangles have a hierarchy each, side by side below the root.
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a, R: Real> {
    nodes: &'a [Node<R>],
    spheres: usize,
    sphere_quads: &'a [SphereQuad<R>],
    triangle_order: &'a [u32],
}

impl<'a, R: Real> Bvh<'a, R> {
    /// The nodes in use: the root first, children in neighbouring pairs.
    pub fn nodes(&self) -> &'a [Node<R>] {
        self.nodes
    }

    /// The spheres in the order of the leaves, in fours.
    pub fn sphere_quads(&self) -> &'a [SphereQuad<R>] {
        self.sphere_quads
    }

    /// The primitive numbers of the triangles in the order of the leaves.
    pub fn triangle_order(&self) -> &'a [u32] {
        self.triangle_order
    }

    /// How many spheres and triangles it was built for.
    pub fn built_for(&self) -> [usize; 2] {
        [self.spheres, self.triangle_order.len()]
    }

    /// Whether it can be a hierarchy of `geometry`: one over as many spheres and triangles.
    #[inline]
    pub fn fits(&self, geometry: &Geometry<'_, R>) -> bool {
        self.spheres == geometry.spheres().len() && self.triangle_order.len() == geometry.triangles().len()
    }
}

/// Slices of the caller's that a hierarchy is built in.
#[derive(Debug)]
pub struct BvhSlices<'a, R: Real> {
    /// [`Structure::required_nodes`].
    pub nodes: &'a mut [Node<R>],
    /// One per sphere is enough; most often a quarter of that is used.
    pub sphere_quads: &'a mut [SphereQuad<R>],
    /// One per triangle.
    pub triangle_order: &'a mut [u32],
}

/// Room for the hierarchy of up to `SPHERES` spheres and `TRIANGLES` triangles in `NODES` nodes, wherever the caller
/// puts it (a `static`, the stack, a box). [`required_nodes`] says how many nodes are enough.
#[derive(Clone, Debug)]
pub struct BvhStorage<R: Real, const NODES: usize, const SPHERES: usize, const TRIANGLES: usize> {
    nodes: [Node<R>; NODES],
    sphere_quads: [SphereQuad<R>; SPHERES],
    triangle_order: [u32; TRIANGLES],
}

impl<R: Real, const NODES: usize, const SPHERES: usize, const TRIANGLES: usize>
    BvhStorage<R, NODES, SPHERES, TRIANGLES>
{
    /// Room with nothing in it.
    pub const EMPTY: Self = Self {
        nodes: [Node::EMPTY; NODES],
        sphere_quads: [SphereQuad::EMPTY; SPHERES],
        triangle_order: [0; TRIANGLES],
    };

    /// Builds the hierarchy of `geometry` here. The scratch is needed only during the call.
    ///
    /// # Errors
    /// [`CapacityError`] where this storage or the scratch is too small; nothing was built then.
    pub fn build(
        &mut self,
        geometry: &Geometry<'_, R>,
        structure: Structure,
        scratch: &mut [BuildItem<R>],
    ) -> Result<Bvh<'_, R>, CapacityError> {
        let Self { nodes, sphere_quads, triangle_order } = self;
        build(geometry, structure, BvhSlices { nodes, sphere_quads, triangle_order }, scratch)
    }
}
