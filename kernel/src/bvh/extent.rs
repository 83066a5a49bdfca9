//! What the builder knows of a primitive, in a form that boxes grow in four lanes at a time.

use super::Bounds;
use crate::lanes::{Lanes, Numbers};
use crate::real::Real;

/// A box; its fourth lane does not count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent<R: Real> {
    pub(super) low: R::Lanes,
    pub(super) high: R::Lanes,
}

impl<R: Real> Extent<R> {
    pub(super) const EMPTY: Self = Self { low: R::Lanes::MAX, high: R::Lanes::LOWEST };

    pub(super) fn new(bounds: &Bounds<R>) -> Self {
        Self::with_fourth(bounds, [R::ZERO; 2])
    }

    fn with_fourth(bounds: &Bounds<R>, fourth: [R; 2]) -> Self {
        let [[x, y, z], [high_x, high_y, high_z]] = bounds.corners;
        Self { low: R::Lanes::new([x, y, z, fourth[0]]), high: R::Lanes::new([high_x, high_y, high_z, fourth[1]]) }
    }

    pub(super) fn bounds(&self) -> Bounds<R> {
        let [low, high] = [self.low, self.high].map(|corner| {
            let [x, y, z, _] = corner.to_array();
            [x, y, z]
        });
        Bounds { corners: [low, high] }
    }

    /// The smallest box around both. NaN changes nothing.
    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self { low: self.low.lesser(other.low), high: self.high.greater(other.high) }
    }

    /// Half the surface area, scene units squared; 0 for an empty box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> R {
        let [dx, dy, dz, _] = (self.high - self.low).to_array();
        if dx < R::ZERO || dy < R::ZERO || dz < R::ZERO { R::ZERO } else { dx * dy + dy * dz + dz * dx }
    }
}

/// Scratch of the builder: one per primitive. 32 bytes in f32.
#[derive(Clone, Copy, Debug)]
pub struct BuildItem<R: Real> {
    /// The primitive's box. In its fourth lanes is the primitive's number: the lower half of its bits, and the upper one.
    pub(super) extent: Extent<R>,
}

impl<R: Real> BuildItem<R> {
    /// An item of a scratch that holds nothing yet.
    pub const EMPTY: Self = Self { extent: Extent::EMPTY };

    pub(super) fn new(bounds: &Bounds<R>, primitive: u32) -> Self {
        let halves = [primitive & 0xFFFF, primitive >> 16].map(|half| R::from_f64(f64::from(half)));
        Self { extent: Extent::with_fourth(bounds, halves) }
    }

    /// The primitive's number.
    #[inline(always)]
    pub(super) fn primitive(&self) -> u32 {
        let [low, high] = [self.extent.low, self.extent.high].map(|lanes| lanes.to_array()[3].to_i32() as u32);
        high << 16 | low
    }

    /// Twice the centre of the box: as good a key as the centre.
    #[inline(always)]
    pub(super) fn keys(&self) -> R::Lanes {
        self.extent.low + self.extent.high
    }
}

/// The box around all items, and that around their keys.
pub(super) fn around<R: Real>(items: &[BuildItem<R>]) -> [Extent<R>; 2] {
    items.iter().fold([Extent::EMPTY; 2], |[bounds, keys], item| grown(&bounds, &keys, item))
}

/// Both boxes with one more item.
#[inline(always)]
fn grown<R: Real>(bounds: &Extent<R>, keys: &Extent<R>, item: &BuildItem<R>) -> [Extent<R>; 2] {
    let key = item.keys();
    [bounds.union(&item.extent), keys.union(&Extent { low: key, high: key })]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_small_and_keep_every_number() {
        assert_eq!(size_of::<BuildItem<f32>>(), 32);
        for primitive in [0, 1, 0xFFFF, 0x1_0000, 0x100_0001, 0x7FFF_FFFF, u32::MAX] {
            let place = Bounds { corners: [[-1.0f32; 3], [2.0; 3]] };
            assert_eq!(BuildItem::new(&place, primitive).primitive(), primitive);
            assert_eq!(BuildItem::new(&place, primitive).extent.bounds(), place);
            let place = Bounds { corners: [[-1.0f64; 3], [2.0; 3]] };
            assert_eq!(BuildItem::new(&place, primitive).primitive(), primitive);
        }
    }
}
