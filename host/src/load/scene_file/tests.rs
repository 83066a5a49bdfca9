//! Whole scene files and what they describe.

mod fixture_scenes;
mod mistakes;

use super::{load_scene_file, parse};
use crate::description::{
    FilterDescription, FresnelDescription, LightDescription, LightSamplingDescription, SamplerDescription,
    ScatteringDescription, SceneDescription,
};
use crate::error::Error;
use crate::load::test_folder::TestFolder;
use glam::DVec3;
use std::path::{Path, PathBuf};

const CAMERA: &str = "camera = { position = [0, 0, 5], look_at = [0, 0, 0] }\n";
const BALL: &str = "materials.m.kind = \"diffuse\"\nspheres = [{ center = [0, 0, 0], radius = 1, material = \"m\" }]\n";

fn scene(text: &str) -> Result<SceneDescription, Error> {
    parse(text, Path::new("a.toml"))
}

fn good(text: &str) -> SceneDescription {
    scene(text).expect("a good scene")
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

#[test]
fn every_key_reaches_the_description_with_its_line() {
    let scene = good(
        r#"[camera]
position = [0, 0, 55]
look_at = [0, 1, 0]
up = [0, 2, 0]
fov_degrees = 40.5
aperture_radius = 1.5
[film]
width = 64
height = 32
spp = 7
filter = "tent"
filter_radius = 1.5
exposure = -1
gamma = 2.2
[integrator]
max_bounces = 3
indirect = false
light_sampling = "hemisphere"
fresnel = "schlick"
roulette_after = 2
sampler = "sobol"
aim = true
seed = 9
[surroundings]
background = 0.25
ambient_ior = 1.33
[materials.zinc]
kind = "mirror"
reflectance = 0.5
[materials.glass]
kind = "dielectric"
[materials.gem]
kind = "dielectric"
ior = 2.4
exterior_ior = 1
transmittance = [1, 0.5, 0]
[materials.lamp]
kind = "diffuse"
albedo = 0
emission = [1, 2, 3]
[[spheres]]
center = [1, 2, 3]
radius = 4
material = "gem"
inverted = true
[[lights]]
kind = "point"
position = [1, 2, 3]
power = 5
[[lights]]
kind = "sphere"
center = [1, 2, 3]
radius = 2
power = [1e5, 0, 0]
"#,
    );
    assert_eq!(scene.camera.origin.to_string(), "a.toml:1");
    assert_eq!(scene.camera.look_at, DVec3::Y);
    assert_eq!((scene.camera.fov_degrees, scene.camera.aperture_radius), (40.5, 1.5));
    assert_eq!(scene.camera.lens_origin.line, 6);
    assert_eq!(scene.camera.focal_distance, libm::sqrt(55.0 * 55.0 + 1.0));
    assert_eq!((scene.film.origin.line, scene.film.width, scene.film.height, scene.film.spp), (7, 64, 32, 7));
    assert_eq!(scene.film.filter, FilterDescription::Tent { radius: 1.5 });
    assert_eq!(scene.film.filter_origin.line, 11);
    assert_eq!((scene.film.exposure, scene.film.gamma), (-1.0, Some(2.2)));
    let integrator = &scene.integrator;
    assert_eq!((integrator.origin.line, integrator.max_bounces, integrator.seed), (15, 3, 9));
    assert_eq!((integrator.indirect, integrator.indirect_origin.line), (false, 17));
    assert_eq!(integrator.light_sampling, LightSamplingDescription::Hemisphere);
    assert_eq!(integrator.fresnel, FresnelDescription::Schlick);
    assert_eq!((integrator.sampler, integrator.sampler_origin.line), (SamplerDescription::Sobol, 21));
    assert_eq!((integrator.roulette_after, integrator.roulette_origin.line), (Some(2), 20));
    assert_eq!((integrator.aim, integrator.aim_origin.line), (true, 22));
    assert_eq!((integrator.background, integrator.background_origin.line), (DVec3::splat(0.25), 25));
    let materials: Vec<_> = scene
        .materials
        .iter()
        .map(|m| (m.name.as_str(), m.origin.line, m.detail_origin.line, m.emission, m.scattering.clone()))
        .collect();
    let dielectric = |interior_ior, exterior_ior, transmittance| ScatteringDescription::Dielectric {
        interior_ior,
        exterior_ior,
        transmittance,
    };
    assert_eq!(
        materials,
        [
            ("zinc", 27, 27, DVec3::ZERO, ScatteringDescription::Mirror { reflectance: DVec3::splat(0.5) }),
            ("glass", 30, 30, DVec3::ZERO, dielectric(1.5, 1.33, DVec3::ONE)),
            ("gem", 32, 32, DVec3::ZERO, dielectric(2.4, 1.0, DVec3::new(1.0, 0.5, 0.0))),
            (
                "lamp",
                37,
                40,
                DVec3::new(1.0, 2.0, 3.0),
                ScatteringDescription::Diffuse { albedo: DVec3::ZERO, texture: None }
            ),
        ]
    );
    let sphere = &scene.spheres[0];
    assert_eq!((sphere.origin.line, sphere.center, sphere.radius), (41, DVec3::new(1.0, 2.0, 3.0), 4.0));
    assert_eq!((sphere.inverted, sphere.material), (true, 2));
    match scene.lights.as_slice() {
        [
            LightDescription::Point { origin: first, power, .. },
            LightDescription::Sphere { origin: second, radius, radiance, .. },
        ] => {
            assert_eq!((first.line, second.line, *radius), (46, 50, 2.0));
            assert_eq!(*power, DVec3::splat(5.0));
            assert!((radiance.x - 633.257_397_764_611).abs() < 1e-9, "{radiance}");
        }
        other => panic!("a point and a sphere expected, got {other:?}"),
    }
    assert!(scene.warnings.is_empty());
}

#[test]
fn defaults_are_those_of_the_reference_page() {
    let scene = good(&[CAMERA, BALL].concat());
    assert_eq!((scene.camera.up, scene.camera.fov_degrees, scene.camera.aperture_radius), (DVec3::Y, 60.0, 0.0));
    assert_eq!((scene.camera.focal_distance, scene.camera.lens_origin.line), (5.0, 1));
    assert_eq!((scene.film.width, scene.film.height, scene.film.spp), (512, 512, 64));
    assert_eq!((scene.film.filter, scene.film.filter_origin.line), (FilterDescription::Box { width: 1.0 }, 0));
    assert_eq!((scene.film.exposure, scene.film.gamma), (0.0, None));
    let integrator = &scene.integrator;
    assert_eq!((integrator.max_bounces, integrator.indirect, integrator.seed), (7, true, 0));
    assert_eq!((integrator.roulette_after, integrator.background), (None, DVec3::ZERO));
    assert_eq!(integrator.light_sampling, LightSamplingDescription::Cone);
    assert_eq!(integrator.fresnel, FresnelDescription::Exact);
    assert_eq!((integrator.sampler, integrator.aim), (SamplerDescription::Independent, false));
    let grey = ScatteringDescription::Diffuse { albedo: DVec3::splat(0.8), texture: None };
    assert_eq!(scene.materials[0].scattering, grey);
    assert!(!scene.spheres[0].inverted);
    assert_eq!(scene.warnings.len(), 1, "nothing gives light: {:?}", scene.warnings);
    for (filter, meant) in [
        ("center", FilterDescription::Center),
        ("tent", FilterDescription::Tent { radius: 1.0 }),
        ("gaussian", FilterDescription::Gaussian { stdev: 0.5 }),
    ] {
        assert_eq!(good(&format!("film.filter = \"{filter}\"\n{CAMERA}{BALL}")).film.filter, meant);
    }
}

#[test]
fn a_mesh_is_scaled_then_turned_then_moved_and_its_glass_is_in_the_ambient_medium() {
    let folder = TestFolder::new();
    folder.write("a.mtl", "newmtl glass\nillum 7\nNi 1.6\nd 0.1\n");
    folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glass\nf 1 2 3\n");
    let text = format!(
        "{CAMERA}surroundings.ambient_ior = 1.33\n[materials.red]\nkind = \"diffuse\"\n[[meshes]]\nfile = \"a.obj\"\n\
         scale = [2, 3, 4]\nrotate_degrees = [0, 0, 90]\ntranslate = [10, 20, 30]\n[[meshes]]\nfile = \"a.obj\"\n\
         material = \"red\"\n"
    );
    let scene = load_scene_file(&folder.write("a.toml", text)).expect("a good scene");
    assert_eq!(scene.meshes[0].origin.line, 5);
    assert_eq!(scene.meshes[0].world_from_mesh.transform_point3(DVec3::X), DVec3::new(10.0, 22.0, 30.0));
    assert_eq!(scene.meshes[0].world_from_mesh.transform_point3(DVec3::Y), DVec3::new(7.0, 20.0, 30.0));
    let material = &scene.materials[scene.meshes[0].triangles[0].material as usize];
    match material.scattering {
        ScatteringDescription::Dielectric { interior_ior, exterior_ior, .. } => {
            assert!((interior_ior - 1.6).abs() < 1e-6);
            assert_eq!(exterior_ior, 1.33);
        }
        ref other => panic!("glass expected, got {other:?}"),
    }
    assert_eq!(scene.meshes[1].triangles[0].material, 0, "the override");
}

#[test]
fn a_texture_is_read_once_and_shown_as_it_is() {
    let text = format!(
        "{CAMERA}{BALL}[materials.a]\nkind = \"diffuse\"\ntexture = \"tiles.png\"\n\
         [materials.b]\nkind = \"diffuse\"\ntexture = \"tiles.png\"\nalbedo = 0.5\n"
    );
    let scene = parse(&text, &fixtures().join("features/a.toml")).expect("a good scene");
    assert_eq!(scene.textures.len(), 1);
    assert_eq!((scene.textures[0].width, scene.textures[0].height), (16, 8));
    let with = |albedo| ScatteringDescription::Diffuse { albedo: DVec3::splat(albedo), texture: Some(0) };
    let textured: Vec<_> = scene.materials.iter().filter(|m| m.name != "m").collect();
    assert_eq!((&textured[0].scattering, textured[0].detail_origin.line), (&with(1.0), 6));
    assert_eq!((&textured[1].scattering, textured[1].detail_origin.line), (&with(0.5), 9));
}

#[test]
fn a_textured_sphere_is_warned_of() {
    let text = format!(
        "{CAMERA}surroundings.background = 1\n[materials.t]\nkind = \"diffuse\"\ntexture = \"tiles.png\"\n\
         [[spheres]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"t\"\n"
    );
    let scene = parse(&text, &fixtures().join("features/a.toml")).expect("a good scene");
    let warnings: Vec<_> = scene.warnings.iter().map(|warning| warning.origin.line).collect();
    assert_eq!(warnings, [6], "{:?}", scene.warnings);
}
