//! Growing nodes over items: from the root down, large subtrees at once where there are threads.

use core::ops::Range;

use super::build::{Join, Structure};
use super::extent::BuildItem;
use super::split::{Cut, Filled, MAX_ROOT_QUADS, Part, quads};
use super::{MAX_DEPTH, MAX_WAITING, Node, WIDTH, required_nodes};
use crate::real::Real;

/// Fewer items are grown in one go.
const MANY: usize = 1 << 15;
/// More subtrees are never put off: each has more than so many-eths of all items.
const MAX_SUBTREES: usize = 64;

/// A child that is to become a node.
#[derive(Clone, Copy)]
struct Pending {
    parent: u32,
    lane: u8,
    depth: u8,
    first: u32,
    count: u32,
}

impl Pending {
    const NONE: Self = Self { parent: 0, lane: 0, depth: 0, first: 0, count: 0 };
}

/// Subtrees that are grown later: those of as many items as `of` says.
struct PutOff {
    of: Range<usize>,
    subtrees: [Pending; MAX_SUBTREES],
    count: usize,
}

impl PutOff {
    const NONE: Self = Self { of: 0..0, subtrees: [Pending::NONE; MAX_SUBTREES], count: 0 };
}

/// Grows the hierarchy of all items, of which the first are `spheres`; returns how many nodes it has. Their leaves are
/// ranges of items.
///
/// What is put off depends on the number of items alone, and so do the numbers of nodes: not on who joins.
pub(super) fn grow_all<R: Real>(
    items: &mut [BuildItem<R>],
    spheres: usize,
    structure: Structure,
    nodes: &mut [Node<R>],
    join: &impl Join,
) -> usize {
    let kinds = [(0, spheres), (spheres, items.len() - spheres)];
    let mut parts = Parts::default();
    for (first, count) in kinds.into_iter().filter(|(_, count)| *count > 0) {
        let mut part = Part::new(items, first, count);
        part.is_leaf |=
            structure == Structure::Box || (count == items.len() && spheres > 0 && quads(count) <= MAX_ROOT_QUADS);
        part.is_whole |= part.is_leaf;
        parts.push(part);
    }
    let mut put_off = PutOff::NONE;
    if items.len() >= MANY {
        put_off.of = items.len() / MAX_SUBTREES + 1..items.len() / 4 + 1;
    }
    let mut used = grow(items, 0, parts, 0, nodes, &mut put_off, join);

    let subtrees = &mut put_off.subtrees[..put_off.count];
    subtrees.sort_unstable_by_key(|subtree| subtree.first);
    let mut grown = [0; MAX_SUBTREES];
    grow_subtrees(subtrees, &mut grown, items, 0, &mut nodes[used..], join);
    // Each was given room for as many nodes as it might have had.
    let mut start = used;
    for (subtree, &count) in subtrees.iter().zip(&grown) {
        nodes.copy_within(start..start + count, used);
        nodes[used..used + count].iter_mut().for_each(|node| node.renumber(used));
        if count > 0 {
            nodes[subtree.parent as usize].set_node(subtree.lane.into(), used as u32);
        }
        start += required_nodes(subtree.count as usize);
        used += count;
    }
    used
}

/// Grows subtrees, each in room for as many nodes as it may need, from the first item and node after `first` and the
/// start of `nodes` on; puts how many it got into `grown`.
fn grow_subtrees<R: Real>(
    subtrees: &[Pending],
    grown: &mut [usize],
    items: &mut [BuildItem<R>],
    first: usize,
    nodes: &mut [Node<R>],
    join: &impl Join,
) {
    match subtrees {
        [] => {}
        [subtree] => {
            let start = subtree.first as usize;
            let items = &mut items[start - first..][..subtree.count as usize];
            let mut parts = Parts::default();
            parts.push(Part::new(items, 0, items.len()));
            let mut nothing = PutOff::NONE;
            grown[0] = grow(items, start, parts, subtree.depth, nodes, &mut nothing, join);
        }
        _ => {
            let (subtrees, more) = subtrees.split_at(subtrees.len() / 2);
            let (grown, more_grown) = grown.split_at_mut(subtrees.len());
            let start = more[0].first as usize;
            let (items, more_items) = items.split_at_mut(start - first);
            let room = subtrees.iter().map(|subtree| required_nodes(subtree.count as usize)).sum();
            let (nodes, more_nodes) = nodes.split_at_mut(room);
            join.join(
                || grow_subtrees(subtrees, grown, items, first, nodes, join),
                || grow_subtrees(more, more_grown, more_items, start, more_nodes, join),
            );
        }
    }
}

/// Grows the nodes of some parts of items, of which the first has number `base`, at a depth; returns how many there are.
fn grow<R: Real>(
    items: &mut [BuildItem<R>],
    base: usize,
    mut parts: Parts<R>,
    depth: u8,
    nodes: &mut [Node<R>],
    put_off: &mut PutOff,
    join: &impl Join,
) -> usize {
    // Depth first: the stack is that of traversal.
    let mut pending = [Pending::NONE; MAX_WAITING];
    let mut top = 0;
    let mut filled = Filled::EMPTY;
    parts.split(items, depth.into(), &mut filled, join);
    // What had no room to be cut before is best left whole: the leaf that its parent has it for.
    if depth > 0 && parts.count == 1 {
        return 0;
    }
    let mut used = 0;
    let (mut parent, mut depth): (Option<(usize, usize)>, u8) = (None, depth);
    loop {
        if let (Some((parent, lane)), [only]) = (parent, parts.all()) {
            nodes[parent].set_items(lane, base, only);
        } else {
            let node = used;
            used += 1;
            nodes[node] = Node::EMPTY;
            if let Some((parent, lane)) = parent {
                nodes[parent].set_node(lane, node as u32);
            }
            for (lane, part) in parts.all().iter().enumerate() {
                nodes[node].set_items(lane, base, part);
                if part.is_leaf {
                    continue;
                }
                let (first, count) = (part.first as u32, part.count as u32);
                let child = Pending { parent: node as u32, lane: lane as u8, depth: depth + 1, first, count };
                if put_off.of.contains(&part.count) {
                    put_off.subtrees[put_off.count] = child;
                    put_off.count += 1;
                } else {
                    pending[top] = child;
                    top += 1;
                }
            }
        }
        if top == 0 {
            return used;
        }
        top -= 1;
        let next = pending[top];
        (parent, depth) = (Some((next.parent as usize, next.lane.into())), next.depth);
        parts = Parts::default();
        parts.push(Part::new(items, next.first as usize, next.count as usize));
        parts.split(items, next.depth.into(), &mut filled, join);
    }
}

/// The children of a node to be.
struct Parts<R: Real> {
    parts: [Part<R>; WIDTH],
    count: usize,
}

impl<R: Real> Default for Parts<R> {
    fn default() -> Self {
        Self { parts: [Part::EMPTY; WIDTH], count: 0 }
    }
}

impl<R: Real> Parts<R> {
    fn all(&self) -> &[Part<R>] {
        &self.parts[..self.count]
    }

    fn push(&mut self, part: Part<R>) {
        self.parts[self.count] = part;
        self.count += 1;
    }

    /// Cuts the largest again and again, while there is room and something to cut.
    fn split(&mut self, items: &mut [BuildItem<R>], depth: usize, filled: &mut Filled<R>, join: &impl Join) {
        let count = self.all().iter().map(|part| part.count).sum();
        // By halves, eight at a time, each level needs an eighth of what the one above it has.
        let cut = if depth + levels(count) < MAX_DEPTH { Cut::Best } else { Cut::Halves };
        while self.count < WIDTH {
            let size = |part: &Part<R>| match cut {
                Cut::Best | Cut::Free => part.bounds.half_area().to_f64(),
                Cut::Halves => part.count as f64,
            };
            let open = self.all().iter().enumerate().filter(|(_, part)| !part.is_leaf);
            let largest = open.reduce(|a, b| if size(b.1) > size(a.1) { b } else { a });
            // Then leaves, which cost nothing to tell apart while there is room.
            let (largest, cut) = match largest {
                Some((largest, _)) => (largest, cut),
                None => {
                    let open = self.all().iter().enumerate().filter(|(_, part)| !part.is_whole);
                    let largest = open.reduce(|a, b| if size(b.1) > size(a.1) { b } else { a });
                    let Some((largest, _)) = largest else { return };
                    (largest, Cut::Free)
                }
            };
            if let Some(right) = self.parts[largest].split(items, cut, filled, join) {
                self.push(right);
            }
        }
    }
}

/// How many nodes must lie one below the other for `count` primitives.
fn levels(count: usize) -> usize {
    let (mut levels, mut reach) = (1, 4 * WIDTH);
    while reach < count {
        levels += 1;
        reach = usize::saturating_mul(reach, WIDTH);
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_primitives_fit_in_the_depth() {
        assert_eq!([1, 32, 33, 256, 257].map(levels), [1, 1, 2, 2, 3]);
        assert!(levels(1 << 31) < MAX_DEPTH);
    }
}
