//! Scene files in TOML. `fixtures/scene-reference.md` lists every key; each part of the file is read by one file of
//! `scene_file/`, through the checked reader of [`super::table`].

mod lights;
mod materials;
mod shapes;
mod view;

#[cfg(test)]
mod tests;

use super::table::{Lines, Table};
use super::value::{LIGHT, POSITIVE};
use crate::description::{MaterialDescription, ScatteringDescription, SceneDescription, TextureDescription};
use crate::error::{Error, Origin, Warning};
use glam::DVec3;
use std::path::Path;
use toml::de::DeTable;

/// What the parts of a scene file share while it is read.
struct Surroundings {
    /// Radiance that comes from where nothing is.
    background: DVec3,
    /// Line that set the background.
    background_origin: Origin,
    /// Index of refraction of what fills the scene.
    ambient_ior: f64,
}

/// Reads the scene file `path`.
///
/// # Errors
/// The file, or one it names, cannot be read; it is not TOML; a key is unknown, absent, of the wrong type or out of range;
/// a material does not exist; the scene is empty.
pub fn load_scene_file(path: &Path) -> Result<SceneDescription, Error> {
    let bytes = std::fs::read(path).map_err(|error| Error::missing_input(path, &error, None))?;
    let origin = Origin::file(path);
    let text = str::from_utf8(&bytes).map_err(|error| {
        let line = 1 + bytes.iter().take(error.valid_up_to()).filter(|&&byte| byte == b'\n').count();
        Error::bad_scene(origin.at(line), "the text is not UTF-8", "save the file as UTF-8")
    })?;
    parse(text, path)
}

/// Reads `text`, the content of the scene file `path`.
fn parse(text: &str, path: &Path) -> Result<SceneDescription, Error> {
    let origin = Origin::file(path);
    let lines = Lines::new(origin.clone(), text);
    let tree = DeTable::parse(text).map_err(|error| {
        let origin = error.span().map_or(origin.clone(), |span| lines.at(span.start));
        let cause = format!("not TOML: {}", error.message().trim_end());
        Error::bad_scene(origin, cause, "see fixtures/scene-reference.md for the form of a scene file")
    })?;
    let mut root = Table::root(&lines, tree.get_ref());

    let camera = view::read_camera(root.table("camera")?)?;
    let film = view::read_film(root.table("film")?)?;
    let integrator = root.table("integrator")?;
    let surroundings = read_surroundings(root.table("surroundings")?)?;
    let ambient_ior = surroundings.ambient_ior;
    let integrator = view::read_integrator(integrator, surroundings)?;
    let (materials, textures) = read_materials(&mut root, ambient_ior)?;
    let lights = root.tables("lights")?.into_iter().map(lights::read_light).collect::<Result<_, _>>()?;
    let spheres = root.tables("spheres")?;
    let meshes = root.tables("meshes")?;
    root.finish(&[])?;

    if spheres.is_empty() && meshes.is_empty() {
        let remedy = "add [[spheres]] with center, radius and material, or [[meshes]] with file";
        return Err(Error::bad_scene(origin, "empty scene: it has no spheres and no meshes", remedy));
    }
    let names: Vec<String> = materials.iter().map(|material| material.name.clone()).collect();
    let spheres = spheres.into_iter().map(|table| shapes::read_sphere(table, &names)).collect::<Result<Vec<_>, _>>()?;
    let mut scene = SceneDescription {
        origin,
        camera,
        film,
        integrator,
        materials,
        textures,
        spheres,
        meshes: Vec::new(),
        lights,
        warnings: Vec::new(),
    };
    for table in meshes {
        shapes::read_mesh(table, &names, ambient_ior, &mut scene)?;
    }
    warn_if_dark(&mut scene);
    warn_of_textured_spheres(&mut scene);
    Ok(scene)
}

fn read_surroundings(mut table: Table<'_>) -> Result<Surroundings, Error> {
    let background = table.get_or("background", LIGHT, DVec3::ZERO)?;
    let ambient_ior = table.get_or("ambient_ior", POSITIVE, 1.0)?.value;
    table.finish(&[])?;
    Ok(Surroundings { background: background.value, background_origin: background.origin, ambient_ior })
}

fn read_materials(
    root: &mut Table<'_>,
    ambient_ior: f64,
) -> Result<(Vec<MaterialDescription>, Vec<TextureDescription>), Error> {
    let mut textures = materials::Textures::default();
    let materials = root
        .named_tables("materials")?
        .into_iter()
        .map(|(name, table)| materials::read_material(name, table, ambient_ior, &mut textures))
        .collect::<Result<_, _>>()?;
    Ok((materials, textures.into_descriptions()))
}

/// A picture without light is black, which is seldom what was meant.
fn warn_if_dark(scene: &mut SceneDescription) {
    let emitting = scene.materials.iter().any(|material| material.emission != DVec3::ZERO);
    if scene.lights.is_empty() && scene.integrator.background == DVec3::ZERO && !emitting {
        let text = "nothing gives light, so the picture will be black; add [[lights]], or background to [surroundings]";
        scene.warnings.push(Warning { origin: scene.origin.clone(), text: text.into() });
    }
}

/// Spheres have no texture coordinates, so a texture cannot be put on them.
fn warn_of_textured_spheres(scene: &mut SceneDescription) {
    let textured = |index: usize| match scene.materials.get(index) {
        Some(MaterialDescription {
            scattering: ScatteringDescription::Diffuse { texture: Some(_), .. }, name, ..
        }) => Some(name),
        _ => None,
    };
    let warnings = scene.spheres.iter().filter_map(|sphere| {
        let name = textured(sphere.material)?;
        let text =
            format!("the sphere shows one corner of the texture of `{name}`; textures need a mesh with `vt` lines");
        Some(Warning { origin: sphere.origin.clone(), text })
    });
    scene.warnings.extend(warnings.collect::<Vec<_>>());
}
