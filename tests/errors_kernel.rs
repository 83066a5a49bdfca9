//! Every error of the kernel: made on purpose, and named in words that say which part and what is wrong with it.

use std::error::Error;

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::camera::{Camera, CameraSettings, Filter};
use ocellus_kernel::error::{CameraError, Capacity, CapacityError, GeometryError, SceneError};
use ocellus_kernel::light::{Light, SphereLight};
use ocellus_kernel::real::Real;
use ocellus_kernel::shape::Geometry;
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{Scene, SceneParts};

use crate::support::in_both_precisions;
use crate::support::meshes::cube;
use crate::support::scene::{CAMERA, OwnedScene, Room, v};

in_both_precisions!(geometry_errors, scene_errors, camera_errors, a_camera_of_any_valid_setting_is_accepted);

/// The words of an error must hold each of these.
#[track_caller]
fn assert_says(error: &dyn Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "\"{message}\" does not say \"{word}\"");
    }
}

fn geometry_errors<R: Real>() {
    let mut scene = OwnedScene::<R>::default();
    scene.sphere([0.0; 3], 1.0, 0);
    scene.sphere([0.0; 3], 1.0, 0);
    let [nan, infinity] = [f64::NAN, f64::INFINITY];
    for (center, radius) in [
        ([0.0; 3], 0.0),
        ([0.0; 3], -0.0),
        ([0.0; 3], -1.0),
        ([0.0; 3], nan),
        ([0.0; 3], infinity),
        ([nan, 0.0, 0.0], 1.0),
        ([0.0, -infinity, 0.0], 1.0),
    ] {
        let mut spheres = scene.spheres.clone();
        (spheres[1].center, spheres[1].radius) = (v::<R>(center), R::from_f64(radius));
        let error = Geometry::new(&spheres, &[], &[]).expect_err("a sphere that cannot be");
        assert_eq!(error, GeometryError::Sphere { index: 1 });
        assert_says(&error, &["sphere 1", "centre", "finite", "radius", "positive"]);
    }
    let positions = [v::<R>([0.0; 3]); 3];
    for corner in [3, u32::MAX] {
        let triangles = [[0, 1, 2], [2, 1, 0], [0, 1, corner]];
        let error = Geometry::<R>::new(&[], &positions, &triangles).expect_err("a corner too many");
        assert_eq!(error, GeometryError::TriangleCorner { index: 2, positions: 3 });
        assert_says(&error, &["triangle 2", "corner", "3 positions"]);
    }
    // A slice of more than 2^31 primitives takes 24 GiB: the words at least.
    assert_says(&GeometryError::TooMany, &["2^31 primitives", "split"]);
}

/// What is wrong, the error for it, and its words.
type SceneCase<R> = (fn(&mut OwnedScene<R>), SceneError, &'static [&'static str]);

fn scene_errors<R: Real>() {
    let base = || {
        let mut scene = OwnedScene::<R>::default();
        let grey = scene.diffuse(0.5, 0.0);
        scene.sphere([0.0; 3], 1.0, grey);
        scene.mesh(&cube(1), grey);
        scene
    };
    let cases: [SceneCase<R>; 16] = [
        (
            |scene| scene.attributes.truncate(11),
            SceneError::Attributes { attributes: 11, triangles: 12 },
            &["11", "attributes", "12 triangles", "one for each"],
        ),
        (|scene| scene.spheres[0].material = 1, SceneError::Material { primitive: 0 }, &["primitive 0", "material"]),
        (
            |scene| scene.attributes[4].material = u32::MAX,
            SceneError::Material { primitive: 5 },
            &["primitive 5", "material"],
        ),
        (
            |scene| scene.attributes[3].normals = Some([0, 0, 0]),
            SceneError::TriangleAttribute { index: 3 },
            &["triangle 3", "normal", "texture coordinate"],
        ),
        (
            |scene| {
                scene.uvs.push([R::ZERO; 2]);
                scene.attributes[7].uvs = Some([0, 0, 1]);
            },
            SceneError::TriangleAttribute { index: 7 },
            &["triangle 7", "normal", "texture coordinate"],
        ),
        (
            |scene| {
                scene.diffuse(0.5, 0.0);
                texture_of(scene, 1, 0);
            },
            SceneError::Texture { material: 1 },
            &["material 1", "texture"],
        ),
        (
            |scene| {
                scene.textures = vec![RED; 2];
                texture_of(scene, 0, 2);
            },
            SceneError::Texture { material: 0 },
            &["material 0", "texture"],
        ),
        (
            |scene| scene.textures = vec![RED, Texture { width: 2, ..RED }],
            SceneError::Texels { index: 1 },
            &["texture 1", "width x height", "texels"],
        ),
        (
            |scene| scene.textures = vec![Texture { width: 0, height: 0, texels: &[] }],
            SceneError::Texels { index: 0 },
            &["texture 0", "zero"],
        ),
        (
            // 2^32 texels, which is 0 in 32 bits.
            |scene| scene.textures = vec![Texture { width: 1 << 16, height: 1 << 16, texels: &[] }],
            SceneError::Texels { index: 0 },
            &["texture 0"],
        ),
        (
            |scene| {
                scene.point_light([0.0; 3], 1.0);
                // The number of a triangle is no sphere's.
                scene.lights.push(Light::Sphere(SphereLight { sphere: 1 }));
            },
            SceneError::Light { index: 1 },
            &["light 1", "sphere"],
        ),
        (
            |scene| {
                scene.aim([0.0; 3], 1.0, 1.0);
                scene.aim([0.0, f64::NAN, 0.0], 1.0, 1.0);
            },
            SceneError::Aim { index: 1 },
            &["aim 1", "centre"],
        ),
        (|scene| scene.aim([0.0; 3], f64::INFINITY, 1.0), SceneError::Aim { index: 0 }, &["aim 0", "radius"]),
        (|scene| scene.aim([0.0; 3], 0.0, 1.0), SceneError::Aim { index: 0 }, &["aim 0", "radius"]),
        (|scene| scene.aim([0.0; 3], 1.0, 0.0), SceneError::Aim { index: 0 }, &["aim 0", "worth"]),
        (|scene| scene.aim([0.0; 3], 1.0, 1.5), SceneError::Aim { index: 0 }, &["aim 0", "worth"]),
    ];
    assert!(Scene::new(base().parts()).is_ok());
    for (spoil, expected, words) in cases {
        let mut scene = base();
        spoil(&mut scene);
        let error = Scene::new(scene.parts()).expect_err("parts that do not fit");
        assert_eq!(error, expected);
        assert_says(&error, words);
    }

    let other = base();
    let geometry = other.geometry();
    let mut room = Room::for_scene(&geometry);
    let bvh = room.build(&geometry, Structure::Bvh).expect("enough room");
    let mut scene = base();
    scene.sphere([3.0; 3], 1.0, 0);
    let error = Scene::new(SceneParts { bvh: Some(bvh), ..scene.parts() }).expect_err("another geometry");
    assert_eq!(error, SceneError::Bvh { built_for: [1, 12], primitives: [2, 12] });
    assert_says(&error, &["BVH", "1 spheres and 12 triangles", "2 and 12", "build it again"]);
}

const RED: Texture<'static> = Texture { width: 1, height: 1, texels: &[[1.0, 0.0, 0.0]] };

fn texture_of<R: Real>(scene: &mut OwnedScene<R>, material: usize, texture: u32) {
    if let ocellus_kernel::material::Scattering::Diffuse(diffuse) = &mut scene.materials[material].scattering {
        diffuse.texture = Some(texture);
    }
}

fn camera_errors<R: Real>() {
    let cases: &[(CameraSettings, CameraError, &[&str])] = &[
        (CameraSettings { position: [0.0, f64::NAN, 0.0], ..CAMERA }, CameraError::NotFinite, &["NaN", "infinite"]),
        (CameraSettings { look_at: [f64::INFINITY, 0.0, 0.0], ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { up: [0.0, f64::NEG_INFINITY, 0.0], ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { field_of_view: f64::NAN, ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { aperture_radius: f64::NAN, ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { focal_distance: f64::INFINITY, ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { filter: Filter::Gaussian(f64::NAN), ..CAMERA }, CameraError::NotFinite, &["NaN"]),
        (CameraSettings { width: 0, ..CAMERA }, CameraError::Size, &["width", "height", "1..=65535"]),
        (CameraSettings { height: 0, ..CAMERA }, CameraError::Size, &["height"]),
        (CameraSettings { width: 65_536, ..CAMERA }, CameraError::Size, &["width"]),
        (CameraSettings { height: u32::MAX, ..CAMERA }, CameraError::Size, &["height"]),
        (CameraSettings { field_of_view: 0.0, ..CAMERA }, CameraError::FieldOfView, &["field of view", "pi"]),
        (CameraSettings { field_of_view: -1.0, ..CAMERA }, CameraError::FieldOfView, &["field of view"]),
        (
            CameraSettings { field_of_view: std::f64::consts::PI, ..CAMERA },
            CameraError::FieldOfView,
            &["field of view"],
        ),
        (CameraSettings { look_at: CAMERA.position, ..CAMERA }, CameraError::Orientation, &["look", "up"]),
        (CameraSettings { up: [0.0; 3], ..CAMERA }, CameraError::Orientation, &["up"]),
        (CameraSettings { up: [0.0, 0.0, -3.0], ..CAMERA }, CameraError::Orientation, &["up"]),
        (CameraSettings { aperture_radius: -0.1, ..CAMERA }, CameraError::Lens, &["aperture", "focal distance"]),
        (
            CameraSettings { aperture_radius: 0.1, focal_distance: 0.0, ..CAMERA },
            CameraError::Lens,
            &["focal distance", "positive"],
        ),
        (CameraSettings { filter: Filter::Box(-1.0), ..CAMERA }, CameraError::Filter, &["filter", "negative"]),
        (CameraSettings { filter: Filter::Tent(-1.0), ..CAMERA }, CameraError::Filter, &["filter"]),
        (CameraSettings { filter: Filter::Gaussian(-1.0), ..CAMERA }, CameraError::Filter, &["filter"]),
    ];
    for (settings, expected, words) in cases {
        let error = Camera::<R>::new(settings).expect_err("settings of no camera");
        assert_eq!(error, *expected, "{settings:?}");
        assert_says(&error, words);
        assert_says(&error, &["camera"]);
    }
}

fn a_camera_of_any_valid_setting_is_accepted<R: Real>() {
    for settings in [
        CameraSettings { width: 65_535, height: 1, ..CAMERA },
        CameraSettings { field_of_view: 1e-6, ..CAMERA },
        CameraSettings { field_of_view: 3.12, ..CAMERA },
        CameraSettings { aperture_radius: 0.0, focal_distance: 0.0, ..CAMERA },
        CameraSettings { filter: Filter::Gaussian(0.0), ..CAMERA },
    ] {
        let camera = Camera::<R>::new(&settings);
        assert!(camera.is_ok_and(|camera| camera.size() == [settings.width, settings.height]), "{settings:?}");
    }
}

/// The values are checked where storages are too small, beside the hierarchy; here the words.
#[test]
fn capacity_errors_say_what_is_needed() {
    for (what, word) in [
        (Capacity::Nodes, "nodes"),
        (Capacity::SphereQuads, "sphere quads"),
        (Capacity::TriangleQuads, "triangle quads"),
        (Capacity::Scratch, "build scratch"),
    ] {
        let error = CapacityError { what, needed: 23, capacity: 7 };
        assert_says(&error, &[word, "23 needed", "room for 7", "larger"]);
    }
}
