//! The measurement: independent runs of each level, in turn, so that a machine that slows down slows all of them.

use super::crop::Crop;
use super::figures::Figures;
use super::flip::{Eye, Flips};
use super::levels::{Choice, LeftOut, Level};
use super::reference::Reference;
use super::spread::Spread;
use crate::assemble::{Accel, SetupReport};
use crate::commands::words::duration;
use crate::description::SceneDescription;
use crate::error::Error;
use crate::film::{Film, Region};
use crate::picture::Picture;
use crate::render::{Job, Monitor, Precision, RenderSettings, Tracer, with_tracer};

/// One run of a level up to one number of samples.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Seconds of tracing, wall time.
    pub seconds: f64,
    /// Seconds that processors spent on it.
    pub cpu_seconds: f64,
    /// Ray queries.
    pub rays: u64,
    /// How far the picture is from the reference.
    pub figures: Figures,
    /// What an eye sees of that in the crop.
    pub flips: Flips,
}

/// All runs of a level up to one number of samples.
#[derive(Clone, Debug)]
pub struct Rung {
    /// Samples per pixel.
    pub spp: u32,
    /// Independent runs.
    pub runs: Vec<Run>,
}

/// What came of a level.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The level.
    pub level: Level,
    /// The kernel's name.
    pub kernel: &'static str,
    /// What setting up its scene took.
    pub setup: SetupReport,
    /// From one sample per pixel on, each with twice as many as the one before.
    pub rungs: Vec<Rung>,
    /// The pictures of the last rung, all runs together.
    pub spread: Spread,
    /// Hash of the first run's picture at the last rung.
    pub image_hash: u64,
    /// A part of the first run's picture at each rung; none for a level that differs in time alone.
    pub crops: Vec<Picture>,
}

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Independent runs of each level.
    pub runs: u32,
    /// Seconds for all of them together.
    pub seconds: f64,
    /// What is kept of the first run's pictures.
    pub crop: Crop,
}

/// The seed of a run, from 0 on; all levels share it.
pub fn seed(scene: &SceneDescription, run: u32) -> u64 {
    scene.integrator.seed.wrapping_add(u64::from(run) + 1)
}

/// Measures all levels; fewer runs of each where the monitor says to stop.
///
/// # Errors
/// As for rendering the scene. A level that no kernel has is left out instead.
pub fn measure(
    scene: &SceneDescription,
    levels: &[Level],
    reference: &Reference,
    effort: Effort,
    monitor: &dyn Monitor,
) -> Result<(Vec<Measured>, Vec<LeftOut>), Error> {
    let mut seen = Vec::new();
    let mut settings = Vec::new();
    for level in levels {
        let setting = Setting::of(&level.settings);
        if !seen.contains(&setting) {
            seen.push(setting);
            settings.push(&level.settings);
        }
    }
    let mut found = (Vec::new(), Vec::new());
    with_all(scene, &settings, None, &mut |ready| {
        let (courses, mut left_out) = Course::all(levels, ready);
        let (mut courses, too_slow) = plan(courses, scene, effort, monitor);
        left_out.extend(too_slow);
        run_all(&mut courses, scene, reference, effort, monitor);
        found = (courses.into_iter().filter_map(Course::measured).collect(), left_out);
    })?;
    Ok(found)
}

/// Precision and structure: what a scene is made ready with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Setting(Precision, Accel);

impl Setting {
    fn of(settings: &RenderSettings) -> Self {
        Self(settings.precision, settings.accel)
    }
}

/// The scene, ready in one setting, and in those before.
struct Ready<'a> {
    setting: Setting,
    tracer: &'a dyn Tracer,
    before: Option<&'a Ready<'a>>,
}

/// Makes the scene ready in all settings at once, one within the other.
fn with_all(
    scene: &SceneDescription,
    settings: &[&RenderSettings],
    before: Option<&Ready<'_>>,
    work: &mut (dyn FnMut(Option<&Ready<'_>>) + Send),
) -> Result<(), Error> {
    let Some((first, more)) = settings.split_first() else {
        work(before);
        return Ok(());
    };
    with_tracer(scene, first, |tracer| {
        let ready = Ready { setting: Setting::of(first), tracer, before };
        with_all(scene, more, Some(&ready), work)
    })?
}

/// A level on its way.
struct Course<'a> {
    level: &'a Level,
    tracer: &'a dyn Tracer,
    job: Job,
    /// Samples per pixel of the last rung.
    top: u32,
    rungs: Vec<Rung>,
    spread: Spread,
    image_hash: u64,
    crops: Vec<Picture>,
}

impl<'a> Course<'a> {
    /// One for each level that there is a kernel for.
    fn all(levels: &'a [Level], ready: Option<&'a Ready<'a>>) -> (Vec<Self>, Vec<LeftOut>) {
        let (mut courses, mut left_out) = (Vec::new(), Vec::new());
        for level in levels {
            let mut all = std::iter::successors(ready, |ready| ready.before);
            let Some(ready) = all.find(|ready| ready.setting == Setting::of(&level.settings)) else { continue };
            match (ready.tracer.job(&level.integrator, &level.settings), level.choice) {
                (Ok(job), _) => courses.push(Self {
                    level,
                    tracer: ready.tracer,
                    job,
                    top: 1,
                    rungs: Vec::new(),
                    spread: Spread::new(level.settings.region),
                    image_hash: 0,
                    crops: Vec::new(),
                }),
                (Err(error), Some(choice)) => {
                    left_out.push(LeftOut { choice, name: level.name.clone(), why: error.cause });
                }
                // The scene as it is asked for has one.
                (Err(_), None) => {}
            }
        }
        (courses, left_out)
    }

    /// One run, from one sample per pixel up.
    fn run(&mut self, seed: u64, reference: &Reference, crop: &Crop, eye: &mut Eye<'_>, monitor: &dyn Monitor) {
        let mut film = Film::new(self.level.settings.region);
        let (mut seconds, mut cpu_seconds, mut rays) = (0.0, 0.0, 0);
        let (mut spp, mut end) = (0, 1);
        let (mut runs, mut crops) = (Vec::new(), Vec::new());
        let is_shown = self.rungs.is_empty() && !self.level.choice.is_some_and(Choice::keeps_the_picture);
        while end <= self.top {
            let before = cpu_clock();
            let traced = self.tracer.trace(&self.job, seed, spp..end, &mut film, monitor);
            if traced.interrupted {
                return;
            }
            seconds += traced.seconds;
            cpu_seconds += cpu_clock().zip(before).map_or(traced.seconds, |(after, before)| after - before);
            rays += traced.work.rays;
            let picture = film.picture();
            let cut = crop.cut(&picture);
            let (figures, flips) = (Figures::of(&picture, reference), eye.look(&cut));
            runs.push((end, Run { seconds, cpu_seconds, rays, figures, flips }));
            if is_shown {
                crops.push(cut);
            }
            (spp, end) = (end, 2 * end);
        }
        for (at, (spp, run)) in runs.into_iter().enumerate() {
            if self.rungs.len() == at {
                self.rungs.push(Rung { spp, runs: Vec::new() });
            }
            self.rungs[at].runs.push(run);
        }
        if self.image_hash == 0 {
            self.image_hash = film.image_hash();
        }
        if is_shown {
            self.crops = crops;
        }
        self.spread.add(&film.picture());
    }

    fn measured(self) -> Option<Measured> {
        let Self { level, tracer, job, rungs, spread, image_hash, crops, .. } = self;
        let is_measured = !rungs.is_empty();
        let (setup, kernel) = (tracer.setup(), job.row.name);
        is_measured.then(|| Measured { level: level.clone(), kernel, setup, rungs, spread, image_hash, crops })
    }
}

/// The fewest samples that the last rung of a level has, where only its time matters and where its error does, too.
const LEAST_SAMPLES: [u32; 2] = [4, 16];

/// A level that needs so many times its share is left out. What takes twice as long as the scene as asked for, as f64 does
/// or twice the bounces, is worth the wait.
const TOO_LONG: f64 = 3.0;

/// The share of the effort that a level gets.
fn weight(level: &Level) -> f64 {
    match level.choice {
        // All others are compared with it.
        None => 2.0,
        Some(choice) if choice.keeps_the_picture() => 0.5,
        Some(_) => 1.0,
    }
}

/// Chooses the last rung of each level by what a sample takes. A level whose fewest samples take much more than its share
/// is left out; the scene as asked for never is.
fn plan<'a>(
    courses: Vec<Course<'a>>,
    scene: &SceneDescription,
    effort: Effort,
    monitor: &dyn Monitor,
) -> (Vec<Course<'a>>, Vec<LeftOut>) {
    let all: f64 = courses.iter().map(|course| weight(course.level)).sum();
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for mut course in courses {
        let mut film = Film::new(course.level.settings.region);
        let seed = scene.integrator.seed;
        let mut once = |at| course.tracer.trace(&course.job, seed, at..at + 1, &mut film, monitor).seconds;
        // Two samples, not counted, show what a sample takes; the first one warms up.
        let [_, mut sample] = [0, 1].map(&mut once);
        let share = effort.seconds * weight(course.level) / all / f64::from(effort.runs);
        let keeps = course.level.choice.is_some_and(Choice::keeps_the_picture);
        let least = LEAST_SAMPLES[usize::from(!keeps)];
        if let Some(choice) = course.level.choice {
            let most = TOO_LONG * share / f64::from(least);
            if sample > most {
                // That the machine was busy for a moment is no reason.
                sample = [2, 3].map(&mut once).into_iter().fold(sample, f64::min);
            }
            if sample > most {
                let takes = duration(f64::from(least) * sample);
                let why = format!("a run of {least} samples takes {takes}, its share is {}", duration(share));
                left_out.push(LeftOut { choice, name: course.level.name.clone(), why });
                continue;
            }
        }
        let most = (share / sample.max(1e-6)).clamp(1.0, 1e6) as u32;
        course.top = (1 << most.ilog2()).max(least);
        kept.push(course);
    }
    (kept, left_out)
}

/// Runs all courses, each as often, with seeds that all share.
fn run_all(
    courses: &mut [Course<'_>],
    scene: &SceneDescription,
    reference: &Reference,
    effort: Effort,
    monitor: &dyn Monitor,
) {
    let truth = effort.crop.cut(&reference.picture);
    for run in 0..effort.runs {
        let mut eye = Eye::new(&truth);
        for course in &mut *courses {
            if monitor.stopped() {
                return;
            }
            course.run(seed(scene, run), reference, &effort.crop, &mut eye, monitor);
        }
    }
}

/// Seconds that processors have spent on this program, where the system counts them.
fn cpu_clock() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
    }
    #[cfg(not(unix))]
    None
}

/// The part in the middle of a region that takes a share of its time, at least 32 pixels wide and high where the region
/// is.
pub fn middle(region: Region, share: f64) -> Region {
    let side = |low: u32, high: u32| {
        let length = high - low;
        let kept = ((f64::from(length) * share.min(1.0).sqrt()) as u32).clamp(length.min(32), length);
        let low = low + (length - kept) / 2;
        [low, low + kept]
    };
    let ([x0, x1], [y0, y1]) = (side(region.x0, region.x1), side(region.y0, region.y1));
    Region { x0, y0, x1, y1 }
}
