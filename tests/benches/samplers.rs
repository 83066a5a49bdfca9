//! What Sobol's numbers are worth: noise and instructions as ratios to independent numbers.
//!
//! `cargo bench -p ocellus-tests --bench samplers` prints a table. Noise is the root mean square error over pixels and
//! channels, from the spread of renders that differ in their seeds. It needs valgrind for the instructions.

#[allow(dead_code, unused_imports, unused_macros, reason = "the suite uses more of it")]
#[path = "../support/mod.rs"]
mod support;

#[path = "../../host/benches/support/callgrind.rs"]
mod callgrind;

use std::process::ExitCode;

use ocellus::description::SamplerDescription;
use ocellus::render::{RenderSettings, Unmonitored, render};

use support::noise::Noise;
use support::pictures::{fixture, scene};

const SCENES: [&str; 7] = [
    "features/sphere_light",
    "features/lens",
    "features/emission",
    "report/fig5a",
    "report/fig5c",
    "reference/spheres",
    "../tests/benches/room",
];
/// Pixels across and down.
const SIZE: u32 = 48;
const SEEDS: u64 = 16;

const KINDS: [(&str, SamplerDescription); 2] =
    [("independent", SamplerDescription::Independent), ("sobol", SamplerDescription::Sobol)];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if let [name, kind, samples] = &arguments[..] {
        let mut scene = scene(fixture(&format!("{name}.toml")), 32);
        scene.integrator.sampler = KINDS.iter().find(|known| known.0 == kind).expect("a sampler").1;
        let samples = samples.parse().expect("a number of samples");
        let settings = RenderSettings { samples: 0..samples, threads: 1, ..RenderSettings::of(&scene) };
        render(&scene, &settings, &Unmonitored).unwrap_or_else(|error| panic!("{error}"));
        return ExitCode::SUCCESS;
    }
    println!("ratios of sobol to independent; less than 1 is better");
    println!("| scene | RMSE: 16, 64, 256 samples | instructions |\n|---|---|---|");
    for name in SCENES {
        let scene = scene(fixture(&format!("{name}.toml")), SIZE);
        let noise = [16, 64, 256].map(|samples| {
            let [independent, sobol] = KINDS.map(|(_, kind)| Noise::of(&scene, kind, samples, SEEDS).rmse());
            format!("{:.2}", sobol / independent)
        });
        let [independent, sobol] = KINDS.map(|(kind, _)| instructions(name, kind));
        println!("| {} | {} | {:.3} |", name.rsplit('/').next().unwrap_or(name), noise.join(", "), sobol / independent);
    }
    ExitCode::SUCCESS
}

/// Instructions of four samples of each pixel, without those of setting up.
fn instructions(scene: &str, kind: &str) -> f64 {
    let program = std::env::current_exe().expect("this program");
    let [few, many] = ["2", "6"].map(|samples| {
        let counted = callgrind::count(&program, [scene, kind, samples]);
        counted.unwrap_or_else(|error| panic!("{error}")).0 as f64
    });
    many - few
}
