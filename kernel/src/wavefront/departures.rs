//! Where the rays of all lanes leave their surfaces.

use super::columns::{Column, LANES, Lanes, Vectors};
use super::few::Few;
use super::hits::{Hits, Rays};
use super::surfaces::Surfaces;
use crate::accuracy::RayOffset;
use crate::clearance::place;
use crate::departure::{Arrival, Departure};
use crate::effects::{EffectSet, Effects};
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3};
use crate::robust::{distance_error, error_box};

/// A [`Departure`] of each lane.
pub(super) struct Departures<R: Real> {
    pub(super) origin: Vectors<R>,
    pub(super) error: Column<R>,
    pub(super) sphere: Column<u32>,
}

/// What departures are from: rays, their hits and the points of the surfaces.
pub(super) struct Arrivals<'a, R: Real> {
    pub(super) few: &'a Few<'a, R>,
    pub(super) rays: &'a Rays<R>,
    pub(super) hits: &'a Hits<R>,
    pub(super) surfaces: &'a Surfaces<R>,
}

impl<R: Real> Departures<R> {
    pub(super) fn none() -> Self {
        Self { origin: Vectors::ZERO, error: [R::ZERO; LANES], sphere: [NO_PRIMITIVE; LANES] }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, departure: Departure<R>) {
        self.origin.set(lane, departure.origin);
        self.error[lane] = departure.error;
        self.sphere[lane] = departure.sphere;
    }

    /// Of rays that stay on the side that the ray came from, in the `wanted` lanes.
    #[inline(always)]
    pub(super) fn reflect<E: EffectSet>(&mut self, from: &Arrivals<'_, R>, wanted: &Column<bool>) {
        let Arrivals { hits, surfaces, .. } = *from;
        // Where these are not worked out together, or triangles may be in the way: those lanes are done one by one.
        let mut near = [1u32; LANES];
        if const { !matches!(E::ACCURACY.offset, RayOffset::Constant) } {
            for lane in 0..LANES {
                let (p, p_error) = (surfaces.p.at(lane), surfaces.p_error.at(lane));
                let departure = Departure::off(p, p_error, hits.t[lane], surfaces.facing_ng.at(lane));
                let outside = surfaces.inverted[lane] != u32::from(surfaces.front[lane]);
                self.origin.set(lane, departure.origin);
                self.error[lane] = departure.error;
                self.sphere[lane] = if outside { hits.primitive[lane] } else { NO_PRIMITIVE };
                near[lane] = if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
                    let place = place::<R>(p, error_box::<R>(p, p_error), distance_error::<R>(hits.t[lane]));
                    u32::from(from.few.may_have_triangles_in(&place))
                } else {
                    0
                };
            }
        }
        for lane in Lanes::that(|lane| wanted[lane] & (near[lane] != 0)) {
            let departure = from.at(
                lane,
                #[inline(always)]
                |arrival| arrival.reflected::<E>(&surfaces.facing(lane)),
            );
            self.set(lane, departure);
        }
    }

    /// Of the ray of direction `wi` in one lane, which may pass through the surface.
    #[inline(always)]
    pub(super) fn scatter<E: EffectSet>(&mut self, lane: usize, from: &Arrivals<'_, R>, wi: Vec3<R>) {
        let departure = from.at(
            lane,
            #[inline(always)]
            |arrival| arrival.scattered::<E>(&from.surfaces.facing(lane), wi),
        );
        self.set(lane, departure);
    }
}

impl<R: Real> Arrivals<'_, R> {
    #[inline(always)]
    fn at(&self, lane: usize, depart: impl FnOnce(Arrival<'_, R>) -> Departure<R>) -> Departure<R> {
        let (ray, hit, point) = (self.rays.ray(lane), self.hits.at(lane), self.surfaces.point(lane));
        depart(Arrival { scene: self.few.scene, ray: &ray, hit: &hit, point: &point })
    }
}
