//! Where to cut a range of primitives in two: binned surface area heuristic (Wald 2007).

use super::build::Join;
use super::extent::{BuildItem, Extent, around};
use super::node::MAX_LEAF_QUADS;
use crate::lanes::{Lanes, Numbers};
use crate::real::Real;

/// Most bins along an axis; fewer primitives need fewer.
const MAX_BINS: usize = 32;
/// Items that are put into bins in less time than it takes to wake another thread for half of them.
const FEW_TO_BIN: usize = 1 << 17;
/// Cost of telling two children apart, in tests of a quad.
const VISIT_COST: f64 = 1.5;
/// Cost of one more leaf in a node that has room for it.
const LEAF_COST: f64 = 0.25;
/// Spheres of up to this many quads, where there is nothing else, are one leaf.
pub(super) const MAX_ROOT_QUADS: usize = 4;

/// Neighbouring items, all of one kind of primitive.
#[derive(Clone, Copy)]
pub(super) struct Part<R: Real> {
    pub(super) first: usize,
    pub(super) count: usize,
    /// The box around them, and that around their keys.
    pub(super) bounds: Extent<R>,
    keys: Extent<R>,
    /// Whether it has been found best to keep it whole.
    pub(super) is_leaf: bool,
    /// Whether that holds even where cutting it costs no node.
    pub(super) is_whole: bool,
    /// The cheapest plane, once it has been looked for.
    plane: Option<Option<Plane<R>>>,
}

/// How parts are cut.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Cut {
    /// Where it costs least.
    Best,
    /// Where it costs least, in a node that has room for one more leaf.
    Free,
    /// In halves, where depth is running out.
    Halves,
}

/// How many quads `count` primitives fill.
pub(super) const fn quads(count: usize) -> usize {
    count.div_ceil(4)
}

impl<R: Real> Part<R> {
    pub(super) const EMPTY: Self = Self {
        first: 0,
        count: 0,
        bounds: Extent::EMPTY,
        keys: Extent::EMPTY,
        is_leaf: true,
        is_whole: true,
        plane: None,
    };

    pub(super) fn new(items: &[BuildItem<R>], first: usize, count: usize) -> Self {
        let [bounds, keys] = around(&items[first..first + count]);
        let is_whole = quads(count) <= 1;
        Self { first, count, bounds, keys, is_leaf: is_whole, is_whole, plane: None }
    }

    /// Cuts it in two, each in its place; the other half is returned. `None` where a leaf is better.
    pub(super) fn split(
        &mut self,
        items: &mut [BuildItem<R>],
        cut: Cut,
        filled: &mut Filled<R>,
        join: &impl Join,
    ) -> Option<Self> {
        let range = &mut items[self.first..self.first + self.count];
        let is_too_large = quads(self.count) > MAX_LEAF_QUADS;
        let plane = match cut {
            Cut::Halves => None,
            _ => *self.plane.get_or_insert_with(|| best_plane(range, &self.keys, filled, join)),
        };
        let middle = match plane {
            Some(plane) => {
                let visit = if cut == Cut::Free { LEAF_COST } else { VISIT_COST };
                let cost = visit + plane.cost / self.bounds.half_area().to_f64();
                if !is_too_large && !(cost < quads(self.count) as f64) {
                    self.keep(cut);
                    return None;
                }
                partition(range, &plane)
            }
            None if is_too_large || cut == Cut::Halves => halve(range, &self.keys),
            None => {
                self.keep(cut);
                return None;
            }
        };
        let (first, count) = (self.first, self.count);
        *self = Self::new(items, first, middle);
        let mut right = Self::new(items, first + middle, count - middle);
        if cut == Cut::Free {
            (self.is_leaf, right.is_leaf) = (true, true);
        }
        Some(right)
    }

    /// Makes it a leaf.
    fn keep(&mut self, cut: Cut) {
        self.is_leaf = true;
        self.is_whole |= cut == Cut::Free;
    }
}

/// Moves the items left of a plane to the front; how many those are.
fn partition<R: Real>(items: &mut [BuildItem<R>], plane: &Plane<R>) -> usize {
    // Without a branch: which side an item belongs to is as good as chance.
    let mut at = 0;
    for next in 0..items.len() {
        let item = items[next];
        let is_left = plane.is_left(&item);
        items[next] = items[at];
        items[at] = item;
        at += usize::from(is_left);
    }
    at
}

/// Where to cut, and what it costs: areas times costs.
#[derive(Clone, Copy)]
struct Plane<R: Real> {
    bins: Bins<R>,
    axis: usize,
    last_left: usize,
    cost: f64,
}

impl<R: Real> Plane<R> {
    /// Whether its bin is left of the plane.
    #[inline(always)]
    fn is_left(&self, item: &BuildItem<R>) -> bool {
        self.bins.of(item)[self.axis] <= self.last_left
    }
}

/// Bins of equal width along each axis.
#[derive(Clone, Copy)]
struct Bins<R: Real> {
    count: usize,
    low: R::Lanes,
    scale: R::Lanes,
}

impl<R: Real> Bins<R> {
    /// The bin of an item along each axis; keys that are not numbers go first.
    #[inline(always)]
    fn of(&self, item: &BuildItem<R>) -> [usize; 4] {
        const { assert!(MAX_BINS.is_power_of_two()) };
        let half = R::from_f64(0.5);
        let middle_of_last = R::from_f64((self.count - 1) as f64) + half;
        let places = (item.keys() - self.low) * self.scale;
        let places = R::Lanes::splat(half).greater(places).lesser(R::Lanes::splat(middle_of_last));
        // Added to a number so large that its neighbours are one apart, they are rounded to whole ones, which its last bits
        // count. Half is taken off before, so that this rounds down; what is whole itself may go to the bin before.
        let counts = places + R::Lanes::splat(half / R::UNIT_ROUNDOFF - half);
        counts.to_array().map(|count| (count.last_bits() % MAX_BINS as u32) as usize)
    }
}

/// What is in each bin of each axis. One for all splits, so that those of few primitives need not clear all bins.
pub(super) struct Filled<R: Real>([[(Extent<R>, usize); 3]; MAX_BINS]);

impl<R: Real> Filled<R> {
    pub(super) const EMPTY: Self = Self([[(Extent::EMPTY, 0); 3]; MAX_BINS]);

    /// Puts items, and nothing else, into bins.
    fn fill(&mut self, items: &[BuildItem<R>], bins: &Bins<R>, join: &impl Join) {
        if items.len() > FEW_TO_BIN {
            let (some, more) = items.split_at(items.len() / 2);
            let mut other = Self::EMPTY;
            join.join(|| self.fill(some, bins, join), || other.fill(more, bins, join));
            let both = self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened());
            both.for_each(|((bounds, held), more)| (*bounds, *held) = (bounds.union(&more.0), *held + more.1));
            return;
        }
        let filled = &mut self.0[..bins.count];
        filled.fill([(Extent::EMPTY, 0); 3]);
        for item in items {
            let [x, y, z, _] = bins.of(item);
            for (axis, bin) in [x, y, z].into_iter().enumerate() {
                let (bounds, held) = &mut filled[bin][axis];
                *bounds = bounds.union(&item.extent);
                *held += 1;
            }
        }
    }
}

/// The cheapest of the planes between bins; `None` where all keys fall into one bin on every axis.
fn best_plane<R: Real>(
    items: &[BuildItem<R>],
    keys: &Extent<R>,
    filled: &mut Filled<R>,
    join: &impl Join,
) -> Option<Plane<R>> {
    let count = (8 + items.len() / 16).min(MAX_BINS);
    let extent = keys.high - keys.low;
    let scale = extent.to_array().map(|extent| {
        let scale = R::from_f64(count as f64) / extent;
        if extent > R::ZERO && scale.is_finite() { scale } else { R::ZERO }
    });
    let bins = Bins { count, low: keys.low, scale: R::Lanes::new(scale) };
    filled.fill(items, &bins, join);
    let filled = &filled.0[..count];
    let mut best: Option<Plane<R>> = None;
    for axis in (0..3).filter(|&axis| scale[axis] > R::ZERO) {
        // Costs of what lies right of each plane, then a sweep from the left.
        let mut right_costs = [0.0; MAX_BINS];
        let (mut bounds, mut held) = (Extent::EMPTY, 0);
        for bin in (1..count).rev() {
            bounds = bounds.union(&filled[bin][axis].0);
            held += filled[bin][axis].1;
            right_costs[bin - 1] = bounds.half_area().to_f64() * quads(held) as f64;
        }
        let (mut bounds, mut held) = (Extent::EMPTY, 0);
        for bin in 0..count - 1 {
            bounds = bounds.union(&filled[bin][axis].0);
            held += filled[bin][axis].1;
            let cost = bounds.half_area().to_f64() * quads(held) as f64 + right_costs[bin];
            if held > 0 && held < items.len() && best.is_none_or(|best| cost < best.cost) {
                best = Some(Plane { bins, axis, last_left: bin, cost });
            }
        }
    }
    best.filter(|best| best.cost < f64::MAX)
}

/// Puts the items below the median of the longest axis first; primitive numbers break ties, so the result is defined. How many
/// those are.
fn halve<R: Real>(items: &mut [BuildItem<R>], keys: &Extent<R>) -> usize {
    let extent = (keys.high - keys.low).to_array();
    let axis = (1..3).fold(0, |longest, axis| if extent[axis] > extent[longest] { axis } else { longest });
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        // A NaN's sign is not the same on every target.
        let [key_a, key_b] = [a, b].map(|item| match item.keys().to_array()[axis].to_f64() {
            key if key.is_nan() => 0.0,
            key => key,
        });
        key_a.total_cmp(&key_b).then(a.primitive().cmp(&b.primitive()))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Bounds;

    fn keys_go_into_the_bin_that_they_lie_in<R: Real>() {
        let [zero, one] = [R::ZERO, R::ONE];
        // Keys are twice the centres: eight bins from 0 to 8, whatever the axis.
        let bins = Bins::<R> { count: 8, low: R::Lanes::splat(zero), scale: R::Lanes::splat(one) };
        let of = |key: R| {
            let point = key * R::from_f64(0.5);
            let [x, y, z, _] = bins.of(&BuildItem::new(&Bounds { corners: [[point; 3]; 2] }, u32::MAX));
            assert!(x == y && y == z);
            x
        };
        for bin in 0..8 {
            for part in [0.01, 0.3, 0.5, 0.7, 0.99] {
                assert_eq!(of(R::from_f64(bin as f64 + part)), bin);
            }
            let whole = R::from_f64(bin as f64);
            assert!(of(whole) == bin || of(whole) + 1 == bin);
            assert_eq!(of(whole.next_up()), bin.max(of(whole)));
        }
        for (key, bin) in [(-one, 0), (zero, 0), (R::from_f64(8.0), 7), (R::MAX, 7), (R::LOWEST, 0)] {
            assert_eq!(of(key), bin);
        }
        assert_eq!([of(R::INFINITY), of(-R::INFINITY), of(R::NAN)], [7, 0, 0]);
    }

    #[test]
    fn keys_go_into_the_bin_that_they_lie_in_f32() {
        keys_go_into_the_bin_that_they_lie_in::<f32>();
    }

    #[test]
    fn keys_go_into_the_bin_that_they_lie_in_f64() {
        keys_go_into_the_bin_that_they_lie_in::<f64>();
    }
}
