//! The builder: from the root down, in place, without an allocator and without recursion.

use super::extent::{BuildItem, Extent};
use super::node::MAX_QUADS;
use super::split::{Cut, Filled, MAX_ROOT_QUADS, Part, quads};
use super::{Bvh, BvhSlices, MAX_DEPTH, MAX_WAITING, Node, WIDTH, required_nodes};
use crate::error::{Capacity, CapacityError};
use crate::real::Real;
use crate::shape::{Geometry, SphereQuad, TriangleQuad};

/// Which structure to build over the primitives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Structure {
    /// One box around all triangles, and one around all spheres.
    Box,
    /// A hierarchy.
    #[default]
    Bvh,
}

impl Structure {
    /// Number of nodes that are enough for it over `geometry`.
    pub fn required_nodes<R: Real>(self, geometry: &Geometry<'_, R>) -> usize {
        match self {
            Self::Box => geometry.len().min(1),
            Self::Bvh => required_nodes(geometry.len()),
        }
    }
}

/// A hierarchy whose leaves are still to be filled.
#[derive(Debug)]
pub struct Plan<'a, 'b, R: Real> {
    geometry: Geometry<'b, R>,
    nodes: &'a mut [Node<R>],
    items: &'b [BuildItem<R>],
    required_quads: [usize; 2],
}

/// Builds a hierarchy of `geometry` in the caller's slices.
///
/// The same geometry gives the same hierarchy on every target. Any input will do: equal centres, NaN and infinite
/// corners; the depth stays within [`MAX_DEPTH`].
///
/// # Errors
/// [`CapacityError`] where a slice is shorter than [`BvhSlices`] says, or the scratch than the number of primitives.
pub fn build<'a, R: Real>(
    geometry: &Geometry<'_, R>,
    structure: Structure,
    slices: BvhSlices<'a, R>,
    scratch: &mut [BuildItem<R>],
) -> Result<Bvh<'a, R>, CapacityError> {
    let BvhSlices { nodes, sphere_quads, triangle_quads } = slices;
    plan(geometry, structure, nodes, scratch)?.fill(sphere_quads, triangle_quads)
}

/// The first half of [`build`]: all but the leaves, whose size is then known.
///
/// # Errors
/// [`CapacityError`] where there are fewer nodes than [`Structure::required_nodes`], or fewer items than primitives.
pub fn plan<'a, 'b, R: Real>(
    geometry: &Geometry<'b, R>,
    structure: Structure,
    nodes: &'a mut [Node<R>],
    scratch: &'b mut [BuildItem<R>],
) -> Result<Plan<'a, 'b, R>, CapacityError> {
    let spheres = geometry.spheres().len();
    room(Capacity::Nodes, structure.required_nodes(geometry), nodes.len())?;
    room(Capacity::Scratch, geometry.len(), scratch.len())?;
    let items = &mut scratch[..geometry.len()];
    for (index, item) in items.iter_mut().enumerate() {
        *item = BuildItem { extent: Extent::new(&geometry.bounds(index)), primitive: index as u32 };
    }
    let used = if items.is_empty() { 0 } else { grow(items, spheres, structure, nodes) };
    let nodes = &mut nodes[..used];
    let mut required_quads = [0; 2];
    for leaf in leaves(nodes) {
        required_quads[usize::from(leaf.start >= spheres)] += quads(leaf.len());
    }
    Ok(Plan { geometry: *geometry, nodes, items, required_quads })
}

impl<'a, R: Real> Plan<'a, '_, R> {
    /// How many quads of spheres and of triangles the leaves need.
    pub fn required_quads(&self) -> [usize; 2] {
        self.required_quads
    }

    /// The second half of [`build`]: copies the primitives to where traversal finds them side by side.
    ///
    /// # Errors
    /// [`CapacityError`] where there are fewer quads than [`Plan::required_quads`], or more are needed than 2^27.
    pub fn fill(
        self,
        sphere_quads: &'a mut [SphereQuad<R>],
        triangle_quads: &'a mut [TriangleQuad<R>],
    ) -> Result<Bvh<'a, R>, CapacityError> {
        let Self { geometry, nodes, items, required_quads: [needed_spheres, needed_triangles] } = self;
        let spheres = geometry.spheres().len();
        room(Capacity::SphereQuads, needed_spheres, sphere_quads.len().min(MAX_QUADS))?;
        room(Capacity::TriangleQuads, needed_triangles, triangle_quads.len().min(MAX_QUADS))?;
        let mut used = [0; 2];
        for node in nodes.iter_mut() {
            for lane in 0..WIDTH {
                let range = node.items(lane);
                if range.is_empty() {
                    continue;
                }
                let of_spheres = range.start < spheres;
                let used = &mut used[usize::from(!of_spheres)];
                let first = *used;
                for four in items[range].chunks(4) {
                    if of_spheres {
                        let mut numbers = [0; 4];
                        numbers.iter_mut().zip(four).for_each(|(number, item)| *number = item.primitive);
                        sphere_quads[*used] = SphereQuad::new(geometry.spheres(), &numbers[..four.len()]);
                    } else {
                        let mut quad = TriangleQuad::EMPTY;
                        for (lane, item) in four.iter().enumerate() {
                            quad.set(lane, item.primitive, &geometry.corners(item.primitive as usize));
                        }
                        triangle_quads[*used] = quad;
                    }
                    *used += 1;
                }
                node.set_leaf(lane, of_spheres, first..*used);
            }
        }
        Ok(Bvh {
            nodes,
            sphere_quads: &sphere_quads[..needed_spheres],
            triangle_quads: &triangle_quads[..needed_triangles],
            built_for: [spheres, items.len() - spheres],
        })
    }
}

fn room(what: Capacity, needed: usize, capacity: usize) -> Result<(), CapacityError> {
    if needed <= capacity { Ok(()) } else { Err(CapacityError { what, needed, capacity }) }
}

/// The items of all leaves.
fn leaves<R: Real>(nodes: &[Node<R>]) -> impl Iterator<Item = core::ops::Range<usize>> {
    nodes.iter().flat_map(|node| (0..WIDTH).map(|lane| node.items(lane))).filter(|items| !items.is_empty())
}

/// A child that is to become a node.
#[derive(Clone, Copy)]
struct Pending {
    parent: u32,
    lane: u8,
    depth: u8,
    first: u32,
    count: u32,
}

/// Grows the hierarchy of all items, of which the first are `spheres`; returns how many nodes it has. Their leaves are
/// ranges of items.
fn grow<R: Real>(items: &mut [BuildItem<R>], spheres: usize, structure: Structure, nodes: &mut [Node<R>]) -> usize {
    // Depth first: the stack is that of traversal.
    let mut pending = [Pending { parent: 0, lane: 0, depth: 0, first: 0, count: 0 }; MAX_WAITING];
    let mut top = 0;
    let kinds = [(0, spheres), (spheres, items.len() - spheres)];
    let mut parts = Parts::default();
    for (first, count) in kinds.into_iter().filter(|(_, count)| *count > 0) {
        let mut part = Part::new(items, first, count);
        part.is_leaf |=
            structure == Structure::Box || (count == items.len() && spheres > 0 && quads(count) <= MAX_ROOT_QUADS);
        parts.push(part);
    }
    let mut filled = Filled::EMPTY;
    parts.split(items, 0, &mut filled);
    let mut used = 0;
    let mut current: Option<Pending> = None;
    loop {
        let (parent, depth) =
            current.map_or((None, 0), |next| (Some((next.parent as usize, next.lane.into())), next.depth));
        match (parent, parts.all()) {
            // What had no room to be cut before is best left whole.
            (Some((parent, lane)), [only]) => nodes[parent].set_items(lane, only),
            (parent, all) => {
                let node = used;
                used += 1;
                nodes[node] = Node::EMPTY;
                if let Some((parent, lane)) = parent {
                    nodes[parent].set_node(lane, node as u32);
                }
                for (lane, part) in all.iter().enumerate() {
                    nodes[node].set_items(lane, part);
                    if !part.is_leaf {
                        let (first, count) = (part.first as u32, part.count as u32);
                        pending[top] =
                            Pending { parent: node as u32, lane: lane as u8, depth: depth + 1, first, count };
                        top += 1;
                    }
                }
            }
        }
        if top == 0 {
            return used;
        }
        top -= 1;
        let next = pending[top];
        current = Some(next);
        parts = Parts::default();
        parts.push(Part::new(items, next.first as usize, next.count as usize));
        parts.split(items, next.depth.into(), &mut filled);
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
    fn split(&mut self, items: &mut [BuildItem<R>], depth: usize, filled: &mut Filled<R>) {
        let count = self.all().iter().map(|part| part.count).sum();
        // By halves, eight at a time, each level needs an eighth of what the one above it has.
        let cut = if depth + levels(count) < MAX_DEPTH { Cut::Best } else { Cut::Halves };
        while self.count < WIDTH {
            let size = |part: &Part<R>| match cut {
                Cut::Best => part.bounds.half_area().to_f64(),
                Cut::Halves => part.count as f64,
            };
            let open = self.all().iter().enumerate().filter(|(_, part)| !part.is_leaf);
            let largest = open.reduce(|a, b| if size(b.1) > size(a.1) { b } else { a });
            let Some((largest, _)) = largest else { return };
            if let Some(right) = self.parts[largest].split(items, cut, filled) {
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
