//! A bare OBJ file as a scene: the camera and the light are chosen for it.
//!
//! The rules, where c and r are the centre and radius of a sphere around the mesh's bounding box:
//! - Camera: 40 degrees wide, so far away that this sphere just fits the picture, 20 degrees above the horizon and 35 degrees
//!   to the right of +z (a three-quarter view), looking at c, y up. Pinhole.
//! - Light: a soft grey surround of radiance 0.5 and a key light, a sphere of radius r whose centre is 4 r from c, 45 degrees
//!   up and to the left of the camera. Its radiance of 8 shines on what faces it with pi/2 (irradiance pi 8 / 4^2), as much as
//!   the surround does at most, so a surface of albedo 0.8 that sees both comes out near 0.8.
//! - A file whose materials emit (`Ke`) lights itself: no key light, and a surround of 0.05 so that its shadows are not black.
//! - 512 x 512 pixels, 64 spp, box filter one pixel wide, `max_bounces` 7.
//!
//! All lengths are multiples of r, so a model in millimetres and the same one in kilometres give the same picture.

use super::obj::load_obj;
use crate::description::{
    CameraDescription, FilmDescription, FilterDescription, FresnelDescription, IntegratorDescription, LightDescription,
    LightSamplingDescription, SamplerDescription, SceneDescription,
};
use crate::error::{Error, Origin};
use glam::{DAffine3, DVec3};
use std::path::Path;

const FOV_DEGREES: f64 = 40.0;
const CAMERA_AZIMUTH_DEGREES: f64 = 35.0;
const CAMERA_ELEVATION_DEGREES: f64 = 20.0;

const KEY_AZIMUTH_DEGREES: f64 = -30.0;
const KEY_ELEVATION_DEGREES: f64 = 45.0;
/// In radii of the mesh.
const KEY_DISTANCE: f64 = 4.0;
const KEY_RADIANCE: f64 = 8.0;

const SURROUND: f64 = 0.5;
const SURROUND_OF_EMITTERS: f64 = 0.05;

/// A little air around the mesh: the share of the picture that its sphere fills.
const FILL: f64 = 0.98;

/// Reads the OBJ file `path` as a scene of its own, by the rules of this module.
///
/// # Errors
/// Those of [`load_obj`], and a mesh that is a single point or too large for 32-bit floats.
pub fn load_bare_obj(path: &Path) -> Result<SceneDescription, Error> {
    let origin = Origin::file(path);
    let mut scene = SceneDescription {
        camera: camera(&origin, DVec3::ZERO, 1.0),
        film: film(&origin),
        integrator: integrator(&origin),
        origin: origin.clone(),
        materials: Vec::new(),
        textures: Vec::new(),
        spheres: Vec::new(),
        meshes: Vec::new(),
        lights: Vec::new(),
        warnings: Vec::new(),
    };
    load_obj(path, None)?.append_to(&mut scene, origin.clone(), DAffine3::IDENTITY, None);

    let (center, radius) = bounding_sphere(&scene).ok_or_else(|| {
        let cause = "the mesh has no size, or one that 32-bit floats cannot hold";
        Error::bad_scene(origin.clone(), cause, "scale it, or check its `v` lines")
    })?;
    scene.camera = camera(&origin, center, radius);
    if emits(&scene) {
        scene.integrator.background = DVec3::splat(SURROUND_OF_EMITTERS);
    } else {
        scene.integrator.background = DVec3::splat(SURROUND);
        scene.lights.push(LightDescription::Sphere {
            origin,
            center: center + KEY_DISTANCE * radius * direction(KEY_AZIMUTH_DEGREES, KEY_ELEVATION_DEGREES),
            radius,
            radiance: DVec3::splat(KEY_RADIANCE),
        });
    }
    Ok(scene)
}

/// A unit vector; azimuth from +z towards +x, elevation from the horizon towards +y.
fn direction(azimuth_degrees: f64, elevation_degrees: f64) -> DVec3 {
    let (azimuth, elevation) = (azimuth_degrees.to_radians(), elevation_degrees.to_radians());
    let level = libm::cos(elevation);
    DVec3::new(level * libm::sin(azimuth), libm::sin(elevation), level * libm::cos(azimuth))
}

/// The sphere of radius `radius` around `center` touches the sides of the picture, less [`FILL`].
fn camera(origin: &Origin, center: DVec3, radius: f64) -> CameraDescription {
    let distance = radius / (FILL * libm::sin((FOV_DEGREES / 2.0).to_radians()));
    CameraDescription {
        origin: origin.clone(),
        position: center + distance * direction(CAMERA_AZIMUTH_DEGREES, CAMERA_ELEVATION_DEGREES),
        look_at: center,
        up: DVec3::Y,
        fov_degrees: FOV_DEGREES,
        aperture_radius: 0.0,
        focal_distance: distance,
        lens_origin: origin.clone(),
    }
}

fn film(origin: &Origin) -> FilmDescription {
    FilmDescription {
        origin: origin.clone(),
        width: 512,
        height: 512,
        spp: 64,
        filter: FilterDescription::Box { width: 1.0 },
        filter_origin: origin.clone(),
        exposure: 0.0,
        gamma: None,
    }
}

fn integrator(origin: &Origin) -> IntegratorDescription {
    IntegratorDescription {
        origin: origin.clone(),
        max_bounces: 7,
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
    }
}

/// The corners that triangles use: a stray `v` line must not move the camera.
fn corners(scene: &SceneDescription) -> impl Iterator<Item = DVec3> {
    scene.meshes.iter().flat_map(|mesh| {
        let indices = mesh.triangles.iter().flat_map(|triangle| triangle.positions);
        let positions = indices.filter_map(|index| mesh.positions.get(index as usize));
        positions.map(|&[x, y, z]| DVec3::new(x.into(), y.into(), z.into()))
    })
}

/// Centre and radius of the sphere around the bounds; `None` where the picture could not be framed in f32.
fn bounding_sphere(scene: &SceneDescription) -> Option<(DVec3, f64)> {
    let least = corners(scene).reduce(DVec3::min)?;
    let most = corners(scene).reduce(DVec3::max)?;
    let (center, radius) = ((least + most) / 2.0, (most - least).length() / 2.0);
    let reach = center.abs().max_element() + 2.0 * KEY_DISTANCE * radius;
    (radius as f32 > 0.0 && (reach as f32).is_finite()).then_some((center, radius))
}

fn emits(scene: &SceneDescription) -> bool {
    let triangles = scene.meshes.iter().flat_map(|mesh| &mesh.triangles);
    let mut materials = triangles.filter_map(|triangle| scene.materials.get(triangle.material as usize));
    materials.any(|material| material.emission != DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::test_folder::TestFolder;

    /// A long, thin, slanted box.
    const SHAPE: [[f64; 3]; 4] = [[-3.0, 0.0, 0.5], [4.0, 0.5, -0.25], [0.0, 2.0, 0.0], [1.0, 0.25, 7.0]];

    fn text(scale: f64, moved: DVec3) -> String {
        let vertices = SHAPE.map(|v| {
            let v = DVec3::from_array(v) * scale + moved;
            format!("v {:e} {:e} {:e}\n", v.x, v.y, v.z)
        });
        // The stray vertex belongs to no face.
        format!("{}v 1e9 1e9 1e9\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n", vertices.concat())
    }

    #[test]
    fn every_corner_is_in_the_picture_and_fills_it_at_any_scale_and_place() {
        let folder = TestFolder::new();
        for scale in [1e-3, 1.0, 25.4, 1e3] {
            for moved in [DVec3::ZERO, DVec3::new(30.0, -20.0, 5.0) * scale] {
                let scene = load_bare_obj(&folder.write("a.obj", text(scale, moved))).expect("a scene");
                let camera = &scene.camera;
                let view = (camera.look_at - camera.position) / camera.focal_distance;
                assert!((view.length() - 1.0).abs() < 1e-9);
                assert!(view.y < 0.0, "from above");
                let right = view.cross(camera.up) / view.cross(camera.up).length();
                let above = right.cross(view);
                let edge = libm::tan((camera.fov_degrees / 2.0).to_radians());
                let mut widest = 0.0_f64;
                for corner in corners(&scene) {
                    let seen = corner - camera.position;
                    let depth = seen.dot(view);
                    assert!(depth > 0.0, "behind the camera at scale {scale}");
                    widest = widest.max((seen.dot(right) / (depth * edge)).abs());
                    widest = widest.max((seen.dot(above) / (depth * edge)).abs());
                }
                assert!((0.5..=1.0).contains(&widest), "fills {widest} at scale {scale}, moved by {moved}");
            }
        }
    }

    #[test]
    fn the_light_scales_with_the_mesh_and_its_radiance_does_not() {
        let folder = TestFolder::new();
        let light = |scale: f64| {
            let scene = load_bare_obj(&folder.write("a.obj", text(scale, DVec3::ZERO))).expect("a scene");
            match scene.lights.as_slice() {
                [LightDescription::Sphere { center, radius, radiance, .. }] => {
                    let (mesh_center, mesh_radius) = bounding_sphere(&scene).expect("a size");
                    let apart = (*center - mesh_center).length();
                    assert!(apart > mesh_radius + radius, "the light stands in the mesh");
                    assert!((scene.camera.position - *center).length() > *radius, "the camera stands in the light");
                    (apart / mesh_radius, radius / mesh_radius, *radiance, scene.integrator.background)
                }
                other => panic!("one sphere light expected, got {other:?}"),
            }
        };
        let (apart, radius, radiance, background) = light(1.0);
        for scale in [1e-3, 1e3] {
            let scaled = light(scale);
            assert!((scaled.0 / apart - 1.0).abs() < 1e-6 && (scaled.1 / radius - 1.0).abs() < 1e-6);
            assert_eq!((scaled.2, scaled.3), (radiance, background));
        }
    }

    #[test]
    fn a_mesh_that_emits_gets_no_light() {
        let folder = TestFolder::new();
        folder.write("a.mtl", "newmtl lamp\nKe 5 5 5\n");
        let text = format!("mtllib a.mtl\nusemtl lamp\n{}", text(1.0, DVec3::ZERO));
        let scene = load_bare_obj(&folder.write("a.obj", text)).expect("a scene");
        assert!(scene.lights.is_empty());
        assert_eq!(scene.integrator.background, DVec3::splat(SURROUND_OF_EMITTERS));
    }

    #[test]
    fn a_mesh_that_cannot_be_framed_is_an_error() {
        let folder = TestFolder::new();
        let huge = folder.write("huge.obj", "v -3e38 0 0\nv 3e38 0 0\nv 0 3e38 0\nf 1 2 3\n");
        let point = folder.write("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
        for path in [huge, point] {
            let error = load_bare_obj(&path).expect_err("no frame");
            assert_eq!(error.file().as_deref(), Some(path.as_path()));
        }
    }
}
