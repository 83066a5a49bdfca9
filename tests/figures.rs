//! The report's figures: hashes that must not change unnoticed, and agreement with the pictures the report's own
//! program made.

use std::fmt::Write as _;
use std::path::Path;

use ocellus::assemble::{Accel, with_view};
use ocellus::description::SceneDescription;
use ocellus::input::read_picture;
use ocellus::output::ToneMap;
use ocellus_kernel::Everything;
use ocellus_kernel::sampler::{AddressedSampler, Block, Sampler};

use crate::support::pictures::{Estimate, FIGURES, PRECISIONS, data_folder, figure, film};
use crate::support::trials::Trials;

/// The file of golden hashes.
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/figures.txt");

/// Set to write the file of golden hashes anew instead of comparing with it, when the pictures are meant to change:
/// `OCELLUS_BLESS=1 cargo test -p ocellus-tests golden`. The change then shows in the commit.
const BLESS: &str = "OCELLUS_BLESS";

#[test]
fn golden_hashes() {
    let mut table = String::from("# figure, precision, image hash of 48 x 48 pixels with samples 0..4\n");
    for name in FIGURES {
        for precision in PRECISIONS {
            let film = film(&figure(name, 48), |settings| {
                settings.samples = 0..4;
                settings.precision = precision;
            });
            writeln!(table, "{name} {precision} {:016x}", film.image_hash()).expect("a string takes all");
        }
    }
    if std::env::var_os(BLESS).is_some() {
        std::fs::write(GOLDEN, &table).expect("the file of golden hashes can be written");
    }
    let golden = std::fs::read_to_string(GOLDEN).unwrap_or_default();
    for (new, old) in table.lines().zip(golden.lines().chain(std::iter::repeat("nothing"))) {
        assert_eq!(new, old, "pictures changed; if they are meant to, set {BLESS}=1 and run this test again");
    }
    assert_eq!(table, golden, "{GOLDEN} has lines of other figures");
    Trials::passed::<f32>("N47", "golden hashes; both precisions (targets: tests/same_bits/run)", 18);
}

/// Pixels across and down of the report's pictures.
const SIZE: u32 = 256;

/// Fewest pixels of a wall in a block for their mean to be compared.
const FEWEST: usize = 64;

/// Fewest blocks of a figure that have to be fit for comparison, lest nothing is compared in silence.
const FEWEST_BLOCKS: u32 = 10;

/// Largest relative deviation of the linear mean of a wall in a block.
const DEVIATION: f64 = 0.02;

/// The same for what lies in the strip of [`STRIP`] pixels beside the frame's edge.
const DEVIATION_AT_EDGE: f64 = 0.03;

/// Width of that strip, pixels: as wide as the side walls are seen.
const STRIP: u32 = 16;

/// A figure, the report's picture of it, and how it is compared.
struct Original {
    name: &'static str,
    picture: &'static str,
    /// Samples per pixel, and pixels across and down of a block: enough of both to leave noise below the tolerance.
    samples: u32,
    block: u32,
    /// Parts left out, in pixels `[x0, y0, x1, y1]`.
    left_out: &'static [[u32; 4]],
}

/// Walls in direct light have no noise but at their edges.
const fn direct(name: &'static str, picture: &'static str, samples: u32) -> Original {
    Original { name, picture, samples, block: 16, left_out: &[] }
}

const ORIGINALS: [Original; 9] = [
    direct("fig2a", "fig2a_diffuse_no_gamma", 1),
    direct("fig2b", "fig2b_diffuse_aa", 16),
    direct("fig2c", "fig2c_mirror_glass", 16),
    direct("fig2d", "fig2d_fresnel", 16),
    Original {
        name: "fig4",
        picture: "fig4_mesh",
        samples: 64,
        block: 64,
        // The cat with its shadow on the floor and, on the right, on the wall: theirs was another cat.
        left_out: &[[40, 50, 205, 192], [205, 120, 250, 192]],
    },
    Original { name: "fig5a", picture: "fig5a_indirect", samples: 64, block: 64, left_out: &[] },
    Original { name: "fig5b", picture: "fig5b_indirect_aa", samples: 64, block: 64, left_out: &[] },
    Original {
        name: "fig5c",
        picture: "fig5c_sphere_light",
        samples: 128,
        block: 64,
        // The floor beside the balls, where glass gathers light that paths find by chance.
        left_out: &[[32, 160, 256, 192]],
    },
    Original {
        name: "fig5d",
        picture: "fig5d_depth_of_field",
        samples: 128,
        block: 64,
        // The floor before the glass ball, which throws light back on it after a reflection inside: the report
        // computes that with Schlick's formula and the cosine of the wrong side, and gets too little.
        left_out: &[[0, 150, 130, 256]],
    },
];

/// Walls and floor agree with the report's pictures wherever these are neither black nor saturated. Pixels within two
/// of another surface are left out, and so are balls and cat: the report's glass has faults, and its cat was another.
#[test]
fn walls_and_floor_agree_with_the_report() {
    let Some(folder) = data_folder("figures against the report's pictures", "seed") else { return };
    let mut faults = Vec::new();
    for original in &ORIGINALS {
        faults.extend(compare(original, &folder.join(original.picture).with_extension("png")));
    }
    assert_eq!(faults, [""; 0]);
}

/// The blocks of a figure that do not agree, each with the wall it shows.
fn compare(original: &Original, path: &Path) -> Vec<String> {
    let name = original.name;
    let description = figure(name, SIZE);
    let theirs = decode(path, description.film.gamma.expect("the figures have a gamma"));
    let film = film(&description, |settings| settings.samples = 0..original.samples);

    let mut faults = Vec::new();
    let (mut compared, mut worst) = (0, 0.0);
    for Patch { wall, block, places } in patches(original, &theirs, &Surfaces::new(&description)) {
        let ours = Estimate::of(places.iter().map(|&place| (&film.pixels()[index(place)]).into()));
        let known = |place| Estimate { mean: theirs[index(place)].unwrap_or_default(), ..Estimate::default() };
        let mean = Estimate::of(places.iter().copied().map(known)).mean;
        let at_edge = |axis: usize| places.iter().all(|place| !(STRIP..SIZE - STRIP).contains(&place[axis]));
        let tolerance = if at_edge(0) || at_edge(1) { DEVIATION_AT_EDGE } else { DEVIATION };
        let noise = [0, 1, 2].map(|c| ours.variance[c].sqrt() / mean[c]);
        // Where noise alone may reach the tolerance, a deviation says nothing.
        if noise.iter().any(|noise| 3.0 * noise > tolerance) {
            continue;
        }
        compared += 1;
        let deviations = [0, 1, 2].map(|c| ours.mean[c] / mean[c] - 1.0);
        let largest = deviations.map(f64::abs).into_iter().fold(0.0, f64::max);
        worst = f64::max(worst, largest);
        let percent = |values: [f64; 3]| values.map(|value| 100.0 * value);
        let line = format!(
            "{name}: block {block:?}, {wall}, {} pixels: off by {:+.2?} %, noise {:.2?} %",
            places.len(),
            percent(deviations),
            percent(noise)
        );
        println!("{line}");
        if !deviations.iter().all(|deviation| deviation.abs() <= tolerance) {
            faults.push(line);
        }
    }
    println!("{name}: {compared} blocks compared, at most {:.2} % off", 100.0 * worst);
    assert!(compared >= FEWEST_BLOCKS, "{name}: only {compared} blocks are fit for comparison");
    faults
}

/// What is seen of a wall in a block.
struct Patch {
    wall: &'static str,
    /// Column and row of the block.
    block: [u32; 2],
    /// Pixels that show the wall alone and that are usable in the report's picture, as all within two of them.
    places: Vec<[u32; 2]>,
}

fn patches(original: &Original, theirs: &[Option<[f64; 3]>], surfaces: &Surfaces) -> Vec<Patch> {
    let left_out = |[x, y]: [u32; 2]| {
        original.left_out.iter().any(|&[x0, y0, x1, y1]| (x0..x1).contains(&x) && (y0..y1).contains(&y))
    };
    let mut patches: Vec<Patch> = Vec::new();
    for place in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| [x, y])) {
        let Some(wall) = surfaces.0[index(place)] else { continue };
        let pure = |near| surfaces.0[index(near)] == Some(wall) && theirs[index(near)].is_some();
        if left_out(place) || !around(place).all(pure) {
            continue;
        }
        let block = place.map(|at| at / original.block);
        match patches.iter_mut().find(|patch| patch.wall == wall && patch.block == block) {
            Some(patch) => patch.places.push(place),
            None => patches.push(Patch { wall, block, places: vec![place] }),
        }
    }
    patches.retain(|patch| patch.places.len() >= FEWEST);
    patches
}

fn index([x, y]: [u32; 2]) -> usize {
    (y * SIZE + x) as usize
}

/// The pixels within two of one, in the picture.
fn around([x, y]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let near = |at: u32| at.saturating_sub(2)..(at + 3).min(SIZE);
    near(y).flat_map(move |y| near(x).map(move |x| [x, y]))
}

/// The report's picture, linear; `None` for pixels that are black or saturated in a channel.
///
/// Its program wrote `254 x^(1/gamma)`, truncated: half a code more is the value in the mean.
fn decode(path: &Path, gamma: f64) -> Vec<Option<[f64; 3]>> {
    let picture = read_picture(path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((picture.width, picture.height), (SIZE, SIZE));
    let codes = ToneMap::default().encode_picture(&picture);
    let linear = |code: &u8| libm::pow((f64::from(*code) + 0.5) / 254.0, gamma);
    let of_pixel = |codes: &[u8]| {
        let usable = codes.iter().all(|code| (5..=250).contains(code));
        usable.then(|| std::array::from_fn(|channel| linear(&codes[channel])))
    };
    codes.chunks_exact(3).map(of_pixel).collect()
}

/// The materials of the room.
const WALLS: [&str; 6] = ["right_wall", "left_wall", "ceiling", "floor", "back_wall", "far_wall"];

/// For each pixel the wall that all of it shows.
struct Surfaces(Vec<Option<&'static str>>);

impl Surfaces {
    fn new(description: &SceneDescription) -> Self {
        let wall_of = |material: usize| {
            let name = &description.materials[material].name;
            WALLS.into_iter().find(|wall| wall == name)
        };
        let of_sphere: Vec<_> = description.spheres.iter().map(|sphere| wall_of(sphere.material)).collect();
        let walls = with_view::<f32, _>(description, Accel::Bvh, |view, _| {
            let first_hit = |x: u32, y: u32, sample: u32| {
                let mut sampler = AddressedSampler::new(0, x, y, sample);
                sampler.begin_vertex(0);
                let hit =
                    view.scene.intersect(&view.camera.ray::<Everything>(x, y, sampler.numbers(Block::Scatter)))?;
                // Lights and triangles come after the spheres of the description.
                *of_sphere.get(hit.primitive as usize)?
            };
            let of_pixel = |x, y| {
                let first = first_hit(x, y, 0);
                first.filter(|_| (1..16).all(|sample| first_hit(x, y, sample) == first))
            };
            (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| [x, y])).map(|[x, y]| of_pixel(x, y)).collect()
        });
        Self(walls.unwrap_or_else(|error| panic!("{error}")))
    }
}
