//! Whether means are exact: `cargo bench -p ocellus --bench unbiased`.
//!
//! Every fixture, in small, is rendered in many short runs with each estimator that applies to it, and the mean over pixels
//! and channels is compared with that of many more samples. Then it is rendered in as many runs that end at a promised
//! error. With `--unbiased` their mean must be exact, too. Without it, a picture's own samples decide when it ends, and how
//! far that takes the mean off is told, but decides nothing here.

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/median.rs"]
mod median;

use std::path::Path;
use std::process::ExitCode;

use ocellus::description::{IntegratorDescription, LightSamplingDescription, SamplerDescription, SceneDescription};
use ocellus::diff::Metric;
use ocellus::film::Film;
use ocellus::ledger::levels::{Choice, Level, levels};
use ocellus::load::load_scene;
use ocellus::promise::{Outlook, Target};
use ocellus::render::{Precision, RenderSettings, Tracer, Unmonitored, with_tracer};
use ocellus::until::{Until, render_until};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

/// Pixels across, and about as many down.
const WIDTH: u32 = 16;
const RUNS: u64 = 200;
/// Samples of a run.
const SPP: u32 = 16;
/// Light that is found by chance is rare: with few samples of it, sums would be too skewed for a test of means.
const SPP_BY_CHANCE: u32 = 64;
/// Runs of a reference and samples of each: their scatter is its standard error.
const REFERENCE: (u64, u32) = (128, 256);
/// Pictures from which a target is chosen that most runs reach a few looks after the first.
const PILOTS: u64 = 9;
const PILOT_SPP: u32 = 24;
/// No run takes more samples.
const MOST_SAMPLES: u32 = 512;
/// The chance that an exact bench fails.
const SIGNIFICANCE: f64 = 0.01;

/// What runs are varied in.
const VARIED: [Choice; 5] = [Choice::Sampler, Choice::LightSampling, Choice::Roulette, Choice::Aim, Choice::Precision];

/// The mean of runs, and its standard error.
#[derive(Clone, Copy)]
struct Mean {
    value: f64,
    error: f64,
}

impl Mean {
    fn of(runs: &[f64]) -> Self {
        let count = runs.len() as f64;
        let value = runs.iter().sum::<f64>() / count;
        let squares: f64 = runs.iter().map(|run| (run - value) * (run - value)).sum();
        Self { value, error: (squares / (count - 1.0) / count).sqrt() }
    }

    /// How many standard errors it is above another one.
    fn above(self, other: Self) -> f64 {
        (self.value - other.value) / libm::hypot(self.error, other.error)
    }
}

/// The first seeds of a scene's runs: no two rows share one, so that what one does by chance no other does.
#[derive(Clone, Copy)]
struct Seeds(u64);

impl Seeds {
    const REFERENCE: u64 = 60;
    const PILOTS: u64 = 61;
    const BY_ITSELF: u64 = 62;
    const UNBIASED: u64 = 63;

    fn of_scene(scene: u64) -> Self {
        Self(scene << 32)
    }

    /// Of a row, below 64.
    fn of(self, row: u64) -> u64 {
        self.0 + (row << 16)
    }
}

fn main() -> ExitCode {
    println!("{:<22}{:<29}{:>5}{:>13}{:>12}{:>8}", "scene", "estimator", "runs", "mean", "off by", "z");
    let [mut tested, mut told, mut dearer, mut kept] = [const { Vec::new() }; 4];
    for (path, seeds) in fixtures::all().into_iter().zip((0..).map(Seeds::of_scene)) {
        let scene = in_small(&path);
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let row = |what: &str, mean: Mean, reference: Mean| {
            let (off, z) = (mean.value / reference.value - 1.0, mean.above(reference));
            println!("{name:<22}{what:<29}{RUNS:>5}{:>13.6}{:>10.3} %{z:>8.2}", mean.value, 100.0 * off);
            z
        };
        let (reference, means, target) = measured(&scene, seeds);
        if reference.error <= f64::from(f32::EPSILON) * reference.value {
            println!("{name:<22}every sample is the same but for rounding, so that there is nothing to test");
            continue;
        }
        tested.extend(means.iter().map(|(what, mean)| row(what, *mean, reference)));
        let by_itself = stopped(&scene, target, seeds.of(Seeds::BY_ITSELF), false);
        let unbiased = stopped(&scene, target, seeds.of(Seeds::UNBIASED), true);
        told.push(row("stopping by itself", by_itself.mean, reference));
        tested.push(row("stopping, --unbiased", unbiased.mean, reference));
        dearer.push(unbiased.paths / by_itself.paths);
        kept.push(unbiased.promised);
    }
    let largest = |all: &[f64]| all.iter().map(|z| z.abs()).fold(0.0, f64::max);
    let limit = Normal::standard().inverse_cdf(1.0 - 0.5 * SIGNIFICANCE / tested.len() as f64);
    println!(
        "\n{} means, the largest |z| is {:.2}; were all exact, one would be beyond {limit:.2} with a chance of 1 %",
        tested.len(),
        largest(&tested)
    );
    let square = tested.iter().map(|z| z * z).sum::<f64>() / tested.len() as f64;
    println!("the mean of z^2 is {square:.2}; 1 is expected");
    println!("stopping by itself, where it is no wonder: {:.2}", largest(&told));
    println!(
        "--unbiased follows {:.2} times the paths; {:.0} % of its pictures promise as much by their own samples, too",
        median::median(dearer),
        100.0 * kept.iter().sum::<f64>() / kept.len() as f64
    );
    // A NaN is not within the limit.
    if tested.iter().all(|z| z.abs() <= limit) {
        ExitCode::SUCCESS
    } else {
        println!("not unbiased");
        ExitCode::FAILURE
    }
}

fn in_small(path: &Path) -> SceneDescription {
    let mut scene = load_scene(path).expect("a fixture");
    let (width, height) = (scene.film.width, scene.film.height);
    (scene.film.width, scene.film.height) = (WIDTH, (WIDTH * height / width).max(2));
    scene
}

/// The reference's mean and those of all estimators, and a target for runs that stop.
fn measured(scene: &SceneDescription, seeds: Seeds) -> (Mean, Vec<(String, Mean)>, Target) {
    let settings = RenderSettings::of(scene);
    let (levels, _) = levels(scene, &settings, &VARIED);
    let exact = RenderSettings { precision: Precision::F64, ..settings.clone() };
    let all = with_tracer(scene, &settings, |single| {
        let target = target(single, scene, &settings, seeds);
        with_tracer(scene, &exact, |double| {
            let (runs, spp) = REFERENCE;
            let first = seeds.of(Seeds::REFERENCE);
            let reference = Mean::of(&means(double, &of_another_kind(scene), &exact, first..first + runs, spp));
            let of_level = |(index, level): (u64, &Level)| {
                let first = seeds.of(index);
                let tracer = if level.settings.precision == Precision::F64 { double } else { single };
                let by_chance = level.integrator.light_sampling == LightSamplingDescription::None;
                let spp = if by_chance { SPP_BY_CHANCE } else { SPP };
                let what = level.choice.map_or("as asked".to_owned(), |choice| format!("{choice} {}", level.name));
                (what, Mean::of(&means(tracer, &level.integrator, &level.settings, first..first + RUNS, spp)))
            };
            (reference, (0..).zip(&levels).map(of_level).collect(), target)
        })
    });
    all.and_then(|inner| inner).expect("a fixture that can be rendered")
}

/// How a reference simulates the same light, with as little in common as there is.
fn of_another_kind(scene: &SceneDescription) -> IntegratorDescription {
    use LightSamplingDescription::{Cone, Hemisphere};
    let light_sampling = if scene.integrator.light_sampling == Cone { Hemisphere } else { Cone };
    let sampler = SamplerDescription::Sobol;
    let aim = !scene.integrator.aim;
    IntegratorDescription { light_sampling, sampler, aim, roulette_after: None, ..scene.integrator.clone() }
}

/// The mean of the picture of each seed.
fn means(
    tracer: &dyn Tracer,
    integrator: &IntegratorDescription,
    settings: &RenderSettings,
    seeds: std::ops::Range<u64>,
    spp: u32,
) -> Vec<f64> {
    let job = tracer.job(integrator, settings).expect("a kernel");
    let run = |seed| {
        let mut film = Film::new(settings.region);
        tracer.trace(&job, seed, 0..spp, &mut film, &Unmonitored);
        mean_of(&film)
    };
    seeds.into_par_iter().map(run).collect()
}

/// Over pixels and channels.
fn mean_of(film: &Film) -> f64 {
    let sum: f64 = film.pixels().iter().flat_map(|pixel| pixel.mean()).map(f64::from).sum();
    sum / (3 * film.pixels().len()) as f64
}

/// A relMSE that a middling picture is promised to have after a few looks.
fn target(tracer: &dyn Tracer, scene: &SceneDescription, settings: &RenderSettings, seeds: Seeds) -> Target {
    let job = tracer.job(&scene.integrator, settings).expect("a kernel");
    let pilot = |seed: u64| {
        let half = |samples| {
            let mut film = Film::new(settings.region);
            tracer.trace(&job, seeds.of(Seeds::PILOTS) + seed, samples, &mut film, &Unmonitored);
            film
        };
        let halves = [half(0..PILOT_SPP / 2), half(PILOT_SPP / 2..PILOT_SPP)];
        Outlook::of(&halves, Metric::RelMse).expect("enough samples").most
    };
    Target { metric: Metric::RelMse, value: median::median((0..PILOTS).map(pilot).collect()) }
}

/// What came of runs that end at a target.
struct Stopped {
    mean: Mean,
    /// Paths of all of them, also those that only decided.
    paths: f64,
    /// The share of the pictures whose own samples promise the target.
    promised: f64,
}

fn stopped(scene: &SceneDescription, target: Target, first_seed: u64, unbiased: bool) -> Stopped {
    let settings = RenderSettings { threads: 1, ..RenderSettings::of(scene) };
    let until = Until { target: Some(target), unbiased, seconds: None, spp: MOST_SAMPLES };
    let run = &|seed| {
        let mut scene = scene.clone();
        scene.integrator.seed = first_seed + seed;
        let promised = render_until(&scene, &settings, &until, &Unmonitored).expect("a fixture that can be rendered");
        let is_promised = promised.outlook.is_some_and(|outlook| outlook.most <= target.value);
        (mean_of(&promised.rendering.film), promised.rendering.work.paths as f64, is_promised)
    };
    // Every run has a pool of its own. In a pool around them, a thread that waits for one would start the next.
    let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get() as u64);
    let share = RUNS.div_ceil(threads);
    let runs: Vec<_> = std::thread::scope(|scope| {
        let start = |first| scope.spawn(move || (first..RUNS.min(first + share)).map(run).collect::<Vec<_>>());
        let workers: Vec<_> = (0..threads).map(|thread| start((thread * share).min(RUNS))).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a run")).collect()
    });
    Stopped {
        mean: Mean::of(&runs.iter().map(|run| run.0).collect::<Vec<_>>()),
        paths: runs.iter().map(|run| run.1).sum(),
        promised: runs.iter().filter(|run| run.2).count() as f64 / RUNS as f64,
    }
}
