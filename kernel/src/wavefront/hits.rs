//! The ray queries of all lanes.

use super::columns::{Column, GROUP, LANES, Lanes, Vectors};
use super::few::{FEW_SPHERES, Few};
use super::reach::{Line, Reach, occlusion, reach};
use crate::bvh::search;
use crate::departure::Departure;
use crate::effects::{EffectSet, Effects};
use crate::ray::{Hit, NO_PRIMITIVE, Ray};
use crate::real::{Real, greater, lesser};
use crate::shape::{PreparedRay, Sphere};

/// Rays of all lanes, from t = 0 on.
pub(super) struct Rays<R: Real> {
    pub(super) origin: Vectors<R>,
    pub(super) direction: Vectors<R>,
    pub(super) tmax: R,
    /// As in [`Departure`].
    pub(super) error: Column<R>,
    pub(super) departed: Column<u32>,
    pub(super) light: u32,
}

impl<R: Real> Rays<R> {
    pub(super) fn none() -> Self {
        Self {
            origin: Vectors::ZERO,
            direction: Vectors::ZERO,
            tmax: R::MAX,
            error: [R::ZERO; LANES],
            departed: [NO_PRIMITIVE; LANES],
            light: NO_PRIMITIVE,
        }
    }

    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> Ray<R> {
        Ray { tmax: self.tmax, ..Ray::new(self.origin.at(lane), self.direction.at(lane)) }
    }

    #[inline(always)]
    pub(super) fn departure(&self, lane: usize) -> Departure<R> {
        let [sphere, light] = [self.departed[lane], self.light];
        Departure { origin: self.origin.at(lane), error: self.error[lane], sphere, light }
    }
}

/// The hits of all lanes.
pub(super) struct Hits<R: Real> {
    pub(super) t: Column<R>,
    pub(super) u: Column<R>,
    pub(super) v: Column<R>,
    pub(super) primitive: Column<u32>,
}

impl<R: Real> Hits<R> {
    pub(super) fn none() -> Self {
        Self { t: [R::ZERO; LANES], u: [R::ZERO; LANES], v: [R::ZERO; LANES], primitive: [NO_PRIMITIVE; LANES] }
    }

    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> Hit<R> {
        Hit { t: self.t[lane], u: self.u[lane], v: self.v[lane], primitive: self.primitive[lane] }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, hit: Hit<R>) {
        self.t[lane] = hit.t;
        self.u[lane] = hit.u;
        self.v[lane] = hit.v;
        self.primitive[lane] = hit.primitive;
    }
}

/// What bounds need of the ray of each lane.
struct Lines<R: Real> {
    /// Of length one.
    direction: Vectors<R>,
    length: Column<R>,
    /// Whether bounds would prove nothing for it. Then the others are NaN, so that nothing seems certain.
    odd: Column<u32>,
}

impl<R: Real> Lines<R> {
    #[inline(always)]
    fn of(rays: &Rays<R>) -> Self {
        let mut lines = Self { direction: Vectors::ZERO, length: [R::ONE; LANES], odd: [0; LANES] };
        for lane in 0..LANES {
            let ray = rays.ray(lane);
            let found = PreparedRay::square_in_range(&ray);
            let length = found.unwrap_or(R::NAN).sqrt();
            lines.direction.set(lane, ray.direction * (R::ONE / length));
            lines.length[lane] = length;
            lines.odd[lane] = u32::from(found.is_none());
        }
        lines
    }

    #[inline(always)]
    fn at(&self, rays: &Rays<R>, lane: usize) -> Line<R> {
        Line { origin: rays.origin.at(lane), direction: self.direction.at(lane), error: rays.error[lane] }
    }
}

/// The closest hit of each wanted lane.
#[inline(always)]
pub(super) fn closest<R: Real, E: EffectSet>(
    few: &Few<'_, R>,
    rays: &Rays<R>,
    wanted: &Column<bool>,
    hits: &mut Hits<R>,
) {
    let scene = few.scene;
    let odd = closest_sphere::<R, E>(few, rays, hits);
    for lane in Lanes::that(|lane| wanted[lane] & (odd[lane] != 0)) {
        let (ray, from) = (rays.ray(lane), rays.departure(lane));
        let found = search::<R, E, false>(scene.geometry(), scene.bvh(), &ray, &from);
        hits.set(lane, found.unwrap_or(Hit::none(rays.tmax)));
    }
    if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
        let mut near = [0u32; LANES];
        for lane in 0..LANES {
            near[lane] = u32::from(few.may_meet_triangles::<E>(&rays.ray(lane), hits.t[lane]));
        }
        for lane in Lanes::that(|lane| wanted[lane] & (near[lane] != 0) & (odd[lane] == 0)) {
            hits.set(lane, few.search_triangles::<E, false>(rays, lane, hits.at(lane)));
            few.prefetch_triangle::<E>(hits.primitive[lane]);
        }
    }
}

/// What rays may meet first.
struct Candidates<R: Real, const N: usize> {
    /// Number of the sphere that may be met first, how far ahead that may be, and how far the next one may be met.
    index: [u32; N],
    first: [R; N],
    second: [R; N],
    /// Where one of them has been met for certain.
    latest: [R; N],
}

impl<R: Real, const N: usize> Candidates<R, N> {
    const NONE: Self = Self { index: [0; N], first: [R::INFINITY; N], second: [R::INFINITY; N], latest: [R::MAX; N] };
}

/// The closest hit of each lane among few spheres; and where it is not certain which.
#[inline(always)]
fn closest_sphere<R: Real, E: EffectSet>(few: &Few<'_, R>, rays: &Rays<R>, hits: &mut Hits<R>) -> Column<u32> {
    let never = R::INFINITY;
    let lines = Lines::of(rays);
    let mut near = Candidates::<R, LANES>::NONE;
    // Group by group, so that its candidates stay in registers.
    for group in (0..LANES).step_by(GROUP) {
        let mut found = Candidates::<R, GROUP>::NONE;
        for (number, sphere) in few.spheres.iter().enumerate() {
            let number = number as u32;
            let (center, radius) = (sphere.center, sphere.radius);
            for k in 0..GROUP {
                let lane = group + k;
                let reach = reach::<R>(center, radius, &lines.at(rays, lane));
                let left_out = rays.departed[lane] == number;
                let reach = if left_out { Reach { earliest: never, latest: never } } else { reach };
                found.second[k] = lesser(found.second[k], greater(found.first[k], reach.earliest));
                found.index[k] = if reach.earliest < found.first[k] { number } else { found.index[k] };
                found.first[k] = lesser(found.first[k], reach.earliest);
                found.latest[k] = lesser(found.latest[k], reach.latest);
            }
        }
        let lanes = group..group + GROUP;
        near.first[lanes.clone()].copy_from_slice(&found.first);
        near.second[lanes.clone()].copy_from_slice(&found.second);
        near.latest[lanes.clone()].copy_from_slice(&found.latest);
        near.index[lanes].copy_from_slice(&found.index);
    }

    let mut odd = lines.odd;
    for lane in 0..LANES {
        let at = near.index[lane] as usize % FEW_SPHERES;
        let (center, radius) = (few.table.center.at(at), few.table.radius[at]);
        let sphere = Sphere { center, radius, material: 0, inverted: false };
        let ray = PreparedRay::new_in::<E, false>(&rays.ray(lane), &rays.departure(lane));
        let t = sphere.intersect_in::<E>(&ray, rays.tmax).unwrap_or(never);
        let none = near.first[lane] > R::MAX;
        let certain = t < never && sphere.has_in_box(&ray, t) && !(near.second[lane] <= near.latest[lane]);
        odd[lane] |= u32::from(!none && !certain);
        hits.t[lane] = if none { rays.tmax } else { t };
        hits.u[lane] = R::ZERO;
        hits.v[lane] = R::ZERO;
        hits.primitive[lane] = if none { NO_PRIMITIVE } else { near.index[lane] };
    }
    odd
}

/// Whether anything is in the way of the ray of each wanted lane.
#[inline(always)]
pub(super) fn occluded<R: Real, E: EffectSet>(few: &Few<'_, R>, rays: &Rays<R>, wanted: &Column<bool>) -> Column<bool> {
    let lines = Lines::of(rays);
    let (mut maybe, mut met) = (lines.odd, [0u32; LANES]);
    for group in (0..LANES).step_by(GROUP) {
        let (mut group_maybe, mut group_met) = ([0u32; GROUP], [0u32; GROUP]);
        for (number, sphere) in few.spheres.iter().enumerate() {
            let number = number as u32;
            if rays.light == number {
                continue;
            }
            let (center, radius) = (sphere.center, sphere.radius);
            for k in 0..GROUP {
                let lane = group + k;
                let end = rays.tmax * lines.length[lane];
                let (possible, certain) = occlusion::<R>(center, radius, &lines.at(rays, lane), end);
                let stays = rays.departed[lane] != number;
                group_maybe[k] |= u32::from(stays & possible);
                group_met[k] |= u32::from(stays & certain);
            }
        }
        met[group..group + GROUP].copy_from_slice(&group_met);
        for k in 0..GROUP {
            maybe[group + k] |= group_maybe[k];
        }
    }
    let mut near = [0u32; LANES];
    if const { E::EFFECTS.contains(Effects::TRIANGLES) } {
        for lane in 0..LANES {
            near[lane] = u32::from(few.may_meet_triangles::<E>(&rays.ray(lane), rays.tmax));
        }
    }
    let mut hidden = [false; LANES];
    for lane in 0..LANES {
        hidden[lane] = wanted[lane] & (met[lane] != 0);
    }
    for lane in Lanes::that(|lane| wanted[lane] & !hidden[lane] & (maybe[lane] | near[lane] != 0)) {
        hidden[lane] = if maybe[lane] != 0 {
            let (ray, from) = (rays.ray(lane), rays.departure(lane));
            search::<R, E, true>(few.scene.geometry(), few.scene.bvh(), &ray, &from).is_some()
        } else {
            few.search_triangles::<E, true>(rays, lane, Hit::none(rays.tmax)).primitive != NO_PRIMITIVE
        };
    }
    hidden
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Everything;
    use crate::material::{Diffuse, Material, Scattering};
    use crate::robust::shadow_tmax;
    use crate::scene::{Scene, SceneParts};
    use crate::shape::Geometry;
    use glam::Vec3 as V;

    /// A ray so long that bounds prove nothing: with a direction taken for one of length one, the sphere beside it would
    /// stand in its way.
    #[test]
    fn rays_out_of_range_are_answered_as_when_alone() {
        let spheres = [Sphere { center: V::new(0.0, 0.5, 0.0), radius: 0.1, material: 0, inverted: false }];
        let diffuse = Diffuse { albedo: V::ONE, texture: None };
        let materials = [Material { scattering: Scattering::Diffuse(diffuse), emission: V::ZERO }];
        let scene = Scene::<f32>::new(SceneParts {
            geometry: Geometry::new(&spheres, &[], &[]).unwrap(),
            bvh: None,
            attributes: &[],
            normals: &[],
            uvs: &[],
            materials: &materials,
            textures: &[],
            lights: &[],
            aims: &[],
            background: V::ZERO,
        })
        .unwrap();
        let few = Few::of::<Everything>(&scene).unwrap();
        let mut rays = Rays::<f32>::none();
        let far = (1u64 << 41) as f32;
        let directions =
            [V::new(far, 1.8, 0.0), V::new(0.0, far, 0.0), V::new(0.0, 1e-9, 0.0), V::new(far, far, 1.0), V::Y, V::X];
        for lane in 0..LANES {
            rays.direction.set(lane, directions[lane % directions.len()]);
        }
        let found = |lane: usize, tmax: f32| {
            let ray = Ray { tmax, ..rays.ray(lane) };
            search::<f32, Everything, false>(scene.geometry(), None, &ray, &rays.departure(lane))
        };
        let mut hits = Hits::none();
        closest::<f32, Everything>(&few, &rays, &[true; LANES], &mut hits);
        for lane in 0..LANES {
            assert_eq!(hits.at(lane), found(lane, f32::MAX).unwrap_or(Hit::none(f32::MAX)), "{lane}");
        }
        let tmax = shadow_tmax::<f32>();
        let alone: [bool; LANES] = core::array::from_fn(|lane| found(lane, tmax).is_some());
        rays.tmax = tmax;
        let hidden = occluded::<f32, Everything>(&few, &rays, &[true; LANES]);
        assert_eq!(hidden, alone);
        assert_eq!(hidden[..6], [false, true, false, false, true, false]);
    }
}
