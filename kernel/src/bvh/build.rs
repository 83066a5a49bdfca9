//! The builder: from the root down, in place, without an allocator.

use super::extent::BuildItem;
use super::grow::grow_all;
use super::node::MAX_QUADS;
use super::split::quads;
use super::{Bvh, BvhSlices, Node, WIDTH, required_nodes};
use crate::error::{Capacity, CapacityError};
use crate::real::Real;
use crate::shape::{Geometry, SphereQuad, TriangleQuad};

/// How a builder does two things that do not depend on each other: `rayon::join` where there are threads. The hierarchy
/// is the same either way.
pub trait Join: Sync {
    /// Does both, in any order or at once.
    fn join<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B);
}

/// One after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct InTurn;

impl Join for InTurn {
    #[inline]
    fn join<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        (a(), b())
    }
}

/// Items and nodes up to which halving the work further does not pay.
const FEW_ITEMS: usize = 1 << 14;
const FEW_NODES: usize = 1 << 12;

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
/// corners; the depth stays within [`MAX_DEPTH`](super::MAX_DEPTH).
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
    plan(geometry, structure, nodes, scratch, &InTurn)?.fill(sphere_quads, triangle_quads, &InTurn)
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
    join: &impl Join,
) -> Result<Plan<'a, 'b, R>, CapacityError> {
    let spheres = geometry.spheres().len();
    room(Capacity::Nodes, structure.required_nodes(geometry), nodes.len())?;
    room(Capacity::Scratch, geometry.len(), scratch.len())?;
    let items = &mut scratch[..geometry.len()];
    prepare(geometry, items, 0, join);
    let used = if items.is_empty() { 0 } else { grow_all(items, spheres, structure, nodes, join) };
    let nodes = &mut nodes[..used];
    let required_quads = required_quads(nodes, spheres);
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
        join: &impl Join,
    ) -> Result<Bvh<'a, R>, CapacityError> {
        let Self { geometry, nodes, items, required_quads: [needed_spheres, needed_triangles] } = self;
        let spheres = geometry.spheres().len();
        room(Capacity::SphereQuads, needed_spheres, sphere_quads.len().min(MAX_QUADS))?;
        room(Capacity::TriangleQuads, needed_triangles, triangle_quads.len().min(MAX_QUADS))?;
        let (sphere_quads, triangle_quads) =
            (&mut sphere_quads[..needed_spheres], &mut triangle_quads[..needed_triangles]);
        Leaves { nodes, sphere_quads, triangle_quads, first: [0; 2] }.fill(&geometry, items, join);
        Ok(Bvh { nodes, sphere_quads, triangle_quads, built_for: [spheres, items.len() - spheres] })
    }
}

/// Nodes whose leaves are to be filled, and the quads for those, of which the first have these numbers.
struct Leaves<'a, R: Real> {
    nodes: &'a mut [Node<R>],
    sphere_quads: &'a mut [SphereQuad<R>],
    triangle_quads: &'a mut [TriangleQuad<R>],
    first: [usize; 2],
}

impl<R: Real> Leaves<'_, R> {
    fn fill(self, geometry: &Geometry<'_, R>, items: &[BuildItem<R>], join: &impl Join) {
        let Self { nodes, sphere_quads, triangle_quads, first } = self;
        let spheres = geometry.spheres().len();
        if nodes.len() > FEW_NODES {
            let (nodes, more_nodes) = nodes.split_at_mut(nodes.len() / 2);
            let held = required_quads(nodes, spheres);
            let (sphere_quads, more_sphere_quads) = sphere_quads.split_at_mut(held[0]);
            let (triangle_quads, more_triangle_quads) = triangle_quads.split_at_mut(held[1]);
            let half = Leaves { nodes, sphere_quads, triangle_quads, first };
            let other = Leaves {
                nodes: more_nodes,
                sphere_quads: more_sphere_quads,
                triangle_quads: more_triangle_quads,
                first: [first[0] + held[0], first[1] + held[1]],
            };
            join.join(|| half.fill(geometry, items, join), || other.fill(geometry, items, join));
            return;
        }
        let mut used = [0; 2];
        for node in nodes {
            for lane in 0..WIDTH {
                let range = node.items(lane);
                if range.is_empty() {
                    continue;
                }
                let of_spheres = range.start < spheres;
                let kind = usize::from(!of_spheres);
                let start = used[kind];
                for four in items[range].chunks(4) {
                    if of_spheres {
                        let mut numbers = [0; 4];
                        numbers.iter_mut().zip(four).for_each(|(number, item)| *number = item.primitive());
                        sphere_quads[used[kind]] = SphereQuad::new(geometry.spheres(), &numbers[..four.len()]);
                    } else {
                        let triangle = |item: &BuildItem<R>| {
                            let primitive = item.primitive();
                            (primitive, geometry.corners(primitive as usize))
                        };
                        triangle_quads[used[kind]] = TriangleQuad::new(four.iter().map(triangle));
                    }
                    used[kind] += 1;
                }
                node.set_leaf(lane, of_spheres, first[kind] + start..first[kind] + used[kind]);
            }
        }
    }
}

/// The items of primitives from `first` on.
fn prepare<R: Real>(geometry: &Geometry<'_, R>, items: &mut [BuildItem<R>], first: usize, join: &impl Join) {
    if items.len() > FEW_ITEMS {
        let middle = items.len() / 2;
        let (items, more) = items.split_at_mut(middle);
        join.join(|| prepare(geometry, items, first, join), || prepare(geometry, more, first + middle, join));
        return;
    }
    for (index, item) in (first..).zip(items) {
        *item = BuildItem::new(&geometry.bounds(index), index as u32);
    }
}

/// How many quads of spheres and of triangles leaves need, of items of which the first are `spheres`.
fn required_quads<R: Real>(nodes: &[Node<R>], spheres: usize) -> [usize; 2] {
    let mut required = [0; 2];
    for leaf in nodes.iter().flat_map(|node| (0..WIDTH).map(|lane| node.items(lane))) {
        required[usize::from(leaf.start >= spheres)] += quads(leaf.len());
    }
    required
}

fn room(what: Capacity, needed: usize, capacity: usize) -> Result<(), CapacityError> {
    if needed <= capacity { Ok(()) } else { Err(CapacityError { what, needed, capacity }) }
}
