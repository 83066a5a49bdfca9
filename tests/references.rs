//! Whole pictures against converged ones of another renderer (`fixtures/reference/README.md`): the mean of each
//! channel, and the means of blocks in units of their standard error.
//!
//! A picture is right where its means are within 0.3 % and every block within 5 standard errors. Blocks are 16 pixels
//! wide, which shows where a fault is, and 64, which shows faults too small for the noise of 16: light that is found
//! by chance through glass is most of the noise in the rooms with balls, and hides an albedo that is 1 % off from
//! blocks of 16, but not from those of 64. No block is left out: with 1024 samples in a pixel those with caustics are
//! near enough to normally distributed to pass like the others.

use std::path::Path;

use glam::DAffine3;
use ocellus::description::{LightDescription, ScatteringDescription, SceneDescription};
use ocellus::error::Origin;
use ocellus::film::{Film, Region};
use ocellus::input::read_picture;
use ocellus::load::obj::load_obj;
use ocellus::picture::Picture;

use crate::support::pictures::{Estimate, data_folder, film, fixture, scene};

/// Pixels across and down of all references.
const SIZE: u32 = 256;

/// Samples per pixel: no fewer than the shortest of the references has.
const SAMPLES: u32 = 1024;

/// Largest relative deviation of the mean of a channel.
const MEAN: f64 = 0.003;

/// Largest deviation of the mean of a block, standard errors.
const STANDARD_ERRORS: f64 = 5.0;

/// Pixels across and down of blocks.
const BLOCKS: [u32; 2] = [16, 64];

/// A converged picture and the standard error of each of its pixels.
struct Reference {
    picture: Picture,
    error: Picture,
}

impl Reference {
    fn read(picture: &Path, error: &Path) -> Self {
        let read = |path| read_picture(path).unwrap_or_else(|error| panic!("{error}"));
        let reference = Self { picture: read(picture), error: read(error) };
        for picture in [&reference.picture, &reference.error] {
            assert_eq!((picture.width, picture.height), (SIZE, SIZE));
        }
        reference
    }

    fn of_fixture(name: &str) -> Self {
        let [picture, error] = ["exr", "se.exr"].map(|end| fixture(&format!("reference/{name}.{end}")));
        Self::read(&picture, &error)
    }

    /// A pixel. Its variance includes its rounding to half floats, at most 2^-11 of the value: that bound is taken for
    /// the standard deviation, which is the safe side of a uniform error's 2^-11 / sqrt 3.
    fn pixel(&self, x: u32, y: u32) -> Estimate {
        let index = (y * SIZE + x) as usize;
        let mean = self.picture.pixels[index].map(f64::from);
        let error = self.error.pixels[index].map(f64::from);
        let rounding = mean.map(|value| value / 2048.0);
        Estimate { mean, variance: std::array::from_fn(|c| error[c] * error[c] + rounding[c] * rounding[c]) }
    }
}

/// How near a film is to a reference.
#[derive(Debug)]
struct Agreement {
    /// Means of the film and of the reference over the film's region.
    means: [[f64; 3]; 2],
    /// For each size of blocks the largest deviation, in standard errors, with the block's column and row.
    worst: Vec<(u32, f64, [u32; 2])>,
}

impl Agreement {
    fn new(film: &Film, reference: &Reference) -> Self {
        let region = film.region();
        let ours = |x: u32, y: u32| {
            Estimate::from(&film.pixels()[((y - region.y0) * region.width() + x - region.x0) as usize])
        };
        // Both films over the same pixels.
        let compare = |part: Region| {
            let places = || (part.y0..part.y1).flat_map(|y| (part.x0..part.x1).map(move |x| (x, y)));
            let ours = Estimate::of(places().map(|(x, y)| ours(x, y)));
            [ours, Estimate::of(places().map(|(x, y)| reference.pixel(x, y)))]
        };
        let worst = BLOCKS.map(|size| {
            let mut worst = (size, 0.0, [0; 2]);
            for (row, column) in (region.y0 / size..region.y1 / size)
                .flat_map(|row| (region.x0 / size..region.x1 / size).map(move |column| (row, column)))
            {
                let (x0, y0) = (column * size, row * size);
                let [ours, theirs] = compare(Region { x0, y0, x1: x0 + size, y1: y0 + size });
                for c in 0..3 {
                    let z = (ours.mean[c] - theirs.mean[c]) / (ours.variance[c] + theirs.variance[c]).sqrt();
                    if !(z.abs() <= f64::abs(worst.1)) {
                        worst = (size, z, [column, row]);
                    }
                }
            }
            worst
        });
        Self { means: compare(region).map(|estimate| estimate.mean), worst: worst.to_vec() }
    }

    /// Relative deviation of the mean of a channel.
    fn deviation(&self, channel: usize) -> f64 {
        self.means[0][channel] / self.means[1][channel] - 1.0
    }

    /// What is wrong; nothing for a right picture.
    fn faults(&self) -> Vec<String> {
        let means = (0..3)
            .filter(|&channel| !(self.deviation(channel).abs() <= MEAN))
            .map(|channel| format!("mean of channel {channel} off by {:+.3} %", 100.0 * self.deviation(channel)));
        let blocks = self
            .worst
            .iter()
            .filter(|(_, z, _)| !(z.abs() < STANDARD_ERRORS))
            .map(|(size, z, at)| format!("block {at:?} of {size} pixels off by {z:+.1} standard errors"));
        means.chain(blocks).collect()
    }

    fn print(&self, what: &str) {
        let [ours, theirs] = &self.means;
        let deviations = [0, 1, 2].map(|channel| 100.0 * self.deviation(channel));
        println!("{what}: means {ours:.5?}, reference {theirs:.5?}, off by {deviations:+.4?} %");
        for (size, z, at) in &self.worst {
            println!("{what}: blocks of {size}: at most {z:+.2} standard errors, at {at:?}");
        }
    }
}

fn reference_scene(name: &str) -> SceneDescription {
    scene(fixture(&format!("reference/{name}.toml")), SIZE)
}

#[track_caller]
fn assert_agrees(what: &str, description: &SceneDescription, reference: &Reference) {
    let agreement = Agreement::new(&film(description, |settings| settings.samples = 0..SAMPLES), reference);
    agreement.print(what);
    assert_eq!(agreement.faults(), [""; 0], "{what}");
}

#[test]
fn spheres_of_glass_and_mirror() {
    assert_agrees("spheres", &reference_scene("spheres"), &Reference::of_fixture("spheres"));
}

#[test]
fn spheres_through_a_lens() {
    assert_agrees("spheres_lens", &reference_scene("spheres_lens"), &Reference::of_fixture("spheres_lens"));
}

#[test]
fn a_mesh_in_the_room() {
    let Some(folder) = data_folder("the bunny in the room", "references") else { return };
    let [mesh, picture, error] =
        ["bunny_in_room.obj", "bunny_room.exr", "bunny_room.se.exr"].map(|name| folder.join(name));
    let mut description = reference_scene("bunny_room");
    let white = description.materials.iter().position(|material| material.name == "white");
    let mesh_file = load_obj(&mesh, None).unwrap_or_else(|error| panic!("{error}"));
    mesh_file.append_to(&mut description, Origin::file(&mesh), DAffine3::IDENTITY, white);
    assert!(description.meshes[0].triangles.len() > 69_000);
    assert_agrees("bunny_room", &description, &Reference::read(&picture, &error));
}

/// A scene that is slightly wrong, and a block of 64 pixels that shows it.
struct Wrong {
    what: &'static str,
    block: [u32; 2],
    change: fn(&mut SceneDescription),
}

/// Scales the albedo of a wall.
fn scale_albedo(description: &mut SceneDescription, wall: &str, factor: f64) {
    let material = description.materials.iter_mut().find(|material| material.name == wall);
    let Some(ScatteringDescription::Diffuse { albedo, .. }) = material.map(|material| &mut material.scattering) else {
        panic!("{wall} is no diffuse material of this scene");
    };
    *albedo *= factor;
}

/// Scales radius and radiance of the light.
fn scale_light(description: &mut SceneDescription, radius_factor: f64, radiance_factor: f64) {
    let [LightDescription::Sphere { radius, radiance, .. }] = description.lights.as_mut_slice() else {
        panic!("one sphere light");
    };
    *radius *= radius_factor;
    *radiance *= radiance_factor;
}

const WRONG: [Wrong; 5] = [
    Wrong { what: "nothing", block: [1, 3], change: |_| () },
    Wrong { what: "floor 1 % brighter", block: [1, 3], change: |scene| scale_albedo(scene, "floor", 1.01) },
    Wrong { what: "far wall 1 % darker", block: [2, 0], change: |scene| scale_albedo(scene, "far_wall", 0.99) },
    Wrong { what: "light 2 % larger, same radiance", block: [1, 3], change: |scene| scale_light(scene, 1.02, 1.0) },
    // The room is lit as before: only the picture of the light itself differs.
    Wrong {
        what: "light 2 % larger, same power",
        block: [1, 0],
        change: |scene| scale_light(scene, 1.02, 1.0 / (1.02 * 1.02)),
    },
];

/// The test has power. Each wrong scene is rendered in one block alone, which holds the same bits as in the whole
/// picture: a block that fails here would fail the test of the whole picture.
#[test]
fn pictures_that_are_slightly_wrong_are_found_out() {
    let reference = Reference::of_fixture("spheres");
    for Wrong { what, block: [column, row], change } in WRONG {
        let mut description = reference_scene("spheres");
        change(&mut description);
        let [x0, y0] = [column, row].map(|block| block * 64);
        let film = film(&description, |settings| {
            settings.samples = 0..SAMPLES;
            settings.region = Region { x0, y0, x1: x0 + 64, y1: y0 + 64 };
        });
        let agreement = Agreement::new(&film, &reference);
        agreement.print(what);
        let blocks = agreement.worst.iter().any(|(_, z, _)| z.abs() >= STANDARD_ERRORS);
        assert_eq!(blocks, what != "nothing", "{what}: {agreement:?}");
    }
}
