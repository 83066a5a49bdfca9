//! How good the promises of `render --target-error` are: `cargo bench -p ocellus --bench promises`.
//!
//! Every fixture, in small, is rendered to several targets with several seeds, and each picture is measured against a
//! converged one. A promise is worth something if it is kept about as often as it says, costs little more than it must,
//! and is foreseen.

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/median.rs"]
mod median;

use std::path::Path;

use ocellus::description::SceneDescription;
use ocellus::diff::Metric;
use ocellus::film::{Film, Region};
use ocellus::ledger::figures::Figures;
use ocellus::ledger::reference::Reference;
use ocellus::load::load_scene;
use ocellus::promise::{FIRST_LOOK, Outlook, Target, foreseen, next_look};
use ocellus::render::{RenderSettings, Tracer, Unmonitored, with_tracer};

use median::median;

const TARGETS: [f64; 6] = [0.1, 0.03, 0.01, 0.003, 0.001, 0.0003];
const SEEDS: u64 = 6;
/// Pixels across, and about as many down.
const WIDTH: u32 = 64;
/// Trials that need more samples, or no more than the first look has, are left out, and counted.
const MOST_SAMPLES: u32 = 1024;
/// Samples of a reference, times those of the longest trial.
const REFERENCE: u32 = 8;

/// What came of one picture.
struct Trial {
    kept: bool,
    /// Samples it took over those at which its error was first below the target and stayed there.
    excess: f64,
    /// Samples foreseen at a tenth of them, over those it took; if a tenth was looked at.
    foreseen: Option<f64>,
}

fn main() {
    let mut all: [Vec<Trial>; TARGETS.len()] = Default::default();
    let mut left_out = [0; TARGETS.len()];
    println!("{:<28}{:>8}{:>8}{:>10}{:>10}", "scene", "trials", "kept", "excess", "foreseen");
    for path in &fixtures::all() {
        let trials = of_scene(path);
        let mut found = Vec::new();
        for (at, (target, left)) in trials.into_iter().enumerate() {
            left_out[at] += left;
            found.extend(target.iter().map(|trial| (trial.kept, trial.excess, trial.foreseen)));
            all[at].extend(target);
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        print_row(&name, &found);
    }
    println!();
    let mut together = Vec::new();
    for ((target, trials), left) in TARGETS.iter().zip(&all).zip(left_out) {
        let found: Vec<_> = trials.iter().map(|trial| (trial.kept, trial.excess, trial.foreseen)).collect();
        print_row(&format!("relMSE {target} ({left} left out)"), &found);
        together.extend(found);
    }
    print_row("all", &together);
    let kept = together.iter().filter(|trial| trial.0).count() as f64 / together.len() as f64;
    let excess = median(together.iter().map(|trial| trial.1).collect());
    let foreseen = median(together.iter().filter_map(|trial| trial.2).map(|ratio| (ratio - 1.0).abs()).collect());
    println!(
        "\n{:.1} % kept (93 wanted), {excess:.2} times the samples (1.3), foreseen within {:.0} % (15)",
        100.0 * kept,
        100.0 * foreseen
    );
    if together.len() < 400 || kept < 0.93 || excess > 1.3 || foreseen > 0.15 {
        println!("not as promised");
        std::process::exit(1);
    }
}

fn print_row(name: &str, trials: &[(bool, f64, Option<f64>)]) {
    let kept = trials.iter().filter(|trial| trial.0).count();
    let excess = median(trials.iter().map(|trial| trial.1).collect());
    let foreseen = median(trials.iter().filter_map(|trial| trial.2).collect());
    println!("{name:<28}{:>8}{kept:>8}{excess:>10.2}{foreseen:>10.2}", trials.len());
}

/// The trials of each target, and how many of them took too long.
fn of_scene(path: &Path) -> Vec<(Vec<Trial>, usize)> {
    let mut scene = load_scene(path).expect("a fixture");
    let (width, height) = (scene.film.width, scene.film.height);
    (scene.film.width, scene.film.height) = (WIDTH, (WIDTH * height / width).max(1));
    let settings = RenderSettings::of(&scene);
    with_tracer(&scene, &settings, |tracer| {
        let reference = reference(&scene, &settings, tracer);
        let mut trials: Vec<(Vec<Trial>, usize)> = TARGETS.iter().map(|_| (Vec::new(), 0)).collect();
        for seed in 0..SEEDS {
            let looks = looks(&scene, &settings, tracer, seed, &reference);
            for ((found, left_out), target) in trials.iter_mut().zip(TARGETS) {
                match trial(&looks, target) {
                    Some(trial) => found.push(trial),
                    None => *left_out += 1,
                }
            }
        }
        trials
    })
    .expect("a fixture that can be rendered")
}

fn reference(scene: &SceneDescription, settings: &RenderSettings, tracer: &dyn Tracer) -> Reference {
    let job = tracer.job(&scene.integrator, settings).expect("a kernel");
    let mut film = Film::new(Region::whole(scene.film.width, scene.film.height));
    tracer.trace(&job, u64::MAX / 3, 0..REFERENCE * MOST_SAMPLES, &mut film, &Unmonitored);
    Reference::of(&film)
}

/// Samples, outlook and true error at each look.
fn looks(
    scene: &SceneDescription,
    settings: &RenderSettings,
    tracer: &dyn Tracer,
    seed: u64,
    reference: &Reference,
) -> Vec<(u32, Outlook, f64)> {
    let job = tracer.job(&scene.integrator, settings).expect("a kernel");
    let mut halves = [(); 2].map(|()| Film::new(settings.region));
    let (mut looks, mut spp) = (Vec::new(), 0);
    loop {
        let next = next_look(spp);
        if next > MOST_SAMPLES {
            return looks;
        }
        let step = (next - spp) / 2;
        for (half, start) in halves.iter_mut().zip([spp, spp + step]) {
            tracer.trace(&job, 1000 + seed, start..start + step, half, &Unmonitored);
        }
        spp = next;
        let mut all = halves[0].clone();
        all.merge(&halves[1]).expect("one region");
        let error = Figures::of(&all.picture(), reference).rel_mse;
        looks.push((spp, Outlook::of(&halves, Metric::RelMse).expect("enough samples"), error));
        if looks.last().is_some_and(|(_, outlook, _)| outlook.most < 0.8 * TARGETS[TARGETS.len() - 1]) {
            return looks;
        }
    }
}

/// The trial that stops at `target`; `None` if it does not, or at the first look.
fn trial(looks: &[(u32, Outlook, f64)], target: f64) -> Option<Trial> {
    let stop = looks.iter().position(|(_, outlook, _)| outlook.most <= target)?;
    let (took, _, error) = looks[stop];
    // What the first look has is no credit to the promise.
    if stop == 0 {
        return None;
    }
    // The look after the last one that was above, as far as looks go.
    let needed = looks
        .iter()
        .rposition(|(.., error)| *error > target)
        .map_or(FIRST_LOOK, |last| looks.get(last + 1).map_or(MOST_SAMPLES, |look| look.0));
    let target_of = Target { metric: Metric::RelMse, value: target };
    let known = looks.iter().rev().find(|(spp, ..)| 10 * spp <= took);
    let foreseen = known.map(|(spp, outlook, _)| foreseen(*spp, *outlook, target_of) / f64::from(took));
    Some(Trial { kept: error <= target, excess: f64::from(took) / f64::from(needed), foreseen })
}
