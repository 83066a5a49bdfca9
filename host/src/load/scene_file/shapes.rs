//! `[[spheres]]` and `[[meshes]]`.

use crate::description::{ScatteringDescription, SceneDescription, SphereDescription};
use crate::error::Error;
use crate::load::obj::load_obj;
use crate::load::resolve;
use crate::load::table::{Given, Table, nearest};
use crate::load::value::{FILE, FLAG, NAME, POSITIVE, SCALE, TRIPLE};
use glam::{DAffine3, DMat3, DVec3};

pub(super) fn read_sphere(mut table: Table<'_>, materials: &[String]) -> Result<SphereDescription, Error> {
    let sphere = SphereDescription {
        origin: table.origin.clone(),
        center: table.require("center", TRIPLE)?.value,
        radius: table.require("radius", POSITIVE)?.value,
        inverted: table.get_or("inverted", FLAG, false)?.value,
        material: material_index(&table.require("material", NAME)?, materials)?,
    };
    table.finish(&[])?;
    Ok(sphere)
}

/// Adds a mesh and the materials of its file to `scene`.
pub(super) fn read_mesh(
    mut table: Table<'_>,
    materials: &[String],
    ambient_ior: f64,
    scene: &mut SceneDescription,
) -> Result<(), Error> {
    let origin = table.origin.clone();
    let file = table.require("file", FILE)?;
    let scale = table.get_or("scale", SCALE, DVec3::ONE)?.value;
    let rotation = rotation_from_degrees(table.get_or("rotate_degrees", TRIPLE, DVec3::ZERO)?.value);
    let translation = table.get_or("translate", TRIPLE, DVec3::ZERO)?.value;
    let material = table.get("material", NAME)?.map(|name| material_index(&name, materials)).transpose()?;
    table.finish(&[])?;

    let world_from_mesh = DAffine3::from_mat3_translation(rotation * DMat3::from_diagonal(scale), translation);
    let obj = load_obj(&resolve(&file.origin.file, &file.value), Some(file.origin))?;
    let first_new = scene.materials.len();
    obj.append_to(scene, origin, world_from_mesh, material);
    // An MTL file cannot say what surrounds its glass.
    for added in scene.materials.iter_mut().skip(first_new) {
        if let ScatteringDescription::Dielectric { exterior_ior, .. } = &mut added.scattering {
            *exterior_ior = ambient_ior;
        }
    }
    Ok(())
}

fn material_index(name: &Given<String>, materials: &[String]) -> Result<usize, Error> {
    materials.iter().position(|known| *known == name.value).ok_or_else(|| {
        let names = || materials.iter().map(String::as_str);
        let remedy = match nearest(&name.value, names()) {
            Some(known) => format!("did you mean `{known}`?"),
            None if materials.is_empty() => format!("define it as [materials.{}]", name.value),
            None => format!("define it, or take one of {}", names().collect::<Vec<_>>().join(", ")),
        };
        Error::bad_scene(name.origin.clone(), format!("there is no material `{}`", name.value), remedy)
    })
}

/// Turns about x, then about y, then about z; counter-clockwise seen from the axis' tip.
fn rotation_from_degrees(degrees: DVec3) -> DMat3 {
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.to_array().map(sine_and_cosine);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
    let about_y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
    let about_z = DMat3::from_cols(DVec3::new(cz, sz, 0.0), DVec3::new(-sz, cz, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// Exact for whole quarter turns, so that they put boxes on boxes.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    let quarters = libm::round(degrees / 90.0);
    let rest = (degrees - quarters * 90.0).to_radians();
    let (sin, cos) = (libm::sin(rest), libm::cos(rest));
    match quarters.rem_euclid(4.0) {
        0.0 => (sin, cos),
        1.0 => (cos, -sin),
        2.0 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_counter_clockwise() {
        let turned = |degrees: [f64; 3], v: DVec3| rotation_from_degrees(DVec3::from_array(degrees)) * v;
        assert_eq!(turned([90.0, 0.0, 0.0], DVec3::Y), DVec3::Z);
        assert_eq!(turned([0.0, 90.0, 0.0], DVec3::Z), DVec3::X);
        assert_eq!(turned([0.0, 0.0, 90.0], DVec3::X), DVec3::Y);
        assert_eq!(turned([0.0, 0.0, -450.0], DVec3::X), DVec3::NEG_Y);
        assert_eq!(turned([180.0, 0.0, 0.0], DVec3::Y), DVec3::NEG_Y);
        assert_eq!(turned([90.0, 90.0, 0.0], DVec3::Y), DVec3::X);
    }

    #[test]
    fn any_angle_is_a_rotation() {
        for degrees in [-720.1, -359.0, -44.9, 0.1, 30.0, 45.0, 89.9, 200.0, 1e6] {
            let (sin, cos) = sine_and_cosine(degrees);
            assert!((sin - libm::sin(degrees.to_radians())).abs() < 1e-9, "{degrees}");
            assert!((cos - libm::cos(degrees.to_radians())).abs() < 1e-9, "{degrees}");
        }
        let rotation = rotation_from_degrees(DVec3::new(10.0, 20.0, 30.0));
        assert!((rotation.determinant() - 1.0).abs() < 1e-14);
    }
}
