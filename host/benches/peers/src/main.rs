//! Ray queries of Ocellus beside those of Embree, obvhs and parry3d: the same rays in the same run, in turns, on one
//! thread, with the answers compared.

mod embree;
mod isa;
mod measure;
mod mesh;
mod options;
mod ours;
mod peer;
mod rays;
mod rust_crates;
mod table;

use std::path::Path;
use std::process::ExitCode;

use embree::Embree;
use isa::Isa;
use mesh::Mesh;
use options::Options;
use ours::Ours;
use peer::Row;

/// Sizes of the growth table: a tenth, ten times as much, and so on.
const SIZES: [usize; 6] = [100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000];
/// Triangles of the mesh of bumps.
const BUMPS: usize = 2_000_000;
/// Triangles of the plain sphere, which is there for its leaks.
const SPHERE: usize = 20_000;
/// How often a hierarchy is built, of which the median counts.
const BUILDS: usize = 5;

fn main() -> ExitCode {
    let done = Options::parse(std::env::args().skip(1))
        .map_err(|error| format!("{error}\n{}", options::USAGE))
        .and_then(|options| run(&options));
    match done {
        Ok(complaints) if complaints.is_empty() => ExitCode::SUCCESS,
        Ok(complaints) => {
            complaints.iter().for_each(|line| eprintln!("disagreement: {line}"));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("peers: {error}");
            ExitCode::from(2)
        }
    }
}

/// Measures what is asked for; says what does not agree.
fn run(options: &Options) -> Result<Vec<String>, String> {
    let embree = options.embree.as_deref().map(Embree::load).transpose()?;
    match &embree {
        Some(embree) => println!("Embree {}", version(embree.version()?)),
        None => println!("skipped: Embree, since --embree names no library"),
    }
    let isas: Vec<String> = Isa::available().map(|isa| isa.to_string()).collect();
    println!("this machine has {}; {} rays per set, {} rounds", isas.join(", "), options.rays, options.rounds);

    let mut complaints = Vec::new();
    if options.growth {
        let mut lines = Vec::new();
        for triangles in SIZES.into_iter().filter(|size| options.triangles.is_none_or(|most| *size <= most)) {
            eprintln!("{triangles} triangles");
            let (of_size, complaints_of_size) = grow(options, embree.as_ref(), &Mesh::bumpy(triangles))?;
            lines.extend(of_size);
            complaints.extend(complaints_of_size);
        }
        table::growth(lines);
        return Ok(complaints);
    }
    for name in &options.meshes {
        if let Some(mesh) = find(options, name)? {
            complaints.extend(compare(options, embree.as_ref(), &mesh)?);
        }
    }
    Ok(complaints)
}

fn version(number: isize) -> String {
    format!("{}.{}.{}", number / 10_000, number / 100 % 100, number % 100)
}

/// The mesh of that name, or of that file.
fn find(options: &Options, name: &str) -> Result<Option<Mesh>, String> {
    Ok(Some(match name {
        "bumps" => Mesh::bumpy(options.triangles.unwrap_or(BUMPS)),
        "sphere" => Mesh::sphere(SPHERE),
        "bunny" => {
            let Some(folder) = std::env::var_os("OCELLUS_DATA") else {
                println!("\nskipped: the bunny, since OCELLUS_DATA names no folder");
                return Ok(None);
            };
            Mesh::load(&Path::new(&folder).join("models/stanford-bunny.obj"))?
        }
        file => Mesh::load(Path::new(file))?,
    }))
}

/// Prints the tables of a mesh; says what does not agree. The plain sphere has only one, of leaks.
fn compare(options: &Options, embree: Option<&Embree>, mesh: &Mesh) -> Result<Vec<String>, String> {
    println!("\n## {}: {} triangles\n", mesh.name, mesh.triangles.len());
    ours::with_scene(mesh, BUILDS, |ours| {
        let rows = rows(ours, embree, mesh, |title| options.wants(title))?;
        let leaks: Option<Vec<f64>> = mesh.closed.then(|| {
            let set = rays::at_corners_and_edges(mesh, options.rays);
            rows.iter().map(|row| 1e6 * (1.0 - measure::hits(row, &set))).collect()
        });
        if let ("sphere", Some(leaks)) = (mesh.name.as_str(), &leaks) {
            table::leaks(&rows, leaks);
            return Ok(Vec::new());
        }
        let sets = rays::sets(mesh, &*rows[0].peer, options.rays)?;
        for (set, name) in sets.iter().zip(rays::NAMES) {
            println!("{name}: {:.0} % of {} rays hit", 100.0 * measure::hits(&rows[0], set), set.rays.len());
        }
        println!();
        let measured = measure::measure(&rows, &sets, options.rounds);
        table::figures(&rows, &measured, leaks.as_deref());
        println!("\nAnswers that are not the first row's:\n");
        table::differences(&rows, &measured);
        Ok(measure::complaints(&rows, &measured, &sets))
    })?
}

/// One size of the growth table, with the most instructions that this machine has; and what does not agree.
fn grow(options: &Options, embree: Option<&Embree>, mesh: &Mesh) -> Result<(Vec<Vec<String>>, Vec<String>), String> {
    ours::with_scene(mesh, BUILDS, |ours| {
        let best = Isa::best().to_string();
        let mut rows = rows(ours, embree, mesh, |title| options.wants(title) && title.ends_with(&best))?;
        rows.retain(|row| row.isa == Isa::best());
        let sets = rays::sets(mesh, &*rows[0].peer, options.rays)?;
        let measured = measure::measure(&rows, &sets, options.rounds);
        let lines = table::growth_lines(mesh.triangles.len(), &rows, &measured);
        Ok((lines, measure::complaints(&rows, &measured, &sets)))
    })?
}

/// Our own rows, the most instructions first, and those of the others that are wanted.
fn rows<'a>(
    ours: &'a Ours<'a>,
    embree: Option<&'a Embree>,
    mesh: &'a Mesh,
    wanted: impl Fn(&str) -> bool + Copy,
) -> Result<Vec<Row<'a>>, String> {
    let mut rows: Vec<Row<'a>> = Isa::available().rev().map(|isa| ours.row(isa)).collect();
    if let Some(embree) = embree {
        rows.extend(embree.rows(mesh, BUILDS, wanted)?);
    }
    rows.extend(rust_crates::rows(mesh, BUILDS, wanted)?);
    Ok(rows)
}
