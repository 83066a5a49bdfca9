//! The builder: binned surface area heuristic (Wald 2007), in place, without an allocator and without recursion.

use super::node::OF_SPHERES;
use super::{Bounds, Bvh, BvhSlices, MAX_DEPTH, Node, required_nodes};
use crate::error::{Capacity, CapacityError};
use crate::real::{Real, Vector};
use crate::shape::{Geometry, Sphere, SphereQuad};

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
            Self::Box if geometry.spheres().is_empty() || geometry.triangles().is_empty() => geometry.len().min(1),
            Self::Box => 3,
            Self::Bvh => required_nodes(geometry.len()),
        }
    }
}

/// Scratch of the builder: one per primitive.
#[derive(Clone, Copy, Debug)]
pub struct BuildItem<R: Real> {
    bounds: Bounds<R>,
    primitive: u32,
}

impl<R: Real> BuildItem<R> {
    /// An item of a scratch that holds nothing yet.
    pub const EMPTY: Self = Self { bounds: Bounds::EMPTY, primitive: 0 };

    /// Twice the centre of the box along `axis`: as good a key as the centre.
    #[inline]
    fn key(&self, axis: usize) -> R {
        self.bounds.corners[0][axis] + self.bounds.corners[1][axis]
    }
}

/// Bins along the axis of a split.
const BINS: usize = 16;
/// Cost of visiting an inner node's two children, in triangle tests.
const VISIT_COST: f64 = 1.25;
/// Leaves cost at most this much, in triangle tests.
const MAX_LEAF_COST: f64 = 8.0;
/// Below this depth splits halve, which takes at most 32 more levels for 2^31 primitives.
const HALVE_FROM_DEPTH: usize = MAX_DEPTH - 33;

/// The primitives of a leaf are of one kind.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Spheres,
    Triangles,
}

impl Kind {
    /// Cost of testing `count` primitives, in triangle tests: four spheres cost about as much as one triangle.
    #[inline]
    fn cost(self, count: usize) -> f64 {
        match self {
            Self::Spheres => count.div_ceil(4) as f64,
            Self::Triangles => count as f64,
        }
    }
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
    let BvhSlices { nodes, sphere_quads, triangle_order } = slices;
    let (spheres, triangles) = (geometry.spheres().len(), geometry.triangles().len());
    let room = |what, needed, capacity| {
        if needed <= capacity { Ok(()) } else { Err(CapacityError { what, needed, capacity }) }
    };
    room(Capacity::Nodes, structure.required_nodes(geometry), nodes.len())?;
    room(Capacity::SphereQuads, spheres, sphere_quads.len())?;
    room(Capacity::TriangleOrder, triangles, triangle_order.len())?;
    room(Capacity::Scratch, spheres + triangles, scratch.len())?;

    let items = &mut scratch[..spheres + triangles];
    for (index, item) in items.iter_mut().enumerate() {
        *item = BuildItem { bounds: geometry.bounds(index), primitive: index as u32 };
    }
    // One root for both kinds, if there are both.
    let both = spheres > 0 && triangles > 0;
    let (mut used, sphere_root, triangle_root) = if both { (3, 1, 2) } else { (items.len().min(1), 0, 0) };
    nodes[..used].fill(Node::EMPTY);
    if both {
        nodes[0] = Node { bounds: union(items), first: 1, count: 0 };
    }
    let (sphere_items, triangle_items) = items.split_at_mut(spheres);
    let mut quads = 0;
    if spheres > 0 {
        used = grow(sphere_items, Kind::Spheres, structure, nodes, sphere_root, used);
        quads = pack_leaves(sphere_items, geometry.spheres(), &mut nodes[..used], sphere_quads);
    }
    if triangles > 0 {
        used = grow(triangle_items, Kind::Triangles, structure, nodes, triangle_root, used);
        for (slot, item) in triangle_order.iter_mut().zip(triangle_items.iter()) {
            *slot = item.primitive;
        }
    }
    Ok(Bvh {
        nodes: &nodes[..used],
        spheres,
        sphere_quads: &sphere_quads[..quads],
        triangle_order: &triangle_order[..triangles],
    })
}

/// Puts the spheres of each leaf side by side, and points the leaf there; returns the number of quads.
fn pack_leaves<R: Real>(
    items: &[BuildItem<R>],
    spheres: &[Sphere<R>],
    nodes: &mut [Node<R>],
    quads: &mut [SphereQuad<R>],
) -> usize {
    let mut used = 0;
    for leaf in nodes.iter_mut().filter(|node| node.count > 0) {
        let first = leaf.first as usize;
        let items = &items[first..first + leaf.count as usize];
        *leaf = Node { first: used as u32, count: leaf.count | OF_SPHERES, ..*leaf };
        for four in items.chunks(4) {
            let mut numbers = [0; 4];
            numbers.iter_mut().zip(four).for_each(|(number, item)| *number = item.primitive);
            quads[used] = SphereQuad::new(spheres, &numbers[..four.len()]);
            used += 1;
        }
    }
    used
}

/// Makes `items` the leaf at `root` and splits it down, with nodes from `used` on; returns the number of nodes then.
fn grow<R: Real>(
    items: &mut [BuildItem<R>],
    kind: Kind,
    structure: Structure,
    nodes: &mut [Node<R>],
    root: usize,
    mut used: usize,
) -> usize {
    nodes[root] = Node { bounds: union(items), first: 0, count: items.len() as u32 };
    if structure == Structure::Box {
        return used;
    }
    // Depth first: at each level one sibling waits, so the stack is as deep as the tree.
    let mut waiting = [(0u32, 0u8); MAX_DEPTH + 1];
    // A root of one kind may lie one below the root of all.
    waiting[0] = (root as u32, u8::from(root > 0));
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (at, depth) = waiting[top];
        let node = nodes[at as usize];
        let (first, count) = (node.first as usize, node.count as usize);
        let range = &mut items[first..first + count];
        let Some(left) = split(range, kind, &node.bounds, depth as usize) else { continue };
        let (left_items, right_items) = range.split_at(left);
        let child = |items: &[BuildItem<R>], first: usize| Node {
            bounds: union(items),
            first: first as u32,
            count: items.len() as u32,
        };
        nodes[used] = child(left_items, first);
        nodes[used + 1] = child(right_items, first + left);
        nodes[at as usize] = Node { first: used as u32, count: 0, ..node };
        waiting[top] = (used as u32 + 1, depth + 1);
        waiting[top + 1] = (used as u32, depth + 1);
        top += 2;
        used += 2;
    }
    used
}

fn union<R: Real>(items: &[BuildItem<R>]) -> Bounds<R> {
    items.iter().fold(Bounds::EMPTY, |bounds, item| bounds.union(&item.bounds))
}

/// Reorders the items and says how many go left; `None` where a leaf is better.
fn split<R: Real>(items: &mut [BuildItem<R>], kind: Kind, bounds: &Bounds<R>, depth: usize) -> Option<usize> {
    if items.len() < 2 {
        return None;
    }
    let mut keys = Bounds::EMPTY;
    for item in items.iter() {
        keys.grow(R::Vec3::new(item.key(0), item.key(1), item.key(2)));
    }
    let leaf_cost = kind.cost(items.len());
    if depth < HALVE_FROM_DEPTH {
        let best = (0..3)
            .filter_map(|axis| best_plane(items, kind, &keys, axis))
            .reduce(|a, b| if b.cost < a.cost { b } else { a });
        if let Some(plane) = best {
            let area = bounds.half_area().to_f64();
            let cost = VISIT_COST + plane.cost / area;
            if leaf_cost > MAX_LEAF_COST || cost < leaf_cost {
                return Some(partition(items, |item| plane.bin(item) <= plane.last_left));
            }
            return None;
        }
    }
    if leaf_cost <= MAX_LEAF_COST {
        return None;
    }
    Some(halve(items, &keys))
}

/// Where to cut, and what it costs: areas times costs.
#[derive(Clone, Copy)]
struct Plane<R: Real> {
    axis: usize,
    low: R,
    scale: R,
    last_left: usize,
    cost: f64,
}

impl<R: Real> Plane<R> {
    /// The bin of an item; keys that are not numbers go first.
    #[inline]
    fn bin(&self, item: &BuildItem<R>) -> usize {
        let bin = ((item.key(self.axis) - self.low) * self.scale).to_i32();
        bin.clamp(0, BINS as i32 - 1) as usize
    }
}

/// The cheapest of the planes between bins along `axis`; `None` where all centres fall into one bin.
fn best_plane<R: Real>(items: &[BuildItem<R>], kind: Kind, keys: &Bounds<R>, axis: usize) -> Option<Plane<R>> {
    let low = keys.corners[0][axis];
    let extent = keys.corners[1][axis] - low;
    let scale = R::from_f64(BINS as f64) / extent;
    if !(extent > R::ZERO && scale.is_finite() && scale > R::ZERO) {
        return None;
    }
    let mut plane = Plane { axis, low, scale, last_left: 0, cost: f64::MAX };
    let mut bins = [(Bounds::<R>::EMPTY, 0); BINS];
    for item in items {
        let (bounds, count) = &mut bins[plane.bin(item)];
        *bounds = bounds.union(&item.bounds);
        *count += 1;
    }
    // Costs of what lies right of each plane, then a sweep from the left.
    let mut right_costs = [0.0; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for bin in (1..BINS).rev() {
        bounds = bounds.union(&bins[bin].0);
        count += bins[bin].1;
        right_costs[bin - 1] = bounds.half_area().to_f64() * kind.cost(count);
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for bin in 0..BINS - 1 {
        bounds = bounds.union(&bins[bin].0);
        count += bins[bin].1;
        let cost = bounds.half_area().to_f64() * kind.cost(count) + right_costs[bin];
        if count > 0 && count < items.len() && cost < plane.cost {
            plane = Plane { last_left: bin, cost, ..plane };
        }
    }
    (plane.cost < f64::MAX).then_some(plane)
}

/// Moves the items that belong left to the front; returns how many they are.
fn partition<T>(items: &mut [T], mut is_left: impl FnMut(&T) -> bool) -> usize {
    let mut left = 0;
    for at in 0..items.len() {
        if is_left(&items[at]) {
            items.swap(left, at);
            left += 1;
        }
    }
    left
}

/// Halves the items at the median of the longest axis; primitive numbers break ties, so the result is defined.
fn halve<R: Real>(items: &mut [BuildItem<R>], keys: &Bounds<R>) -> usize {
    let extent = |axis: usize| keys.corners[1][axis] - keys.corners[0][axis];
    let axis = (1..3).fold(0, |longest, axis| if extent(axis) > extent(longest) { axis } else { longest });
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let (key_a, key_b) = (a.key(axis).to_f64(), b.key(axis).to_f64());
        key_a.total_cmp(&key_b).then(a.primitive.cmp(&b.primitive))
    });
    middle
}
