//! A walk over all leaves of a hierarchy that may matter, in no order of distance.

use super::{Bounds, Bvh, Leaf, MAX_DEPTH};
use crate::real::Real;

impl<R: Real> Bvh<'_, R> {
    /// Shows `see` the leaves whose own boxes and all boxes around them `matter`, until it says that it has seen enough.
    /// Whether it has.
    #[inline(always)]
    pub(crate) fn walk(&self, matters: impl Fn(&Bounds<R>) -> bool, mut see: impl FnMut(Leaf) -> bool) -> bool {
        let Some(mut node) = self.nodes.first().filter(|root| matters(&root.bounds)) else { return false };
        // One node waits per level, so the stack cannot overflow.
        let mut waiting = [0u32; MAX_DEPTH];
        let mut top = 0;
        loop {
            if let Some(leaf) = node.leaf() {
                if see(leaf) {
                    return true;
                }
            } else {
                let left = node.first;
                let pair = &self.nodes[left as usize..left as usize + 2];
                let matter = [matters(&pair[0].bounds), matters(&pair[1].bounds)];
                if matter[0] || matter[1] {
                    if matter[0] && matter[1] {
                        waiting[top] = left + 1;
                        top += 1;
                    }
                    node = &pair[usize::from(!matter[0])];
                    continue;
                }
            }
            if top == 0 {
                return false;
            }
            top -= 1;
            node = &self.nodes[waiting[top] as usize];
        }
    }
}
