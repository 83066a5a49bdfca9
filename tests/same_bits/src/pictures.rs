//! Small pictures that between them have every effect.

use ocellus_kernel::bvh::{BuildItem, BvhStorage, Structure};
use ocellus_kernel::camera::{CameraSettings, Filter};
use ocellus_kernel::light::{Light, PointLight, SphereLight};
use ocellus_kernel::material::{Dielectric, Diffuse, Material, Mirror, Scattering};
use ocellus_kernel::real::{Real, Vec3, Vector, vec3_from_f64};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::shape::{Geometry, Sphere, TriangleAttributes};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{Aim, Camera, Everything, ImageHash, PathOptions, Pixel, SamplerKind, Scene, SceneParts, View};

use crate::operations::TEXELS;

const WIDTH: u32 = 20;
const HEIGHT: u32 = 16;
const SAMPLES: u32 = 2;

const CAMERA: CameraSettings = CameraSettings {
    position: [0.0, 1.0, 6.0],
    look_at: [0.0, 0.0, 0.0],
    up: [0.0, 1.0, 0.0],
    field_of_view: 0.8,
    width: WIDTH,
    height: HEIGHT,
    aperture_radius: 0.0,
    focal_distance: 6.0,
    filter: Filter::Box(1.0),
};

fn hash<R: Real>(scene: &Scene<'_, R>, settings: &CameraSettings, options: &PathOptions) -> u64 {
    let camera = Camera::<R>::new(settings).expect("a camera");
    let view = View { scene, camera: &camera, options };
    let mut hash = ImageHash::new(WIDTH, HEIGHT);
    let mut row = [Pixel::EMPTY; WIDTH as usize];
    for y in 0..HEIGHT {
        row.fill(Pixel::EMPTY);
        view.render::<Everything>(0, y, 0..SAMPLES, &mut row);
        row.iter().for_each(|pixel| hash.add(pixel.mean()));
    }
    hash.finish()
}

fn matte<R: Real>(albedo: [f64; 3], texture: Option<u32>, emission: [f64; 3]) -> Material<R> {
    Material {
        scattering: Scattering::Diffuse(Diffuse { albedo: vec3_from_f64::<R>(albedo), texture }),
        emission: vec3_from_f64::<R>(emission),
    }
}

/// Mirror, glass and hollow glass under a spherical light, through a lens and a Gaussian filter, with roulette.
pub fn balls_through_a_lens<R: Real>(_queries: u32) -> u64 {
    balls::<R>(PathOptions { roulette_after: Some(2), ..PathOptions::default() })
}

/// The same by Sobol's numbers and with aim.
pub fn balls_with_aim<R: Real>(_queries: u32) -> u64 {
    let even = PathOptions { sampler: SamplerKind::Sobol, aim: true, ..PathOptions::default() };
    balls::<R>(PathOptions { roulette_after: Some(2), ..even })
}

fn balls<R: Real>(options: PathOptions) -> u64 {
    let black = Vec3::<R>::ZERO;
    let glass = |interior, exterior| Material {
        scattering: Scattering::Dielectric(Dielectric {
            interior_ior: R::from_f64(interior),
            exterior_ior: R::from_f64(exterior),
            transmittance: vec3_from_f64::<R>([1.0, 0.95, 0.9]),
        }),
        emission: black,
    };
    let materials = [
        matte([0.5, 0.6, 0.7], None, [0.0; 3]),
        Material {
            scattering: Scattering::Mirror(Mirror { reflectance: vec3_from_f64::<R>([0.9, 0.8, 0.7]) }),
            emission: black,
        },
        glass(1.5, 1.0),
        matte([0.0; 3], None, [9.0, 8.0, 7.0]),
    ];
    let sphere = |center, radius: f64, material, inverted| Sphere {
        center: vec3_from_f64::<R>(center),
        radius: R::from_f64(radius),
        material,
        inverted,
    };
    let spheres = [
        sphere([0.0, -1000.0, 0.0], 999.0, 0, false),
        sphere([0.0, 0.0, -1000.0], 996.0, 0, false),
        sphere([-1.5, 0.0, 0.0], 1.0, 1, false),
        sphere([1.2, 0.0, 0.5], 1.0, 2, false),
        sphere([1.2, 0.0, 0.5], 0.9, 2, true),
        sphere([0.0, -0.6, 1.8], 0.4, 2, false),
        sphere([2.0, 4.0, 3.0], 0.7, 3, false),
    ];
    let aims = [5, 6].map(|at: usize| Aim { center: spheres[at].center, radius: spheres[at].radius, worth: R::ONE });
    let geometry = Geometry::new(&spheres, &[], &[]).expect("a geometry");
    let mut storage = BvhStorage::<R, 1, 7, 0>::EMPTY;
    let bvh = storage.build(&geometry, Structure::Bvh, &mut [BuildItem::EMPTY; 7]).expect("room");
    let scene = Scene::new(SceneParts {
        geometry,
        bvh: Some(bvh),
        attributes: &[],
        normals: &[],
        uvs: &[],
        materials: &materials,
        textures: &[],
        lights: &[Light::Sphere(SphereLight { sphere: 6 })],
        aims: &aims,
        background: black,
    })
    .expect("a scene");
    let settings = CameraSettings { aperture_radius: 0.1, filter: Filter::Gaussian(0.5), ..CAMERA };
    hash(&scene, &settings, &options)
}

/// A textured, smooth octahedron on two triangles that emit, under a point light and a sky.
pub fn textured_mesh_in_the_sky<R: Real>(_queries: u32) -> u64 {
    const CORNERS: [[f64; 3]; 10] = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [-4.0, -1.0, -4.0],
        [-4.0, -1.0, 4.0],
        [4.0, -1.0, 4.0],
        [4.0, -1.0, -4.0],
    ];
    const TRIANGLES: [[u32; 3]; 10] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5], [6, 7, 8], [6, 8, 9]];
    let positions = CORNERS.map(vec3_from_f64::<R>);
    let normals = positions.map(normalize::<R>);
    let uvs = CORNERS.map(|[x, y, z]| [R::from_f64(x + z), R::from_f64(y - z)]);
    let attributes: [TriangleAttributes; 10] = core::array::from_fn(|index| match index {
        0..8 => TriangleAttributes { normals: Some(TRIANGLES[index]), uvs: Some(TRIANGLES[index]), material: 0 },
        _ => TriangleAttributes { normals: None, uvs: None, material: 1 },
    });
    let geometry = Geometry::new(&[], &positions, &TRIANGLES).expect("a geometry");
    let mut storage = BvhStorage::<R, 2, 0, 10>::EMPTY;
    let bvh = storage.build(&geometry, Structure::Bvh, &mut [BuildItem::EMPTY; 10]).expect("room");
    let point =
        PointLight { position: vec3_from_f64::<R>([2.0, 3.0, 4.0]), intensity: vec3_from_f64::<R>([20.0, 18.0, 15.0]) };
    let materials = [matte([0.9; 3], Some(0), [0.0; 3]), matte([0.4, 0.5, 0.3], None, [0.05, 0.0, 0.1])];
    let lights = [Light::Point(point)];
    let scene = Scene::new(SceneParts {
        geometry,
        bvh: Some(bvh),
        attributes: &attributes,
        normals: &normals,
        uvs: &uvs,
        materials: &materials,
        textures: &[Texture { width: 3, height: 2, texels: &TEXELS }],
        lights: &lights,
        aims: &[],
        background: vec3_from_f64::<R>([0.2, 0.3, 0.5]),
    })
    .expect("a scene");
    hash(&scene, &CameraSettings { filter: Filter::Tent(1.0), ..CAMERA }, &PathOptions::default())
}
