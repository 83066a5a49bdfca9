//! From a description to the kernel's slices, in the precision that was chosen.

use std::fmt;
use std::time::Instant;

use glam::{DMat3, DVec3};
use ocellus_kernel::aim::Aim;
use ocellus_kernel::bvh::{Bvh, Structure};
use ocellus_kernel::camera::{Camera, CameraSettings, Filter};
use ocellus_kernel::light::{Light, LightSampling, PointLight, SphereLight};
use ocellus_kernel::material::{Dielectric, Diffuse, Fresnel, Material, Mirror, Scattering};
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::{Real, Vec3, vec3_from_f64};
use ocellus_kernel::sampler::SamplerKind;
use ocellus_kernel::scene::{Scene, SceneParts};
use ocellus_kernel::shape::{Geometry, Sphere, TriangleAttributes};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::view::View;

use crate::aims::{AimDescription, aims};
use crate::description::{
    FilterDescription, FresnelDescription, IntegratorDescription, LightDescription, LightSamplingDescription,
    MaterialDescription, MeshDescription, SamplerDescription, ScatteringDescription, SceneDescription,
};
use crate::error::Error;
use crate::hierarchy::Hierarchy;

/// How the closest primitive is found. The picture is the same, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Accel {
    /// Every primitive is tested.
    None,
    /// One box around all triangles and one around all spheres, then every primitive in them.
    Box,
    /// A bounding volume hierarchy.
    #[default]
    Bvh,
}

impl fmt::Display for Accel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Box => "box",
            Self::Bvh => "bvh",
        })
    }
}

/// What setting up took, and how large the result is.
#[derive(Clone, Copy, Debug, Default)]
pub struct SetupReport {
    /// Seconds for building the kernel's arrays and the hierarchy; loading files is apart.
    pub seconds: f64,
    /// Primitives: spheres and triangles.
    pub primitives: usize,
    /// Bytes of the kernel's arrays but for hierarchy and textures.
    pub scene_bytes: usize,
    /// Bytes of decoded textures.
    pub texture_bytes: usize,
    /// Bytes of nodes and primitive order.
    pub bvh_bytes: usize,
}

/// The kernel's arrays of one scene.
struct Arrays<R: Real> {
    spheres: Vec<Sphere<R>>,
    positions: Vec<Vec3<R>>,
    triangles: Vec<[u32; 3]>,
    attributes: Vec<TriangleAttributes>,
    normals: Vec<Vec3<R>>,
    uvs: Vec<[R; 2]>,
    materials: Vec<Material<R>>,
    lights: Vec<Light<R>>,
    aims: Vec<Aim<R>>,
}

/// Builds the scene and its view in precision `R` and hands them to `work`; they live as long as it runs.
///
/// # Errors
/// A description that no kernel scene or camera can be made of: [`crate::error::ExitCode::BadScene`].
pub fn with_view<R: Real, T>(
    description: &SceneDescription,
    accel: Accel,
    work: impl FnOnce(&View<'_, R>, &SetupReport) -> T,
) -> Result<T, Error> {
    let start = Instant::now();
    let arrays = Arrays::<R>::new(description)?;
    let unusable = |cause: String| {
        Error::bad_scene(
            description.origin.clone(),
            cause,
            "check the numbers of this scene; `ocellus explain` lists them",
        )
    };
    let geometry = Geometry::new(&arrays.spheres, &arrays.positions, &arrays.triangles)
        .map_err(|error| unusable(error.to_string()))?;

    let structure = match accel {
        Accel::None => None,
        Accel::Box => Some(Structure::Box),
        Accel::Bvh => Some(Structure::Bvh),
    };
    let mut hierarchy = Hierarchy::default();
    let bvh = match structure {
        None => None,
        Some(structure) => Some(hierarchy.build(&geometry, structure).map_err(unusable)?),
    };

    let textures: Vec<Texture<'_>> = description
        .textures
        .iter()
        .map(|texture| Texture { width: texture.width, height: texture.height, texels: &texture.texels })
        .collect();
    let scene = Scene::new(SceneParts {
        geometry,
        bvh,
        attributes: &arrays.attributes,
        normals: &arrays.normals,
        uvs: &arrays.uvs,
        materials: &arrays.materials,
        textures: &textures,
        lights: &arrays.lights,
        aims: &arrays.aims,
        background: vec3::<R>(description.integrator.background),
    })
    .map_err(|error| unusable(error.to_string()))?;
    let camera = Camera::new(&camera_settings(description)).map_err(|error| {
        let remedy = "give position, look_at, up, fov_degrees and the film's size usable values";
        Error::bad_scene(description.camera.origin.clone(), error.to_string(), remedy)
    })?;
    let options = path_options(&description.integrator);

    let report = SetupReport {
        seconds: start.elapsed().as_secs_f64(),
        primitives: geometry.len(),
        scene_bytes: arrays.bytes(),
        texture_bytes: textures.iter().map(|texture| size_of_val(texture.texels)).sum(),
        bvh_bytes: bvh.as_ref().map_or(0, bvh_bytes),
    };
    Ok(work(&View { scene: &scene, camera: &camera, options: &options }, &report))
}

fn bvh_bytes<R: Real>(bvh: &Bvh<'_, R>) -> usize {
    size_of_val(bvh.nodes()) + size_of_val(bvh.sphere_quads()) + size_of_val(bvh.triangle_quads())
}

impl<R: Real> Arrays<R> {
    fn new(description: &SceneDescription) -> Result<Self, Error> {
        let mut arrays = Self {
            spheres: Vec::new(),
            positions: Vec::new(),
            triangles: Vec::new(),
            attributes: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            materials: description.materials.iter().map(material).collect(),
            lights: Vec::new(),
            // What is too small or too large for the precision is found by chance.
            aims: aims(description).iter().map(aim).filter(Aim::is_valid).collect(),
        };
        for sphere in &description.spheres {
            arrays.spheres.push(Sphere {
                center: vec3::<R>(sphere.center),
                radius: R::from_f64(sphere.radius),
                material: sphere.material as u32,
                inverted: sphere.inverted,
            });
        }
        for light in &description.lights {
            arrays.push_light(light);
        }
        for mesh in &description.meshes {
            arrays.push_mesh(mesh)?;
        }
        Ok(arrays)
    }

    /// A sphere light is a black sphere of the scene with a material of its own.
    fn push_light(&mut self, light: &LightDescription) {
        match light {
            LightDescription::Point { position, power, .. } => {
                let intensity = *power * (0.25 * std::f64::consts::FRAC_1_PI);
                self.lights
                    .push(Light::Point(PointLight { position: vec3::<R>(*position), intensity: vec3::<R>(intensity) }));
            }
            LightDescription::Sphere { center, radius, radiance, .. } => {
                self.lights.push(Light::Sphere(SphereLight { sphere: self.spheres.len() as u32 }));
                self.spheres.push(Sphere {
                    center: vec3::<R>(*center),
                    radius: R::from_f64(*radius),
                    material: self.materials.len() as u32,
                    inverted: false,
                });
                let black = Diffuse { albedo: vec3::<R>(DVec3::ZERO), texture: None };
                self.materials
                    .push(Material { scattering: Scattering::Diffuse(black), emission: vec3::<R>(*radiance) });
            }
        }
    }

    /// Transforms a mesh to the world and appends it. A transform that mirrors turns the corners around, so that
    /// fronts stay fronts.
    fn push_mesh(&mut self, mesh: &MeshDescription) -> Result<(), Error> {
        let first = [self.positions.len(), self.normals.len(), self.uvs.len()];
        let total = [mesh.positions.len(), mesh.normals.len(), mesh.uvs.len()];
        let last = (0..3).map(|i| first[i] + total[i]).max().unwrap_or(0);
        if u32::try_from(last).is_err() {
            let remedy = "split the scene into several renders";
            return Err(Error::bad_scene(mesh.origin.clone(), "more than 2^32 vertices in one scene", remedy));
        }
        let [first_position, first_normal, first_uv] = first.map(|index| index as u32);
        let linear = mesh.world_from_mesh.matrix3;
        let mirrored = linear.determinant() < 0.0;
        let normal_matrix = cofactors(linear);
        let to_f64 = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
        self.positions
            .extend(mesh.positions.iter().map(|p| vec3::<R>(mesh.world_from_mesh.transform_point3(to_f64(p)))));
        self.normals.extend(mesh.normals.iter().map(|n| vec3::<R>(normal_matrix * to_f64(n))));
        self.uvs.extend(mesh.uvs.iter().map(|uv| uv.map(|x| R::from_f64(f64::from(x)))));
        for triangle in &mesh.triangles {
            let shift = |indices: [u32; 3], by: u32| {
                let [a, b, c] = indices.map(|index| index + by);
                if mirrored { [a, c, b] } else { [a, b, c] }
            };
            self.triangles.push(shift(triangle.positions, first_position));
            self.attributes.push(TriangleAttributes {
                normals: triangle.normals.map(|indices| shift(indices, first_normal)),
                uvs: triangle.uvs.map(|indices| shift(indices, first_uv)),
                material: triangle.material,
            });
        }
        Ok(())
    }

    fn bytes(&self) -> usize {
        size_of_val(self.spheres.as_slice())
            + size_of_val(self.positions.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.attributes.as_slice())
            + size_of_val(self.normals.as_slice())
            + size_of_val(self.uvs.as_slice())
            + size_of_val(self.materials.as_slice())
            + size_of_val(self.lights.as_slice())
            + size_of_val(self.aims.as_slice())
    }
}

/// The matrix that takes normals along, up to a positive factor; unlike the inverse transpose it exists for every
/// transform. A mirroring one changes its sign with the corners' turn.
fn cofactors(m: DMat3) -> DMat3 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}

fn vec3<R: Real>(v: DVec3) -> Vec3<R> {
    vec3_from_f64::<R>(v.to_array())
}

fn material<R: Real>(description: &MaterialDescription) -> Material<R> {
    let scattering = match &description.scattering {
        ScatteringDescription::Diffuse { albedo, texture } => {
            Scattering::Diffuse(Diffuse { albedo: vec3::<R>(*albedo), texture: texture.map(|index| index as u32) })
        }
        ScatteringDescription::Mirror { reflectance } => {
            Scattering::Mirror(Mirror { reflectance: vec3::<R>(*reflectance) })
        }
        ScatteringDescription::Dielectric { interior_ior, exterior_ior, transmittance } => {
            Scattering::Dielectric(Dielectric {
                interior_ior: R::from_f64(*interior_ior),
                exterior_ior: R::from_f64(*exterior_ior),
                transmittance: vec3::<R>(*transmittance),
            })
        }
    };
    Material { scattering, emission: vec3::<R>(description.emission) }
}

fn aim<R: Real>(aim: &AimDescription) -> Aim<R> {
    Aim { center: vec3::<R>(aim.center), radius: R::from_f64(aim.radius), worth: R::from_f64(aim.worth) }
}

fn camera_settings(description: &SceneDescription) -> CameraSettings {
    let (camera, film) = (&description.camera, &description.film);
    CameraSettings {
        position: camera.position.to_array(),
        look_at: camera.look_at.to_array(),
        up: camera.up.to_array(),
        field_of_view: camera.fov_degrees.to_radians(),
        width: film.width,
        height: film.height,
        aperture_radius: camera.aperture_radius,
        // A pinhole has none, and the default, far away, may be beyond the precision.
        focal_distance: if camera.aperture_radius > 0.0 { camera.focal_distance } else { 1.0 },
        filter: match film.filter {
            FilterDescription::Center => Filter::Box(0.0),
            FilterDescription::Box { width } => Filter::Box(width),
            FilterDescription::Tent { radius } => Filter::Tent(radius),
            FilterDescription::Gaussian { stdev } => Filter::Gaussian(stdev),
        },
    }
}

/// The kernel's words for an integrator.
pub fn path_options(integrator: &IntegratorDescription) -> PathOptions {
    PathOptions {
        max_bounces: integrator.max_bounces,
        indirect: integrator.indirect,
        light_sampling: match integrator.light_sampling {
            LightSamplingDescription::Hemisphere => LightSampling::Hemisphere,
            LightSamplingDescription::Cone => LightSampling::Cone,
            LightSamplingDescription::None => LightSampling::None,
        },
        fresnel: match integrator.fresnel {
            FresnelDescription::None => Fresnel::None,
            FresnelDescription::Schlick => Fresnel::Schlick,
            FresnelDescription::Exact => Fresnel::Exact,
        },
        roulette_after: integrator.roulette_after,
        aim: integrator.aim,
        sampler: match integrator.sampler {
            SamplerDescription::Independent => SamplerKind::Independent,
            SamplerDescription::Sobol => SamplerKind::Sobol,
        },
        seed: integrator.seed,
    }
}
