//! A node: 32 bytes in f32.

use core::ops::Range;

use super::Bounds;
use crate::real::Real;

/// A leaf (`count > 0`) or an inner node (children `first`, `first + 1`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<R: Real> {
    pub(super) bounds: Bounds<R>,
    /// Of a leaf: its first in [`super::Bvh::sphere_quads`] or in [`super::Bvh::triangle_order`].
    pub(super) first: u32,
    /// Number of primitives of a leaf, with [`OF_SPHERES`] if they are spheres.
    pub(super) count: u32,
}

/// Set in the count of a leaf of spheres.
pub(super) const OF_SPHERES: u32 = 1 << 31;

/// What a leaf holds: primitives of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaf {
    /// This range of [`super::Bvh::sphere_quads`].
    Spheres(Range<usize>),
    /// This range of [`super::Bvh::triangle_order`].
    Triangles(Range<usize>),
}

impl<R: Real> Node<R> {
    /// A node of a storage that holds nothing yet.
    pub const EMPTY: Self = Self { bounds: Bounds::EMPTY, first: 0, count: 0 };

    /// The box around everything below.
    pub fn bounds(&self) -> &Bounds<R> {
        &self.bounds
    }

    /// The number of primitives of a leaf; 0 for an inner node.
    #[inline]
    pub fn primitives(&self) -> usize {
        (self.count & !OF_SPHERES) as usize
    }

    /// What a leaf holds; `None` for an inner node.
    #[inline]
    pub fn leaf(&self) -> Option<Leaf> {
        let first = self.first as usize;
        match self.count {
            0 => None,
            count if count < OF_SPHERES => Some(Leaf::Triangles(first..first + count as usize)),
            _ => Some(Leaf::Spheres(first..first + self.primitives().div_ceil(4))),
        }
    }

    /// The two children of an inner node; `None` for a leaf.
    pub fn children(&self) -> Option<[usize; 2]> {
        let first = self.first as usize;
        (self.count == 0).then_some([first, first + 1])
    }
}
