//! The kernel's operations, one by one: wall times, and instructions that must not grow.
//!
//! `cargo bench -p ocellus --bench operations`                     times, by criterion; a word chooses some of them
//! `cargo bench -p ocellus --bench operations -- --instructions`   instructions of each, by callgrind, beside what they
//!                                                                 were before (`operations.txt`; `OCELLUS_BLESS=1` writes it)
//!
//! All are for f32 and the target's baseline. Before anything is measured the searches of a hierarchy are compared with
//! those of all triangles, bit by bit.

#[path = "support/callgrind.rs"]
mod callgrind;
#[path = "support/counts.rs"]
mod counts;

use std::hint::black_box;
use std::process::ExitCode;

use counts::Counts;
use criterion::Criterion;
use glam::Vec3;
use ocellus::hierarchy::Hierarchy;
use ocellus::isa::Prefetching;
use ocellus_kernel::bvh::{Bounds, Bvh, Structure, intersect, occluded};
use ocellus_kernel::camera::{CameraSettings, Filter};
use ocellus_kernel::material::fresnel::{Fresnel, Interface, reflectance};
use ocellus_kernel::sampler::{AddressedSampler, Block, Sampler};
use ocellus_kernel::shape::{Geometry, PreparedRay, Sphere, triangle};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{Camera, EffectSet, Effects, Pixel, Ray, SamplerKind, robust, warp};

/// How many different inputs each operation goes through.
const INPUTS: usize = 1 << 12;
/// How often each is done while its instructions are counted, once and once more.
const COUNTED: usize = INPUTS;
/// Rows of the mesh; it has four times the square of it triangles, about.
const ROWS: u32 = 64;

/// A kernel of triangles alone.
#[derive(Clone, Copy)]
struct Triangles;

impl EffectSet for Triangles {
    const EFFECTS: Effects = Effects::TRIANGLES;
}

type Kernel = Prefetching<Triangles>;

/// One operation: its name and what it does with the input of a number, which is a sum of bits.
type Operation<'a> = (&'static str, Box<dyn Fn(usize) -> u32 + 'a>);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let inputs = Inputs::new();
    let geometry = Geometry::new(&[], &inputs.positions, &inputs.triangles).expect("a mesh");
    let mut hierarchy = Hierarchy::default();
    let bvh = hierarchy.build(&geometry, Structure::Bvh).expect("a hierarchy");
    let operations = inputs.operations(&geometry, &bvh);
    if words.first() != Some(&"--once") {
        inputs.check(&geometry, &bvh);
    }
    match words[..] {
        ["--once", name, times] => {
            let times = times.parse().expect("a number");
            let (_, operation) = operations.iter().find(|(known, _)| *known == name).expect("an operation");
            println!("{}", (0..times).map(operation).fold(0, u32::wrapping_add));
            ExitCode::SUCCESS
        }
        _ if words.contains(&"--instructions") => match instructions(&operations) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("operations: {error}");
                ExitCode::FAILURE
            }
        },
        _ => {
            let mut criterion = Criterion::default().configure_from_args();
            for (name, operation) in &operations {
                let mut number = 0;
                criterion.bench_function(name, |bencher| {
                    bencher.iter(|| {
                        number = (number + 1) % INPUTS;
                        operation(black_box(number))
                    });
                });
            }
            criterion.final_summary();
            ExitCode::SUCCESS
        }
    }
}

/// What operations work on.
struct Inputs {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// From a sphere around the mesh to somewhere in it.
    rays: Vec<Ray<f32>>,
    prepared: Vec<PreparedRay<f32>>,
    boxes: Vec<Bounds<f32>>,
    vectors: Vec<Vec3>,
    units: Vec<[f32; 2]>,
    texels: Vec<[f32; 3]>,
    camera: Camera<f32>,
}

impl Inputs {
    fn new() -> Self {
        let mut state = 1u64;
        let mut unit = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut vectors = Vec::new();
        while vectors.len() < INPUTS {
            let v = Vec3::new(unit(), unit(), unit()) * 2.0 - 1.0;
            if v.length_squared() > 0.01 && v.length_squared() < 1.0 {
                vectors.push(v);
            }
        }
        let (positions, triangles) = sphere_of_bumps();
        let toward = |(k, v): (usize, &Vec3)| {
            let origin = robust::normalize::<f32>(vectors[(k + 1) % INPUTS]) * 3.0;
            Ray::new(origin, robust::normalize::<f32>(*v - origin))
        };
        let rays: Vec<_> = vectors.iter().enumerate().map(toward).collect();
        let around = |corners: &[Vec3]| {
            let mut bounds = Bounds::EMPTY;
            corners.iter().for_each(|corner| bounds.grow(*corner));
            bounds
        };
        let settings = CameraSettings {
            position: [3.0, -2.0, 5.5],
            look_at: [0.25, 0.5, -1.0],
            up: [0.1, 1.0, 0.0],
            field_of_view: 0.9,
            width: 640,
            height: 480,
            aperture_radius: 0.3,
            focal_distance: 7.0,
            filter: Filter::Tent(1.0),
        };
        Self {
            positions,
            triangles,
            prepared: rays.iter().map(PreparedRay::new).collect(),
            rays,
            boxes: vectors.windows(2).map(around).collect(),
            units: vectors.iter().map(|v| [v.x * v.x, v.y * v.y]).collect(),
            texels: vectors.iter().map(|v| v.abs().to_array()).collect(),
            camera: Camera::new(&settings).expect("a camera"),
            vectors,
        }
    }

    fn operations<'a>(&'a self, geometry: &'a Geometry<'a, f32>, bvh: &'a Bvh<'a, f32>) -> Vec<Operation<'a>> {
        let Self { positions, triangles, rays, prepared, boxes, vectors, units, texels, camera } = self;
        let ray = |k: usize| &rays[k % INPUTS];
        let vector = |k: usize| vectors[k % INPUTS];
        let unit = |k: usize| units[k % INPUTS];
        let corners = |k: usize| triangles[k % triangles.len()].map(|corner| positions[corner as usize]);
        let texture = Texture { width: 64, height: 64, texels };
        let numbers = |kind| {
            move |k: usize| {
                let sampler = AddressedSampler::new(7, k as u32 % 640, 3, k as u32).of_kind(kind);
                sampler.numbers(Block::Scatter).into_iter().fold(0, u32::wrapping_add)
            }
        };
        vec![
            (
                "camera ray",
                Box::new(move |k| {
                    sum(camera.ray::<ocellus_kernel::Everything>(k as u32 % 640, 7, [k as u32; 4]).direction)
                }),
            ),
            ("independent numbers", Box::new(numbers(SamplerKind::Independent))),
            ("Sobol's numbers", Box::new(numbers(SamplerKind::Sobol))),
            ("ray prepared", Box::new(move |k| black_box(PreparedRay::new(ray(k))).tmin.to_bits())),
            ("box", Box::new(move |k| entered(boxes[k % boxes.len()].entry(&prepared[k % INPUTS], f32::MAX)))),
            (
                "triangle",
                Box::new(move |k| {
                    entered(triangle::intersect(&corners(k), &prepared[k % INPUTS], f32::MAX).map(|(t, _, _)| t))
                }),
            ),
            (
                "sphere",
                Box::new(move |k| {
                    let sphere = Sphere { center: vector(k), radius: 0.5, material: 0, inverted: false };
                    entered(sphere.intersect(&prepared[k % INPUTS], f32::MAX))
                }),
            ),
            ("closest hit", Box::new(move |k| hit(geometry, Some(bvh), ray(k)))),
            ("any hit", Box::new(move |k| u32::from(occluded::<f32, Kernel>(geometry, Some(bvh), ray(k))))),
            (
                "origin off a surface",
                Box::new(move |k| {
                    let (p, n) = (vector(k), robust::normalize::<f32>(vector(k + 1)));
                    sum(robust::offset_ray_origin::<f32>(p, p.abs() * robust::gamma::<f32>(7), n, vector(k + 2)))
                }),
            ),
            (
                "diffuse direction",
                Box::new(move |k| {
                    let [u, v] = unit(k);
                    let n = robust::normalize::<f32>(vector(k));
                    sum(warp::to_world::<f32>(n, warp::cosine_hemisphere::<f32>(u, v)))
                }),
            ),
            (
                "Fresnel's equations",
                Box::new(move |k| {
                    let [cos_i, cos_t] = unit(k);
                    reflectance::<f32>(Fresnel::Exact, &Interface { cos_i, cos_t, ior_i: 1.0, ior_t: 1.5 }).to_bits()
                }),
            ),
            ("texture", Box::new(move |k| sum(texture.lookup::<f32>(unit(k))))),
            (
                "four samples of a pixel",
                Box::new(move |k| {
                    let mut pixel = Pixel::EMPTY;
                    (0..4).for_each(|next| pixel.add(vector(k + next).to_array()));
                    sum(Vec3::from(pixel.mean()))
                }),
            ),
        ]
    }

    /// Compares the searches with those that test all triangles.
    fn check(&self, geometry: &Geometry<'_, f32>, bvh: &Bvh<'_, f32>) {
        for ray in self.rays.iter().step_by(16) {
            assert_eq!(hit(geometry, Some(bvh), ray), hit(geometry, None, ray), "{ray:?}");
            let [found, expected] = [Some(bvh), None].map(|bvh| occluded::<f32, Kernel>(geometry, bvh, ray));
            assert_eq!(found, expected, "{ray:?}");
        }
    }
}

/// The bits of where a ray enters something.
fn entered(t: Option<f32>) -> u32 {
    t.map_or(1, f32::to_bits)
}

/// The bits of what a ray hits first.
fn hit(geometry: &Geometry<'_, f32>, bvh: Option<&Bvh<'_, f32>>, ray: &Ray<f32>) -> u32 {
    intersect::<f32, Kernel>(geometry, bvh, ray).map_or(1, |hit| hit.t.to_bits() ^ hit.primitive.rotate_left(16))
}

fn sum(v: Vec3) -> u32 {
    v.to_array().map(f32::to_bits).into_iter().fold(0, u32::wrapping_add)
}

/// A sphere of radius 1 with waves on it: positions and triangles.
fn sphere_of_bumps() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let columns = 2 * ROWS;
    let position = |row: u32, column: u32| {
        let [latitude, longitude] =
            [(row, ROWS), (column, columns / 2)].map(|(k, count)| std::f32::consts::PI * k as f32 / count as f32);
        let radius = 1.0 + 0.05 * libm::sinf(9.0 * latitude) * libm::cosf(8.0 * longitude);
        let ring = libm::sinf(latitude);
        Vec3::new(ring * libm::cosf(longitude), libm::cosf(latitude), ring * libm::sinf(longitude)) * radius
    };
    let grid = |rows: u32| (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)));
    let positions = grid(ROWS + 1).map(|(row, column)| position(row, column)).collect();
    let two = |(row, column): (u32, u32)| {
        let [left, right] = [column, (column + 1) % columns].map(|column| row * columns + column);
        [[left, right, left + columns], [right, right + columns, left + columns]]
    };
    (positions, grid(ROWS).flat_map(two).collect())
}

/// Prints the instructions of each operation; an error where one takes more than before.
fn instructions(operations: &[Operation<'_>]) -> Result<(), String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut counts = Counts::of("operations.txt")?;
    println!("instructions of one operation in the mean, by callgrind, and their ratio to those before");
    for (name, operation) in operations {
        let mut with_set_up = Vec::new();
        for times in [COUNTED, 2 * COUNTED] {
            let (count, output) = callgrind::count(&program, ["--once", name, &times.to_string()])?;
            let expected = (0..times).map(operation).fold(0, u32::wrapping_add);
            if String::from_utf8_lossy(&output).trim() != expected.to_string() {
                return Err(format!("{name}: another result under callgrind"));
            }
            with_set_up.push(count);
        }
        let tenths = (10 * (with_set_up[1] - with_set_up[0])).div_ceil(COUNTED as u64);
        let own = tenths as f64 / 10.0;
        println!("{name:<25} {own:>8} {:>8.3}", counts.add(name, own));
    }
    counts.finish()
}
