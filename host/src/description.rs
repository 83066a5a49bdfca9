//! A scene as its files describe it: in f64, with the line that asked for each thing, before a precision is chosen.
//!
//! Loaders make one; [`crate::assemble`] turns it into the kernel's slices; `explain` reads the origins.

use crate::error::{Origin, Warning};
use glam::{DAffine3, DVec3};
use std::path::PathBuf;

/// Everything a render needs, as its files say it.
#[derive(Clone, Debug)]
pub struct SceneDescription {
    /// The file that was opened.
    pub origin: Origin,
    /// Where the picture is taken from.
    pub camera: CameraDescription,
    /// Size, samples and pixel filter.
    pub film: FilmDescription,
    /// Which light transport is simulated.
    pub integrator: IntegratorDescription,
    /// All materials; shapes refer to them by index.
    pub materials: Vec<MaterialDescription>,
    /// All textures; materials refer to them by index.
    pub textures: Vec<TextureDescription>,
    /// Spheres, in file order.
    pub spheres: Vec<SphereDescription>,
    /// Meshes, in file order.
    pub meshes: Vec<MeshDescription>,
    /// Lights, in file order.
    pub lights: Vec<LightDescription>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Camera, looking from `position` to `look_at`.
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// Line of the camera table, or the file as a whole where defaults are used.
    pub origin: Origin,
    /// Centre of the lens, scene units.
    pub position: DVec3,
    /// Point in the middle of the picture, scene units.
    pub look_at: DVec3,
    /// Direction that is up in the picture.
    pub up: DVec3,
    /// Full horizontal field of view, degrees.
    pub fov_degrees: f64,
    /// Lens radius, scene units; 0 is a pinhole.
    pub aperture_radius: f64,
    /// Distance from the lens to the plane in focus, along the view axis, scene units.
    pub focal_distance: f64,
    /// Line that set `aperture_radius`.
    pub lens_origin: Origin,
}

/// Pixel reconstruction filter; widths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterDescription {
    /// Every sample through the pixel's centre (no anti-aliasing).
    Center,
    /// Uniform over a square `width` pixels wide.
    Box {
        /// Full width, pixels.
        width: f64,
    },
    /// Falling linearly to zero at `radius` in x and y.
    Tent {
        /// Half width, pixels.
        radius: f64,
    },
    /// Normal in x and y (Box-Muller).
    Gaussian {
        /// Standard deviation, pixels.
        stdev: f64,
    },
}

/// Size, samples and pixel filter.
#[derive(Clone, Debug)]
pub struct FilmDescription {
    /// Line of the film table.
    pub origin: Origin,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Pixel reconstruction filter.
    pub filter: FilterDescription,
    /// Line that chose the filter.
    pub filter_origin: Origin,
    /// Stops of exposure for the PNG: radiance is multiplied by 2^exposure.
    pub exposure: f64,
    /// `Some(g)`: the PNG holds x^(1/g); `None`: the sRGB curve.
    pub gamma: Option<f64>,
}

/// How a spherical light is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSamplingDescription {
    /// Cosine-weighted points on the hemisphere that faces the shading point, as in the report.
    Hemisphere,
    /// Uniform in the solid angle of the light as seen from the shading point.
    Cone,
    /// Never sampled: paths find the light by chance.
    None,
}

/// How dielectrics share light between reflection and refraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FresnelDescription {
    /// Refract wherever refraction is possible.
    None,
    /// Schlick's polynomial, with the cosine on the thin side.
    Schlick,
    /// The Fresnel equations for unpolarised light.
    Exact,
}

/// How the numbers of the samples of one pixel relate to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SamplerDescription {
    /// Not at all: each sample is independent of the others.
    Independent,
    /// They avoid each other: Sobol's sequence, scrambled. Less noise, least at 16, 64, 256 ... samples.
    Sobol,
}

/// Which light transport is simulated.
#[derive(Clone, Debug)]
pub struct IntegratorDescription {
    /// Line of the integrator table.
    pub origin: Origin,
    /// Scattering events a path may have; 0 shows emitters only, 1 direct light.
    pub max_bounces: u32,
    /// `false` ends a path at its first diffuse hit, after direct light.
    pub indirect: bool,
    /// Line that set `indirect`.
    pub indirect_origin: Origin,
    /// How spherical lights are sampled.
    pub light_sampling: LightSamplingDescription,
    /// How dielectrics share light between reflection and refraction.
    pub fresnel: FresnelDescription,
    /// Bounces after which paths may end at random, unbiased; `None` never.
    pub roulette_after: Option<u32>,
    /// Line that set `roulette_after`.
    pub roulette_origin: Origin,
    /// Whether some diffuse directions go to lights behind glass, to what emits, and to what gathers light.
    pub aim: bool,
    /// Line that set `aim`.
    pub aim_origin: Origin,
    /// Radiance of the surroundings, linear Rec.709.
    pub background: DVec3,
    /// Line that set `background`.
    pub background_origin: Origin,
    /// How the numbers of the samples of one pixel relate to each other.
    pub sampler: SamplerDescription,
    /// Line that set `sampler`.
    pub sampler_origin: Origin,
    /// Seed of the sample numbers.
    pub seed: u64,
}

/// What a surface does to light.
#[derive(Clone, Debug, PartialEq)]
pub enum ScatteringDescription {
    /// Lambertian; with a texture, `albedo` multiplies it.
    Diffuse {
        /// Reflected fraction per channel, linear, 0..=1.
        albedo: DVec3,
        /// Index into [`SceneDescription::textures`].
        texture: Option<usize>,
    },
    /// Perfect mirror.
    Mirror {
        /// Reflected fraction per channel, linear, 0..=1.
        reflectance: DVec3,
    },
    /// Smooth glass or liquid.
    Dielectric {
        /// Index of refraction behind the surface (against its normal).
        interior_ior: f64,
        /// Index of refraction in front of the surface (where its normal points).
        exterior_ior: f64,
        /// Transmitted fraction per channel, linear, 0..=1.
        transmittance: DVec3,
    },
}

/// A named material.
#[derive(Clone, Debug)]
pub struct MaterialDescription {
    /// Line that defined it.
    pub origin: Origin,
    /// Its name in the file.
    pub name: String,
    /// What it does to light.
    pub scattering: ScatteringDescription,
    /// Emitted radiance, linear Rec.709; zero for most.
    pub emission: DVec3,
    /// Line that asked for emission or a texture, where it differs from `origin`.
    pub detail_origin: Origin,
}

/// A decoded colour texture, linear Rec.709, row 0 on top.
#[derive(Clone, Debug)]
pub struct TextureDescription {
    /// Line that named the file.
    pub origin: Origin,
    /// The file.
    pub file: PathBuf,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// `width * height` linear texels, row by row.
    pub texels: Vec<[f32; 3]>,
}

/// A sphere.
#[derive(Clone, Debug)]
pub struct SphereDescription {
    /// Line that defined it.
    pub origin: Origin,
    /// Centre, scene units.
    pub center: DVec3,
    /// Radius, scene units, positive.
    pub radius: f64,
    /// Whether its normal points to the centre (the inside of a hollow shell).
    pub inverted: bool,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
}

/// One triangle of a mesh, by index into the mesh's arrays, counter-clockwise seen from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleDescription {
    /// Corners, into `positions`.
    pub positions: [u32; 3],
    /// Vertex normals, into `normals`.
    pub normals: Option<[u32; 3]>,
    /// Texture coordinates, into `uvs`.
    pub uvs: Option<[u32; 3]>,
    /// Index into [`SceneDescription::materials`].
    pub material: u32,
}

/// A triangle mesh in its own space.
#[derive(Clone, Debug)]
pub struct MeshDescription {
    /// Line that asked for it.
    pub origin: Origin,
    /// First `vn` line of its file, if it has vertex normals.
    pub normals_origin: Option<Origin>,
    /// Corner positions.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals, any length but zero.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, v up.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles.
    pub triangles: Vec<TriangleDescription>,
    /// Takes mesh space to the world.
    pub world_from_mesh: DAffine3,
}

/// A light that is sampled.
#[derive(Clone, Debug)]
pub enum LightDescription {
    /// An isotropic point.
    Point {
        /// Line that defined it.
        origin: Origin,
        /// Position, scene units.
        position: DVec3,
        /// Power per channel, W; intensity is power / 4 pi.
        power: DVec3,
    },
    /// A black sphere of constant radiance.
    Sphere {
        /// Line that defined it.
        origin: Origin,
        /// Centre, scene units.
        center: DVec3,
        /// Radius, scene units.
        radius: f64,
        /// Emitted radiance per channel; power / (4 pi^2 radius^2).
        radiance: DVec3,
    },
}
