//! How much sooner a picture is good: `cargo bench -p ocellus --bench sooner`, with `-- fig5c` of that scene alone.
//!
//! Each scene is rendered as the report describes (independent numbers, spherical lights by the hemisphere that faces the
//! point) and with what makes a picture less noisy (Sobol's numbers, cones, roulette after one bounce, aim), in turn and
//! with the same seeds, until the relMSE is below each target. The bunny's room needs the folder that `OCELLUS_DATA`
//! names. Errors are read at 1, 2, 4 ... samples and taken to fall by a power of the time in between. Of figure 5c it also
//! says how much of its squared error is light that mirrors and glass throw.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::DAffine3;
use ocellus::description::SceneDescription;
use ocellus::description::{IntegratorDescription, LightDescription, LightSamplingDescription, SamplerDescription};
use ocellus::diff::REL_MSE_EPSILON;
use ocellus::error::Origin;
use ocellus::film::Film;
use ocellus::ledger::estimate::{Estimate, Ratio};
use ocellus::ledger::figures::Figures;
use ocellus::ledger::reference::Reference;
use ocellus::load::{load_scene, obj::load_obj};
use ocellus::render::{RenderSettings, Tracer, Unmonitored, with_tracer};

/// relMSE to reach.
const TARGETS: [f64; 2] = [0.01, 0.001];
const RUNS: u64 = 8;
/// Samples per pixel of the reference.
const REFERENCE: u32 = 1 << 14;
/// A run that needs more than these never arrives.
const MOST: u32 = 1 << 15;

/// What one scene is to show: how much sooner, for each target.
struct Wanted {
    name: &'static str,
    scene: Option<SceneDescription>,
    /// Pixels across and down.
    side: u32,
    ratio: f64,
}

fn main() -> ExitCode {
    let report = |name: &str| Some(load_scene(&fixture("report", name)).expect("a fixture"));
    let wanted = [
        Wanted { name: "fig5a", scene: report("fig5a"), side: 64, ratio: 2.0 },
        Wanted { name: "bunny room", scene: bunny_room(), side: 64, ratio: 2.0 },
        Wanted { name: "fig5c", scene: report("fig5c"), side: 32, ratio: 1.5 },
    ];
    println!(
        "{:<12}{:>8}{:>22}{:>22}{:>26}",
        "scene", "relMSE", "s, as in the report", "s, less noisy", "times sooner"
    );
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let mut short = false;
    for Wanted { name, scene, side, ratio } in wanted {
        if !asked.is_empty() && !asked.iter().any(|asked| asked == name) {
            continue;
        }
        let Some(mut scene) = scene else {
            println!("{name:<12}skipped: OCELLUS_DATA names no folder with its mesh");
            continue;
        };
        (scene.film.width, scene.film.height) = (side, side);
        for (target, found) in TARGETS.iter().zip(times(&scene)) {
            let [old, new] = [0, 1].map(|kind| Ratio::of(found.iter().map(|pair| pair[kind])));
            let sooner = Ratio::of(found.iter().map(|pair| pair[0] / pair[1]));
            println!("{name:<12}{target:>8}{:>22}{:>22}{:>26}", words(old, 3), words(new, 3), words(sooner, 2));
            short |= sooner.is_none_or(|sooner| sooner.interval[0] < ratio);
        }
        if name == "fig5c" {
            let share = caustic_share(&scene);
            let [value, half] = [share.value, share.half].map(|share| 100.0 * share);
            println!(
                "{name:<12}{value:.0} +- {half:.0} % of its relMSE, as in the report, is light through mirrors and glass"
            );
        }
    }
    if short {
        println!(
            "less than was wanted, with 95 % certainty: 2 times for fig5a and the bunny room, 1.5 times for fig5c"
        );
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn words(ratio: Option<Ratio>, digits: usize) -> String {
    ratio.map_or("not reached".to_owned(), |Ratio { value, interval: [low, high] }| {
        format!("{value:.digits$} ({low:.digits$}..{high:.digits$})")
    })
}

fn fixture(folder: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(folder).join(name).with_extension("toml")
}

fn bunny_room() -> Option<SceneDescription> {
    let mesh = PathBuf::from(std::env::var_os("OCELLUS_DATA")?).join("references/bunny_in_room.obj");
    let mut scene = load_scene(&fixture("reference", "bunny_room")).ok()?;
    let white = scene.materials.iter().position(|material| material.name == "white");
    load_obj(&mesh, None).ok()?.append_to(&mut scene, Origin::file(&mesh), DAffine3::IDENTITY, white);
    Some(scene)
}

fn as_in_the_report(scene: &SceneDescription) -> IntegratorDescription {
    IntegratorDescription {
        light_sampling: LightSamplingDescription::Hemisphere,
        sampler: SamplerDescription::Independent,
        roulette_after: None,
        aim: false,
        ..scene.integrator.clone()
    }
}

fn less_noisy(scene: &SceneDescription) -> IntegratorDescription {
    IntegratorDescription {
        light_sampling: LightSamplingDescription::Cone,
        sampler: SamplerDescription::Sobol,
        roulette_after: Some(1),
        aim: true,
        ..scene.integrator.clone()
    }
}

/// Seconds to each target, of each run, both ways.
fn times(scene: &SceneDescription) -> [Vec<[f64; 2]>; TARGETS.len()] {
    let settings = RenderSettings::of(scene);
    with_tracer(scene, &settings, |tracer| {
        let reference = reference(tracer, scene, &settings);
        let mut found = TARGETS.map(|_| Vec::new());
        for seed in 0..RUNS {
            let both = [as_in_the_report(scene), less_noisy(scene)]
                .map(|integrator| arrivals(tracer, &integrator, &settings, seed, &reference));
            for (at, found) in found.iter_mut().enumerate() {
                found.push(both.map(|arrivals| arrivals[at]));
            }
        }
        found
    })
    .expect("a scene that can be rendered")
}

/// By independent samples, whose variance is known; bench `unbiased` shows that all ways have the same mean.
fn reference(tracer: &dyn Tracer, scene: &SceneDescription, settings: &RenderSettings) -> Reference {
    let integrator = IntegratorDescription { sampler: SamplerDescription::Independent, ..less_noisy(scene) };
    let job = tracer.job(&integrator, settings).expect("a kernel");
    let mut film = Film::new(settings.region);
    tracer.trace(&job, u64::MAX / 3, 0..REFERENCE, &mut film, &Unmonitored);
    Reference::of(&film)
}

/// When one run is below each target for the first time: between the numbers of samples, which double, errors are taken
/// to fall by a power of the time.
fn arrivals(
    tracer: &dyn Tracer,
    integrator: &IntegratorDescription,
    settings: &RenderSettings,
    seed: u64,
    reference: &Reference,
) -> [f64; TARGETS.len()] {
    let job = tracer.job(integrator, settings).expect("a kernel");
    let mut film = Film::new(settings.region);
    let mut found = TARGETS.map(|_| f64::INFINITY);
    let (mut spp, mut end, mut seconds) = (0, 1, 0.0);
    let mut before = [f64::NAN; 2];
    while end <= MOST && found.iter().any(|time| time.is_infinite()) {
        seconds += tracer.trace(&job, 1000 + seed, spp..end, &mut film, &Unmonitored).seconds;
        (spp, end) = (end, 2 * end);
        let error = Figures::of(&film.picture(), reference).rel_mse;
        for (time, target) in found.iter_mut().zip(TARGETS) {
            if time.is_infinite() && error <= target {
                let way = libm::log(target / before[1]) / libm::log(error / before[1]);
                let between = before[0] * libm::pow(seconds / before[0], way);
                *time = if between.is_finite() { between } else { seconds };
            }
        }
        before = [seconds, error];
    }
    found
}

/// The share of the squared error that is light which mirrors and glass throw onto diffuse surfaces.
///
/// A point as bright as the light throws none that a path can find. What else it lacks is the noise of choosing a point
/// of the light, which a picture of direct light alone has, too; at later bounces that is left, which is a small part.
fn caustic_share(scene: &SceneDescription) -> Estimate {
    let mut dotted = scene.clone();
    for light in &mut dotted.lights {
        if let LightDescription::Sphere { origin, center, radius, radiance } = light.clone() {
            let power = radiance * (4.0 * std::f64::consts::PI * std::f64::consts::PI * radius * radius);
            *light = LightDescription::Point { origin, position: center, power };
        }
    }
    let films = |scene: &SceneDescription, indirect: bool| -> Vec<Film> {
        let integrator = IntegratorDescription { indirect, ..as_in_the_report(scene) };
        let settings = RenderSettings::of(scene);
        let of_runs = with_tracer(scene, &settings, |tracer| {
            let job = tracer.job(&integrator, &settings).expect("a kernel");
            let film = |seed| {
                let mut film = Film::new(settings.region);
                tracer.trace(&job, seed, 0..REFERENCE / 16, &mut film, &Unmonitored);
                film
            };
            (0..RUNS).map(film).collect()
        });
        of_runs.expect("a scene that can be rendered")
    };
    let all = films(scene, true);
    let mut weights = all[0].clone();
    for film in &all[1..] {
        weights.merge(film).expect("one region");
    }
    // Of one sample of each pixel, relative to the picture as it is.
    let variance = |film: &Film| -> f64 {
        let pixels = film.pixels().iter().zip(weights.pixels());
        let relative = pixels.map(|(pixel, weight)| {
            let of_channels = pixel.variance().into_iter().zip(weight.mean());
            of_channels.map(|(variance, mean)| variance / (f64::from(mean * mean) + REL_MSE_EPSILON)).sum::<f64>()
        });
        relative.sum()
    };
    let of_runs = |films: &[Film]| films.iter().map(variance).collect::<Vec<_>>();
    let [direct, dotted_all, dotted_direct] =
        [(scene, false), (&dotted, true), (&dotted, false)].map(|(scene, indirect)| of_runs(&films(scene, indirect)));
    Estimate::of(of_runs(&all).into_iter().enumerate().map(|(run, all)| {
        let of_the_point = direct[run] - dotted_direct[run];
        (all - dotted_all[run] - of_the_point) / all
    }))
}
