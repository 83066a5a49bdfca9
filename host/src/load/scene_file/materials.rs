//! `[materials.NAME]`.

use crate::description::{MaterialDescription, ScatteringDescription, TextureDescription};
use crate::error::Error;
use crate::load::resolve;
use crate::load::table::{Given, Table};
use crate::load::texture::load_texture;
use crate::load::value::{FILE, FRACTION, Kind, LIGHT, POSITIVE, choice};
use glam::DVec3;
use std::path::PathBuf;

#[derive(Clone, Copy)]
enum Scattering {
    Diffuse,
    Mirror,
    Dielectric,
}

const SCATTERING: Kind<Scattering> = Kind {
    wanted: "one of \"diffuse\", \"mirror\", \"dielectric\"",
    example: "\"diffuse\"",
    read: |value| {
        choice(
            value,
            [("diffuse", Scattering::Diffuse), ("mirror", Scattering::Mirror), ("dielectric", Scattering::Dielectric)],
        )
    },
};

/// Keys that belong to one kind of material only.
const SCATTERING_KEYS: [(&str, &str); 6] = [
    ("albedo", "kind = \"diffuse\""),
    ("texture", "kind = \"diffuse\""),
    ("reflectance", "kind = \"mirror\""),
    ("ior", "kind = \"dielectric\""),
    ("exterior_ior", "kind = \"dielectric\""),
    ("transmittance", "kind = \"dielectric\""),
];

/// The textures read so far: a file that several materials name is read once.
#[derive(Default)]
pub(super) struct Textures {
    read: Vec<(PathBuf, TextureDescription)>,
}

impl Textures {
    /// The index of the texture that `file` names.
    fn index(&mut self, file: &Given<String>) -> Result<usize, Error> {
        let path = resolve(&file.origin.file, &file.value);
        if let Some(index) = self.read.iter().position(|(known, _)| *known == path) {
            return Ok(index);
        }
        let texture = load_texture(&path, file.origin.clone())?;
        self.read.push((path, texture));
        Ok(self.read.len() - 1)
    }

    /// All textures, by index.
    pub(super) fn into_descriptions(self) -> Vec<TextureDescription> {
        self.read.into_iter().map(|(_, texture)| texture).collect()
    }
}

pub(super) fn read_material(
    name: String,
    mut table: Table<'_>,
    ambient_ior: f64,
    textures: &mut Textures,
) -> Result<MaterialDescription, Error> {
    let origin = table.origin.clone();
    let mut detail_origin = origin.clone();
    let scattering = match table.require("kind", SCATTERING)?.value {
        Scattering::Diffuse => {
            let texture = table.get("texture", FILE)?;
            if let Some(file) = &texture {
                detail_origin = file.origin.clone();
            }
            // A texture is shown as it is, unless the albedo is there to tint it.
            let albedo = if texture.is_some() { 1.0 } else { 0.8 };
            ScatteringDescription::Diffuse {
                albedo: table.get_or("albedo", FRACTION, DVec3::splat(albedo))?.value,
                texture: texture.map(|file| textures.index(&file)).transpose()?,
            }
        }
        Scattering::Mirror => {
            ScatteringDescription::Mirror { reflectance: table.get_or("reflectance", FRACTION, DVec3::ONE)?.value }
        }
        Scattering::Dielectric => ScatteringDescription::Dielectric {
            interior_ior: table.get_or("ior", POSITIVE, 1.5)?.value,
            exterior_ior: table.get_or("exterior_ior", POSITIVE, ambient_ior)?.value,
            transmittance: table.get_or("transmittance", FRACTION, DVec3::ONE)?.value,
        },
    };
    let emission = table.get("emission", LIGHT)?;
    if let Some(given) = &emission {
        detail_origin = given.origin.clone();
    }
    table.finish(&SCATTERING_KEYS)?;
    let emission = emission.map_or(DVec3::ZERO, |given| given.value);
    Ok(MaterialDescription { origin, name, scattering, emission, detail_origin })
}
