//! A node: 32 bytes in f32.

use super::Bounds;
use crate::real::Real;

/// A leaf (`count > 0`: primitives `order[first..first + count]`) or an inner node (children `first`, `first + 1`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<R: Real> {
    pub(super) bounds: Bounds<R>,
    pub(super) first: u32,
    pub(super) count: u32,
}

impl<R: Real> Node<R> {
    /// A node of a storage that holds nothing yet.
    pub const EMPTY: Self = Self { bounds: Bounds::EMPTY, first: 0, count: 0 };

    /// The box around everything below.
    pub fn bounds(&self) -> &Bounds<R> {
        &self.bounds
    }

    /// The range of `order` that a leaf holds; `None` for an inner node.
    pub fn leaf(&self) -> Option<core::ops::Range<usize>> {
        let first = self.first as usize;
        (self.count > 0).then(|| first..first + self.count as usize)
    }

    /// The two children of an inner node; `None` for a leaf.
    pub fn children(&self) -> Option<[usize; 2]> {
        let first = self.first as usize;
        (self.count == 0).then_some([first, first + 1])
    }
}
