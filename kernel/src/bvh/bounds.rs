//! Axis-aligned boxes and the one slab test that everything uses.

use super::extent::Extent;
use crate::effects::EffectSet;
use crate::lanes::Numbers;
use crate::real::{Real, Vec3, Vector, greater, lesser};
use crate::robust::{slab_far_padding, slab_near_padding};
use crate::shape::PreparedRay;

/// An axis-aligned box: `[lower corner, upper corner]`, scene units. Empty where lower > upper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<R: Real> {
    /// Lower and upper corner.
    pub corners: [[R; 3]; 2],
}

impl<R: Real> Bounds<R> {
    /// The box that holds nothing, ready to grow.
    pub const EMPTY: Self = Self { corners: [[R::MAX; 3], [R::LOWEST; 3]] };

    /// Grows to hold `p`. A NaN component changes nothing.
    #[inline]
    pub fn grow(&mut self, p: Vec3<R>) {
        for (axis, value) in p.to_array().into_iter().enumerate() {
            self.corners[0][axis] = lesser(self.corners[0][axis], value);
            self.corners[1][axis] = greater(self.corners[1][axis], value);
        }
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Extent::new(self).union(&Extent::new(other)).bounds()
    }

    /// Whether the boxes have a point in common; touching counts.
    #[inline(always)]
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let [[al, ah], [bl, bh]] = [self.corners, other.corners];
        // Without branches: most boxes miss, each on an axis of its own.
        (0..3).fold(true, |meets, axis| meets & (al[axis] <= bh[axis]) & (bl[axis] <= ah[axis]))
    }

    /// Half the surface area, scene units squared; 0 for an empty box.
    #[inline]
    pub fn half_area(&self) -> R {
        Extent::new(self).half_area()
    }

    /// Where the ray enters the box, clamped to tmin; `None` where it misses or enters beyond `tmax`.
    ///
    /// Never misses a box that the exact ray meets: the far side is padded by [`slab_far_padding`], and a NaN
    /// (an origin on the plane of a slab that the ray runs along) leaves the interval as it is. Monotone: a box that
    /// holds another is entered no later, since each product rounds monotonely.
    #[inline]
    pub fn entry(&self, ray: &PreparedRay<R>, tmax: R) -> Option<R> {
        self.entry_between(&ray.slabs, ray.tmin, tmax)
    }

    /// [`Bounds::entry`] of a ray of which only this is known.
    #[inline(always)]
    pub(crate) fn entry_between(&self, ray: &Slabs<R>, tmin: R, tmax: R) -> Option<R> {
        let (near, far) = ray.interval(|side, axis| self.corners[side][axis], |one| one, tmin, tmax);
        if near <= far { Some(near) } else { None }
    }
}

/// A ray in the form that the slab test wants.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<R: Real> {
    /// Origin, scene units.
    origin: [R; 3],
    /// One over each component of the direction, for the near and for the far side of a slab, padded if
    /// [`Accuracy`](crate::Accuracy) says so; infinite where the component is zero.
    inverse: [[R; 3]; 2],
    /// Whether the direction's sign bit is set: then a slab is entered through its upper side.
    negative: [bool; 3],
}

impl<R: Real> Slabs<R> {
    /// From an origin and one over each component of a direction.
    #[inline(always)]
    pub(crate) fn new<E: EffectSet>(origin: [R; 3], inverse: [R; 3]) -> Self {
        let pads = if const { E::ACCURACY.pads_boxes() } {
            [slab_near_padding::<R>(), slab_far_padding::<R>()]
        } else {
            [R::ONE, R::ONE]
        };
        Self {
            origin,
            inverse: pads.map(|pad| inverse.map(|d| d * pad)),
            negative: inverse.map(|d| d.is_sign_negative()),
        }
    }

    /// Where the ray enters and leaves a box, or several, clamped to `tmin` and `tmax`; `corner` gives the lower and
    /// the upper corners by axis.
    #[inline(always)]
    pub(super) fn interval<T: Numbers>(
        &self,
        corner: impl Fn(usize, usize) -> T,
        splat: impl Fn(R) -> T,
        tmin: R,
        tmax: R,
    ) -> (T, T) {
        let reach = |far_side: bool, axis: usize| {
            let corner = corner(usize::from(self.negative[axis] != far_side), axis);
            (corner - splat(self.origin[axis])) * splat(self.inverse[usize::from(far_side)][axis])
        };
        let near = splat(tmin).greater(reach(false, 0)).greater(reach(false, 1)).greater(reach(false, 2));
        let far = splat(tmax).lesser(reach(true, 0)).lesser(reach(true, 1)).lesser(reach(true, 2));
        (near, far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3 as V;

    const UNIT: Bounds<f32> = Bounds { corners: [[-1.0; 3], [1.0; 3]] };

    fn entry(bounds: Bounds<f32>, origin: V, direction: V) -> Option<f32> {
        let ray = Ray::<f32>::new(origin, direction);
        bounds.entry(&PreparedRay::new(&ray), ray.tmax)
    }

    #[test]
    fn rays_along_faces_and_edges_hit() {
        for x in [-1.0, 0.5, 1.0] {
            for zero in [0.0, -0.0] {
                assert!(entry(UNIT, V::new(x, 1.0, -3.0), V::new(zero, zero, 1.0)).is_some(), "x {x} zero {zero}");
                assert!(entry(UNIT, V::new(x, 1.5, -3.0), V::new(zero, zero, 1.0)).is_none(), "x {x} zero {zero}");
            }
        }
    }

    #[test]
    fn empty_and_infinite_boxes() {
        assert!(entry(Bounds::EMPTY, V::ZERO, V::ONE).is_none());
        let all = Bounds { corners: [[-f32::INFINITY; 3], [f32::INFINITY; 3]] };
        assert_eq!(entry(all, V::new(1e30, 0.0, -5.0), V::new(0.0, -1.0, 1e-30)), Some(0.0));
    }

    #[test]
    fn growing_ignores_nan() {
        let mut bounds = Bounds::<f32>::EMPTY;
        bounds.grow(V::new(1.0, f32::NAN, 3.0));
        assert_eq!(bounds.corners[0][0], 1.0);
        assert_eq!(bounds.half_area(), 0.0);
    }
}
