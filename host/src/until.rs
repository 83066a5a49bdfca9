//! Rendering until an error is promised or the time is up, instead of a number of samples.

use std::time::Instant;

use crate::commands::words::duration;
use crate::description::SceneDescription;
use crate::error::Error;
use crate::film::Film;
use crate::promise::{FIRST_LOOK, Outlook, Target, next_look};
use crate::render::{Job, Monitor, RenderSettings, Rendering, Tracer, with_tracer};
use ocellus_kernel::Work;

/// When to stop: at whatever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// The error is promised to be at most this.
    pub target: Option<Target>,
    /// So many seconds of tracing have gone.
    pub seconds: Option<f64>,
    /// Each pixel has so many samples.
    pub spp: u32,
}

/// A picture, and what is promised of it.
#[derive(Clone, Debug)]
pub struct Promised {
    /// The picture. Its samples are 0 to `spp`, so that `--spp` renders it again, bit for bit.
    pub rendering: Rendering,
    /// Samples of each pixel.
    pub spp: u32,
    /// What its error is; `None` with too few samples or without a target.
    pub outlook: Option<Outlook>,
}

impl Promised {
    /// Whether the error is promised to be below the target.
    pub fn keeps(&self, target: Target) -> bool {
        self.outlook.is_some_and(|outlook| outlook.most <= target.value)
    }
}

/// Renders `description` until it is enough. What is decided from is sums at numbers of samples that are fixed before,
/// and the clock.
///
/// # Errors
/// As [`crate::render::render`].
pub fn render_until(
    description: &SceneDescription,
    settings: &RenderSettings,
    until: &Until,
    monitor: &dyn Monitor,
) -> Result<Promised, Error> {
    with_tracer(description, settings, |tracer| {
        let job = tracer.job(&description.integrator, settings)?;
        let film = || {
            Film::try_new(settings.region)
                .map_err(|error| Error::usage(error.to_string(), "ask for a smaller --size, or for parts with --crop"))
        };
        let mut course = Course {
            tracer,
            job,
            seed: description.integrator.seed,
            halves: [film()?, film()?],
            spp: 0,
            work: Work::default(),
            start: Instant::now(),
            interrupted: false,
        };
        let outlook = course.run(until, monitor);
        Ok(course.finish(outlook))
    })?
}

/// A picture on its way.
struct Course<'a> {
    tracer: &'a dyn Tracer,
    job: Job,
    seed: u64,
    /// Of as many samples each, so that their difference shows the error.
    halves: [Film; 2],
    spp: u32,
    work: Work,
    start: Instant,
    interrupted: bool,
}

impl Course<'_> {
    fn run(&mut self, until: &Until, monitor: &dyn Monitor) -> Option<Outlook> {
        let mut outlook = None;
        while let Some(step) = self.step(until) {
            for (half, start) in [(0, self.spp), (1, self.spp + step / 2)] {
                let film = &mut self.halves[half];
                let traced = self.tracer.trace(&self.job, self.seed, start..start + step / 2, film, monitor);
                self.work = self.work + traced.work;
                self.interrupted |= traced.interrupted;
                if self.interrupted {
                    return None;
                }
            }
            self.spp += step;
            if let Some(target) = until.target {
                outlook = Outlook::of(&self.halves, target.metric);
                if outlook.is_some_and(|outlook| outlook.most <= target.value) {
                    break;
                }
            }
            monitor.tell(&self.words(until, outlook));
        }
        outlook
    }

    /// How many samples to add, an even number; `None` where it is enough.
    fn step(&self, until: &Until) -> Option<u32> {
        let next = if self.spp < FIRST_LOOK { (2 * self.spp).max(2) } else { next_look(self.spp) };
        let step = next.min(until.spp) - self.spp;
        let step = match until.seconds {
            // Something is to be seen in any case.
            Some(seconds) if self.spp > 0 => {
                let gone = self.start.elapsed().as_secs_f64();
                step.min(((seconds - gone) / gone * f64::from(self.spp)) as u32)
            }
            _ => step,
        };
        (step >= 2).then_some(step & !1)
    }

    /// How far it is, and how long it may still take.
    fn words(&self, until: &Until, outlook: Option<Outlook>) -> String {
        let gone = self.start.elapsed().as_secs_f64();
        let left = |seconds: f64| format!(", about {} left", duration(seconds.max(0.0)));
        let by_target = until.target.zip(outlook).map(|(target, outlook)| {
            let left = left(gone * (outlook.shortfall(target) - 1.0));
            format!(", {} {:.3e} at most{left}", target.metric, outlook.most)
        });
        let by_time = until.seconds.map(|seconds| left(seconds - gone));
        format!("{} spp{}", self.spp, by_target.or(by_time).unwrap_or_default())
    }

    fn finish(self, outlook: Option<Outlook>) -> Promised {
        let seconds = self.start.elapsed().as_secs_f64();
        let [mut film, other] = self.halves;
        film.add(&other);
        let rendering = Rendering {
            film,
            work: self.work,
            required: self.job.required,
            row: self.job.row,
            isa: self.job.isa,
            threads: self.tracer.threads(),
            setup: self.tracer.setup(),
            trace_seconds: seconds,
            interrupted: self.interrupted,
        };
        Promised { rendering, spp: self.spp, outlook }
    }
}
