//! Which effects a scene calls for, and which lines ask for them.

use ocellus_kernel::Effects;

use crate::description::{FilterDescription, LightDescription, ScatteringDescription, SceneDescription};
use crate::error::Origin;
use glam::DVec3;

/// An effect with every line that asks for it, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Demand {
    /// The effect.
    pub effect: Effects,
    /// Its name.
    pub name: &'static str,
    /// The lines that ask for it; none where the scene does without.
    pub origins: Vec<Origin>,
}

/// Every effect there is, with the lines that ask for it. The union of those with lines is what
/// [`ocellus_kernel::View::required_effects`] finds.
pub fn demands(scene: &SceneDescription) -> Vec<Demand> {
    let mut demands: Vec<Demand> =
        Effects::ALL.iter().map(|&(effect, name)| Demand { effect, name, origins: Vec::new() }).collect();
    let mut ask = |effect: Effects, origin: &Origin| {
        for demand in demands.iter_mut().filter(|demand| demand.effect == effect && !demand.origins.contains(origin)) {
            demand.origins.push(origin.clone());
        }
    };

    let mut used = vec![false; scene.materials.len()];
    for sphere in &scene.spheres {
        ask(Effects::SPHERES, &sphere.origin);
        used[sphere.material] = true;
    }
    for mesh in scene.meshes.iter().filter(|mesh| !mesh.triangles.is_empty()) {
        ask(Effects::TRIANGLES, &mesh.origin);
        if mesh.triangles.iter().any(|triangle| triangle.normals.is_some()) {
            ask(Effects::SMOOTH_NORMALS, mesh.normals_origin.as_ref().unwrap_or(&mesh.origin));
        }
        for triangle in &mesh.triangles {
            used[triangle.material as usize] = true;
        }
    }
    for (material, _) in scene.materials.iter().zip(&used).filter(|(_, used)| **used) {
        match material.scattering {
            ScatteringDescription::Diffuse { texture: Some(_), .. } => ask(Effects::TEXTURES, &material.detail_origin),
            ScatteringDescription::Diffuse { texture: None, .. } => {}
            ScatteringDescription::Mirror { .. } => ask(Effects::MIRROR, &material.origin),
            ScatteringDescription::Dielectric { .. } => ask(Effects::GLASS, &material.origin),
        }
        if material.emission != DVec3::ZERO {
            ask(Effects::EMISSION, &material.detail_origin);
        }
    }
    for light in &scene.lights {
        match light {
            LightDescription::Point { origin, .. } => ask(Effects::POINT_LIGHT, origin),
            LightDescription::Sphere { origin, .. } => {
                ask(Effects::SPHERES, origin);
                ask(Effects::SPHERE_LIGHT, origin);
            }
        }
    }
    let integrator = &scene.integrator;
    if integrator.background != DVec3::ZERO {
        ask(Effects::BACKGROUND, &integrator.background_origin);
    }
    if integrator.indirect {
        ask(Effects::INDIRECT, &integrator.indirect_origin);
    }
    if integrator.roulette_after.is_some() {
        ask(Effects::ROULETTE, &integrator.roulette_origin);
    }
    if scene.camera.aperture_radius > 0.0 {
        ask(Effects::LENS, &scene.camera.lens_origin);
    }
    if matches!(scene.film.filter, FilterDescription::Tent { .. } | FilterDescription::Gaussian { .. }) {
        ask(Effects::FILTER, &scene.film.filter_origin);
    }
    demands
}
