//! The surface points of all lanes.

use super::columns::{Column, LANES, Lanes, Vectors};
use super::few::{FEW_SPHERES, Few};
use super::hits::{Hits, Rays};
use crate::effects::{EffectSet, Effects};
use crate::real::Real;
use crate::shape::Sphere;
use crate::surface::{Facing, SurfacePoint, surface_point};

/// A [`SurfacePoint`] of each lane, and its [`Facing`].
pub(super) struct Surfaces<R: Real> {
    pub(super) p: Vectors<R>,
    pub(super) p_error: Vectors<R>,
    pub(super) ng: Vectors<R>,
    ns: Vectors<R>,
    pub(super) wo: Vectors<R>,
    uv: [Column<R>; 2],
    pub(super) material: Column<u32>,
    /// Whether it is a sphere whose normal points inwards.
    pub(super) inverted: Column<u32>,
    pub(super) front: Column<bool>,
    pub(super) facing_ng: Vectors<R>,
    facing_ns: Vectors<R>,
}

impl<R: Real> Surfaces<R> {
    pub(super) fn none() -> Self {
        Self {
            p: Vectors::ZERO,
            p_error: Vectors::ZERO,
            ng: Vectors::ZERO,
            ns: Vectors::ZERO,
            wo: Vectors::ZERO,
            uv: [[R::ZERO; LANES]; 2],
            material: [0; LANES],
            inverted: [0; LANES],
            front: [false; LANES],
            facing_ng: Vectors::ZERO,
            facing_ns: Vectors::ZERO,
        }
    }

    #[inline(always)]
    pub(super) fn point(&self, lane: usize) -> SurfacePoint<R> {
        SurfacePoint {
            p: self.p.at(lane),
            p_error: self.p_error.at(lane),
            ng: self.ng.at(lane),
            ns: self.ns.at(lane),
            uv: [self.uv[0][lane], self.uv[1][lane]],
            wo: self.wo.at(lane),
            material: self.material[lane],
        }
    }

    #[inline(always)]
    pub(super) fn facing(&self, lane: usize) -> Facing<R> {
        Facing { front: self.front[lane], ng: self.facing_ng.at(lane), ns: self.facing_ns.at(lane) }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, point: SurfacePoint<R>) {
        self.p.set(lane, point.p);
        self.p_error.set(lane, point.p_error);
        self.ng.set(lane, point.ng);
        self.ns.set(lane, point.ns);
        self.uv[0][lane] = point.uv[0];
        self.uv[1][lane] = point.uv[1];
        self.wo.set(lane, point.wo);
        self.material[lane] = point.material;
    }

    /// Those of all hits; of spheres for all lanes at once, of triangles one by one.
    #[inline(always)]
    pub(super) fn find<E: EffectSet>(&mut self, few: &Few<'_, R>, rays: &Rays<R>, hits: &Hits<R>) {
        let triangles = few.triangles::<E>();
        let of_triangles = Lanes::that(|lane| triangles.contains(&hits.primitive[lane]));
        of_triangles.for_each(|lane| few.prefetch_corners::<E>(hits.primitive[lane]));
        for lane in 0..LANES {
            let at = hits.primitive[lane] as usize % FEW_SPHERES;
            let (center, radius) = (few.table.center.at(at), few.table.radius[at]);
            let sphere = Sphere { center, radius, material: 0, inverted: false };
            let ray = rays.ray(lane);
            let point = sphere.point_at(&ray, hits.t[lane]);
            let inverted = few.table.inverted[at];
            let ng = if inverted != 0 { -point.outward } else { point.outward };
            self.p.set(lane, point.p);
            self.p_error.set(lane, point.p_error);
            self.ng.set(lane, ng);
            self.ns.set(lane, ng);
            self.wo.set(lane, -ray.direction);
            self.material[lane] = few.table.material[at];
            self.inverted[lane] = inverted;
        }
        if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
            self.uv = [[R::ZERO; LANES]; 2];
            for lane in of_triangles {
                self.set(lane, surface_point::<R, E>(few.scene, &rays.ray(lane), &hits.at(lane)));
            }
        }
        for lane in 0..LANES {
            let facing = self.point(lane).toward_viewer::<E>();
            self.front[lane] = facing.front;
            self.facing_ng.set(lane, facing.ng);
            self.facing_ns.set(lane, facing.ns);
        }
    }
}
