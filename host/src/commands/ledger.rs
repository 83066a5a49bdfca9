//! `ocellus ledger`.

use std::path::PathBuf;

use super::load;
use super::streams::{print, tell};
use crate::cli::LedgerArgs;
use crate::error::{Error, ExitCode};
use crate::film::Region;
use crate::interrupt::Interrupt;
use crate::ledger::levels::Choice;
use crate::ledger::measure::seed;
use crate::ledger::page::{Heading, html};
use crate::ledger::{Order, open};
use crate::output::{ToneMap, write_file};
use crate::render::{Monitor, RenderSettings};

pub(super) fn run(args: &LedgerArgs) -> Result<ExitCode, Error> {
    let scene = load(&args.scene)?;
    let folder = folder(args)?;
    let film = &scene.film;
    let whole = Region::whole(film.width, film.height);
    let settings = RenderSettings {
        samples: 0..1,
        odd_rows_end: None,
        region: args.crop.unwrap_or(whole),
        threads: usize::from(args.threads),
        precision: args.scene.precision,
        accel: args.scene.accel,
        effects: args.scene.effects,
        accuracy: args.scene.accuracy.into(),
        isa: args.scene.isa,
    };
    let order = Order {
        vary: if args.vary.is_empty() { Choice::USUAL.to_vec() } else { args.vary.clone() },
        runs: args.runs,
        seconds: args.budget,
        target: args.target,
        reference: args.reference.clone(),
    };
    let interrupt = Interrupt::listen();
    let ledger = open(&scene, &settings, &order, &UntilInterrupted(interrupt.clone()))?;

    std::fs::create_dir_all(&folder).map_err(|error| Error::cannot_create(&folder, error))?;
    let json = ledger.to_json();
    let heading = Heading {
        scene: &args.scene.scene.to_string_lossy(),
        size: args.scene.size,
        whole,
        has_max_bounces: args.scene.max_bounces.is_some(),
        has_fresnel: args.scene.fresnel.is_some(),
        has_sampler: args.scene.sampler.is_some(),
        tone: ToneMap::new(film.exposure, film.gamma)?,
        seed: seed(&scene, 0),
    };
    write_file(&folder.join("ledger.csv"), ledger.csv().as_bytes())?;
    write_file(&folder.join("ledger.json"), format!("{json:#}\n").as_bytes())?;
    write_file(&folder.join("ledger.html"), html(&ledger, &heading).as_bytes())?;
    if args.scene.json {
        print(json)?;
    } else {
        print(format_args!("{}\n{}", scene.origin.file.display(), ledger.table()))?;
    }
    tell(format_args!("wrote ledger.html (to look at), ledger.csv and ledger.json in {}", folder.display()));
    Ok(interrupt.received().unwrap_or(ExitCode::Done))
}

/// The folder to write to: that named, or the scene's name with `.ledger` in the current folder.
fn folder(args: &LedgerArgs) -> Result<PathBuf, Error> {
    if let Some(folder) = &args.output {
        return Ok(folder.clone());
    }
    let mut name = args
        .scene
        .scene
        .file_stem()
        .ok_or_else(|| Error::usage("the scene has no name", "name a folder with -o"))?
        .to_os_string();
    name.push(".ledger");
    Ok(PathBuf::from(name))
}

/// Goes on until a signal asks to stop.
struct UntilInterrupted(Interrupt);

impl Monitor for UntilInterrupted {
    fn advance(&self, _paths: u64) {}

    fn stopped(&self) -> bool {
        self.0.received().is_some()
    }
}
