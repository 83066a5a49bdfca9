//! Rendering: rows in parallel, in passes over the whole picture.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use ocellus_kernel::path::PathOptions;
use ocellus_kernel::{Accuracy, Effects, Real, View, Work};
use rayon::prelude::*;

use crate::assemble::{Accel, SetupReport, path_options, with_view};
use crate::description::{IntegratorDescription, SceneDescription};
use crate::error::Error;
use crate::film::{Film, Region};
use crate::isa::{Isa, IsaChoice};
use crate::kernels::{EffectChoice, Kernel, Row, TableReal, select};

/// Precision of all geometry and light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Precision {
    /// 32 bits; what must be exact inside of an operation is formed in 64.
    #[default]
    F32,
    /// 64 bits.
    F64,
}

impl std::fmt::Display for Precision {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
}

/// How to render, beside what the scene says.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// Which samples of each pixel.
    pub samples: Range<u32>,
    /// Where the samples of the film's odd rows end, if not where those of the even ones do.
    pub odd_rows_end: Option<u32>,
    /// Which pixels.
    pub region: Region,
    /// Worker threads; 0 is one for each core.
    pub threads: usize,
    /// Precision of all geometry and light.
    pub precision: Precision,
    /// How the closest primitive is found.
    pub accel: Accel,
    /// Which kernels may be used.
    pub effects: EffectChoice,
    /// What exactness they spend time on.
    pub accuracy: Accuracy,
    /// Which instructions may be used.
    pub isa: IsaChoice,
}

impl RenderSettings {
    /// What the scene asks for, with everything else as by default.
    pub fn of(description: &SceneDescription) -> Self {
        let film = &description.film;
        Self {
            samples: 0..film.spp,
            odd_rows_end: None,
            region: Region::whole(film.width, film.height),
            threads: 0,
            precision: Precision::default(),
            accel: Accel::default(),
            effects: EffectChoice::default(),
            accuracy: Accuracy::default(),
            isa: IsaChoice::default(),
        }
    }

    /// How many paths that are.
    pub fn paths(&self) -> u64 {
        let of_row = |y| row_samples(&self.samples, self.odd_rows_end, y).len() as u64;
        u64::from(self.region.width()) * (self.region.y0..self.region.y1).map(of_row).sum::<u64>()
    }
}

/// Which samples the pixels of a row of the film get.
fn row_samples(samples: &Range<u32>, odd_rows_end: Option<u32>, y: u32) -> Range<u32> {
    match odd_rows_end {
        Some(end) if y % 2 == 1 => samples.start..end,
        _ => samples.clone(),
    }
}

/// What a render made and took.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The samples.
    pub film: Film,
    /// Paths and ray queries.
    pub work: Work,
    /// The scene's own effects.
    pub required: Effects,
    /// The kernel that was used.
    pub row: &'static Row,
    /// The instructions it was compiled for.
    pub isa: Isa,
    /// Worker threads.
    pub threads: usize,
    /// What setting up took.
    pub setup: SetupReport,
    /// Seconds of tracing, wall time.
    pub trace_seconds: f64,
    /// Whether it was stopped before all samples were done.
    pub interrupted: bool,
}

/// Someone to tell how far the work is, and to ask whether to go on.
pub trait Monitor: Sync {
    /// `paths` more were followed.
    fn advance(&self, paths: u64);
    /// Whether to stop: pixels keep the samples they have.
    fn stopped(&self) -> bool;
    /// How far a work is whose end is not known beforehand.
    fn tell(&self, _words: &str) {}
}

/// Tells nobody and never stops.
#[derive(Clone, Copy, Debug)]
pub struct Unmonitored;

impl Monitor for Unmonitored {
    fn advance(&self, _paths: u64) {}

    fn stopped(&self) -> bool {
        false
    }
}

/// Largest number of samples of a pass: small enough that a picture that is stopped early is even, large enough that the
/// last paths of a row, which leave lanes idle, are few among all.
const LARGEST_PASS: u32 = 64;

/// Renders `description`. The picture depends on the description and the samples alone.
///
/// # Errors
/// A description of no usable scene or camera; a region outside of the picture; threads that cannot be started; a film
/// larger than memory.
pub fn render(
    description: &SceneDescription,
    settings: &RenderSettings,
    monitor: &impl Monitor,
) -> Result<Rendering, Error> {
    with_tracer(description, settings, |tracer| {
        let job = tracer.job(&description.integrator, settings)?;
        let mut film = Film::try_new(settings.region)
            .map_err(|error| Error::usage(error.to_string(), "ask for a smaller --size, or for parts with --crop"))?;
        let traced = tracer.trace(&job, description.integrator.seed, settings.samples.clone(), &mut film, monitor);
        Ok(Rendering {
            film,
            work: traced.work,
            required: job.required,
            row: job.row,
            isa: job.isa,
            threads: tracer.threads(),
            setup: tracer.setup(),
            trace_seconds: traced.seconds,
            interrupted: traced.interrupted,
        })
    })?
}

/// Which light to simulate in a scene that is ready, and with which kernel.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    options: PathOptions,
    odd_rows_end: Option<u32>,
    /// The effects that are needed.
    pub required: Effects,
    /// The kernel that is used.
    pub row: &'static Row,
    /// The instructions it was compiled for.
    pub isa: Isa,
}

/// What tracing took.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Paths and ray queries.
    pub work: Work,
    /// Seconds, wall time.
    pub seconds: f64,
    /// Whether it was stopped before all samples were done.
    pub interrupted: bool,
}

/// A scene made ready, which can be traced again and again.
pub trait Tracer: Sync {
    /// Worker threads.
    fn threads(&self) -> usize;

    /// What setting up took.
    fn setup(&self) -> SetupReport;

    /// Chooses the kernel for an integrator, with the effects, accuracy and instructions of `settings`, and the end of
    /// its odd rows.
    ///
    /// # Errors
    /// There is no such kernel, or the machine lacks the instructions.
    fn job(&self, integrator: &IntegratorDescription, settings: &RenderSettings) -> Result<Job, Error>;

    /// Adds samples of each pixel of the film's region, with the numbers of a seed. Those of odd rows end elsewhere if
    /// the job says so.
    fn trace(&self, job: &Job, seed: u64, samples: Range<u32>, film: &mut Film, monitor: &dyn Monitor) -> Traced;
}

/// Makes a scene ready, in the precision and with the structure of `settings`, and hands it to `work` on one of the
/// threads.
///
/// # Errors
/// A description of no usable scene or camera; a region outside of the picture; threads that cannot be started.
pub fn with_tracer<T: Send>(
    description: &SceneDescription,
    settings: &RenderSettings,
    work: impl FnOnce(&dyn Tracer) -> T + Send,
) -> Result<T, Error> {
    match settings.precision {
        Precision::F32 => with_tracer_in::<f32, T>(description, settings, work),
        Precision::F64 => with_tracer_in::<f64, T>(description, settings, work),
    }
}

fn with_tracer_in<R: TableReal, T: Send>(
    description: &SceneDescription,
    settings: &RenderSettings,
    work: impl FnOnce(&dyn Tracer) -> T + Send,
) -> Result<T, Error> {
    let (region, film) = (settings.region, &description.film);
    if !(region.x0 < region.x1 && region.x1 <= film.width && region.y0 < region.y1 && region.y1 <= film.height) {
        return Err(Error::usage(
            format!("the region {},{},{},{} is not part of the picture", region.x0, region.y0, region.x1, region.y1),
            format!("choose 0 <= x0 < x1 <= {} and 0 <= y0 < y1 <= {}", film.width, film.height),
        ));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .map_err(|error| Error::usage(format!("cannot start threads: {error}"), "ask for fewer with --threads"))?;
    // Set-up, too, keeps to these threads.
    pool.install(|| with_view::<R, _>(description, settings.accel, |view, setup| work(&Ready { view, setup: *setup })))
}

/// A view, on the threads of the pool that it is used in.
struct Ready<'a, R: Real> {
    view: &'a View<'a, R>,
    setup: SetupReport,
}

impl<R: TableReal> Tracer for Ready<'_, R> {
    fn threads(&self) -> usize {
        rayon::current_num_threads()
    }

    fn setup(&self) -> SetupReport {
        self.setup
    }

    fn job(&self, integrator: &IntegratorDescription, settings: &RenderSettings) -> Result<Job, Error> {
        let options = path_options(integrator);
        let required = View { options: &options, ..*self.view }.required_effects();
        let row = select(required, settings.effects, settings.accuracy)?;
        Ok(Job { options, odd_rows_end: settings.odd_rows_end, required, row, isa: Isa::select(settings.isa)? })
    }

    fn trace(&self, job: &Job, seed: u64, samples: Range<u32>, film: &mut Film, monitor: &dyn Monitor) -> Traced {
        let options = PathOptions { seed, ..job.options };
        let view = View { options: &options, ..*self.view };
        let start = Instant::now();
        let (work, interrupted) = {
            let kernel = R::kernels(job.row).of_isa(job.isa);
            let of_row = |y| row_samples(&samples, job.odd_rows_end, y);
            passes(&view, kernel, of_row, film, monitor)
        };
        Traced { work, seconds: start.elapsed().as_secs_f64(), interrupted }
    }
}

/// Renders pass after pass of all rows; returns the work done and whether it was stopped.
fn passes<R: TableReal>(
    view: &View<'_, R>,
    kernel: Kernel<R>,
    samples: impl Fn(u32) -> Range<u32> + Sync,
    film: &mut Film,
    monitor: &dyn Monitor,
) -> (Work, bool) {
    let region = film.region();
    let interrupted = AtomicBool::new(false);
    let mut work = Work::default();
    // Rows differ in where they end alone, and every other row is like the first or the second one.
    let [first, second] = [region.y0, region.y0 + 1].map(&samples);
    let (mut start, last) = (first.start, first.end.max(second.end));
    // The first pass is one sample, so that a picture exists soon; each next one doubles.
    let mut pass = 1;
    while start < last && !interrupted.load(Ordering::Relaxed) {
        let end = start.saturating_add(pass).min(last);
        let of_row = |(index, pixels): (usize, &mut [ocellus_kernel::Pixel])| {
            if monitor.stopped() {
                interrupted.store(true, Ordering::Relaxed);
                return Work::default();
            }
            let y = region.y0 + index as u32;
            let work = kernel(view, region.x0, y, start..end.min(samples(y).end), pixels);
            monitor.advance(work.paths);
            work
        };
        work = work
            + film
                .pixels
                .par_chunks_mut(region.width() as usize)
                .enumerate()
                // Row by row to the end, or a thread would be left with several of the last.
                .with_max_len(1)
                .map(of_row)
                .reduce(Work::default, |a, b| a + b);
        start = end;
        pass = (pass * 2).min(LARGEST_PASS);
    }
    (work, interrupted.into_inner())
}
