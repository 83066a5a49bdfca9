//! A bounding volume hierarchy in arrays that the caller owns.

mod bounds;
mod build;
mod node;
mod traverse;

pub use bounds::{Bounds, Slabs};
pub use build::{BuildItem, Structure, build};
pub use node::Node;
pub use traverse::{intersect, occluded};

use crate::error::CapacityError;
use crate::real::Real;
use crate::shape::Geometry;

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
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a, R: Real> {
    nodes: &'a [Node<R>],
    order: &'a [u32],
}

impl<'a, R: Real> Bvh<'a, R> {
    /// The nodes in use: the root first, children in neighbouring pairs.
    pub fn nodes(&self) -> &'a [Node<R>] {
        self.nodes
    }

    /// The primitive numbers in the order of the leaves.
    pub fn order(&self) -> &'a [u32] {
        self.order
    }
}

/// Room for the hierarchy of up to `PRIMS` primitives in `NODES` nodes, wherever the caller puts it (a `static`,
/// the stack, a box). [`required_nodes`] says how many nodes are enough.
#[derive(Clone, Debug)]
pub struct BvhStorage<R: Real, const NODES: usize, const PRIMS: usize> {
    nodes: [Node<R>; NODES],
    order: [u32; PRIMS],
}

impl<R: Real, const NODES: usize, const PRIMS: usize> BvhStorage<R, NODES, PRIMS> {
    /// Room with nothing in it.
    pub const EMPTY: Self = Self { nodes: [Node::EMPTY; NODES], order: [0; PRIMS] };

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
        build(geometry, structure, &mut self.nodes, &mut self.order, scratch)
    }
}
