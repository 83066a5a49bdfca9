//! What Sobol's numbers are worth: `cargo bench -p ocellus --bench samplers`.
//!
//! Every fixture, in small, is rendered by independent and by Sobol's numbers with seeds of its own. Half the mean square
//! difference of two pictures is their mean squared error, without a reference and without what is systematic; each
//! pair of seeds gives an error at each number of samples, a slope, and a ratio. Intervals are Student's, over pairs.

#[path = "support/fixtures.rs"]
mod fixtures;

use std::path::Path;
use std::process::ExitCode;

use ocellus::description::SamplerDescription::{self, Independent, Sobol};
use ocellus::film::Film;
use ocellus::ledger::estimate::{Estimate, Line, Ratio};
use ocellus::load::load_scene;
use ocellus::render::{RenderSettings, Unmonitored, with_tracer};

/// Pixels across, and about as many down.
const WIDTH: u32 = 24;
const PAIRS: u64 = 8;
/// Samples per pixel: powers of four, where Sobol's numbers are evenest.
const RUNGS: [u32; 4] = [4, 16, 64, 256];
/// Student's factor for 99.95 % over that for 95 %, of seven degrees of freedom: so sure must each of the scenes be for
/// all of them together to be.
const SURER: f64 = 6.08 / 2.365;

/// Mean squared errors of each pair, at each rung.
type Errors = Vec<[f64; RUNGS.len()]>;

fn main() -> ExitCode {
    println!("RMSE: slope over samples; by Sobol's numbers over that by independent ones. +- and .. are 95 %");
    println!(
        "{:<22}{:>18}{:>18}{:>20}{:>20}  sobol is",
        "scene", "independent", "sobol", "at 16 samples", "at 256 samples"
    );
    let (mut better, mut wrong) = (0, Vec::new());
    for path in fixtures::all() {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let [independent, sobol] = [Independent, Sobol].map(|sampler| errors(&path, sampler));
        if independent.iter().flatten().any(|error| *error == 0.0) {
            println!("{name:<22}left out: nothing in it is up to chance");
            continue;
        }
        let [usual, slope] = [&independent, &sobol].map(slope);
        let ratios = [1, 3].map(|rung| {
            let pairs =
                independent.iter().zip(&sobol).map(|(independent, sobol)| (sobol[rung] / independent[rung]).sqrt());
            Ratio::of(pairs).expect("errors above zero")
        });
        let log = ratios.map(|ratio| [libm::log(ratio.value), libm::log(ratio.factor())]);
        let verdict = if log.iter().any(|[value, half]| *value > SURER * half) {
            wrong.push(format!("{name}: worse"));
            "worse"
        } else if log[1][0] < -SURER * log[1][1] {
            better += 1;
            "better"
        } else {
            "no different, as far as this shows"
        };
        if (usual.value + 0.5).abs() > SURER * usual.half {
            wrong.push(format!("{name}: independent samples do not fall by their root"));
        }
        let [few, many] =
            ratios.map(|Ratio { value, interval: [low, high] }| format!("{value:.2} ({low:.2}..{high:.2})"));
        let [usual, slope] = [usual, slope].map(|Estimate { value, half }| format!("{value:.3} +- {half:.3}"));
        println!("{name:<22}{usual:>18}{slope:>18}{few:>20}{many:>20}  {verdict}");
    }
    println!(
        "better on {better} scenes; {}",
        if wrong.is_empty() { "worse on none".to_owned() } else { wrong.join("; ") }
    );
    if better < 4 || !wrong.is_empty() { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn slope(errors: &Errors) -> Estimate {
    Estimate::of(errors.iter().map(|errors| {
        let points = RUNGS.iter().zip(errors).map(|(spp, error)| [libm::log(f64::from(*spp)), 0.5 * libm::log(*error)]);
        Line::through(&points.collect::<Vec<_>>()).expect("four rungs").slope
    }))
}

fn errors(path: &Path, sampler: SamplerDescription) -> Errors {
    let mut scene = load_scene(path).expect("a fixture");
    let (width, height) = (scene.film.width, scene.film.height);
    (scene.film.width, scene.film.height) = (WIDTH, (WIDTH * height / width).max(1));
    scene.integrator.sampler = sampler;
    let settings = RenderSettings::of(&scene);
    with_tracer(&scene, &settings, |tracer| {
        let job = tracer.job(&scene.integrator, &settings).expect("a kernel");
        let of_pair = |pair: u64| {
            let mut films = [(); 2].map(|()| Film::new(settings.region));
            let mut start = 0;
            RUNGS.map(|end| {
                for (film, seed) in films.iter_mut().zip([2 * pair, 2 * pair + 1]) {
                    tracer.trace(&job, seed, start..end, film, &Unmonitored);
                }
                start = end;
                let [a, b] = [&films[0], &films[1]].map(|film| film.pixels().iter().flat_map(|pixel| pixel.mean()));
                let squares: f64 = a.zip(b).map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum();
                0.5 * squares / (3 * films[0].pixels().len()) as f64
            })
        };
        (0..PAIRS).map(of_pair).collect()
    })
    .expect("a fixture that can be rendered")
}
