//! `ocellus render`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use ocellus_kernel::Accuracy;
use serde_json::{Value, json};

use super::streams::{print, tell};
use super::words::{abridged, counted, duration};
use super::{load, promise};
use crate::accuracy::describe;
use crate::cli::RenderArgs;
use crate::description::SceneDescription;
use crate::error::{Error, ExitCode};
use crate::film::Region;
use crate::interrupt::Interrupt;
use crate::output::{ToneMap, check_output, check_replaces_nothing, write_picture};
use crate::progress::Progress;
use crate::render::{RenderSettings, Rendering, render};
use crate::until::{Promised, Until, render_until};

pub(super) fn run(args: &RenderArgs) -> Result<ExitCode, Error> {
    let start = Instant::now();
    let scene = load(&args.scene)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let tone = ToneMap::new(args.exposure.unwrap_or(scene.film.exposure), args.gamma.or(scene.film.gamma))?;
    let outputs = outputs(args)?;
    let inputs: Vec<_> = scene.textures.iter().map(|texture| texture.file.as_path()).collect();
    check_replaces_nothing(&outputs, &inputs)?;
    for output in &outputs {
        check_output(output)?;
    }
    let mut settings = settings(args, &scene);
    let interrupt = Interrupt::listen();
    let Promised { rendering, outlook, foreseen, .. } = trace(args, &scene, &mut settings, &interrupt)?;

    let mut report = report(args, &scene, &settings, &rendering, load_seconds);
    summarize(&rendering, &settings);
    let met = promise::tell_of(args, &settings, &rendering, outlook, foreseen, &mut report);
    let picture = rendering.film.picture();
    let mut written = Ok(());
    for output in &outputs {
        // One that fails is no reason to lose the others.
        match write_picture(output, &picture, &tone, &provenance(&report)) {
            Ok(()) => tell(format_args!("wrote {}", output.display())),
            Err(error) => written = written.and(Err(error)),
        }
    }
    written?;
    if let (true, Some(target), None) = (args.audit, args.target_error, interrupt.received()) {
        promise::tell_audit(&scene, &settings, &rendering.film, target, &interrupt, &mut report)?;
    }
    if args.scene.json {
        print(report)?;
    }
    Ok(match interrupt.received() {
        Some(code) if rendering.interrupted => code,
        _ if met => ExitCode::Done,
        _ => ExitCode::TargetNotMet,
    })
}

/// Renders, as many samples as are asked for or until it is enough: these are then the samples of `settings`.
fn trace(
    args: &RenderArgs,
    scene: &SceneDescription,
    settings: &mut RenderSettings,
    interrupt: &Interrupt,
) -> Result<Promised, Error> {
    if args.target_error.is_none() && args.time.is_none() {
        let progress = Progress::new(settings.paths(), interrupt.clone());
        let rendering = render(scene, settings, &progress);
        progress.finish();
        let (spp, odd_rows_end) = (settings.samples.end, settings.odd_rows_end);
        return Ok(Promised { rendering: rendering?, spp, odd_rows_end, outlook: None, foreseen: None });
    }
    let until = Until {
        target: args.target_error,
        unbiased: args.unbiased,
        seconds: args.time,
        spp: args.spp.unwrap_or(u32::MAX),
    };
    let progress = Progress::open_ended(interrupt.clone());
    let promised = render_until(scene, settings, &until, &progress);
    progress.finish();
    let promised = promised?;
    (settings.samples, settings.odd_rows_end) = (0..promised.spp, promised.odd_rows_end);
    Ok(promised)
}

/// The files to write: those named, or the scene's name as a PNG in the current folder.
fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>, Error> {
    if !args.output.is_empty() {
        return Ok(args.output.clone());
    }
    let mut name = args
        .scene
        .scene
        .file_stem()
        .ok_or_else(|| Error::usage("the scene has no name", "name an output with -o"))?
        .to_os_string();
    name.push(".png");
    let output = PathBuf::from(name);
    if output.exists() && !is_ours(&output) {
        // Beside a mesh `cat.obj` often lies its texture `cat.png`.
        let cause = format!("{} exists and was not rendered by this program", output.display());
        return Err(Error::usage(cause, "name an output with -o; the same name replaces that file"));
    }
    Ok(vec![output])
}

/// Whether a file is a picture that this program rendered, as the text in it says.
fn is_ours(path: &Path) -> bool {
    let Ok(file) = std::fs::File::open(path) else { return false };
    let Ok(reader) = png::Decoder::new(std::io::BufReader::new(file)).read_info() else { return false };
    let texts = &reader.info().uncompressed_latin1_text;
    texts.iter().any(|text| text.keyword == "program" && text.text.starts_with("ocellus "))
}

fn settings(args: &RenderArgs, scene: &SceneDescription) -> RenderSettings {
    let samples = args.samples.clone().unwrap_or(0..args.spp.unwrap_or(scene.film.spp));
    RenderSettings {
        samples,
        odd_rows_end: args.spp_odd_rows,
        region: args.crop.unwrap_or(Region::whole(scene.film.width, scene.film.height)),
        threads: usize::from(args.threads),
        precision: args.scene.precision,
        accel: args.scene.accel,
        effects: args.scene.effects,
        accuracy: args.scene.accuracy.into(),
        isa: args.scene.isa,
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
    let mut report = json!({
        "program": concat!("ocellus ", env!("CARGO_PKG_VERSION")),
        "scene": args.scene.scene.display().to_string(),
        "seed": scene.integrator.seed,
        "size": [scene.film.width, scene.film.height],
        "crop": [region.x0, region.y0, region.x1, region.y1],
        "spp": settings.samples.len(),
        "samples": [settings.samples.start, settings.samples.end],
        "samples_per_pixel": film.samples_per_pixel(),
        "max_bounces": scene.integrator.max_bounces,
        "fresnel": format!("{:?}", scene.integrator.fresnel).to_lowercase(),
        "sampler": format!("{:?}", scene.integrator.sampler).to_lowercase(),
        "effects": rendering.required.names().collect::<Vec<_>>(),
        "kernel": rendering.row.name,
        "accuracy": describe(rendering.row.accuracy),
        "precision": settings.precision.to_string(),
        "accel": settings.accel.to_string(),
        "threads": rendering.threads,
        "isa": rendering.isa.to_string(),
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
    });
    if let Some(odd_rows_end) = settings.odd_rows_end {
        report["spp_odd_rows"] = json!(odd_rows_end);
    }
    report
}

/// The report as the text that goes into picture files: what does not depend on the machine, so that the same render
/// gives the same file.
fn provenance(report: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let entries = report.as_object().into_iter().flatten();
    let stays = |key: &str| !key.ends_with("_seconds") && key != "threads" && key != "isa";
    entries.filter(|(key, _)| stays(key)).map(|(key, value)| (key.clone(), text(value))).collect()
}

/// The last lines, for people.
fn summarize(rendering: &Rendering, settings: &RenderSettings) {
    let (film, seconds) = (&rendering.film, rendering.trace_seconds);
    let asked = match settings.odd_rows_end {
        Some(odd) => format!("{} (odd rows {odd})", counted(settings.samples.len() as u64, "sample")),
        None => counted(settings.samples.len() as u64, "sample"),
    };
    let [fewest, most] = film.samples_per_pixel();
    let took = duration(seconds);
    tell(match rendering.interrupted {
        false => format!("{asked} per pixel in {took}"),
        true if most == 0 => format!("stopped early: no sample was done in {took}, so the picture is black"),
        true if fewest == 0 => {
            format!("stopped early: pixels have 0 to {most} of {asked} after {took}; those with 0 are black")
        }
        true if fewest == most => format!("stopped early: each pixel has {most} of {asked} after {took}"),
        true => format!("stopped early: pixels have {fewest} to {most} of {asked} after {took}"),
    });
    let rate = |count: u64| abridged(count as f64 / seconds.max(1e-9));
    let robust = rendering.row.accuracy == Accuracy::ROBUST;
    tell(format_args!(
        "{} paths/s, {} rays/s; kernel {}{}; image hash {:016x}",
        rate(rendering.work.paths),
        rate(rendering.work.rays),
        rendering.row.name,
        if robust { String::new() } else { format!(" with {}", describe(rendering.row.accuracy)) },
        film.image_hash(),
    ));
    let non_finite = film.non_finite();
    if let Some([x, y]) = non_finite.first {
        let count = counted(non_finite.samples, "sample");
        tell(format_args!("warning: not finite and counted nowhere: {count}, the first in pixel {x},{y}"));
    }
}
