//! OBJ meshes with their MTL materials.

use crate::description::{
    MaterialDescription, MeshDescription, ScatteringDescription, SceneDescription, TextureDescription,
    TriangleDescription,
};
use crate::error::{Error, Origin, Warning};
use crate::load::mtl::{Materials, default_material, read_library};
use crate::load::mtl_lines::MaterialLines;
use crate::load::obj_lines::{face_line, first_fault};
use crate::load::obj_text::{Has, ObjText, prepare};
use crate::load::polygon::{Outline, Triangulator};
use crate::load::{read_text, resolve};
use glam::{DAffine3, DVec3};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// The geometry of an OBJ file; triangles refer to [`ObjFile::materials`].
#[derive(Clone, Debug, Default)]
pub struct ObjMesh {
    /// Corner positions, all finite.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals, unit length.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, v up, all finite.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles, in file order; polygons are cut into triangles.
    pub triangles: Vec<TriangleDescription>,
}

/// What an OBJ file and its MTL files hold. Indices are into the file's own lists.
#[derive(Clone, Debug)]
pub struct ObjFile {
    /// All faces as one mesh.
    pub mesh: ObjMesh,
    /// The materials that faces use, in the order of first use.
    pub materials: Vec<MaterialDescription>,
    /// The textures that these materials use.
    pub textures: Vec<TextureDescription>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// The first `vn` line, if a face has vertex normals.
    pub normals_origin: Option<Origin>,
}

impl ObjFile {
    /// Adds the mesh to a scene, with its materials and textures, or with the scene's material of index `material` in place
    /// of all of them. `origin` is the line that asks for the mesh.
    pub fn append_to(
        self,
        scene: &mut SceneDescription,
        origin: Origin,
        world_from_mesh: DAffine3,
        material: Option<usize>,
    ) {
        let ObjMesh { positions, normals, uvs, mut triangles } = self.mesh;
        let (first_material, first_texture) = (scene.materials.len(), scene.textures.len());
        for triangle in &mut triangles {
            // A scene holds fewer than 2^32 materials: each takes more than a byte.
            triangle.material = material.unwrap_or(first_material + triangle.material as usize) as u32;
        }
        if material.is_none() {
            scene.textures.extend(self.textures);
            scene.materials.extend(self.materials.into_iter().map(|mut material| {
                if let ScatteringDescription::Diffuse { texture: Some(texture), .. } = &mut material.scattering {
                    *texture += first_texture;
                }
                material
            }));
        }
        scene.warnings.extend(self.warnings);
        let normals_origin = self.normals_origin;
        scene.meshes.push(MeshDescription {
            origin,
            normals_origin,
            positions,
            normals,
            uvs,
            triangles,
            world_from_mesh,
        });
    }
}

/// Reads an OBJ file and the MTL files it names; `asked_by` is the line that names the OBJ file, if a file does.
///
/// All objects and groups become one mesh; lines, points and free-form surfaces are left out. Polygons are cut into triangles by
/// ear clipping. A face whose corners do not all have a normal (one of length zero counts as none) is flat, one whose
/// corners do not all have a texture coordinate has none. Materials follow the table in `load/mtl.rs`.
///
/// # Errors
/// `MissingInput` for a file that cannot be read, with the line that names it; `BadScene` with file and line for an index
/// out of range, a number that is none or not finite, or a texture that cannot be decoded; `BadScene` for a file without faces.
pub fn load_obj(path: &Path, asked_by: Option<Origin>) -> Result<ObjFile, Error> {
    let source = read_text(path, asked_by)?;
    let origin = Origin::file(path);
    let prepared = prepare(&source).map_err(|fault| fault.in_file(&origin))?;
    let faulty = |cause: &str| match first_fault(&source) {
        Some(fault) => fault.in_file(&origin),
        None => Error::bad_scene(origin.clone(), cause.to_string(), "export the mesh again"),
    };
    if prepared.out_of_range {
        return Err(faulty("a face refers to something that the file does not have"));
    }
    if prepared.faces == 0 {
        let remedy = "export the mesh with its faces, as text (`f` lines with three or more corners)";
        return Err(Error::bad_scene(
            origin,
            "the mesh is empty: the file has no faces of three or more corners",
            remedy,
        ));
    }
    let (models, library) = read_with_tobj(path, &origin, &prepared, &faulty)?;

    let mut builder = Builder::default();
    for model in &models {
        if !builder.add(model) {
            return Err(faulty("a vertex is not finite, or the mesh has more than 2^32 vertices"));
        }
    }
    let flat = builder.mesh.triangles.iter().filter(|triangle| !has_area(&builder.mesh, triangle)).count();
    if flat == builder.mesh.triangles.len() {
        let remedy = "export the mesh again; its faces may have collapsed to lines or points";
        return Err(Error::bad_scene(origin, "the mesh is empty: all its faces lie on a line or a point", remedy));
    }
    let normals_used = builder.mesh.triangles.iter().any(|triangle| triangle.normals.is_some());
    let normals_origin = prepared.first_normal.filter(|_| normals_used).map(|line| origin.at(line));
    let mut warnings = text_warnings(&prepared, &origin, &library);
    warnings.extend(builder.warnings(&source, &origin, prepared.first_normal));
    if flat > 0 {
        let text = format!("triangles without an area, which no ray hits: {flat}");
        warnings.push(Warning { origin: origin.clone(), text });
    }

    let mut all = Materials::default();
    let mut materials = Vec::with_capacity(builder.materials.len());
    for used in &builder.materials {
        materials.push(match used.and_then(|index| library.get(index)) {
            Some((material, lines)) => all.describe(material, lines)?,
            None => default_material(origin.clone()),
        });
    }
    let textures = std::mem::take(&mut all.textures);
    warnings.extend(all.into_warnings());
    let mesh = builder.mesh;
    warnings.extend(textures_without_uvs(&mesh, &materials));
    Ok(ObjFile { mesh, materials, textures, warnings, normals_origin })
}

/// Whether a ray can hit a triangle; differences and products of f32 are all but exact in f64.
fn has_area(mesh: &ObjMesh, triangle: &TriangleDescription) -> bool {
    let [a, b, c] = triangle.positions.map(|corner| DVec3::from(mesh.positions[corner as usize].map(f64::from)));
    (b - a).cross(c - a) != DVec3::ZERO
}

/// All materials of the libraries, as tobj numbers them.
type Library = Vec<(tobj::Material, MaterialLines)>;

fn read_with_tobj(
    path: &Path,
    origin: &Origin,
    prepared: &ObjText,
    faulty: &dyn Fn(&str) -> Error,
) -> Result<(Vec<tobj::Model>, Library), Error> {
    let mut libraries: Vec<(PathBuf, Origin)> = Vec::new();
    for (line, names) in &prepared.libraries {
        for library in library_paths(path, names) {
            if libraries.iter().all(|(known, _)| *known != library) {
                libraries.push((library, origin.at(*line)));
            }
        }
    }
    // Materials may be used above their `mtllib` line: all libraries come first, under their number as a name.
    let names: String = (0..libraries.len()).map(|number| format!("mtllib {number}\n")).collect();
    let lines = RefCell::new(Vec::new());
    let failed = RefCell::new(None);
    let load_library = |number: &Path| {
        let library = number.to_str().and_then(|number| libraries.get(number.parse::<usize>().ok()?));
        let (library, asked_by) = library.ok_or(tobj::LoadError::OpenFileFailed)?;
        match read_library(library, asked_by.clone()) {
            Ok((read, its_lines)) => {
                lines.borrow_mut().extend(its_lines);
                read
            }
            // tobj drops the error of one library where another has materials.
            Err(error) => {
                failed.borrow_mut().get_or_insert(error);
                Err(tobj::LoadError::OpenFileFailed)
            }
        }
    };
    let options =
        tobj::LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };
    let mut reader = std::io::Read::chain(names.as_bytes(), prepared.text.as_bytes());
    let read = tobj::load_obj_buf(&mut reader, &options, load_library);
    if let Some(error) = failed.into_inner() {
        return Err(error);
    }
    let (models, materials) = read.map_err(|error| faulty(&format!("cannot read the mesh: {error}")))?;
    let materials = materials.map_err(|error| faulty(&format!("cannot read the materials: {error}")))?;
    Ok((models, materials.into_iter().zip(lines.into_inner()).collect()))
}

/// The files of a `mtllib` statement. File names may hold blanks, and blanks may part file names: it is the former
/// unless no such file exists and one of the parts does.
fn library_paths(obj: &Path, names: &str) -> Vec<PathBuf> {
    let whole = resolve(obj, names);
    let parts: Vec<_> = names.split_whitespace().map(|name| resolve(obj, name)).collect();
    if whole.exists() || !parts.iter().any(|part| part.exists()) { vec![whole] } else { parts }
}

/// Puts tobj's models together.
#[derive(Default)]
struct Builder {
    mesh: ObjMesh,
    /// The library's materials in use; `None` is the default material.
    materials: Vec<Option<usize>>,
    triangulator: Triangulator,
    faces: usize,
    /// Number of polygons that cross themselves, and the first such face.
    crossing: (usize, usize),
    /// Number of normals without direction.
    undirected: usize,
}

impl Builder {
    /// Adds the faces of one model; `false` where a vertex is not finite or too many.
    fn add(&mut self, model: &tobj::Model) -> bool {
        let mesh = &model.mesh;
        let has = Has::of_group(&model.name);
        let finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let (Ok(first_position), Ok(first_uv)) =
            (u32::try_from(self.mesh.positions.len()), u32::try_from(self.mesh.uvs.len()))
        else {
            return false;
        };
        if !finite(&mesh.positions) || (has.uvs && !finite(&mesh.texcoords)) {
            return false;
        }
        let positions = mesh.positions.as_chunks::<3>().0;
        self.mesh.positions.extend(positions);
        let normals = if has.normals { self.add_normals(mesh.normals.as_chunks::<3>().0) } else { Vec::new() };
        if has.uvs {
            self.mesh.uvs.extend(mesh.texcoords.as_chunks::<2>().0);
        }
        let material = self.material(mesh.material_id);

        let mut polygon = Vec::new();
        let mut triangles = Vec::new();
        let mut first = 0;
        let triangle_arities = std::iter::repeat_n(3, mesh.indices.len() / 3);
        let arities: &mut dyn Iterator<Item = usize> = if mesh.face_arities.is_empty() {
            &mut triangle_arities.into_iter()
        } else {
            &mut mesh.face_arities.iter().map(|&arity| arity as usize)
        };
        for arity in arities {
            let face = first..first + arity;
            first += arity;
            let Some(corners) = mesh.indices.get(face.clone()) else { return false };
            let face_uvs = mesh.texcoord_indices.get(face.clone()).filter(|_| has.uvs);
            let face_normals = mesh.normal_indices.get(face).filter(|_| has.normals);
            let face_normals: Option<Vec<u32>> =
                face_normals.and_then(|indices| indices.iter().map(|&index| *normals.get(index as usize)?).collect());
            triangles.clear();
            if arity == 3 {
                triangles.push([0, 1, 2]);
            } else {
                polygon.clear();
                polygon.extend(corners.iter().filter_map(|&corner| positions.get(corner as usize)));
                if self.triangulator.triangulate(&polygon, &mut triangles) == Outline::Crossing {
                    self.crossing =
                        (self.crossing.0 + 1, if self.crossing.0 == 0 { self.faces } else { self.crossing.1 });
                }
            }
            self.faces += 1;
            self.mesh.triangles.extend(triangles.iter().map(|triangle| TriangleDescription {
                positions: triangle.map(|corner| corners[corner] + first_position),
                normals: face_normals.as_ref().map(|indices| triangle.map(|corner| indices[corner])),
                uvs: face_uvs.map(|indices| triangle.map(|corner| indices[corner] + first_uv)),
                material,
            }));
        }
        true
    }

    /// Adds those normals that have a direction, at unit length: OBJ gives their lengths no meaning, but interpolation
    /// would. Gives the new index of each.
    fn add_normals(&mut self, normals: &[[f32; 3]]) -> Vec<Option<u32>> {
        let mut indices = Vec::with_capacity(normals.len());
        for normal in normals {
            let wide = DVec3::from_array(normal.map(f64::from));
            let length = wide.length_squared().sqrt();
            if length > 0.0 && length.is_finite() {
                indices.push(u32::try_from(self.mesh.normals.len()).ok());
                self.mesh.normals.push((wide / length).to_array().map(|component| component as f32));
            } else {
                self.undirected += 1;
                indices.push(None);
            }
        }
        indices
    }

    /// The index of a material of the library among those in use.
    fn material(&mut self, used: Option<usize>) -> u32 {
        let index = self.materials.iter().position(|&known| known == used).unwrap_or_else(|| {
            self.materials.push(used);
            self.materials.len() - 1
        });
        // Each material in use takes a line of the file, which fits in memory.
        index as u32
    }

    fn warnings(&self, source: &str, origin: &Origin, first_normal: Option<usize>) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.crossing.0 > 0 {
            let line = face_line(source, self.crossing.1).unwrap_or(0);
            let text = format!(
                "polygons that cross themselves, each of which becomes a fan of triangles: {}",
                self.crossing.0
            );
            warnings.push(Warning { origin: origin.at(line), text });
        }
        if self.undirected > 0 {
            let text = format!("normals without a direction, which leave their faces flat: {}", self.undirected);
            warnings.push(Warning { origin: origin.at(first_normal.unwrap_or(0)), text });
        }
        warnings
    }
}

/// Warnings about what the text asks for and does not get.
fn text_warnings(prepared: &ObjText, origin: &Origin, library: &Library) -> Vec<Warning> {
    let mut unknown: Vec<_> = prepared
        .materials
        .iter()
        .filter(|(name, _)| library.iter().all(|(material, _)| material.name != **name))
        .map(|(name, &line)| (line, format!("no MTL file defines the material {name}; the default grey is used")))
        .collect();
    unknown.sort();
    let left_out = prepared.left_out.iter().map(|&(line, what)| (line, what.to_string()));
    left_out.chain(unknown).map(|(line, text)| Warning { origin: origin.at(line), text }).collect()
}

/// A warning for each textured material with faces that have no texture coordinates.
fn textures_without_uvs(mesh: &ObjMesh, materials: &[MaterialDescription]) -> Vec<Warning> {
    let mut missing = vec![0_usize; materials.len()];
    for triangle in mesh.triangles.iter().filter(|triangle| triangle.uvs.is_none()) {
        missing[triangle.material as usize] += 1;
    }
    let textured = materials.iter().zip(missing).filter(|(material, missing)| {
        *missing > 0 && matches!(material.scattering, ScatteringDescription::Diffuse { texture: Some(_), .. })
    });
    textured
        .map(|(material, missing)| Warning {
            origin: material.detail_origin.clone(),
            text: format!("{missing} triangles of the material {} have no texture coordinates", material.name),
        })
        .collect()
}

#[cfg(test)]
mod tests;
