//! What accuracy costs: each choice alone, on the kernel that does everything, against the robust one.
//!
//! `cargo bench -p ocellus-tests --bench prices` prints a table for each precision: time and instructions as ratios to
//! the robust kernel's, on spheres (figure 5c), on a mesh (figure 4) and in a room of quads (`room.toml`), and what goes
//! wrong in a million trials. It needs valgrind. The losses are checked as `cargo test` checks them.

#[allow(dead_code, unused_imports, unused_macros, reason = "the suite uses more of it")]
#[path = "../support/mod.rs"]
mod support;

#[path = "../../host/benches/support/callgrind.rs"]
mod callgrind;

use std::process::ExitCode;

use ocellus::accuracy::describe;
use ocellus::description::{FresnelDescription, SceneDescription};
use ocellus::kernels::{ALTERNATIVES, EffectChoice};
use ocellus::render::{Precision, RenderSettings, Rendering, Unmonitored, render};
use ocellus_kernel::{Accuracy, Real};

use support::losses::{Row, rows};
use support::pictures::{PRECISIONS, figure, fixture, scene};

const SCENES: [&str; 3] = ["fig5c", "fig4", "room"];
/// Pairs of renders for each ratio of times.
const ROUNDS: usize = 11;

/// One value of one choice: a kernel's accuracy, or the scene's Fresnel equations.
#[derive(Clone, Copy)]
struct Choice {
    accuracy: Accuracy,
    fresnel: FresnelDescription,
}

const ROBUST: Choice = Choice { accuracy: Accuracy::ROBUST, fresnel: FresnelDescription::Exact };

impl Choice {
    /// All but the robust one, as options of the command line.
    fn alternatives() -> Vec<(String, Self)> {
        let of_kernels = ALTERNATIVES.iter().map(|row| Self { accuracy: row.accuracy, ..ROBUST });
        let kernels = of_kernels.map(|choice| (describe(choice.accuracy), choice));
        let fresnel = [("schlick", FresnelDescription::Schlick), ("none", FresnelDescription::None)];
        let fresnel = fresnel.map(|(name, fresnel)| (format!("--fresnel {name}"), Self { fresnel, ..ROBUST }));
        kernels.chain(fresnel).collect()
    }

    fn render(self, scene: &SceneDescription, precision: Precision, samples: u32) -> Rendering {
        let mut scene = scene.clone();
        scene.integrator.fresnel = self.fresnel;
        let settings = RenderSettings {
            samples: 0..samples,
            threads: 1,
            precision,
            effects: EffectChoice::All,
            accuracy: self.accuracy,
            ..RenderSettings::of(&scene)
        };
        render(&scene, &settings, &Unmonitored).unwrap_or_else(|error| panic!("{error}"))
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if let [option, scene, precision, samples] = &arguments[..] {
        let choice = Choice::alternatives()
            .into_iter()
            .find(|(name, _)| name == option)
            .map_or_else(|| if option == "robust" { ROBUST } else { panic!("no option {option}") }, |(_, it)| it);
        let samples = samples.parse().expect("a number of samples");
        let precision = PRECISIONS.into_iter().find(|known| known.to_string() == *precision).expect("a precision");
        choice.render(&scene_of(scene, 32), precision, samples);
        return ExitCode::SUCCESS;
    }
    println!("ratios to the robust kernel of the same precision, on one thread; less than 1 is cheaper");
    print_table::<f32>(Precision::F32);
    print_table::<f64>(Precision::F64);
    ExitCode::SUCCESS
}

/// A figure of the report, or the room beside this file.
fn scene_of(name: &str, size: u32) -> SceneDescription {
    match name {
        "room" => scene(fixture("../tests/benches/room.toml"), size),
        _ => figure(name, size),
    }
}

fn print_table<R: Real>(precision: Precision) {
    println!("\n| {precision} | time: spheres, mesh, room | instructions: spheres, mesh, room | of a million trials |");
    println!("|---|---|---|---|");
    let losses = rows::<R>();
    let instructions_of_robust = SCENES.map(|scene| instructions("robust", scene, precision));
    let alternatives = Choice::alternatives();
    for (option, choice) in &alternatives {
        let group = option.split(' ').next().expect("a name");
        if let Some(robust) = losses.iter().map(|row| row.option).find(|other| other.starts_with(group))
            && !alternatives.iter().take_while(|(other, _)| other != option).any(|(other, _)| other.starts_with(group))
        {
            println!("| `{robust}` | 1 | 1 | {} |", words(&losses, robust));
        }
        let times = SCENES.map(|scene| time(*choice, scene, precision));
        let times = times.map(|ratio| format!("{ratio:.2}")).join(", ");
        let counts = [0, 1, 2].map(|at| instructions(option, SCENES[at], precision) / instructions_of_robust[at]);
        let counts = counts.map(|ratio| format!("{ratio:.3}")).join(", ");
        println!("| `{option}` | {times} | {counts} | {} |", words(&losses, option));
    }
}

/// What a choice loses, measured now.
fn words(losses: &[Row], option: &str) -> String {
    let of_option = losses.iter().filter(|row| row.option == option);
    let words: Vec<String> = of_option
        .map(|row| {
            let loss = (row.measure)(1_000_000);
            assert_eq!(row.is_kept(&loss), row.keeps, "{option}, {}: {loss:?}", row.class);
            let failures = loss.failures as f64 * 1e6 / loss.trials as f64;
            let worst = row.limit.map_or(String::new(), |(_, unit)| format!(", worst error {:.2e} {unit}", loss.worst));
            format!("{}: {failures:.0} wrong{}", row.class, worst.trim_end())
        })
        .collect();
    words.join("; ")
}

/// The median of the ratios of times, each of two renders side by side.
fn time(choice: Choice, scene: &str, precision: Precision) -> f64 {
    let scene = scene_of(scene, 96);
    let mut ratios: Vec<f64> = (0..ROUNDS)
        .map(|round| {
            let both = if round % 2 == 0 { [choice, ROBUST] } else { [ROBUST, choice] };
            let [first, second] = both.map(|choice| choice.render(&scene, precision, 8).trace_seconds);
            if round % 2 == 0 { first / second } else { second / first }
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ROUNDS / 2]
}

/// Instructions of four samples of each pixel, without those of setting up.
fn instructions(option: &str, scene: &str, precision: Precision) -> f64 {
    let program = std::env::current_exe().expect("this program");
    let [few, many] = [2, 6].map(|samples: u32| {
        let arguments = [option, scene, &precision.to_string(), &samples.to_string()];
        let (count, _) = callgrind::count(&program, arguments).unwrap_or_else(|error| panic!("{error}"));
        count as f64
    });
    many - few
}
