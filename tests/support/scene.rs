//! Scenes that own what the kernel borrows, and pictures of them.

use ocellus_kernel::bvh::{self, BuildItem, Bvh, BvhSlices, Node, Structure, required_nodes};
use ocellus_kernel::camera::{Camera, CameraSettings, Filter};
use ocellus_kernel::error::CapacityError;
use ocellus_kernel::light::{Light, PointLight, SphereLight};
use ocellus_kernel::material::{Dielectric, Diffuse, Material, Mirror, Scattering};
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::{Real, Vec3, Vector, vec3_from_f64};
use ocellus_kernel::shape::{Geometry, Sphere, SphereQuad, TriangleAttributes, TriangleQuad};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{Aim, EffectSet, Pixel, Ray, Scene, SceneParts, View};

use super::meshes::Mesh;

/// Every way to find primitives: all of them, one box, a hierarchy.
pub(crate) const STRUCTURES: [Option<Structure>; 3] = [None, Some(Structure::Box), Some(Structure::Bvh)];

/// From f64, each component rounded.
pub(crate) fn v<R: Real>(components: [f64; 3]) -> Vec3<R> {
    vec3_from_f64::<R>(components)
}

/// A ray without end.
pub(crate) fn ray<R: Real>(origin: [f64; 3], direction: [f64; 3]) -> Ray<R> {
    Ray::new(v::<R>(origin), v::<R>(direction))
}

/// A scene in vectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnedScene<R: Real> {
    pub(crate) spheres: Vec<Sphere<R>>,
    pub(crate) positions: Vec<Vec3<R>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) attributes: Vec<TriangleAttributes>,
    pub(crate) normals: Vec<Vec3<R>>,
    pub(crate) uvs: Vec<[R; 2]>,
    pub(crate) materials: Vec<Material<R>>,
    pub(crate) textures: Vec<Texture<'static>>,
    pub(crate) lights: Vec<Light<R>>,
    pub(crate) aims: Vec<Aim<R>>,
    pub(crate) background: [f64; 3],
}

impl<R: Real> OwnedScene<R> {
    /// Adds a sphere; its number.
    pub(crate) fn sphere(&mut self, center: [f64; 3], radius: f64, material: u32) -> u32 {
        self.spheres.push(Sphere { center: v::<R>(center), radius: R::from_f64(radius), material, inverted: false });
        self.spheres.len() as u32 - 1
    }

    /// Adds a flat mesh.
    pub(crate) fn mesh(&mut self, mesh: &Mesh, material: u32) {
        let first = self.positions.len() as u32;
        self.positions.extend(mesh.positions.iter().map(|position| v::<R>(*position)));
        self.triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
        let attributes = TriangleAttributes { normals: None, uvs: None, material };
        self.attributes.resize(self.triangles.len(), attributes);
    }

    fn material(&mut self, scattering: Scattering<R>, emission: f64) -> u32 {
        self.materials.push(Material { scattering, emission: v::<R>([emission; 3]) });
        self.materials.len() as u32 - 1
    }

    /// Adds a grey diffuse material that may emit; its number.
    pub(crate) fn diffuse(&mut self, albedo: f64, emission: f64) -> u32 {
        self.material(Scattering::Diffuse(Diffuse { albedo: v::<R>([albedo; 3]), texture: None }), emission)
    }

    /// Adds a mirror; its number.
    pub(crate) fn mirror(&mut self, reflectance: f64) -> u32 {
        self.material(Scattering::Mirror(Mirror { reflectance: v::<R>([reflectance; 3]) }), 0.0)
    }

    /// Adds glass; its number.
    pub(crate) fn glass(&mut self, interior_ior: f64, exterior_ior: f64, transmittance: [f64; 3]) -> u32 {
        let [interior_ior, exterior_ior] = [interior_ior, exterior_ior].map(R::from_f64);
        let glass = Dielectric { interior_ior, exterior_ior, transmittance: v::<R>(transmittance) };
        self.material(Scattering::Dielectric(glass), 0.0)
    }

    /// Adds a white point light of an intensity in W/sr.
    pub(crate) fn point_light(&mut self, position: [f64; 3], intensity: f64) {
        let light = PointLight { position: v::<R>(position), intensity: v::<R>([intensity; 3]) };
        self.lights.push(Light::Point(light));
    }

    /// Adds a black sphere that emits and is sampled.
    pub(crate) fn sphere_light(&mut self, center: [f64; 3], radius: f64, emission: f64) {
        let material = self.diffuse(0.0, emission);
        let sphere = self.sphere(center, radius, material);
        self.lights.push(Light::Sphere(SphereLight { sphere }));
    }

    /// Adds a sphere to aim at.
    pub(crate) fn aim(&mut self, center: [f64; 3], radius: f64, worth: f64) {
        let [radius, worth] = [radius, worth].map(R::from_f64);
        self.aims.push(Aim { center: v::<R>(center), radius, worth });
    }

    /// The primitives.
    pub(crate) fn geometry(&self) -> Geometry<'_, R> {
        Geometry::new(&self.spheres, &self.positions, &self.triangles).expect("a valid geometry")
    }

    /// All parts, without a hierarchy.
    pub(crate) fn parts(&self) -> SceneParts<'_, R> {
        SceneParts {
            geometry: self.geometry(),
            bvh: None,
            attributes: &self.attributes,
            normals: &self.normals,
            uvs: &self.uvs,
            materials: &self.materials,
            textures: &self.textures,
            lights: &self.lights,
            aims: &self.aims,
            background: v::<R>(self.background),
        }
    }

    /// Lends the scene over a structure.
    pub(crate) fn lend<T>(&self, structure: Option<Structure>, look: impl FnOnce(&Scene<'_, R>) -> T) -> T {
        let geometry = self.geometry();
        let mut room = Room::for_scene(&geometry);
        let bvh = structure.map(|structure| room.build(&geometry, structure).expect("enough room"));
        look(&Scene::new(SceneParts { bvh, ..self.parts() }).expect("a valid scene"))
    }
}

/// A scene with nothing in it but one grey material, number 0.
pub(crate) fn one_material<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    scene.diffuse(0.5, 0.0);
    scene
}

/// A scene of one grey triangle.
pub(crate) fn one_triangle<R: Real>(corners: [Vec3<R>; 3]) -> OwnedScene<R> {
    let mut scene = one_material::<R>();
    scene.mesh(&Mesh { positions: vec![], triangles: vec![[0, 1, 2]] }, 0);
    scene.positions = corners.to_vec();
    scene
}

/// Boxed slices for a hierarchy.
pub(crate) struct Room<R: Real> {
    pub(crate) nodes: Vec<Node<R>>,
    pub(crate) sphere_quads: Vec<SphereQuad<R>>,
    pub(crate) triangle_quads: Vec<TriangleQuad<R>>,
    pub(crate) scratch: Vec<BuildItem<R>>,
}

impl<R: Real> Room<R> {
    /// Room for these numbers of nodes, spheres, triangles and items.
    pub(crate) fn new([nodes, spheres, triangles, scratch]: [usize; 4]) -> Self {
        Self {
            nodes: vec![Node::EMPTY; nodes],
            sphere_quads: vec![SphereQuad::EMPTY; spheres],
            triangle_quads: vec![TriangleQuad::EMPTY; triangles],
            scratch: vec![BuildItem::EMPTY; scratch],
        }
    }

    /// As much as `geometry` can need.
    pub(crate) fn for_scene(geometry: &Geometry<'_, R>) -> Self {
        let (spheres, triangles) = (geometry.spheres().len(), geometry.triangles().len());
        Self::new([required_nodes(geometry.len()), spheres, triangles, geometry.len()])
    }

    pub(crate) fn build(
        &mut self,
        geometry: &Geometry<'_, R>,
        structure: Structure,
    ) -> Result<Bvh<'_, R>, CapacityError> {
        let Self { nodes, sphere_quads, triangle_quads, scratch } = self;
        bvh::build(geometry, structure, BvhSlices { nodes, sphere_quads, triangle_quads }, scratch)
    }
}

/// The corners of a triangle.
pub(crate) fn corners<R: Real>(geometry: &Geometry<'_, R>, triangle: usize) -> [Vec3<R>; 3] {
    geometry.triangles()[triangle].map(|corner| geometry.positions()[corner as usize])
}

/// A pinhole camera at z = 5 that looks at the origin, every sample on its pixel's centre.
pub(crate) const CAMERA: CameraSettings = CameraSettings {
    position: [0.0, 0.0, 5.0],
    look_at: [0.0, 0.0, 0.0],
    up: [0.0, 1.0, 0.0],
    field_of_view: 0.8,
    width: 16,
    height: 16,
    aperture_radius: 0.0,
    focal_distance: 5.0,
    filter: Filter::Box(0.0),
};

/// Lends a view of a scene.
pub(crate) fn with_view<R: Real, T>(
    scene: &OwnedScene<R>,
    settings: &CameraSettings,
    options: &PathOptions,
    look: impl FnOnce(&View<'_, R>) -> T,
) -> T {
    let camera = Camera::<R>::new(settings).expect("a camera");
    scene.lend(Some(Structure::Bvh), |scene| look(&View { scene, camera: &camera, options }))
}

/// All pixels of a view.
pub(crate) fn picture<R: Real, E: EffectSet>(view: &View<'_, R>, samples: std::ops::Range<u32>) -> Vec<Pixel> {
    let [width, height] = view.camera.size();
    let mut pixels = vec![Pixel::EMPTY; (width * height) as usize];
    for (y, row) in (0..height).zip(pixels.chunks_mut(width as usize)) {
        view.render::<E>(0, y, samples.clone(), row);
    }
    pixels
}

/// Shows the radiance of every path of a picture. One function for all that look, since each copy is a whole kernel.
pub(crate) fn each_path<R: Real, E: EffectSet>(view: &View<'_, R>, samples: u32, see: &mut dyn FnMut([f64; 3])) {
    let [width, height] = view.camera.size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for sample in 0..samples {
            see(view.sample::<E>(x, y, sample).radiance.to_array().map(|c| c.to_f64()));
        }
    }
}
