//! Makes the cat of figure 4: `cat.obj`, `cat.mtl` and its texture `cat.png`.
//!
//! `cargo run --release -p ocellus --example make_cat -- --triangles 5000 -o fixtures/meshes`
//!
//! A distance field is polygonised, simplified to the wanted number of triangles, unwrapped and painted.
//! The same arguments give the same bytes on every machine: only exactly rounded operations and the `libm`
//! crate are used, and nothing is visited in hash order.

mod body;
mod coat;
mod mesh;
mod pack;
mod polygonise;
mod raster;
mod shape;
mod simplify;
#[cfg(test)]
mod tests;
mod texture;
mod uv;
mod write;

use body::{BOUNDS, Cat, Part};
use clap::Parser;
use glam::DVec3;
use mesh::Mesh;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use texture::Texture;
use uv::Unwrapping;

/// Makes a cat: an OBJ mesh with normals and texture coordinates, its material and its texture.
#[derive(Parser)]
struct Arguments {
    /// How many triangles the mesh shall have (the result has this many, or one less).
    #[arg(long, default_value_t = 5000, value_parser = clap::value_parser!(u32).range(2000..=200_000))]
    triangles: u32,
    /// Folder for cat.obj, cat.mtl and cat.png; it is made if missing.
    #[arg(short, long, default_value = "fixtures/meshes")]
    output: PathBuf,
}

/// Everything that goes into the files.
struct CatModel {
    mesh: Mesh,
    /// Unit normals, one for each vertex of the mesh.
    normals: Vec<DVec3>,
    unwrapping: Unwrapping,
    texture: Texture,
}

/// Side of the texture in texels.
const TEXTURE_SIZE: usize = 512;

/// Grid spacing that resolves the ears' edges, in model units.
const COARSEST_SPACING: f64 = 0.38;

/// Triangles of the raw mesh for each one that is kept, at least: simplification needs something to choose from.
const SURPLUS: f64 = 2.5;

/// Rounds of evening out the triangles on the surface.
const RELAXATIONS: usize = 2;

/// How much more an error of shape matters on the head than on the body.
const HEAD_DETAIL: f64 = 8.0;

fn make_cat(triangles: u32) -> CatModel {
    let cat = Cat::new();
    let field = |point: DVec3| cat.distance(point);
    let wanted = f64::from(triangles) * SURPLUS;
    let mut spacing = COARSEST_SPACING;
    let mut raw = polygonise::polygonise(field, BOUNDS, spacing);
    while (raw.triangles.len() as f64) < wanted {
        // The count grows with the inverse square of the spacing; a little more makes one repetition enough.
        spacing *= 0.98 * libm::sqrt(raw.triangles.len() as f64 / wanted);
        raw = polygonise::polygonise(field, BOUNDS, spacing);
    }
    let is_head = |point: DVec3| cat.part(point) == Part::Head;
    let detail = |point: DVec3| if is_head(point) { HEAD_DETAIL } else { 1.0 };
    let mut mesh = simplify::simplify(raw, triangles as usize, detail);
    for _ in 0..RELAXATIONS {
        mesh.relax(|point| cat.gradient(point));
        for point in &mut mesh.positions {
            *point = cat.project(*point);
        }
    }
    let normals = mesh.positions.iter().map(|&point| shape::unit(cat.gradient(point))).collect();
    let unwrapping = uv::unwrap(&mesh, is_head);
    let texture = texture::paint(&mesh, &unwrapping, TEXTURE_SIZE, coat::CREAM, |point| coat::color(&cat, point));

    let ground = mesh.positions.iter().fold(f64::INFINITY, |lowest, point| lowest.min(point.y));
    for point in &mut mesh.positions {
        point.y -= ground;
    }
    CatModel { mesh, normals, unwrapping, texture }
}

/// What to type to make this cat, in the default folder.
fn command(triangles: u32) -> String {
    format!("cargo run --release -p ocellus --example make_cat -- --triangles {triangles}")
}

/// The files' names and bytes.
fn files(triangles: u32) -> Result<[(&'static str, Vec<u8>); 3], String> {
    let model = make_cat(triangles);
    let png = write::png(&model.texture).map_err(|error| format!("cannot encode the texture: {error}"))?;
    Ok([
        ("cat.obj", write::obj(&model, &command(triangles)).into_bytes()),
        ("cat.mtl", write::MTL.as_bytes().to_vec()),
        ("cat.png", png),
    ])
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let folder: &Path = &arguments.output;
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("cannot make the folder {}: {error}; choose another with -o", folder.display()))?;
    for (name, bytes) in files(arguments.triangles)? {
        let path = folder.join(name);
        std::fs::write(&path, &bytes)
            .map_err(|error| format!("cannot write {}: {error}; choose another folder with -o", path.display()))?;
        println!("{} ({} bytes)", path.display(), bytes.len());
    }
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
