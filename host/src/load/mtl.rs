//! MTL materials.
//!
//! | what the file says | material |
//! |---|---|
//! | `illum` 3, 5 or 8 | mirror; reflectance `Ks`, white without `Ks` |
//! | `illum` 4, 6, 7 or 9 | smooth dielectric; index of refraction `Ni`, transmittance `Tf`, white without `Tf` |
//! | other or no `illum`, opacity below 0.5 and no `map_d` | the same dielectric |
//! | everything else | diffuse; albedo `Kd`, 0.8 grey without `Kd` |
//!
//! - Opacity is `d`, else 1 - `Tr`, else 1; `d` wins because exporters disagree on the meaning of `Tr`. A surface of
//!   opacity 0.5 or more stays diffuse, and so does one with `map_d`, whose opacity varies: both are opaque here.
//! - `Ni` counts where it is positive and not 1, so 0.75 is air seen from water. Many exporters write 1 for "not set" on
//!   materials that they mark as glass, so 1 stands for 1.5, as does a missing `Ni`; the former with a warning. On
//!   a diffuse material `Ni` has no meaning (Blender writes `Ni 1.45` on each).
//! - `map_Kd` is the diffuse albedo, decoded from sRGB; `Kd`, linear, multiplies it unless it is absent or black, which
//!   exporters write beside a texture to mean "unused".
//! - `Ke` is emitted radiance on any material.
//! - Colors above 1 (`Ke` excepted) are cut to 1, negative ones to 0, each with a warning.
//! - `Ka` and `Ns` are not used. Keys that would change the look but are not simulated (`Ks` on a diffuse material, opacity
//!   of 0.5 or more, bump and other maps, `Pr` and `Pm`) are named in one warning per file.
//! - A face without a material, or with one that no file defines, is diffuse with albedo 0.8, named `default`.

use crate::description::{MaterialDescription, ScatteringDescription, TextureDescription};
use crate::error::{Error, Origin, Warning};
use crate::load::mtl_lines::{MaterialLines, prepare};
use crate::load::texture::{load_texture, split_options};
use crate::load::{read_text, resolve};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Albedo where a file gives none.
const DEFAULT_ALBEDO: DVec3 = DVec3::splat(0.8);
/// Index of refraction of glass where a file gives none.
const DEFAULT_IOR: f64 = 1.5;

/// Reads an MTL file that line `asked_by` names: tobj's result, which is never an error, and the lines of its
/// materials in the same order.
///
/// # Errors
/// `MissingInput` if the file cannot be read, `BadScene` with the line of a value that cannot be used.
pub(super) fn read_library(path: &Path, asked_by: Origin) -> Result<(tobj::MTLLoadResult, Vec<MaterialLines>), Error> {
    let source = read_text(path, Some(asked_by))?;
    let file = Origin::file(path);
    let (text, lines) = prepare(&source, &file).map_err(|fault| fault.in_file(&file))?;
    match tobj::load_mtl_buf(&mut text.as_bytes()) {
        Ok(materials) => Ok((Ok(materials), lines)),
        Err(error) => Err(Error::bad_scene(file, format!("cannot read the materials: {error}"), "export them again")),
    }
}

/// The material of faces that have none.
pub(super) fn default_material(origin: Origin) -> MaterialDescription {
    MaterialDescription {
        detail_origin: origin.clone(),
        origin,
        name: "default".into(),
        scattering: ScatteringDescription::Diffuse { albedo: DEFAULT_ALBEDO, texture: None },
        emission: DVec3::ZERO,
    }
}

/// Turns tobj's materials into descriptions, and gathers their textures and warnings.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// Each image file once.
    pub(super) textures: Vec<TextureDescription>,
    texture_paths: Vec<PathBuf>,
    warnings: Vec<Warning>,
    /// Keys that are not simulated: how many materials have each, and the first line.
    ignored: Vec<(&'static str, usize, Origin)>,
}

impl Materials {
    /// One material by the table on top of this file; texture indices are into [`Materials::textures`].
    ///
    /// # Errors
    /// A texture that is missing or cannot be decoded, with the line that names it.
    pub(super) fn describe(
        &mut self,
        material: &tobj::Material,
        lines: &MaterialLines,
    ) -> Result<MaterialDescription, Error> {
        for key in &lines.ignored {
            self.ignore(key, lines);
        }
        let newmtl = &lines.origin;
        let made_so = |key| lines.line(key).unwrap_or_else(|| newmtl.clone());
        let emission = self.emission(material, lines);
        let lit = |emission: DVec3| if emission == DVec3::ZERO { newmtl.clone() } else { made_so("Ke") };
        let (scattering, origin, detail_origin) = match (material.illumination_model, self.opacity(material, lines)) {
            (Some(3 | 5 | 8), _) => (self.mirror(material, lines), made_so("illum"), lit(emission)),
            (Some(4 | 6 | 7 | 9), _) => (self.dielectric(material, lines), made_so("illum"), lit(emission)),
            (_, Some(key)) => (self.dielectric(material, lines), made_so(key), lit(emission)),
            _ => {
                let texture = self.texture(material, lines)?;
                let textured = texture.is_some() && emission == DVec3::ZERO;
                let detail_origin = if textured { made_so("map_Kd") } else { lit(emission) };
                (self.diffuse(material, lines, texture), newmtl.clone(), detail_origin)
            }
        };
        if !matches!(scattering, ScatteringDescription::Diffuse { .. }) && material.diffuse_texture.is_some() {
            self.ignore("map_Kd", lines);
        }
        Ok(MaterialDescription { origin, name: material.name.clone(), scattering, emission, detail_origin })
    }

    /// All warnings, with one for the keys that are not simulated.
    pub(super) fn into_warnings(mut self) -> Vec<Warning> {
        if let Some((_, _, first)) = self.ignored.first() {
            let keys: Vec<_> = self.ignored.iter().map(|(key, count, _)| format!("{key} ({count})")).collect();
            let text = format!("not simulated, with the number of materials that have it: {}", keys.join(", "));
            self.warnings.push(Warning { origin: first.clone(), text });
        }
        self.warnings
    }

    fn mirror(&mut self, material: &tobj::Material, lines: &MaterialLines) -> ScatteringDescription {
        let reflectance = material.specular.map_or(DVec3::ONE, |specular| self.fraction("Ks", widen(specular), lines));
        ScatteringDescription::Mirror { reflectance }
    }

    fn dielectric(&mut self, material: &tobj::Material, lines: &MaterialLines) -> ScatteringDescription {
        let interior_ior = match material.optical_density {
            None => DEFAULT_IOR,
            Some(ior) if ior > 0.0 && ior != 1.0 => widen_one(ior),
            Some(ior) => {
                self.warn("Ni", lines, format!("glass with an index of refraction of {ior}: {DEFAULT_IOR} is used"));
                DEFAULT_IOR
            }
        };
        let filter = material.unknown_param.get("Tf").and_then(|filter| three_numbers(filter));
        let transmittance = filter.map_or(DVec3::ONE, |filter| self.fraction("Tf", widen(filter), lines));
        ScatteringDescription::Dielectric { interior_ior, exterior_ior: 1.0, transmittance }
    }

    fn diffuse(
        &mut self,
        material: &tobj::Material,
        lines: &MaterialLines,
        texture: Option<usize>,
    ) -> ScatteringDescription {
        if material.specular.is_some_and(|specular| specular != [0.0; 3]) {
            self.ignore("Ks", lines);
        }
        let albedo = match (material.diffuse, texture) {
            (None | Some([0.0, 0.0, 0.0]), Some(_)) => DVec3::ONE,
            (None, None) => DEFAULT_ALBEDO,
            (Some(albedo), _) => self.fraction("Kd", widen(albedo), lines),
        };
        ScatteringDescription::Diffuse { albedo, texture }
    }

    /// The key that makes the material mostly transparent, if one does.
    fn opacity(&mut self, material: &tobj::Material, lines: &MaterialLines) -> Option<&'static str> {
        let transparency = material.unknown_param.get("Tr").and_then(|number| number.parse::<f32>().ok());
        let (key, opacity) = match (material.dissolve, transparency) {
            (Some(dissolve), _) => ("d", dissolve),
            (None, Some(transparency)) => ("Tr", 1.0 - transparency),
            (None, None) => return None,
        };
        if opacity < 0.5 && lines.line("map_d").is_none() {
            return Some(key);
        }
        if opacity < 1.0 && matches!(material.illumination_model, None | Some(0 | 1 | 2 | 10)) {
            self.ignore(key, lines);
        }
        None
    }

    fn emission(&mut self, material: &tobj::Material, lines: &MaterialLines) -> DVec3 {
        let emission = widen(material.emissive.unwrap_or_default());
        if emission.min_element() < 0.0 {
            self.warn("Ke", lines, "negative emission is cut to 0".into());
        }
        emission.max(DVec3::ZERO)
    }

    fn texture(&mut self, material: &tobj::Material, lines: &MaterialLines) -> Result<Option<usize>, Error> {
        let Some(statement) = &material.diffuse_texture else { return Ok(None) };
        let (options, name) = split_options(statement);
        if !options.is_empty() {
            self.warn("map_Kd", lines, format!("the options {} are ignored", options.join(" ")));
        }
        let path = resolve(&lines.origin.file, name);
        if let Some(known) = self.texture_paths.iter().position(|known| *known == path) {
            return Ok(Some(known));
        }
        let asked_by = lines.line("map_Kd").unwrap_or_else(|| lines.origin.clone());
        self.textures.push(load_texture(&path, asked_by)?);
        self.texture_paths.push(path);
        Ok(Some(self.textures.len() - 1))
    }

    /// A color that is a fraction of the arriving light.
    fn fraction(&mut self, key: &str, color: DVec3, lines: &MaterialLines) -> DVec3 {
        let cut = color.clamp(DVec3::ZERO, DVec3::ONE);
        if cut != color {
            let text =
                format!("{key} {} {} {} is cut to 0..1: no surface returns more light", color.x, color.y, color.z);
            self.warn(key, lines, text);
        }
        cut
    }

    fn warn(&mut self, key: &str, lines: &MaterialLines, text: String) {
        let origin = lines.line(key).unwrap_or_else(|| lines.origin.clone());
        self.warnings.push(Warning { origin, text });
    }

    fn ignore(&mut self, key: &'static str, lines: &MaterialLines) {
        match self.ignored.iter_mut().find(|(known, _, _)| *known == key) {
            Some((_, count, _)) => *count += 1,
            None => self.ignored.push((key, 1, lines.line(key).unwrap_or_else(|| lines.origin.clone()))),
        }
    }
}

/// tobj keeps single precision; the shortest decimal of such a number is what the file says, so that 0.8 here is the
/// 0.8 of a scene file.
fn widen_one(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

fn widen(color: [f32; 3]) -> DVec3 {
    DVec3::from_array(color.map(widen_one))
}

fn three_numbers(text: &str) -> Option<[f32; 3]> {
    let mut numbers = text.split_whitespace().map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?, numbers.next()?.ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::load::test_folder::TestFolder;
    use image::{ImageBuffer, Rgb};

    struct Described {
        materials: Vec<MaterialDescription>,
        textures: Vec<TextureDescription>,
        warnings: Vec<Warning>,
    }

    fn describe_in(folder: &TestFolder, source: &str) -> Result<Described, Error> {
        let path = folder.write("a.mtl", source);
        let (read, lines) = read_library(&path, Origin::file(Path::new("a.obj")).at(1))?;
        let mut all = Materials::default();
        let read = read.expect("errors come separately").0;
        assert_eq!(read.len(), lines.len());
        let materials =
            read.iter().zip(&lines).map(|(read, lines)| all.describe(read, lines)).collect::<Result<_, _>>()?;
        Ok(Described { materials, textures: std::mem::take(&mut all.textures), warnings: all.into_warnings() })
    }

    /// The one material that these keys make; `newmtl` stands on line 1.
    fn one(keys: &str) -> (MaterialDescription, Vec<Warning>) {
        let described = describe_in(&TestFolder::new(), &format!("newmtl m\n{keys}")).unwrap();
        (described.materials[0].clone(), described.warnings)
    }

    fn diffuse(r: f64, g: f64, b: f64) -> ScatteringDescription {
        ScatteringDescription::Diffuse { albedo: DVec3::new(r, g, b), texture: None }
    }

    fn glass(interior_ior: f64, transmittance: DVec3) -> ScatteringDescription {
        ScatteringDescription::Dielectric { interior_ior, exterior_ior: 1.0, transmittance }
    }

    #[test]
    fn blenders_default_material_is_diffuse() {
        let (material, warnings) =
            one("Ns 250\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1.0\nillum 2\n");
        assert_eq!(material.scattering, diffuse(0.8, 0.8, 0.8));
        assert_eq!((material.name.as_str(), material.emission), ("m", DVec3::ZERO));
        assert_eq!((material.origin.line, material.detail_origin.line), (1, 1));
        assert_eq!(warnings.len(), 1);
        assert_eq!(warnings[0].origin.line, 5);
        assert!(warnings[0].text.contains("Ks (1)"));
    }

    #[test]
    fn the_table_holds_row_by_row() {
        let white = DVec3::ONE;
        let mirror = |reflectance| ScatteringDescription::Mirror { reflectance };
        for (keys, scattering, line) in [
            ("illum 3\nKs .9 .8 .7", mirror(DVec3::new(0.9, 0.8, 0.7)), 2),
            ("Kd 1 0 0\nillum 5", mirror(white), 3),
            ("illum 8", mirror(white), 2),
            ("illum 4", glass(1.5, white), 2),
            ("Ni 1.33\nillum 6\nTf .5 1 1", glass(1.33, DVec3::new(0.5, 1.0, 1.0)), 3),
            ("illum 7\nd 1", glass(1.5, white), 2),
            ("illum 9\nNi .75\nTf .5", glass(0.75, DVec3::splat(0.5)), 2),
            ("illum 2\nNi 1.45\nd .1", glass(1.45, white), 4),
            ("Tr .9\nNi 2", glass(2.0, white), 2),
            ("Tr .9\nd 1", diffuse(0.8, 0.8, 0.8), 1),
            ("Tr .5\nKd 1 0 0", diffuse(1.0, 0.0, 0.0), 1),
            ("d 0\nmap_d leaf.png\nKd 0 1 0", diffuse(0.0, 1.0, 0.0), 1),
            ("illum 0\nKd 0 0 0", diffuse(0.0, 0.0, 0.0), 1),
            ("illum 10\nNi 3", diffuse(0.8, 0.8, 0.8), 1),
            ("", diffuse(0.8, 0.8, 0.8), 1),
        ] {
            let (material, _) = one(keys);
            assert_eq!((material.scattering, material.origin.line), (scattering, line), "{keys}");
        }
    }

    #[test]
    fn emission_is_kept_and_points_to_its_line() {
        let (material, warnings) = one("Kd 0 0 0\nKe 17 12.5 4");
        assert_eq!(material.emission, DVec3::new(17.0, 12.5, 4.0));
        assert_eq!((material.origin.line, material.detail_origin.line), (1, 3));
        assert!(warnings.is_empty());
        let (material, warnings) = one("Ke -1 0 2");
        assert_eq!(material.emission, DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(warnings[0].origin.line, 2);
    }

    #[test]
    fn values_out_of_range_are_cut_with_a_warning() {
        let (material, warnings) = one("Kd 1.5 -1 0.25");
        assert_eq!(material.scattering, diffuse(1.0, 0.0, 0.25));
        assert_eq!((warnings.len(), warnings[0].origin.line), (1, 2));
        for keys in ["illum 7\nNi 1", "illum 7\nNi 0", "illum 7\nNi -2"] {
            let (material, warnings) = one(keys);
            assert_eq!(material.scattering, glass(1.5, DVec3::ONE));
            assert_eq!((warnings.len(), warnings[0].origin.line), (1, 3));
        }
        let (_, warnings) = one("illum 2\nd 0.7");
        assert!(warnings.len() == 1 && warnings[0].text.contains("d (1)"));
    }

    #[test]
    fn textures_are_shared_and_multiplied_as_stated() {
        let folder = TestFolder::new();
        std::fs::create_dir(folder.path("maps")).unwrap();
        ImageBuffer::from_pixel(1, 1, Rgb([255_u8, 0, 0])).save(folder.path("maps/wood.png")).unwrap();
        let source = "newmtl a\nmap_Kd maps\\wood.png\nnewmtl b\nKd 0 0 0\nmap_Kd -s 2 2 2 maps/wood.png\n\
                      newmtl c\nKd .5 .5 .5\nKe 1 1 1\nmap_Kd maps/wood.png\nnewmtl d\nillum 5\nmap_Kd none.png\n";
        let described = describe_in(&folder, source).unwrap();
        assert_eq!(described.textures.len(), 1);
        assert_eq!(described.textures[0].texels, [[1.0, 0.0, 0.0]]);
        assert_eq!(described.textures[0].origin.line, 2);
        for (material, (albedo, detail)) in described.materials.iter().zip([(1.0, 2), (1.0, 5), (0.5, 8)]) {
            let albedo = DVec3::splat(albedo);
            assert_eq!(material.scattering, ScatteringDescription::Diffuse { albedo, texture: Some(0) });
            assert_eq!(material.detail_origin.line, detail);
        }
        let lines: Vec<_> = described.warnings.iter().map(|warning| warning.origin.line).collect();
        assert_eq!(lines, [5, 12]);
        assert!(described.warnings[1].text.contains("map_Kd (1)"));
    }

    #[test]
    fn a_missing_texture_names_its_line() {
        let error = describe_in(&TestFolder::new(), "newmtl a\n\nmap_Kd none.png").err().unwrap();
        assert_eq!((error.code, error.origin.unwrap().line), (ExitCode::MissingInput, 3));
        assert!(error.cause.contains("none.png"));
        let error = describe_in(&TestFolder::new(), "newmtl a\n\nKd 1 2").err().unwrap();
        assert_eq!((error.code, error.origin.unwrap().line), (ExitCode::BadScene, 3));
    }

    #[test]
    fn one_warning_names_all_keys_that_are_not_simulated() {
        let source = "newmtl a\nKs 1 1 1\nbump x.png\nnewmtl b\nKs 1 1 1\nnewmtl c\nKs 0 0 0\nPm 0.5\n";
        let described = describe_in(&TestFolder::new(), source).unwrap();
        assert_eq!(described.warnings.len(), 1);
        let text = &described.warnings[0].text;
        assert!(text.contains("Ks (2)") && text.contains("bump (1)") && text.contains("Pm (1)"), "{text}");
    }

    #[test]
    fn numbers_are_those_of_the_file() {
        assert_eq!(widen_one(0.8), 0.8);
        assert_eq!(widen_one(1.45), 1.45);
        assert_eq!(widen_one(1e-30), 1e-30);
    }
}
