//! Whether a promised error is kept: fresh pictures, each measured against all others.

use crate::description::SceneDescription;
use crate::diff::Metric;
use crate::error::Error;
use crate::film::{Film, Region};
use crate::ledger::figures::Figures;
use crate::ledger::reference::{Reference, Source};
use crate::ledger::spread::Spread;
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
    let mut pictures = vec![film.picture()];
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
        }
        Ok(false)
    })??;
    let errors = (0..pictures.len()).map(|own| error(&pictures, own, target));
    Ok((!stopped).then(|| Audit { errors: errors.collect() }))
}

/// The error of one of the pictures against the mean of all others. What that is off by itself shows in how the others
/// scatter: samples of one picture say it only where they are independent.
fn error(pictures: &[Picture], own: usize, target: Target) -> f64 {
    let picture = &pictures[own];
    let mut others = Spread::new(Region::whole(picture.width, picture.height));
    for (_, other) in pictures.iter().enumerate().filter(|(at, _)| *at != own) {
        others.add(other);
    }
    let count = (pictures.len() - 1) as f64;
    let reference = Reference {
        picture: others.picture(),
        variance: others.variances().map(|variance| variance.map(|one| one / count)).collect(),
        source: Source::Rendered { spp: 0, seconds: 0.0 },
    };
    let figures = Figures::of(picture, &reference);
    match target.metric {
        Metric::Rmse => figures.mse.max(0.0).sqrt(),
        _ => figures.rel_mse,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures of samples that avoid each other: each mean is nearer to the truth than its samples' scatter says.
    #[test]
    fn errors_are_those_of_pictures_however_their_samples_relate() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5
        };
        let pictures: Vec<_> = (0..=FRESH)
            .map(|_| {
                let mut film = Film::new(Region::whole(64, 64));
                for pixel in &mut film.pixels {
                    let error = 0.1 * next();
                    for side in [-1.0, 1.0] {
                        pixel.add([1.0 + side + error; 3]);
                    }
                }
                film.picture()
            })
            .collect();
        let expected = 0.1 / 12f64.sqrt();
        for own in 0..pictures.len() {
            let found = error(&pictures, own, Target { metric: Metric::Rmse, value: 1.0 });
            // 4096 pixels know it to about a hundredth.
            assert!((found / expected - 1.0).abs() < 0.05, "{found} instead of {expected}");
        }
    }
}
