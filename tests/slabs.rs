//! Boxes against exact arithmetic: none is missed that a ray meets.

use ocellus_kernel::bvh::Bounds;
use ocellus_kernel::real::Real;
use ocellus_kernel::shape::PreparedRay;
use proptest::prelude::*;

use crate::support::exact::{Exact, exact};
use crate::support::in_both_precisions;
use crate::support::property::{component, for_all, power_of_two};
use crate::support::tolerance::u;
use crate::support::trials::{Trials, trials};

in_both_precisions!(slabs_never_miss_what_exact_rays_meet);

/// Whether `origin + t direction` meets the closed box at some t > 0, in exact arithmetic.
pub(crate) fn meets(corners: &[[f64; 3]; 2], origin: [f64; 3], direction: [f64; 3]) -> bool {
    // Both ends of the interval as fractions with positive denominators.
    let (mut near, mut far): (Option<[Exact; 2]>, Option<[Exact; 2]>) = (None, None);
    let less = |a: &[Exact; 2], b: &[Exact; 2]| &a[0] * &b[1] < &b[0] * &a[1];
    for axis in 0..3 {
        let (o, d) = (exact(origin[axis]), exact(direction[axis]));
        let [low, high] = [0, 1].map(|side| exact(corners[side][axis]) - &o);
        if d == exact(0.0) {
            if low > exact(0.0) || high < exact(0.0) {
                return false;
            }
            continue;
        }
        let (enter, leave) = if d > exact(0.0) { ([low, d.clone()], [high, d]) } else { ([-high, -&d], [-low, -d]) };
        if near.as_ref().is_none_or(|near| less(near, &enter)) {
            near = Some(enter);
        }
        if far.as_ref().is_none_or(|far| less(&leave, far)) {
            far = Some(leave);
        }
    }
    match (near, far) {
        (Some(near), Some(far)) => !less(&far, &near) && far[0] > exact(0.0),
        _ => false,
    }
}

/// Boxes flat or not, origins on their planes, directions along their faces and at their points.
fn slabs_never_miss_what_exact_rays_meet<R: Real>() {
    let corner = || proptest::array::uniform3(component());
    let places = (corner(), corner(), corner(), corner(), prop::array::uniform3(0u8..6), prop::array::uniform3(0u8..6));
    let tiny = if R::WIDE_IS_SELF { 1e-310 } else { 1e-40 };
    let (mut met, mut missed) = (std::cell::Cell::new(0), std::cell::Cell::new(0));
    for_all(5 * (trials(12_000) / 2), (places, power_of_two(-20..20)), |((a, b, target, free, start, aim), scale)| {
        let round = |x: f64| R::from_f64(x * scale).to_f64();
        let [low, high] = [f64::min, f64::max].map(|pick| std::array::from_fn(|i| round(pick(a[i], b[i]))));
        let origin: [f64; 3] = std::array::from_fn(|i| match start[i] {
            0 => low[i],
            1 => high[i],
            2 => round(0.5 * (low[i] + high[i])),
            _ => round(free[i] * 10.0),
        });
        let direction: [f64; 3] = std::array::from_fn(|i| match aim[i] {
            0 => 0.0,
            1 => -0.0,
            2 => R::from_f64(low[i] - origin[i]).to_f64(),
            // So small that its inverse is infinite, where the slab holds the origin.
            3 if origin[i] >= low[i] && origin[i] <= high[i] => tiny.copysign(target[i]),
            _ => R::from_f64((low[i] + (high[i] - low[i]) * target[i].abs()) - origin[i]).to_f64(),
        });
        let ray = crate::support::scene::ray::<R>(origin, direction);
        if !ray.is_valid() {
            return Ok(());
        }
        let bounds = Bounds { corners: [low, high].map(|corner| corner.map(R::from_f64)) };
        let entry = bounds.entry(&PreparedRay::new(&ray), ray.tmax);
        if meets(&[low, high], origin, direction) {
            met.set(met.get() + 1);
            prop_assert!(entry.is_some(), "{:?} misses {:?}", ray, bounds);
        } else if entry.is_none() {
            missed.set(missed.get() + 1);
        }
        Ok(())
    });
    let (met, missed) = (*met.get_mut(), *missed.get_mut());
    assert!(met >= trials(12_000) && missed > 1000, "{met} met, {missed} missed; unit {}", u::<R>());
    for case in ["N1", "N2", "N3", "N4", "N5"] {
        Trials::passed::<R>(case, "boxes that exact rays meet: planes, edges, zeros, tiny components", met);
    }
}
