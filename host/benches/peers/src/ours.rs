//! Ocellus. All that this program uses of the kernel is in this file.

use glam::Vec3;
use ocellus::hierarchy::Hierarchy;
use ocellus::isa::Prefetching;
use ocellus_kernel::bvh::Structure;
use ocellus_kernel::material::{Diffuse, Material, Scattering};
use ocellus_kernel::shape::{Geometry, TriangleAttributes};
use ocellus_kernel::{EffectSet, Effects, Scene, SceneParts};
use rayon::ThreadPoolBuilder;

use crate::isa::{Isa, Work};
use crate::measure::{median, seconds};
use crate::mesh::Mesh;
use crate::peer::{Answer, Peer, Ray, Row};

/// The name in the tables.
pub(crate) const NAME: &str = "Ocellus";

/// A kernel that knows triangles alone, as a mesh asks for: one for each instruction set.
#[derive(Clone, Copy)]
struct Triangles<const ISA: u8>;

impl<const ISA: u8> EffectSet for Triangles<ISA> {
    const EFFECTS: Effects = Effects::TRIANGLES;
}

/// A scene that can be queried, and what it took.
pub(crate) struct Ours<'a> {
    scene: Scene<'a, f32>,
    build_seconds: [f64; 2],
    bytes_per_triangle: f64,
}

/// Builds the scene `builds` times and hands the last one to `work`.
pub(crate) fn with_scene<T>(mesh: &Mesh, builds: usize, work: impl FnOnce(&Ours<'_>) -> T) -> Result<T, String> {
    let positions: Vec<Vec3> = mesh.positions.iter().copied().map(Vec3::from).collect();
    let attributes = vec![TriangleAttributes { normals: None, uvs: None, material: 0 }; mesh.triangles.len()];
    let white = Scattering::Diffuse(Diffuse { albedo: Vec3::ONE, texture: None });
    let materials = [Material { scattering: white, emission: Vec3::ZERO }];

    let geometry = Geometry::new(&[], &positions, &mesh.triangles).map_err(|error| error.to_string())?;
    let on = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        let mut times = Vec::new();
        for _ in 0..builds {
            let build = || Hierarchy::default().build(&geometry, Structure::Bvh).map(|_| ());
            let (time, built) = pool.install(|| seconds(threads, build));
            built?;
            times.push(time);
        }
        Ok::<_, String>(median(&mut times))
    };
    // On two threads first, as for Embree: who comes first is first to touch new memory.
    let on_two = on(2)?;
    let build_seconds = [on(1)?, on_two];
    let mut hierarchy = Hierarchy::default();
    let bvh = hierarchy.build(&geometry, Structure::Bvh)?;

    let scene = Scene::new(SceneParts {
        geometry,
        bvh: Some(bvh),
        attributes: &attributes,
        normals: &[],
        uvs: &[],
        materials: &materials,
        textures: &[],
        lights: &[],
        aims: &[],
        background: Vec3::ZERO,
    })
    .map_err(|error| error.to_string())?;
    let bytes = size_of_val(bvh.nodes()) + size_of_val(bvh.triangle_quads());
    Ok(work(&Ours { scene, build_seconds, bytes_per_triangle: bytes as f64 / mesh.triangles.len() as f64 }))
}

impl<'a> Ours<'a> {
    /// Its row of the tables with these instructions.
    pub(crate) fn row<'b>(&'b self, isa: Isa) -> Row<'b>
    where
        'a: 'b,
    {
        Row {
            name: NAME,
            isa,
            build_seconds: self.build_seconds.map(Some),
            bytes_per_triangle: self.bytes_per_triangle,
            peer: Box::new(Tracer { scene: &self.scene, isa }),
        }
    }
}

/// The scene, queried with some instructions.
struct Tracer<'a> {
    scene: &'a Scene<'a, f32>,
    isa: Isa,
}

impl Peer for Tracer<'_> {
    fn closest(&self, rays: &[Ray], answers: &mut [Answer]) {
        self.isa.run(Closest { scene: self.scene, rays, answers });
    }

    fn any(&self, rays: &[Ray], answers: &mut [Answer]) {
        self.isa.run(Any { scene: self.scene, rays, answers });
    }
}

struct Closest<'a> {
    scene: &'a Scene<'a, f32>,
    rays: &'a [Ray],
    answers: &'a mut [Answer],
}

impl Work for Closest<'_> {
    #[inline(always)]
    fn run<const ISA: u8>(self) {
        for (ray, answer) in self.rays.iter().zip(self.answers) {
            *answer = match self.scene.intersect_in::<Prefetching<Triangles<ISA>>>(&kernel_ray(ray)) {
                Some(hit) => Answer { t: hit.t, u: hit.u, v: hit.v, primitive: hit.primitive },
                None => Answer::MISS,
            };
        }
    }
}

struct Any<'a> {
    scene: &'a Scene<'a, f32>,
    rays: &'a [Ray],
    answers: &'a mut [Answer],
}

impl Work for Any<'_> {
    #[inline(always)]
    fn run<const ISA: u8>(self) {
        for (ray, answer) in self.rays.iter().zip(self.answers) {
            *answer = Answer::any(self.scene.occluded_in::<Prefetching<Triangles<ISA>>>(&kernel_ray(ray)));
        }
    }
}

#[inline(always)]
fn kernel_ray(ray: &Ray) -> ocellus_kernel::Ray<f32> {
    ocellus_kernel::Ray { origin: ray.origin.into(), direction: ray.direction.into(), tmin: ray.tnear, tmax: ray.tfar }
}
