//! Scenes whose spheres are few enough to be looked at one by one for all lanes; there may be any number of triangles.

use core::ops::Range;

use super::columns::Vectors;
use super::directions::Kind;
use super::hits::Rays;
use crate::bvh::{Bounds, Slabs, TrianglesBelow};
use crate::effects::{EffectSet, Effects};
use crate::material::Scattering;
use crate::ray::{Hit, Ray};
use crate::real::{Real, Vec3, Vector};
use crate::scene::Scene;
use crate::shape::Sphere;

/// Up to how many spheres are few.
pub(super) const FEW_SPHERES: usize = 16;

/// What all lanes are tested against at once: few spheres, and the box around all triangles.
pub(super) struct Few<'a, R: Real> {
    pub(super) scene: &'a Scene<'a, R>,
    pub(super) spheres: &'a [Sphere<R>],
    /// The spheres once more, as columns.
    pub(super) table: Table<R>,
    /// `None` if there are none.
    triangles: Option<TrianglesBelow<'a, R>>,
    /// The box around all triangles; empty if there are none.
    bounds: Bounds<R>,
}

/// What is known of each sphere by its number.
pub(super) struct Table<R: Real> {
    pub(super) center: Vectors<R, FEW_SPHERES>,
    pub(super) radius: [R; FEW_SPHERES],
    pub(super) inverted: [u32; FEW_SPHERES],
    pub(super) material: [u32; FEW_SPHERES],
    pub(super) kind: [Kind; FEW_SPHERES],
    /// Of a diffuse sphere without a texture.
    pub(super) albedo: Vectors<R, FEW_SPHERES>,
    /// Whether something has to be looked at that is not here: light that it emits, a texture.
    pub(super) has_more: [u32; FEW_SPHERES],
}

impl<'a, R: Real> Few<'a, R> {
    /// `None` where there are too many spheres, or where bounds by rounded numbers prove nothing; and where triangles are
    /// in no hierarchy, which would say where they all are.
    #[inline(always)]
    pub(super) fn of<E: EffectSet>(scene: &'a Scene<'a, R>) -> Option<Self> {
        let geometry = scene.geometry();
        let spheres = geometry.spheres();
        let proved = const { !R::WIDE_IS_SELF && E::ACCURACY.proves_boxes_of_spheres() };
        if !proved || spheres.len() > FEW_SPHERES || !spheres.iter().all(Sphere::is_near) {
            return None;
        }
        let bvh = scene.bvh().filter(|bvh| bvh.fits(geometry));
        let triangles = match bvh {
            _ if geometry.triangles().is_empty() => None,
            Some(bvh) => Some(TrianglesBelow::new(bvh)),
            None => return None,
        };
        let bounds = triangles.map_or(Bounds::EMPTY, |triangles| triangles.bounds);
        Some(Self { scene, spheres, table: Table::of::<E>(scene, spheres), triangles, bounds })
    }

    /// Whether a ray may meet a triangle before `tmax`.
    #[inline(always)]
    pub(super) fn may_meet_triangles<E: EffectSet>(&self, ray: &Ray<R>, tmax: R) -> bool {
        let slabs = Slabs::new::<E>(ray.origin.to_array(), ray.direction.to_array().map(|d| R::ONE / d));
        self.bounds.entry_between(&slabs, R::ZERO, tmax).is_some()
    }

    /// Whether there may be a triangle in a box.
    #[inline(always)]
    pub(super) fn may_have_triangles_in(&self, place: &Bounds<R>) -> bool {
        self.bounds.meets(place)
    }

    /// The primitives that are triangles.
    #[inline(always)]
    pub(super) fn triangles<E: EffectSet>(&self) -> Range<u32> {
        let first = self.spheres.len() as u32;
        let end =
            if const { E::EFFECTS.contains(Effects::TRIANGLES) } { self.scene.geometry().len() as u32 } else { 0 };
        first..end
    }

    /// Which of the triangles a primitive is, if it is one.
    #[inline(always)]
    fn triangle<E: EffectSet>(&self, primitive: u32) -> Option<usize> {
        let triangles = self.triangles::<E>();
        triangles.contains(&primitive).then(|| (primitive - triangles.start) as usize)
    }

    /// Has what is known of a triangle fetched.
    #[inline(always)]
    pub(super) fn prefetch_triangle<E: EffectSet>(&self, primitive: u32) {
        if let Some(triangle) = self.triangle::<E>(primitive) {
            self.scene.geometry().triangles().get(triangle).into_iter().for_each(E::prefetch);
            self.scene.attributes().get(triangle).into_iter().for_each(E::prefetch);
        }
    }

    /// Has the corners of a triangle fetched.
    #[inline(always)]
    pub(super) fn prefetch_corners<E: EffectSet>(&self, primitive: u32) {
        let geometry = self.scene.geometry();
        let corners = self.triangle::<E>(primitive).and_then(|triangle| geometry.triangles().get(triangle));
        for &corner in corners.into_iter().flatten() {
            geometry.positions().get(corner as usize).into_iter().for_each(E::prefetch);
        }
    }

    /// Goes on with the search of a lane that has found `best` among the spheres.
    #[inline(always)]
    pub(super) fn search_triangles<E: EffectSet, const ANY: bool>(
        &self,
        rays: &Rays<R>,
        lane: usize,
        best: Hit<R>,
    ) -> Hit<R> {
        let Some(triangles) = &self.triangles else { return best };
        let (ray, from) = (rays.ray(lane), rays.departure(lane));
        triangles.search::<E, ANY>(self.scene.geometry(), &ray, &from, best)
    }
}

impl<R: Real> Table<R> {
    #[inline(always)]
    fn of<E: EffectSet>(scene: &Scene<'_, R>, spheres: &[Sphere<R>]) -> Self {
        let mut table = Self {
            center: Vectors::ZERO,
            radius: [R::ONE; FEW_SPHERES],
            inverted: [0; FEW_SPHERES],
            material: [0; FEW_SPHERES],
            kind: [Kind::Ends; FEW_SPHERES],
            albedo: Vectors::ZERO,
            has_more: [0; FEW_SPHERES],
        };
        for (at, sphere) in spheres.iter().enumerate().take(FEW_SPHERES) {
            let material = &scene.materials()[sphere.material as usize];
            table.center.set(at, sphere.center);
            table.radius[at] = sphere.radius;
            table.inverted[at] = u32::from(sphere.inverted);
            table.material[at] = sphere.material;
            table.kind[at] = Kind::of::<R, E>(&material.scattering);
            table.has_more[at] = u32::from(material.is_emissive());
            if let Scattering::Diffuse(surface) = &material.scattering {
                table.albedo.set(at, surface.albedo);
                table.has_more[at] |=
                    u32::from(const { E::EFFECTS.contains(Effects::TEXTURES) } && surface.texture.is_some());
                if surface.albedo == Vec3::<R>::ZERO {
                    table.kind[at] = Kind::Ends;
                }
            }
        }
        table
    }
}
