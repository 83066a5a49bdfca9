//! Which effects a scene calls for, and which lines ask for them.

use std::collections::HashSet;
use std::sync::Arc;

use ocellus_kernel::Effects;

use crate::aims::aims;
use crate::description::{
    FilterDescription, LightDescription, SamplerDescription, ScatteringDescription, SceneDescription,
};
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
    let mut asked = HashSet::new();
    let mut ask = |effect: Effects, origin: &Origin| {
        // A scene may have many thousand spheres: looking through the list each time would take minutes.
        if asked.insert((effect, Arc::clone(&origin.file), origin.line)) {
            for demand in demands.iter_mut().filter(|demand| demand.effect == effect) {
                demand.origins.push(origin.clone());
            }
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
            ScatteringDescription::Diffuse { texture: Some(texture), .. } => {
                // With emission too, `detail_origin` is the line of that.
                let emits = material.emission != DVec3::ZERO;
                let of_texture = scene.textures.get(texture).filter(|_| emits).map(|texture| &texture.origin);
                ask(Effects::TEXTURES, of_texture.unwrap_or(&material.detail_origin));
            }
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
    if integrator.aim && !aims(scene).is_empty() {
        ask(Effects::AIM, &integrator.aim_origin);
    }
    if integrator.sampler == SamplerDescription::Sobol {
        ask(Effects::SOBOL, &integrator.sampler_origin);
    }
    if scene.camera.aperture_radius > 0.0 {
        ask(Effects::LENS, &scene.camera.lens_origin);
    }
    if matches!(scene.film.filter, FilterDescription::Tent { .. } | FilterDescription::Gaussian { .. }) {
        ask(Effects::FILTER, &scene.film.filter_origin);
    }
    demands
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assemble::{Accel, with_view};
    use crate::load::{load_scene, test_folder::TestFolder};
    use ocellus_kernel::Real;
    use std::path::{Path, PathBuf};

    fn fixture_scenes() -> Vec<PathBuf> {
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
        let mut scenes = vec![fixtures.join("meshes/cat.obj")];
        for folder in ["report", "features"] {
            let entries = std::fs::read_dir(fixtures.join(folder)).expect("the fixtures");
            let paths = entries.map(|entry| entry.expect("an entry").path());
            scenes.extend(paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml")));
        }
        assert!(scenes.len() > 30, "only {} scenes found", scenes.len());
        scenes
    }

    fn demanded(scene: &SceneDescription) -> Effects {
        let on = demands(scene).into_iter().filter(|demand| !demand.origins.is_empty());
        on.fold(Effects::NONE, |set, demand| set.union(demand.effect))
    }

    fn required<R: Real>(scene: &SceneDescription) -> Effects {
        with_view::<R, _>(scene, Accel::None, |view, _| view.required_effects()).expect("a scene for the kernel")
    }

    #[test]
    fn the_lines_ask_for_what_the_kernel_finds() {
        let mut seen = Effects::NONE;
        for path in fixture_scenes() {
            let scene = load_scene(&path).expect("a good scene");
            let demanded = demanded(&scene);
            assert_eq!(demanded, required::<f32>(&scene), "{}", path.display());
            assert_eq!(demanded, required::<f64>(&scene), "{}", path.display());
            seen = seen.union(demanded);
        }
        assert_eq!(seen, Effects::EVERYTHING, "each effect is asked for by some fixture");
    }

    /// What a scene defines and does not use costs nothing.
    #[test]
    fn what_is_not_used_asks_for_nothing() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/features/mirror.toml");
        let mut scene = load_scene(&path).expect("a good scene");
        assert!(demanded(&scene).contains(Effects::MIRROR));
        scene.spheres.retain(|sphere| {
            !matches!(scene.materials[sphere.material].scattering, ScatteringDescription::Mirror { .. })
        });
        assert!(!demanded(&scene).contains(Effects::MIRROR));
        assert_eq!(demanded(&scene), required::<f32>(&scene));
    }

    #[test]
    fn a_material_with_texture_and_emission_asks_for_both_on_their_own_lines() {
        let folder = TestFolder::new();
        folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
        image::RgbImage::new(1, 1).save(folder.path("a.png")).expect("a picture");
        let text = "[camera]\nposition = [0, 0, 4]\nlook_at = [0, 0, 0]\n[materials.m]\nkind = \"diffuse\"\n\
                    texture = \"a.png\"\nemission = 2\n[[meshes]]\nfile = \"a.obj\"\nmaterial = \"m\"\n";
        let demands = demands(&load_scene(&folder.write("a.toml", text)).expect("a good scene"));
        let lines = |effect| {
            let demand = demands.iter().find(|demand| demand.effect == effect).expect("every effect is listed");
            demand.origins.iter().map(|origin| origin.line).collect::<Vec<_>>()
        };
        assert_eq!((lines(Effects::TEXTURES), lines(Effects::EMISSION)), (vec![6], vec![7]));
        assert_eq!(lines(Effects::TRIANGLES), [8]);
    }

    #[test]
    fn each_line_is_listed_once() {
        for path in fixture_scenes() {
            for demand in demands(&load_scene(&path).expect("a good scene")) {
                for (index, origin) in demand.origins.iter().enumerate() {
                    assert!(!demand.origins[..index].contains(origin), "{origin} twice for {}", demand.name);
                }
            }
        }
    }
}
