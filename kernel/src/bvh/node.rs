//! A node: the boxes of eight children side by side, and what is in them. 256 bytes in f32.

use core::ops::Range;

use super::split::Part;
use super::{Bounds, Slabs};
use crate::lanes::Lanes;
use crate::real::Real;

/// How many children a node can have.
pub const WIDTH: usize = 8;

/// Up to [`WIDTH`] children.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Node<R: Real> {
    /// What each child is, as [`ChildBits`]. First, so that it is in the cache as soon as the boxes are.
    children: [ChildBits; WIDTH],
    /// Lower and upper corners of the children's boxes, by axis, as the slab test reads them; scene units. Where there
    /// is no child, a box that no ray meets.
    corners: [[[R::Lanes; 2]; 3]; 2],
    /// How many primitives a leaf holds; 0 for an inner node.
    counts: [u32; WIDTH],
}

/// A child of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch<R: Real> {
    /// The box around all of it, scene units.
    pub bounds: Bounds<R>,
    /// How many primitives a leaf holds; 0 for a node.
    pub primitives: usize,
    /// What it is.
    pub child: Child,
}

/// What a child of a node is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Child {
    /// The node of this number.
    Node(usize),
    /// A leaf of spheres: this range of [`super::Bvh::sphere_quads`].
    Spheres(Range<usize>),
    /// A leaf of triangles: this range of [`super::Bvh::triangle_quads`].
    Triangles(Range<usize>),
}

/// A child in 32 bits: the number of a node; or [`LEAF`], [`OF_SPHERES`] if so, how many quads (0 for all there are,
/// from the first on), and the first quad.
pub(super) type ChildBits = u32;

const LEAF: u32 = 1 << 31;
const OF_SPHERES: u32 = 1 << 30;
const QUADS_SHIFT: u32 = 27;
const FIRST: u32 = (1 << QUADS_SHIFT) - 1;

/// The most quads that leaves of a hierarchy can have.
pub(super) const MAX_LEAF_QUADS: usize = 7;
/// The most quads that a hierarchy can have.
pub(super) const MAX_QUADS: usize = 1 << QUADS_SHIFT;

/// What the bits of a child mean, of a hierarchy with these numbers of quads of spheres and of triangles.
#[inline(always)]
pub(super) fn decode(child: ChildBits, all: [usize; 2]) -> Child {
    let first = (child & FIRST) as usize;
    let end = |all| match child >> QUADS_SHIFT & 7 {
        0 => all,
        quads => first + quads as usize,
    };
    if child & LEAF == 0 {
        Child::Node(child as usize)
    } else if child & OF_SPHERES == 0 {
        Child::Triangles(first..end(all[1]))
    } else {
        Child::Spheres(first..end(all[0]))
    }
}

/// The number of the node that a child is, and of the first quad of triangles if it is a leaf of some; 0 where it is not.
#[inline(always)]
pub(super) fn node_or_quad(child: ChildBits) -> (usize, usize) {
    let is_node = child & LEAF == 0;
    let is_triangles = child & (LEAF | OF_SPHERES) == LEAF;
    (if is_node { child as usize } else { 0 }, if is_triangles { (child & FIRST) as usize } else { 0 })
}

impl<R: Real> Node<R> {
    /// A node without children.
    pub const EMPTY: Self = Self {
        corners: [[[R::Lanes::MAX; 2]; 3], [[R::Lanes::LOWEST; 2]; 3]],
        children: [0; WIDTH],
        counts: [0; WIDTH],
    };

    /// How many children it has.
    pub(super) fn len(&self) -> usize {
        // Only the root is the child of none.
        (0..WIDTH).filter(|&lane| self.counts[lane] > 0 || self.children[lane] > 0).count()
    }

    /// The box of child `lane`, scene units.
    pub(super) fn bounds(&self, lane: usize) -> Bounds<R> {
        Bounds { corners: self.corners.map(|corner| corner.map(|axis| axis[lane / 4].to_array()[lane % 4])) }
    }

    /// How many primitives child `lane` holds, if it is a leaf; else 0.
    pub(super) fn primitives(&self, lane: usize) -> usize {
        self.counts[lane] as usize
    }

    pub(super) fn child(&self, lane: usize) -> ChildBits {
        self.children[lane]
    }

    /// Makes child `lane` a leaf of a part's items, which count from `base`, until [`Node::set_leaf`] knows their quads.
    pub(super) fn set_items(&mut self, lane: usize, base: usize, part: &Part<R>) {
        self.children[lane] = (base + part.first) as u32;
        self.counts[lane] = part.count as u32;
        for (corners, corner) in self.corners.iter_mut().zip(part.bounds.bounds().corners) {
            for (axis, value) in corners.iter_mut().zip(corner) {
                let mut four = axis[lane / 4].to_array();
                four[lane % 4] = value;
                axis[lane / 4] = R::Lanes::new(four);
            }
        }
    }

    /// The items of child `lane`, if it is a leaf.
    pub(super) fn items(&self, lane: usize) -> Range<usize> {
        let first = self.children[lane] as usize;
        first..first + self.counts[lane] as usize
    }

    pub(super) fn set_node(&mut self, lane: usize, node: u32) {
        self.children[lane] = node;
        self.counts[lane] = 0;
    }

    /// Adds to the numbers of children that are nodes, before any leaf has its quads.
    pub(super) fn renumber(&mut self, by: usize) {
        for (child, count) in self.children.iter_mut().zip(self.counts) {
            // No child is node 0.
            if count == 0 && *child > 0 {
                *child += by as u32;
            }
        }
    }

    /// Points a leaf at its quads. Leaves of more than [`MAX_LEAF_QUADS`] must hold all that there are.
    pub(super) fn set_leaf(&mut self, lane: usize, of_spheres: bool, quads: Range<usize>) {
        let kind = if of_spheres { OF_SPHERES } else { 0 };
        let length = if quads.len() > MAX_LEAF_QUADS { 0 } else { quads.len() as u32 };
        self.children[lane] = LEAF | kind | length << QUADS_SHIFT | quads.start as u32;
    }

    /// Where the ray enters the box of each child, and a bit for each that it enters no later than `tmax`:
    /// [`Bounds::entry`] of eight boxes.
    #[inline(always)]
    pub(super) fn entries(&self, ray: &Slabs<R>, tmin: R, tmax: R) -> ([[R; 4]; 2], u32) {
        let half = |half: usize| {
            let (near, far) = ray.interval(|side, axis| self.corners[side][axis][half], R::Lanes::splat, tmin, tmax);
            (near.to_array(), R::Lanes::all_at_most([(near, far)]))
        };
        let ((near, met), (more_near, more_met)) = (half(0), half(1));
        ([near, more_near], met | more_met << 4)
    }

    /// A bit for each child whose box has a point in common with `place`.
    #[inline(always)]
    pub(super) fn meeting(&self, place: &Bounds<R>) -> u32 {
        let [low, high] = &self.corners;
        let [place_low, place_high] = place.corners.map(|corner| corner.map(R::Lanes::splat));
        let half = |half: usize| {
            let below = |axis: usize| (low[axis][half], place_high[axis]);
            let above = |axis: usize| (place_low[axis], high[axis][half]);
            R::Lanes::all_at_most([below(0), above(0), below(1), above(1), below(2), above(2)])
        };
        half(0) | half(1) << 4
    }
}
