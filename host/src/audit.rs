//! Whether a promised error is kept: fresh pictures, each measured against all others.

use crate::description::SceneDescription;
use crate::diff::Metric;
use crate::error::Error;
use crate::film::Film;
use crate::ledger::figures::Figures;
use crate::ledger::reference::{Reference, Source};
use crate::picture::Picture;
use crate::promise::Target;
use crate::render::{Monitor, RenderSettings, with_tracer};

/// Fresh pictures beside the one that is audited.
pub const FRESH: u32 = 8;

/// What an audit found.
#[derive(Clone, Debug, PartialEq)]
pub struct Audit {
    /// The error of the picture, and of the fresh ones.
    pub errors: Vec<f64>,
}

impl Audit {
    /// How many pictures are within the target.
    pub fn kept(&self, target: Target) -> usize {
        self.errors.iter().filter(|error| **error <= target.value).count()
    }
}

/// Renders as many samples as `film` has with fresh seeds, [`FRESH`] times. `None` if the monitor stops it.
///
/// # Errors
/// As [`crate::render::render`].
pub fn audit(
    scene: &SceneDescription,
    settings: &RenderSettings,
    film: &Film,
    target: Target,
    monitor: &dyn Monitor,
) -> Result<Option<Audit>, Error> {
    let (mut all, mut pictures) = (film.clone(), vec![film.picture()]);
    let stopped = with_tracer(scene, settings, |tracer| {
        let job = tracer.job(&scene.integrator, settings)?;
        for fresh in 1..=u64::from(FRESH) {
            let mut film = Film::new(settings.region);
            // Far from the seeds that people choose.
            let seed = scene.integrator.seed.wrapping_add(fresh.wrapping_mul(0xD1B5_4A32_D192_ED03));
            if tracer.trace(&job, seed, settings.samples.clone(), &mut film, monitor).interrupted {
                return Ok::<_, Error>(true);
            }
            pictures.push(film.picture());
            all.add(&film);
        }
        Ok(false)
    })??;
    let errors = pictures.iter().map(|picture| error(picture, &all, target));
    Ok((!stopped).then(|| Audit { errors: errors.collect() }))
}

/// The error of one of the pictures against the mean of all others.
fn error(picture: &Picture, all: &Film, target: Target) -> f64 {
    let (own, total) = (1.0 / f64::from(FRESH), 1.0 + 1.0 / f64::from(FRESH));
    let others = |mean: [f32; 3], one: &[f32; 3]| {
        std::array::from_fn(|channel| (total * f64::from(mean[channel]) - own * f64::from(one[channel])) as f32)
    };
    let pixels = all.pixels().iter().zip(&picture.pixels).map(|(pixel, one)| others(pixel.mean(), one)).collect();
    let variance = all.pixels().iter().map(|pixel| {
        // Of the samples of all but one.
        let count = f64::from(pixel.count()) / total;
        pixel.variance().map(|variance| variance / count)
    });
    let reference = Reference {
        picture: Picture { width: picture.width, height: picture.height, pixels },
        variance: variance.collect(),
        source: Source::Rendered { spp: 0, seconds: 0.0 },
    };
    let figures = Figures::of(picture, &reference);
    match target.metric {
        Metric::Rmse => figures.mse.max(0.0).sqrt(),
        _ => figures.rel_mse,
    }
}
