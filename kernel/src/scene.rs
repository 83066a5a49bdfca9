//! A scene: borrowed slices, checked once.

use crate::aim::Aim;
use crate::bvh::{self, Bvh};
use crate::departure::Departure;
use crate::effects::{EffectSet, Effects, Everything};
use crate::error::SceneError;
use crate::light::Light;
use crate::material::{Material, Scattering};
use crate::ray::{Hit, Ray};
use crate::real::{Real, Vec3, Vector};
use crate::shape::{Geometry, TriangleAttributes};
use crate::surface::{SurfacePoint, surface_point};
use crate::texture::Texture;

/// What a scene is made of. All of it is the caller's.
#[derive(Clone, Copy, Debug)]
pub struct SceneParts<'a, R: Real> {
    /// The primitives.
    pub geometry: Geometry<'a, R>,
    /// A hierarchy over them; `None` tests them all.
    pub bvh: Option<Bvh<'a, R>>,
    /// Attributes of each triangle.
    pub attributes: &'a [TriangleAttributes],
    /// Vertex normals, any length but zero.
    pub normals: &'a [Vec3<R>],
    /// Texture coordinates, v up.
    pub uvs: &'a [[R; 2]],
    /// Materials.
    pub materials: &'a [Material<R>],
    /// Textures.
    pub textures: &'a [Texture<'a>],
    /// Lights that are sampled.
    pub lights: &'a [Light<R>],
    /// What diffuse surfaces may aim at; few, since each takes time at each bounce.
    pub aims: &'a [Aim<R>],
    /// Radiance from everywhere behind the scene, linear Rec.709.
    pub background: Vec3<R>,
}

/// A scene whose indices are all in range, so that nothing that uses it can fail.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a, R: Real> {
    parts: SceneParts<'a, R>,
    effects: Effects,
}

impl<'a, R: Real> Scene<'a, R> {
    /// Checks the parts against each other and finds the effects they need.
    ///
    /// # Errors
    /// [`SceneError`] names the first part that does not fit.
    pub fn new(parts: SceneParts<'a, R>) -> Result<Self, SceneError> {
        check(&parts)?;
        Ok(Self { parts, effects: required_effects(&parts) })
    }

    /// The effects that this scene needs.
    #[inline]
    pub fn required_effects(&self) -> Effects {
        self.effects
    }

    /// The primitives.
    #[inline]
    pub fn geometry(&self) -> &Geometry<'a, R> {
        &self.parts.geometry
    }

    /// The hierarchy, if there is one.
    #[inline]
    pub fn bvh(&self) -> Option<&Bvh<'a, R>> {
        self.parts.bvh.as_ref()
    }

    /// Attributes of each triangle.
    #[inline]
    pub fn attributes(&self) -> &'a [TriangleAttributes] {
        self.parts.attributes
    }

    /// Vertex normals.
    #[inline]
    pub fn normals(&self) -> &'a [Vec3<R>] {
        self.parts.normals
    }

    /// Texture coordinates.
    #[inline]
    pub fn uvs(&self) -> &'a [[R; 2]] {
        self.parts.uvs
    }

    /// Materials.
    #[inline]
    pub fn materials(&self) -> &'a [Material<R>] {
        self.parts.materials
    }

    /// Textures.
    #[inline]
    pub fn textures(&self) -> &'a [Texture<'a>] {
        self.parts.textures
    }

    /// Lights that are sampled.
    #[inline]
    pub fn lights(&self) -> &'a [Light<R>] {
        self.parts.lights
    }

    /// What diffuse surfaces may aim at.
    #[inline]
    pub fn aims(&self) -> &'a [Aim<R>] {
        self.parts.aims
    }

    /// Radiance from everywhere behind the scene.
    #[inline]
    pub fn background(&self) -> Vec3<R> {
        self.parts.background
    }

    /// Whether the primitive is one of the lights.
    #[inline]
    pub fn is_light(&self, primitive: u32) -> bool {
        self.parts.lights.iter().any(|light| is_sphere_light(light, primitive))
    }

    /// The closest hit in `tmin < t <= tmax`; of equally close ones the lowest primitive.
    #[inline]
    pub fn intersect(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        self.intersect_in::<Everything>(ray)
    }

    /// Whether anything is hit in `tmin < t <= tmax`.
    #[inline]
    pub fn occluded(&self, ray: &Ray<R>) -> bool {
        self.occluded_in::<Everything>(ray)
    }

    /// Shows `see` every crossing of the ray with a primitive, each surface once ([`bvh::crossings`]).
    #[inline]
    pub fn crossings(&self, ray: &Ray<R>, see: impl FnMut(Hit<R>)) {
        bvh::crossings::<R, Everything>(&self.parts.geometry, self.bvh(), ray, see);
    }

    /// The surface point of a hit of `ray`, whose direction must have length 1; `None` where the scene has no such
    /// primitive.
    #[inline]
    pub fn surface_point(&self, ray: &Ray<R>, hit: &Hit<R>) -> Option<SurfacePoint<R>> {
        let known = (hit.primitive as usize) < self.parts.geometry.len();
        known.then(|| surface_point::<R, Everything>(self, ray, hit))
    }

    /// [`Scene::intersect`] for a kernel of fewer effects.
    #[inline]
    pub fn intersect_in<E: EffectSet>(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        self.intersect_from::<E>(ray, &Departure::exactly(ray.origin))
    }

    /// [`Scene::occluded`] for a kernel of fewer effects.
    #[inline]
    pub fn occluded_in<E: EffectSet>(&self, ray: &Ray<R>) -> bool {
        self.occluded_from::<E>(ray, &Departure::exactly(ray.origin))
    }

    /// [`Scene::intersect_in`] for a ray that leaves a surface.
    #[inline(always)]
    pub(crate) fn intersect_from<E: EffectSet>(&self, ray: &Ray<R>, from: &Departure<R>) -> Option<Hit<R>> {
        bvh::search::<R, E, false>(&self.parts.geometry, self.bvh(), ray, from)
    }

    /// [`Scene::occluded_in`] for a ray that leaves a surface.
    #[inline(always)]
    pub(crate) fn occluded_from<E: EffectSet>(&self, ray: &Ray<R>, from: &Departure<R>) -> bool {
        bvh::search::<R, E, true>(&self.parts.geometry, self.bvh(), ray, from).is_some()
    }
}

fn is_sphere_light<R: Real>(light: &Light<R>, primitive: u32) -> bool {
    matches!(light, Light::Sphere(light) if light.sphere == primitive)
}

fn check<R: Real>(parts: &SceneParts<'_, R>) -> Result<(), SceneError> {
    let geometry = &parts.geometry;
    let (spheres, triangles) = (geometry.spheres(), geometry.triangles());
    if let Some(bvh) = &parts.bvh
        && !bvh.fits(geometry)
    {
        return Err(SceneError::Bvh { built_for: bvh.built_for(), primitives: [spheres.len(), triangles.len()] });
    }
    if parts.attributes.len() != triangles.len() {
        return Err(SceneError::Attributes { attributes: parts.attributes.len(), triangles: triangles.len() });
    }
    let has_material = |material: u32| (material as usize) < parts.materials.len();
    if let Some(primitive) = spheres.iter().position(|sphere| !has_material(sphere.material)) {
        return Err(SceneError::Material { primitive });
    }
    for (index, attributes) in parts.attributes.iter().enumerate() {
        if !has_material(attributes.material) {
            return Err(SceneError::Material { primitive: spheres.len() + index });
        }
        let in_range =
            |indices: Option<[u32; 3]>, length: usize| indices.iter().flatten().all(|&i| (i as usize) < length);
        if !in_range(attributes.normals, parts.normals.len()) || !in_range(attributes.uvs, parts.uvs.len()) {
            return Err(SceneError::TriangleAttribute { index });
        }
    }
    for (material, Material { scattering, .. }) in parts.materials.iter().enumerate() {
        if let Scattering::Diffuse(diffuse) = scattering
            && diffuse.texture.is_some_and(|texture| texture as usize >= parts.textures.len())
        {
            return Err(SceneError::Texture { material });
        }
    }
    if let Some(index) = parts.textures.iter().position(|texture| !texture.is_valid()) {
        return Err(SceneError::Texels { index });
    }
    let bad_light = |light: &Light<R>| matches!(light, Light::Sphere(light) if light.sphere as usize >= spheres.len());
    if let Some(index) = parts.lights.iter().position(bad_light) {
        return Err(SceneError::Light { index });
    }
    match parts.aims.iter().position(|aim| !aim.is_valid()) {
        Some(index) => Err(SceneError::Aim { index }),
        None => Ok(()),
    }
}

fn required_effects<R: Real>(parts: &SceneParts<'_, R>) -> Effects {
    let of_material = |index: u32| {
        let material = &parts.materials[index as usize];
        match &material.scattering {
            Scattering::Diffuse(diffuse) => Effects::TEXTURES.when(diffuse.texture.is_some()),
            Scattering::Mirror(_) => Effects::MIRROR,
            Scattering::Dielectric(_) => Effects::GLASS,
        }
    };
    let emits = |index: u32| parts.materials[index as usize].is_emissive();
    let mut effects = Effects::BACKGROUND.when(parts.background != Vec3::<R>::ZERO);
    for (index, sphere) in parts.geometry.spheres().iter().enumerate() {
        // Spheres have no texture coordinates: a texture has one colour there, and still has to be looked up.
        effects = effects.union(Effects::SPHERES).union(of_material(sphere.material));
        if emits(sphere.material) && !parts.lights.iter().any(|light| is_sphere_light(light, index as u32)) {
            effects = effects.union(Effects::EMISSION);
        }
    }
    for attributes in parts.attributes {
        effects = effects
            .union(Effects::TRIANGLES)
            .union(of_material(attributes.material))
            .union(Effects::SMOOTH_NORMALS.when(attributes.normals.is_some()))
            .union(Effects::EMISSION.when(emits(attributes.material)));
    }
    parts.lights.iter().fold(effects, |effects, light| {
        effects.union(match light {
            Light::Point(_) => Effects::POINT_LIGHT,
            Light::Sphere(_) => Effects::SPHERE_LIGHT,
        })
    })
}
