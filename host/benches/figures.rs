//! Benches of the whole program on the report's figures. Each checks that the pictures agree.
//!
//! `cargo bench -p ocellus --bench figures -- speed`         paths per second, figure 5c at its bounds
//! `cargo bench -p ocellus --bench figures -- accel`         figure 4's mesh: none, box and BVH in one run
//! `cargo bench -p ocellus --bench figures -- instructions`  specialised kernels against the one that does everything, and
//!                                                           against what they took before
//! `cargo bench -p ocellus --bench figures -- hashes`        the golden hashes of `cargo test`, with this build
//!
//! Without an argument all of them run. `instructions` needs valgrind. With `--profile unoptimised` the program is
//! built without optimisation.

#[path = "support/callgrind.rs"]
mod callgrind;
#[path = "support/counts.rs"]
mod counts;

use std::error::Error;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use counts::Counts;
use serde_json::Value;

type Outcome = Result<(), Box<dyn Error>>;
type Bench = fn() -> Outcome;

/// The figures of the report.
const FIGURES: [&str; 9] = ["fig2a", "fig2b", "fig2c", "fig2d", "fig4", "fig5a", "fig5b", "fig5c", "fig5d"];
/// Figure 5c's floor on the two cores that it was set for, paths per second.
const SPEED_FLOOR: f64 = 1.2e6;
const PROGRAM: &str = env!("CARGO_BIN_EXE_ocellus");

fn main() -> ExitCode {
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let benches: [(&str, Bench); 4] =
        [("speed", speed), ("accel", accel), ("instructions", instructions), ("hashes", hashes)];
    if let Some(unknown) = asked.iter().find(|name| !benches.iter().any(|(known, _)| known == name)) {
        eprintln!("no bench {unknown}; there are speed, accel, instructions and hashes");
        return ExitCode::from(2);
    }
    for (name, bench) in benches {
        if !asked.is_empty() && !asked.iter().any(|asked| asked == name) {
            continue;
        }
        if let Err(error) = bench() {
            eprintln!("{name}: {error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

fn figure(name: &str) -> PathBuf {
    fixtures().join("report").join(name).with_extension("toml")
}

/// Runs `ocellus render SCENE` with more arguments and reads its report.
fn render(scene: &Path, arguments: &[&str]) -> Result<Value, Box<dyn Error>> {
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench.exr");
    let output =
        Command::new(PROGRAM).args(["render", "--json", "-o"]).arg(&picture).arg(scene).args(arguments).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or(f64::NAN)
}

/// Paths per second of each figure at 256 x 256, and figure 5c against its floor, which is set for two threads.
fn speed() -> Outcome {
    println!("speed: 256 x 256 pixels, 7 bounces, f32, two threads; the median of three runs");
    println!("{:<8} {:>20} {:>6} {:>14} {:>14}", "figure", "kernel", "spp", "M paths/s", "M rays/s");
    for name in FIGURES {
        let spp = if name == "fig5c" { "64" } else { "16" };
        let mut reports = Vec::new();
        for _ in 0..3 {
            let arguments = ["--size", "256x256", "--spp", spp, "--max-bounces", "7", "--threads", "2"];
            reports.push(render(&figure(name), &arguments)?);
        }
        if reports.iter().any(|report| report["image_hash"] != reports[0]["image_hash"]) {
            return Err(format!("{name}: runs differ").into());
        }
        let rate = |report: &Value, key: &str| number(report, key) / number(report, "trace_seconds");
        reports.sort_by(|a, b| rate(a, "paths").total_cmp(&rate(b, "paths")));
        let median = &reports[1];
        let (paths, rays) = (rate(median, "paths"), rate(median, "rays"));
        let kernel = median["kernel"].as_str().unwrap_or_default();
        println!("{name:<8} {kernel:>20} {spp:>6} {:>14.3} {:>14.2}", paths * 1e-6, rays * 1e-6);
        if name == "fig5c" {
            let [slowest, fastest] = [&reports[0], &reports[2]].map(|report| rate(report, "paths") * 1e-6);
            println!("         {slowest:.3} to {fastest:.3} M paths/s");
            if paths < SPEED_FLOOR {
                return Err(format!("{name}: below the floor of {:.1} M paths/s", SPEED_FLOOR * 1e-6).into());
            }
        }
    }
    Ok(())
}

/// Figure 4 with a mesh of 70,000 triangles at 64 x 64 pixels and 1 sample: time of none, box and BVH.
fn accel() -> Outcome {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cat70k");
    std::fs::create_dir_all(folder.join("report"))?;
    let made = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--release", "--package", "ocellus", "--example", "make_cat", "--"])
        .args(["--triangles", "70000", "-o"])
        .arg(folder.join("meshes"))
        .status()?;
    if !made.success() {
        return Err("the mesh could not be made".into());
    }
    let scene = folder.join("report/fig4.toml");
    std::fs::copy(figure("fig4"), &scene)?;

    let structures = ["none", "box", "bvh"];
    let mut seconds = [f64::INFINITY; 3];
    let mut hashes = Vec::new();
    for _ in 0..3 {
        for (structure, best) in structures.iter().zip(&mut seconds) {
            let report = render(&scene, &["--size", "64x64", "--spp", "1", "--accel", structure])?;
            *best = best.min(number(&report, "trace_seconds"));
            hashes.push(report["image_hash"].clone());
        }
    }
    if hashes.iter().any(|hash| *hash != hashes[0]) {
        return Err("the structures differ in their pictures".into());
    }
    println!("accel: figure 4 with 70,000 triangles, 64 x 64 pixels, 1 sample; the best of three runs, tracing alone");
    for (structure, seconds) in structures.iter().zip(seconds) {
        println!("{structure:<6} {:>10.4} s", seconds);
    }
    println!("none : box : bvh = {:.0} : {:.0} : 1", seconds[0] / seconds[2], seconds[1] / seconds[2]);
    Ok(())
}

/// The golden hashes that `cargo test` keeps, rendered by the program of this profile.
fn hashes() -> Outcome {
    let golden = std::fs::read_to_string(fixtures().join("../tests/golden/figures.txt"))?;
    let mut equal = 0;
    for line in golden.lines().filter(|line| !line.starts_with('#')) {
        let [name, precision, hash] = line.split(' ').collect::<Vec<_>>()[..] else {
            return Err(format!("not a figure, a precision and a hash: {line}").into());
        };
        let report = render(&figure(name), &["--size", "48x48", "--samples", "0..4", "--precision", precision])?;
        if report["image_hash"] != hash {
            return Err(format!("{name} in {precision}: {} here, {hash} in cargo test", report["image_hash"]).into());
        }
        equal += 1;
    }
    println!("hashes: {equal} pictures hold the same bits as in cargo test");
    if equal == 0 { Err("no hash to compare with".into()) } else { Ok(()) }
}

/// Instructions of each figure in its own kernel and in the one that does everything, set-up included, and beside what
/// they were when they were last written down: `OCELLUS_BLESS=1` writes them.
fn instructions() -> Outcome {
    println!("instructions: 32 x 32 pixels, 4 samples, one thread, without AVX2, counted by callgrind");
    println!(
        "{:<8} {:>20} {:>16} {:>16} {:>8} {:>10}",
        "figure", "kernel", "specialised", "everything", "ratio", "to before"
    );
    let mut counts = Counts::of("instructions.txt")?;
    let mut slower = Vec::new();
    for name in FIGURES {
        let (own, kernel, hash) = count(&figure(name), "auto")?;
        let (all, _, hash_of_all) = count(&figure(name), "all")?;
        if hash != hash_of_all {
            return Err(format!("{name}: the kernels differ in their pictures").into());
        }
        let change = counts.add(name, own as f64);
        let ratio = own as f64 / all as f64;
        println!("{name:<8} {kernel:>20} {own:>16} {all:>16} {ratio:>8.3} {change:>10.3}");
        if own > all {
            slower.push(name);
        }
    }
    if !slower.is_empty() {
        return Err(format!("specialised is slower on {}", slower.join(", ")).into());
    }
    Ok(counts.finish()?)
}

/// Instructions of a render by callgrind, the kernel it used and its picture's hash.
fn count(scene: &Path, effects: &str) -> Result<(u64, String, Value), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let picture = folder.join("bench.exr");
    let mut render = vec!["render", "--json", "--threads", "1", "--isa", "baseline", "--size", "32x32", "--spp", "4"];
    render.extend(["--effects", effects, "-o"]);
    let arguments = render.into_iter().map(OsStr::new).chain([picture.as_os_str(), scene.as_os_str()]);
    let (counted, output) = callgrind::count(PROGRAM, arguments)?;
    let report: Value = serde_json::from_slice(&output)?;
    Ok((counted, report["kernel"].as_str().unwrap_or_default().to_owned(), report["image_hash"].clone()))
}
