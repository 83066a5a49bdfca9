//! `ocellus render`.

use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Value, json};

use super::{instruction_set, load};
use crate::cli::RenderArgs;
use crate::description::SceneDescription;
use crate::error::{Error, ExitCode};
use crate::film::Region;
use crate::interrupt::Interrupt;
use crate::output::{ToneMap, check_output, write_picture};
use crate::progress::Progress;
use crate::render::{RenderSettings, Rendering, render};

pub(super) fn run(args: &RenderArgs) -> Result<ExitCode, Error> {
    let start = Instant::now();
    let scene = load(&args.scene)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let tone = ToneMap::new(args.exposure.unwrap_or(scene.film.exposure), args.gamma.or(scene.film.gamma))?;
    let outputs = outputs(args)?;
    for output in &outputs {
        check_output(output)?;
    }
    let settings = settings(args, &scene);
    let paths =
        u64::from(settings.region.width()) * u64::from(settings.region.height()) * settings.samples.len() as u64;

    let interrupt = Interrupt::listen();
    let progress = Progress::new(paths, interrupt.clone());
    let rendering = render(&scene, &settings, &progress);
    progress.finish();
    let rendering = rendering?;

    let report = report(args, &scene, &settings, &rendering, load_seconds);
    let picture = rendering.film.picture();
    for output in &outputs {
        write_picture(output, &picture, &tone, &provenance(&report))?;
        eprintln!("wrote {}", output.display());
    }
    if args.scene.json {
        println!("{report}");
    }
    summarize(&rendering);
    Ok(match interrupt.received() {
        Some(code) if rendering.interrupted => code,
        _ => ExitCode::Done,
    })
}

/// The files to write: those named, or the scene's name as a PNG in the current folder.
fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>, Error> {
    if !args.output.is_empty() {
        return Ok(args.output.clone());
    }
    let name =
        args.scene.scene.file_stem().ok_or_else(|| Error::usage("the scene has no name", "name an output with -o"))?;
    Ok(vec![PathBuf::from(name).with_extension("png")])
}

fn settings(args: &RenderArgs, scene: &SceneDescription) -> RenderSettings {
    let samples = args.samples.clone().unwrap_or(0..args.spp.unwrap_or(scene.film.spp));
    RenderSettings {
        samples,
        region: args.crop.unwrap_or(Region::whole(scene.film.width, scene.film.height)),
        threads: args.threads,
        precision: args.scene.precision,
        accel: args.scene.accel,
        effects: args.scene.effects,
    }
}

/// Everything that is known of a render, as one JSON object.
fn report(
    args: &RenderArgs,
    scene: &SceneDescription,
    settings: &RenderSettings,
    rendering: &Rendering,
    load_seconds: f64,
) -> Value {
    let (film, region) = (&rendering.film, settings.region);
    let non_finite = film.non_finite();
    json!({
        "program": concat!("ocellus ", env!("CARGO_PKG_VERSION")),
        "scene": args.scene.scene.display().to_string(),
        "seed": scene.integrator.seed,
        "size": [scene.film.width, scene.film.height],
        "crop": [region.x0, region.y0, region.x1, region.y1],
        "spp": settings.samples.len(),
        "samples": [settings.samples.start, settings.samples.end],
        "max_bounces": scene.integrator.max_bounces,
        "effects": rendering.required.names().collect::<Vec<_>>(),
        "kernel": rendering.row.name,
        "precision": settings.precision.to_string(),
        "accel": settings.accel.to_string(),
        "threads": rendering.threads,
        "isa": instruction_set(),
        "load_seconds": load_seconds,
        "setup_seconds": rendering.setup.seconds,
        "trace_seconds": rendering.trace_seconds,
        "paths": rendering.work.paths,
        "rays": rendering.work.rays,
        "non_finite": non_finite.samples,
        "first_non_finite_pixel": non_finite.first,
        "estimated_rmse": film.estimated_rmse(),
        "interrupted": rendering.interrupted,
        "image_hash": format!("{:016x}", film.image_hash()),
    })
}

/// The report as the text that goes into picture files.
fn provenance(report: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    report.as_object().into_iter().flatten().map(|(key, value)| (key.clone(), text(value))).collect()
}

/// The last line, for people.
fn summarize(rendering: &Rendering) {
    let (work, seconds) = (rendering.work, rendering.trace_seconds);
    let stopped = if rendering.interrupted { "stopped early: " } else { "" };
    eprintln!(
        "{stopped}{:.2} million paths in {seconds:.2} s ({:.2} M paths/s, {:.1} M rays/s) by kernel {}; image hash {:016x}",
        work.paths as f64 * 1e-6,
        work.paths as f64 * 1e-6 / seconds,
        work.rays as f64 * 1e-6 / seconds,
        rendering.row.name,
        rendering.film.image_hash(),
    );
    let non_finite = rendering.film.non_finite();
    if let Some([x, y]) = non_finite.first {
        eprintln!(
            "warning: {} samples were not finite, the first in pixel {x},{y}; they count nowhere",
            non_finite.samples
        );
    }
}
