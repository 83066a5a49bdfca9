use super::*;
use crate::description::{
    CameraDescription, FilmDescription, FilterDescription, FresnelDescription, IntegratorDescription,
    LightSamplingDescription, SamplerDescription,
};
use crate::error::ExitCode;
use crate::load::test_folder::TestFolder;
use image::{ImageBuffer, Rgb};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn load(text: &str) -> Result<ObjFile, Error> {
    let folder = TestFolder::new();
    load_obj(&folder.write("a.obj", text), None)
}

fn fault(text: &str) -> (usize, String) {
    let error = load(text).expect_err(text);
    assert_eq!(error.code, ExitCode::BadScene);
    (error.origin.expect("a place").line, error.cause)
}

fn corners(file: &ObjFile, triangle: usize) -> [[f32; 3]; 3] {
    file.mesh.triangles[triangle].positions.map(|corner| file.mesh.positions[corner as usize])
}

fn area(file: &ObjFile) -> f64 {
    let areas = (0..file.mesh.triangles.len()).map(|triangle| {
        let [a, b, c] = corners(file, triangle).map(|p| DVec3::from_array(p.map(f64::from)));
        0.5 * (b - a).cross(c - a).length_squared().sqrt()
    });
    areas.sum()
}

fn empty_scene() -> SceneDescription {
    let origin = Origin::file(Path::new("scene.toml"));
    SceneDescription {
        origin: origin.clone(),
        camera: CameraDescription {
            origin: origin.clone(),
            position: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_degrees: 40.0,
            aperture_radius: 0.0,
            focal_distance: 1.0,
            lens_origin: origin.clone(),
        },
        film: FilmDescription {
            origin: origin.clone(),
            width: 1,
            height: 1,
            spp: 1,
            filter: FilterDescription::Center,
            filter_origin: origin.clone(),
            exposure: 0.0,
            gamma: None,
        },
        integrator: IntegratorDescription {
            origin: origin.clone(),
            max_bounces: 1,
            indirect: true,
            indirect_origin: origin.clone(),
            light_sampling: LightSamplingDescription::Cone,
            fresnel: FresnelDescription::Exact,
            roulette_after: None,
            roulette_origin: origin.clone(),
            aim: false,
            aim_origin: origin.clone(),
            background: DVec3::ZERO,
            background_origin: origin.clone(),
            sampler: SamplerDescription::Independent,
            sampler_origin: origin.clone(),
            seed: 0,
        },
        materials: vec![default_material(origin)],
        textures: Vec::new(),
        spheres: Vec::new(),
        meshes: Vec::new(),
        lights: Vec::new(),
        warnings: Vec::new(),
    }
}

#[test]
fn a_plain_square_has_the_default_material_and_no_normals() {
    let file = load(&format!("{SQUARE}f 1 2 3 4")).unwrap();
    assert_eq!(file.mesh.triangles.len(), 2);
    assert_eq!(corners(&file, 1), [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert!(file.mesh.triangles.iter().all(|triangle| triangle.normals.is_none() && triangle.uvs.is_none()));
    assert_eq!(file.materials.len(), 1);
    let grey = ScatteringDescription::Diffuse { albedo: DVec3::splat(0.8), texture: None };
    assert_eq!((file.materials[0].name.as_str(), &file.materials[0].scattering), ("default", &grey));
    assert!(file.warnings.is_empty() && file.normals_origin.is_none());
}

#[test]
fn windows_line_ends_and_relative_indices_are_read() {
    let text = format!("\u{feff}{SQUARE}f -4 -3 -2\nv 5 0 0\nf -1 1 -2\n").replace('\n', "\r\n");
    let file = load(&text).unwrap();
    assert_eq!(corners(&file, 0), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(corners(&file, 1), [[5.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn concave_faces_keep_their_area() {
    let l = "v 0 0 5\nv 2 0 5\nv 2 1 5\nv 1 1 5\nv 1 2 5\nv 0 2 5\n";
    for start in 0..6 {
        let face: Vec<_> = (0..6).map(|i| ((i + start) % 6 + 1).to_string()).collect();
        let file = load(&format!("{l}f {}", face.join(" "))).unwrap();
        assert_eq!((file.mesh.triangles.len(), area(&file)), (4, 3.0));
    }
}

#[test]
fn mixed_faces_keep_exactly_what_they_have() {
    let data = "vt .1 0\nvt .2 0\nvt .3 0\nvt .4 0\nvn 0 0 2\nvn 0 3 0\nvn 0 0 0\n";
    let faces = "f 1 2 3\nf 1//1 2//2 3//1\nf 1/1 2/2 3/3\nf 2/4/2 3/3/2 4/2/1\nf 1/1/1 2/2 3\nf 1//3 2//1 3//1\nf 4//2 3//2 2//1 1//1";
    let file = load(&format!("{SQUARE}{data}{faces}")).unwrap();
    let normal = |triangle: usize| {
        file.mesh.triangles[triangle].normals.map(|n| n.map(|index| file.mesh.normals[index as usize]))
    };
    let uv = |triangle: usize| {
        file.mesh.triangles[triangle].uvs.map(|uvs| uvs.map(|index| file.mesh.uvs[index as usize][0]))
    };
    let (z, y) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    assert_eq!((normal(0), uv(0)), (None, None));
    assert_eq!((normal(1), uv(1)), (Some([z, y, z]), None));
    assert_eq!((normal(2), uv(2)), (None, Some([0.1, 0.2, 0.3])));
    assert_eq!((normal(3), uv(3)), (Some([y, y, z]), Some([0.4, 0.3, 0.2])));
    assert_eq!((normal(4), uv(4)), (None, None));
    assert_eq!((normal(5), uv(5)), (None, None), "a normal of length zero counts as missing");
    assert_eq!((normal(6), normal(7)), (Some([y, y, z]), Some([y, z, z])));
    assert_eq!(corners(&file, 3), [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(file.normals_origin.as_ref().unwrap().line, 9);
    assert_eq!(file.warnings.len(), 1);
    assert!(file.warnings[0].text.ends_with(": 1"));
}

#[test]
fn unused_normals_ask_for_nothing() {
    let file = load(&format!("{SQUARE}vn 0 0 1\nf 1 2 3")).unwrap();
    assert_eq!(file.normals_origin, None);
}

#[test]
fn only_materials_in_use_are_kept_over_objects_and_libraries() {
    let folder = TestFolder::new();
    folder.write("sub/one.mtl", "newmtl red\nKd 1 0 0\nnewmtl unused\nmap_Kd none.png\n");
    folder.write("sub/two three.mtl", "newmtl mirror\nillum 3\n");
    let text = format!(
        "o first\nusemtl mirror\n{SQUARE}f 1 2 3\ng part\nusemtl red\nf 1 2 3\no second\nf 2 3 4\nusemtl nowhere\nf 1 2 4\n\
         usemtl mirror\nf 1 3 4\nmtllib one.mtl\nmtllib two three.mtl\nmtllib one.mtl\n"
    );
    let file = load_obj(&folder.write("sub/a.obj", text), None).unwrap();
    let names: Vec<_> = file.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["mirror", "red", "default"]);
    let used: Vec<_> = file.mesh.triangles.iter().map(|triangle| triangle.material).collect();
    assert_eq!(used, [0, 1, 1, 2, 0]);
    assert_eq!(file.materials[0].origin.line, 2);
    assert!(file.materials[0].origin.file.ends_with("two three.mtl"));
    assert_eq!(file.warnings.len(), 1);
    assert_eq!(file.warnings[0].origin.line, 13);
    assert!(file.warnings[0].text.contains("nowhere"));
}

#[test]
fn one_statement_may_name_several_libraries() {
    let folder = TestFolder::new();
    folder.write("a.mtl", "newmtl a\n");
    folder.write("b.mtl", "newmtl b\n");
    let text = format!("mtllib a.mtl b.mtl\n{SQUARE}usemtl b\nf 1 2 3\nusemtl a\nf 1 2 4\n");
    let file = load_obj(&folder.write("a.obj", text), None).unwrap();
    assert!(file.warnings.is_empty());
    assert_eq!(file.materials.iter().map(|material| material.name.as_str()).collect::<Vec<_>>(), ["b", "a"]);
}

#[test]
fn missing_files_are_told_with_the_line_that_names_them() {
    let folder = TestFolder::new();
    let asked_by = Origin::file(Path::new("scene.toml")).at(4);
    let error = load_obj(&folder.path("none.obj"), Some(asked_by.clone())).unwrap_err();
    assert_eq!((error.code, error.origin), (ExitCode::MissingInput, Some(asked_by)));

    folder.write("good.mtl", "newmtl good\n");
    let obj = folder.write("a.obj", format!("# c\nmtllib good.mtl\nmtllib none.mtl\n{SQUARE}f 1 2 3"));
    let error = load_obj(&obj, None).unwrap_err();
    assert_eq!((error.code, error.origin), (ExitCode::MissingInput, Some(Origin::file(&obj).at(3))));
    assert!(error.cause.contains("none.mtl"));

    let mtl = folder.write("good.mtl", "newmtl good\nKd 1 2\n");
    let obj = folder.write("a.obj", format!("mtllib good.mtl\n{SQUARE}f 1 2 3"));
    let error = load_obj(&obj, None).unwrap_err();
    assert_eq!((error.code, error.origin), (ExitCode::BadScene, Some(Origin::file(&mtl).at(2))));
}

#[test]
fn every_fault_has_its_line_and_cause() {
    for (statement, cause) in [
        ("f 1 2 5", "position 5"),
        ("f 1/1 2/1 3/1", "texture coordinate 1"),
        ("f 1//1 2//1 3//1", "normal 1"),
        ("f 1 2 -5", "position -5"),
        ("f 1//-1 2//-1 3//-1", "normal -1"),
        ("f 1/-9223372036854775807 2 3", "texture coordinate -9223372036854775807"),
        ("f 1/9223372036854775807 2 3", "texture coordinate 9223372036854775807"),
        ("f 0 1 2", "index 0"),
        ("f 1/0 2/0 3/0", "index 0"),
        ("f 1 2 x", "no index"),
        ("v 1 2", "2 numbers"),
        ("v 1 2 x", "x is no number"),
        ("vn 1 2", "2 numbers"),
        ("vt x 0", "x is no number"),
        ("usemtl", "without a name"),
    ] {
        let (line, found) = fault(&format!("{SQUARE}\n{statement}\nf 1 2 3\n"));
        assert!(line == 6 && found.contains(cause), "{statement}: {line} {found}");
    }
    let (line, cause) = fault("v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3");
    assert!(line == 3 && cause.contains("not finite"));
    let (line, cause) = fault(&format!("{SQUARE}vt inf 0\nf 1/1 2/1 3/1"));
    assert!(line == 5 && cause.contains("not finite"));
}

#[test]
fn meshes_without_faces_are_empty() {
    for text in ["", "# nothing", SQUARE, "v 0 0 0\nl 1 1\np 1\nf 1 1", "v 0 0 0\nf 1 1 1 1", "\0\u{1}\u{2}"] {
        assert!(fault(text).1.contains("the mesh is empty"), "{text}");
    }
}

#[test]
fn what_is_left_out_is_said_once() {
    let text =
        "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 0 0\nl 1 2 3\nf 1 2\nf 2 1\nf 1 2 3\nusemtl gone\nf 1 2 3\nusemtl gone\n";
    let file = load(text).unwrap();
    assert_eq!(file.mesh.triangles.len(), 2);
    let lines: Vec<_> = file.warnings.iter().map(|warning| warning.origin.line).collect();
    assert_eq!(lines, [1, 5, 8]);
}

#[test]
fn crossing_polygons_are_fanned_with_a_warning_at_the_first() {
    let text = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2\nf 1 2 3\n\nf 1 2 3 4\nf 4 3 2 1\n";
    let file = load(text).unwrap();
    assert_eq!(file.mesh.triangles.len(), 5);
    let warning = file.warnings.iter().find(|warning| warning.text.contains("cross")).unwrap();
    assert_eq!(warning.origin.line, 8);
    assert!(warning.text.ends_with(": 2"));
}

#[test]
fn damaged_bytes_never_panic() {
    let folder = TestFolder::new();
    folder.write("a.mtl", b"newmtl caf\xe9\nKd 1 0 0\n");
    let good =
        b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl caf\xe9\nf 1/1/1 2/-1/-1 3//1\nf 1 2 3 1\n";
    let path = folder.write("a.obj", good);
    assert_eq!(load_obj(&path, None).unwrap().materials.len(), 1);
    for index in 0..good.len() {
        for byte in [0, b' ', b'\n', b'/', b'-', b'9', 0xff] {
            let mut bad = good.to_vec();
            bad[index] = byte;
            load_obj(&folder.write("a.obj", &bad), None).ok();
        }
        load_obj(&folder.write("a.obj", &good[..index]), None).ok();
    }
}

#[test]
fn a_texture_needs_texture_coordinates() {
    let folder = TestFolder::new();
    ImageBuffer::from_pixel(1, 1, Rgb([255_u8; 3])).save(folder.path("a.png")).unwrap();
    folder.write("a.mtl", "newmtl a\nmap_Kd a.png\n");
    let text = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1\nf 1 2 3 4\n");
    let file = load_obj(&folder.write("a.obj", text), None).unwrap();
    assert_eq!((file.textures.len(), file.warnings.len()), (1, 1));
    assert!(file.warnings[0].text.starts_with("2 triangles of the material a"));
    assert_eq!(file.warnings[0].origin.line, 2);
}

#[test]
fn appending_moves_indices_behind_those_of_the_scene() {
    let folder = TestFolder::new();
    ImageBuffer::from_pixel(1, 1, Rgb([255_u8; 3])).save(folder.path("a.png")).unwrap();
    folder.write("a.mtl", "newmtl a\nmap_Kd a.png\nnewmtl b\nillum 3\n");
    let text = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nvn 0 0 1\nusemtl b\nf 1 2 3\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n");
    let path = folder.write("a.obj", text);
    let origin = Origin::file(Path::new("scene.toml")).at(9);
    let moved = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0));

    let mut scene = empty_scene();
    for _ in 0..2 {
        load_obj(&path, None).unwrap().append_to(&mut scene, origin.clone(), moved, None);
    }
    load_obj(&path, None).unwrap().append_to(&mut scene, origin.clone(), DAffine3::IDENTITY, Some(0));
    assert_eq!((scene.materials.len(), scene.textures.len(), scene.meshes.len()), (5, 2, 3));
    let used = |mesh: usize| scene.meshes[mesh].triangles.iter().map(|t| t.material).collect::<Vec<_>>();
    assert_eq!((used(0), used(1), used(2)), (vec![1, 2], vec![3, 4], vec![0, 0]));
    let texture = |material: usize| match scene.materials[material].scattering {
        ScatteringDescription::Diffuse { texture, .. } => texture,
        _ => None,
    };
    assert_eq!([0, 1, 2, 3, 4].map(texture), [None, None, Some(0), None, Some(1)]);
    assert_eq!(scene.meshes[1].world_from_mesh, moved);
    assert_eq!(scene.meshes[1].origin, origin);
    assert_eq!(scene.meshes[0].normals_origin, Some(Origin::file(&path).at(7)));
}

/// Meshes from elsewhere, in the folder that `OCELLUS_DATA` names.
#[test]
fn real_meshes_load_whole() {
    let Some(folder) = std::env::var_os("OCELLUS_DATA").map(|folder| PathBuf::from(folder).join("models")) else {
        println!("skipped: OCELLUS_DATA names no folder with models/*.obj");
        return;
    };
    for (name, triangles, uvs, normals) in [
        ("spot.obj", 5856, true, false),
        ("teapot.obj", 6320, false, false),
        ("suzanne.obj", 968, false, true),
        ("stanford-bunny.obj", 69451, false, false),
    ] {
        let start = std::time::Instant::now();
        let file = load_obj(&folder.join(name), None).unwrap();
        println!("{name}: {:?}", start.elapsed());
        assert_eq!(file.mesh.triangles.len(), triangles, "{name}");
        assert!(file.mesh.triangles.iter().all(|t| t.uvs.is_some() == uvs && t.normals.is_some() == normals));
        assert!(file.warnings.is_empty(), "{name}: {:?}", file.warnings);
    }
}

#[test]
fn triangles_without_an_area_are_named_and_alone_make_no_mesh() {
    let line = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n";
    assert!(load(line).unwrap_err().cause.contains("on a line or a point"));
    let file = load(&format!("{line}f 1 2 4\n")).unwrap();
    assert!(file.warnings.iter().any(|warning| warning.text.ends_with("which no ray hits: 1")), "{:?}", file.warnings);
}
