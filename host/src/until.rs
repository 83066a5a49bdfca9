//! Rendering until an error is promised or the time is up, instead of a number of samples.

use std::time::Instant;

use crate::commands::words::duration;
use crate::description::SceneDescription;
use crate::error::Error;
use crate::fields::Fields;
use crate::film::Film;
use crate::promise::{FIRST_LOOK, Outlook, Target, foreseen, next_look};
use crate::render::{Job, Monitor, RenderSettings, Rendering, Tracer, with_tracer};
use ocellus_kernel::Work;

/// When to stop: at whatever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// The error is promised to be at most this.
    pub target: Option<Target>,
    /// Even rows of the film decide that for odd ones, and odd rows for even ones: then no mean is off because of it.
    pub unbiased: bool,
    /// So many seconds of tracing have gone.
    pub seconds: Option<f64>,
    /// Each pixel has so many samples.
    pub spp: u32,
}

/// A picture, and what is promised of it.
#[derive(Clone, Debug)]
pub struct Promised {
    /// The picture. Its samples are 0 to `spp`, so that `--spp` renders it again, bit for bit; in odd rows of the film 0
    /// to `odd_rows_end` where that is another number.
    pub rendering: Rendering,
    /// Samples of each pixel; of those in even rows, where odd ones have their own number.
    pub spp: u32,
    /// Samples of each pixel in odd rows, where they have their own number.
    pub odd_rows_end: Option<u32>,
    /// What its error is; `None` with too few samples or without a target.
    pub outlook: Option<Outlook>,
    /// At how many samples per pixel the target will be met, or was.
    pub foreseen: Option<f64>,
}

/// Renders `description` until it is enough. What is decided from is sums at numbers of samples that are fixed before,
/// and the clock.
///
/// # Errors
/// As [`crate::render::render`]; an unbiased picture of one row.
pub fn render_until(
    description: &SceneDescription,
    settings: &RenderSettings,
    until: &Until,
    monitor: &dyn Monitor,
) -> Result<Promised, Error> {
    if until.unbiased && settings.region.height() < 2 {
        return Err(Error::usage(
            "--unbiased lets even rows decide for odd ones, and there is one row",
            "render more of the picture, or leave --unbiased out",
        ));
    }
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
            fields: until.unbiased.then(Fields::default),
            spp: 0,
            work: Work::default(),
            start: Instant::now(),
            interrupted: false,
            last_look: None,
        };
        course.run(until, monitor);
        Ok(course.finish(until))
    })?
}

/// A picture on its way.
struct Course<'a> {
    tracer: &'a dyn Tracer,
    job: Job,
    seed: u64,
    /// Of as many samples each, so that their difference shows the error.
    halves: [Film; 2],
    /// What is done of it, where its fields decide for each other.
    fields: Option<Fields>,
    spp: u32,
    work: Work,
    start: Instant,
    interrupted: bool,
    /// The number of samples at the last look, and what it saw.
    last_look: Option<(u32, Outlook)>,
}

impl Course<'_> {
    fn run(&mut self, until: &Until, monitor: &dyn Monitor) {
        while let Some(step) = self.step(until) {
            for (half, start) in [(0, self.spp), (1, self.spp + step / 2)] {
                let film = &mut self.halves[half];
                let traced = self.tracer.trace(&self.job, self.seed, start..start + step / 2, film, monitor);
                self.work = self.work + traced.work;
                self.interrupted |= traced.interrupted;
                if self.interrupted {
                    return;
                }
            }
            self.spp += step;
            if until.target.is_some_and(|target| self.look(target)) {
                return;
            }
            monitor.tell(&self.words(until));
        }
    }

    /// Looks whether it is enough.
    fn look(&mut self, target: Target) -> bool {
        let outlook = match &mut self.fields {
            None => Outlook::of(&self.halves, target.metric),
            Some(fields) => fields.look(self.spp, &self.halves, target),
        };
        let Some(outlook) = outlook else { return false };
        self.last_look = Some((self.spp, outlook));
        match &self.fields {
            None => outlook.most <= target.value,
            Some(fields) => fields.are_done(),
        }
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

    /// At how many samples the target will be met.
    fn foreseen(&self, until: &Until) -> Option<f64> {
        let (spp, outlook) = self.last_look?;
        Some(foreseen(spp, outlook, until.target?))
    }

    /// How far it is, and how long it may still take.
    fn words(&self, until: &Until) -> String {
        let gone = self.start.elapsed().as_secs_f64();
        let left = |seconds: f64| format!(", about {} left", duration(seconds.max(0.0)));
        let by_target = self.foreseen(until).zip(self.last_look).map(|(foreseen, (_, outlook))| {
            let left = left(gone * (foreseen / f64::from(self.spp) - 1.0));
            format!(", error {:.3e} at most{left}", outlook.most)
        });
        let by_time = until.seconds.map(|seconds| left(seconds - gone));
        format!("{} spp{}", self.spp, by_target.or(by_time).unwrap_or_default())
    }

    fn finish(mut self, until: &Until) -> Promised {
        let (mut outlook, mut foreseen_spp) = (self.last_look.map(|(_, outlook)| outlook), self.foreseen(until));
        let (mut spp, mut odd_rows_end) = (self.spp, None);
        if let (Some(fields), Some(target)) = (&self.fields, until.target) {
            let [even, odd] = fields.spp(self.spp);
            (spp, odd_rows_end) = (even, Some(odd));
            outlook = fields.finish(&mut self.halves, target.metric);
            foreseen_spp = outlook.map(|outlook| foreseen(even, outlook, target));
        }
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
        Promised { rendering, spp, odd_rows_end, outlook, foreseen: foreseen_spp }
    }
}
