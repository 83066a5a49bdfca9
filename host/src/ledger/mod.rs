//! `ocellus ledger`: what accuracy costs in time.
//!
//! Independent runs of the scene as it is asked for, and with one option at a time at another level, are compared with a
//! reference at 1, 2, 4 ... samples per pixel. The runs of all levels share their seeds and take turns, so that chance and
//! a busy machine touch all alike; intervals are Student's, over runs. What came of it is told as a table, as data and as a
//! page of plots and pictures.

pub mod account;
pub mod crop;
mod data;
pub mod estimate;
pub mod figures;
pub mod flip;
pub mod levels;
pub mod measure;
pub mod page;
pub mod reference;
pub mod spread;
pub mod table;

use std::path::PathBuf;
use std::time::Instant;

use crate::description::SceneDescription;
use crate::error::Error;
use crate::film::{Film, Region};
use crate::picture::Picture;
use crate::promise::Target;
use crate::render::{Monitor, RenderSettings, with_tracer};
use account::Account;
use crop::Crop;
use levels::{Choice, LeftOut, levels};
use measure::{Effort, measure, middle};
use reference::Reference;

/// What a ledger is asked for.
#[derive(Clone, Debug)]
pub struct Order {
    /// What to vary.
    pub vary: Vec<Choice>,
    /// Independent runs of each level.
    pub runs: u32,
    /// Seconds for everything, roughly.
    pub seconds: f64,
    /// The error whose price is asked for.
    pub target: Target,
    /// The reference; rendered where there is none.
    pub reference: Option<PathBuf>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Ledger {
    /// The part of the film that was measured.
    pub region: Region,
    /// Whether that is less than was asked for, to keep to the time.
    pub is_part: bool,
    /// What was asked for, whole, with two samples per pixel.
    pub preview: Picture,
    /// Column and row of its first pixel.
    pub preview_corner: [u32; 2],
    /// Worker threads.
    pub threads: usize,
    /// The error whose price was asked for.
    pub target: Target,
    /// What everything was compared with.
    pub reference: Reference,
    /// The part of it that the crops of pictures show.
    pub crop: Crop,
    /// Each level's account, the scene as asked for first.
    pub accounts: Vec<Account>,
    /// Levels that were not measured.
    pub left_out: Vec<LeftOut>,
    /// Seconds for everything.
    pub seconds: f64,
    /// Whether it was stopped before all runs were done.
    pub interrupted: bool,
}

/// The share of the time that goes into the reference.
const FOR_REFERENCE: f64 = 0.35;
/// Samples per pixel of the last rung that are worth measuring less of the picture for.
const WORTHWHILE_SAMPLES: f64 = 16.0;

/// Measures.
///
/// # Errors
/// As for rendering the scene, and for reading the reference.
pub fn open(
    scene: &SceneDescription,
    settings: &RenderSettings,
    order: &Order,
    monitor: &dyn Monitor,
) -> Result<Ledger, Error> {
    let start = Instant::now();
    let asked = settings.region;
    let mut threads = 0;
    let for_runs = order.seconds * if order.reference.is_some() { 0.95 } else { 0.95 - FOR_REFERENCE };
    let (all, mut left_out) = levels(scene, settings, &order.vary);

    // How much of the picture there is time for.
    let (once, preview) = with_tracer(scene, settings, |tracer| {
        threads = tracer.threads();
        let job = tracer.job(&scene.integrator, settings)?;
        let mut film = Film::try_new(asked)
            .map_err(|error| Error::usage(error.to_string(), "ask for a smaller --size, or for parts with --crop"))?;
        // The first sample also warms up.
        let once = |sample| tracer.trace(&job, scene.integrator.seed, sample..sample + 1, &mut film, monitor).seconds;
        let [_, once] = [0, 1].map(once);
        Ok::<_, Error>((once, film.picture()))
    })??;
    let needed = once * WORTHWHILE_SAMPLES * f64::from(order.runs) * all.len() as f64;
    let region = middle(asked, for_runs / needed);
    let settings = RenderSettings { region, ..settings.clone() };
    let (all, _) = levels(scene, &settings, &order.vary);

    let reference = match &order.reference {
        Some(path) => Reference::read(path, scene, region)?,
        None => Reference::render(scene, &settings, order.seconds * FOR_REFERENCE, monitor)?,
    };
    let crop = Crop::of(&reference);
    let effort = Effort { runs: order.runs, seconds: for_runs, crop };
    let (measured, more_left_out) = measure(scene, &all, &reference, effort, monitor)?;
    left_out.extend(more_left_out);
    let accounts = account::accounts(measured, &reference, order.target);
    let interrupted = monitor.stopped();
    Ok(Ledger {
        region,
        is_part: region != asked,
        preview,
        preview_corner: [asked.x0, asked.y0],
        threads,
        target: order.target,
        reference,
        crop,
        accounts,
        left_out,
        seconds: start.elapsed().as_secs_f64(),
        interrupted,
    })
}
