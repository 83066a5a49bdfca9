//! The command line: what can be asked for, and how it is read.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::accuracy::AccuracyArgs;
use crate::assemble::Accel;
use crate::description::{FresnelDescription, SamplerDescription};
use crate::diff::Metric;
use crate::film::Region;
use crate::isa::IsaChoice;
use crate::kernels::EffectChoice;
use crate::ledger::levels::Choice;
use crate::promise::Target;
use crate::render::Precision;

/// A path tracer that says what accuracy costs.
#[derive(Debug, Parser)]
#[command(name = "ocellus", version, about, max_term_width = 100, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 diff above --tolerance; 2 usage; 3 --target-error not met; 65 bad scene;
66 missing input; 73, 74 cannot write; 130, 143 interrupted, picture so far saved.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to picture files.
    Render(RenderArgs),
    /// Say which effects a scene calls for, which line asked for each, and what the render will use.
    Explain(ExplainArgs),
    /// Measure what accuracy costs in time, for the scene as asked for and with one option at a time at another level.
    Ledger(LedgerArgs),
    /// Compare two pictures.
    Diff(DiffArgs),
}

/// What changes a scene before it is used.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// A scene file (.toml), or a mesh (.obj) that gets a camera and a light of its own.
    pub scene: PathBuf,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Scattering events a path may have: 0 shows emitters only, 1 direct light.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=65_535))]
    pub max_bounces: Option<u32>,
    /// Seed of the sample numbers.
    #[arg(long)]
    pub seed: Option<u64>,
    /// Precision of all geometry and light.
    #[arg(long, value_enum, default_value_t)]
    pub precision: Precision,
    /// How the closest surface is found; the picture is the same.
    #[arg(long, value_enum, default_value_t)]
    pub accel: Accel,
    /// Use the smallest kernel that covers the scene, or the one that can do everything; the picture is the same.
    #[arg(long, value_enum, default_value = "auto")]
    pub effects: EffectChoice,
    /// Instructions that the kernel may use; the picture is the same.
    #[arg(long, value_enum, default_value = "auto")]
    pub isa: IsaChoice,
    /// How dielectrics share light between reflection and refraction [default: as the scene says].
    #[arg(long, value_enum)]
    pub fresnel: Option<FresnelDescription>,
    /// How the numbers of the samples of one pixel relate to each other [default: as the scene says].
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerDescription>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
    /// What exactness is spent on.
    #[command(flatten)]
    pub accuracy: AccuracyArgs,
}

/// `ocellus render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene and what is changed of it.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Where to write: .png (to look at) or .exr (linear float); repeatable [default: SCENE's name with .png].
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Samples per pixel; with --target-error or --time, the most.
    #[arg(long, value_name = "N", conflicts_with = "samples", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Samples per pixel in odd rows of the picture, counted from 0, where those are not as many: what --unbiased ends in.
    #[arg(
        long,
        value_name = "N",
        requires = "spp",
        conflicts_with_all = ["samples", "target_error", "time"],
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    pub spp_odd_rows: Option<u32>,
    /// Stop when the picture's error is at most this, with a certainty of 95 %: X or relmse=X, or rmse=X. Exit code 3 if
    /// --time or --spp ends it before.
    #[arg(long, value_name = "[METRIC=]X", conflicts_with = "samples", value_parser = parse_error)]
    pub target_error: Option<Target>,
    /// Let even rows decide when odd ones have enough for --target-error, and odd rows for even ones, so that no pixel's mean
    /// is off because its own samples decided. Takes more samples, and where light is rare the picture may end above the
    /// target all the same: exit code 3.
    #[arg(long, requires = "target_error", conflicts_with = "samples")]
    pub unbiased: bool,
    /// Stop after so many seconds of tracing.
    #[arg(long, value_name = "SECONDS", conflicts_with = "samples", value_parser = parse_seconds)]
    pub time: Option<f64>,
    /// See whether the promise of --target-error is kept, by eight more pictures with fresh seeds.
    #[arg(long, requires = "target_error", conflicts_with = "samples")]
    pub audit: bool,
    /// Only samples A, A+1, ... B-1 of each pixel.
    #[arg(long, value_name = "A..B", value_parser = parse_samples)]
    pub samples: Option<Range<u32>>,
    /// Only pixels x0 <= x < x1, y0 <= y < y1: exactly that part of the whole picture.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop)]
    pub crop: Option<Region>,
    /// Worker threads; 0 is one for each core. The picture is the same.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    pub threads: u16,
    /// Stops of exposure of the PNG.
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Encode the PNG as x^(1/G) instead of the sRGB curve; 1 is linear.
    #[arg(long, value_name = "G")]
    pub gamma: Option<f64>,
}

/// `ocellus explain`.
#[derive(Debug, Args)]
pub struct ExplainArgs {
    /// The scene and what is changed of it.
    #[command(flatten)]
    pub scene: SceneArgs,
}

/// `ocellus ledger`.
#[derive(Debug, Args)]
pub struct LedgerArgs {
    /// The scene and what is changed of it.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder for ledger.html (plots, maps, pictures), ledger.csv and ledger.json [default: SCENE's name with .ledger].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// What to vary, one at a time, where it can matter to the scene [default: all but triangle-test, slab-test,
    /// sphere-test and isa].
    #[arg(long, value_name = "OPTIONS", value_enum, value_delimiter = ',')]
    pub vary: Vec<Choice>,
    /// Independent runs of each level; intervals come from how they differ.
    #[arg(long, value_name = "K", default_value_t = 6, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub runs: u32,
    /// Seconds for everything, roughly; less of the picture is measured where they are too few.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = parse_seconds)]
    pub budget: f64,
    /// The error whose price is asked for: relmse=X or rmse=X.
    #[arg(long, value_name = "METRIC=X", default_value = "relmse=0.01", value_parser = parse_target)]
    pub target: Target,
    /// A converged picture to compare with, .exr; NAME.se.exr beside it holds its standard errors. Without one, a part of
    /// the time goes into making it.
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Only pixels x0 <= x < x1, y0 <= y < y1.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop)]
    pub crop: Option<Region>,
    /// Worker threads; 0 is one for each core.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    pub threads: u16,
}

/// `ocellus diff`.
#[derive(Debug, Args)]
pub struct DiffArgs {
    /// A picture, .png or .exr.
    pub a: PathBuf,
    /// The picture it is compared with: the reference.
    pub b: PathBuf,
    /// Write a map of the relative error as a PNG.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The metric that --tolerance bounds: rmse, relmse, flip or hdr-flip. HDR-FLIP is for .exr pictures; of two
    /// PNGs, which are clipped at white, FLIP says more.
    #[arg(long, default_value = "relmse", value_parser = |text: &str| text.parse::<Metric>().map_err(|e| e.to_string()))]
    pub metric: Metric,
    /// Exit with 1 if the metric is above this.
    #[arg(long, value_name = "X")]
    pub tolerance: Option<f64>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |side: &str| side.parse::<u32>().ok().filter(|n| (1..=65_535).contains(n));
    let parsed = text.split_once('x').and_then(|(w, h)| Some([side(w)?, side(h)?]));
    parsed.ok_or_else(|| "write width x height, each 1 to 65535, as in 640x480".to_owned())
}

fn parse_samples(text: &str) -> Result<Range<u32>, String> {
    let parsed = text.split_once("..").and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
    parsed
        .filter(|range| range.start < range.end)
        .ok_or_else(|| "write first..end, as in 0..64; end is not included".to_owned())
}

fn parse_crop(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Region { x0, y0, x1, y1 }),
        _ => Err("write x0,y0,x1,y1 with x0 < x1 and y0 < y1; x1 and y1 are not included".to_owned()),
    }
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    parsed.ok_or_else(|| "write seconds, more than 0".to_owned())
}

fn parse_target(text: &str) -> Result<Target, String> {
    let example = "write relmse=X or rmse=X with X above 0, as in relmse=0.01";
    let (metric, value) = text.split_once('=').ok_or(example)?;
    let metric = metric.parse().ok().filter(|metric| matches!(metric, Metric::Rmse | Metric::RelMse));
    let value = value.parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0);
    metric.zip(value).map(|(metric, value)| Target { metric, value }).ok_or_else(|| example.to_owned())
}

fn parse_error(text: &str) -> Result<Target, String> {
    parse_target(&if text.contains('=') { text.to_owned() } else { format!("relmse={text}") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn values_are_read_or_refused_with_an_example() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        assert_eq!(parse_samples("3..9"), Ok(3..9));
        assert_eq!(parse_crop("0, 1,2,3"), Ok(Region { x0: 0, y0: 1, x1: 2, y1: 3 }));
        for text in ["640", "0x480", "640x70000", "axb"] {
            assert!(parse_size(text).unwrap_err().contains("640x480"));
        }
        assert!(parse_samples("9..9").is_err() && parse_samples("4").is_err());
        assert!(parse_crop("1,1,1,2").is_err() && parse_crop("1,2,3").is_err());
    }
}
