//! A bounding volume hierarchy in arrays that the caller owns: nodes of eight children, leaves of triangles and of
//! spheres in fours.

mod bounds;
mod build;
mod crossings;
mod extent;
mod grow;
mod near;
mod node;
mod split;
mod traverse;
mod walk;

pub use bounds::{Bounds, Slabs};
pub use build::{InTurn, Join, Plan, Structure, build, plan};
pub use crossings::crossings;
pub use extent::BuildItem;
pub(crate) use near::any_triangle_near;
pub use node::{Branch, Child, Node, WIDTH};
pub(crate) use traverse::{TrianglesBelow, search};
pub use traverse::{intersect, occluded};

use crate::effects::EffectSet;
use crate::error::CapacityError;
use crate::real::Real;
use crate::shape::{Geometry, SphereQuad, TriangleQuad};

/// How many nodes lie one below the other at most. The builder keeps to it, so traversal has a stack that cannot
/// overflow.
pub const MAX_DEPTH: usize = 16;

/// How many children can wait at once: all but one of each node from the root down, and all of the last.
const MAX_WAITING: usize = (WIDTH - 1) * MAX_DEPTH + 1;

/// How many nodes the hierarchy of `primitives` can need: each but the root is there for five or more, and a node has
/// eight children, or else only leaves.
pub const fn required_nodes(primitives: usize) -> usize {
    match primitives {
        0 => 0,
        1..=8 => 1,
        n => (n - 1) / 4,
    }
}

/// A hierarchy over the primitives of one [`Geometry`], borrowed from the caller. Made by [`build`].
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a, R: Real> {
    nodes: &'a [Node<R>],
    sphere_quads: &'a [SphereQuad<R>],
    triangle_quads: &'a [TriangleQuad<R>],
    built_for: [usize; 2],
}

impl<'a, R: Real> Bvh<'a, R> {
    /// The nodes in use: the root first, each before those below it.
    pub fn nodes(&self) -> &'a [Node<R>] {
        self.nodes
    }

    /// The children of a node of this hierarchy.
    pub fn children(&self, node: &Node<R>) -> impl Iterator<Item = Branch<R>> {
        let quads = self.quads();
        (0..node.len()).map(move |lane| Branch {
            bounds: node.bounds(lane),
            primitives: node.primitives(lane),
            child: node::decode(node.child(lane), quads),
        })
    }

    /// The spheres in the order of the leaves, in fours.
    pub fn sphere_quads(&self) -> &'a [SphereQuad<R>] {
        self.sphere_quads
    }

    /// The triangles in the order of the leaves, in fours.
    pub fn triangle_quads(&self) -> &'a [TriangleQuad<R>] {
        self.triangle_quads
    }

    /// How many spheres and triangles it was built for.
    pub fn built_for(&self) -> [usize; 2] {
        self.built_for
    }

    /// Whether it can be a hierarchy of `geometry`: one over as many spheres and triangles.
    #[inline]
    pub fn fits(&self, geometry: &Geometry<'_, R>) -> bool {
        self.built_for == [geometry.spheres().len(), geometry.triangles().len()]
    }

    /// Has the memory of a child fetched that is going to be visited later: a node, or the first triangles of a leaf.
    #[inline(always)]
    fn prefetch<E: EffectSet>(&self, child: node::ChildBits) {
        // Both, of which at least one is the first of all and not wanted: a branch would cost more.
        let (node, quad) = node::node_or_quad(child);
        self.nodes.get(node).into_iter().for_each(E::prefetch);
        self.triangle_quads.get(quad).into_iter().for_each(E::prefetch);
    }

    #[inline(always)]
    fn quads(&self) -> [usize; 2] {
        [self.sphere_quads.len(), self.triangle_quads.len()]
    }
}

/// Slices of the caller's that a hierarchy is built in.
#[derive(Debug)]
pub struct BvhSlices<'a, R: Real> {
    /// [`Structure::required_nodes`].
    pub nodes: &'a mut [Node<R>],
    /// [`Plan::required_quads`]: one per sphere is enough; most often half of that is used.
    pub sphere_quads: &'a mut [SphereQuad<R>],
    /// [`Plan::required_quads`]: one per triangle is enough; most often a third of that is used.
    pub triangle_quads: &'a mut [TriangleQuad<R>],
}

/// Room for a hierarchy of up to so many nodes and quads, wherever the caller puts it (a `static`, the stack, a box).
/// [`required_nodes`] says how many nodes are enough, [`BvhSlices`] how many quads.
#[derive(Clone, Debug)]
pub struct BvhStorage<R: Real, const NODES: usize, const SPHERE_QUADS: usize, const TRIANGLE_QUADS: usize> {
    nodes: [Node<R>; NODES],
    sphere_quads: [SphereQuad<R>; SPHERE_QUADS],
    triangle_quads: [TriangleQuad<R>; TRIANGLE_QUADS],
}

impl<R: Real, const NODES: usize, const SPHERE_QUADS: usize, const TRIANGLE_QUADS: usize>
    BvhStorage<R, NODES, SPHERE_QUADS, TRIANGLE_QUADS>
{
    /// Room with nothing in it.
    pub const EMPTY: Self = Self {
        nodes: [Node::EMPTY; NODES],
        sphere_quads: [SphereQuad::EMPTY; SPHERE_QUADS],
        triangle_quads: [TriangleQuad::EMPTY; TRIANGLE_QUADS],
    };

    /// Builds the hierarchy of `geometry` here. The scratch is needed only during the call.
    ///
    /// # Errors
    /// [`CapacityError`] where this storage or the scratch is too small.
    pub fn build(
        &mut self,
        geometry: &Geometry<'_, R>,
        structure: Structure,
        scratch: &mut [BuildItem<R>],
    ) -> Result<Bvh<'_, R>, CapacityError> {
        let Self { nodes, sphere_quads, triangle_quads } = self;
        build(geometry, structure, BvhSlices { nodes, sphere_quads, triangle_quads }, scratch)
    }
}
