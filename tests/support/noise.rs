//! How noisy pictures are, from renders that differ in nothing but the seed.

use ocellus::description::{SamplerDescription, SceneDescription};

use super::pictures::film;
use super::statistics::Moments;

/// Each pixel's channels, over seeds.
pub(crate) struct Noise(Vec<Moments>);

impl Noise {
    /// Of the first `samples` samples of each pixel, over seeds `0..seeds`.
    pub(crate) fn of(scene: &SceneDescription, sampler: SamplerDescription, samples: u32, seeds: u64) -> Self {
        let mut scene = scene.clone();
        scene.integrator.sampler = sampler;
        let mut moments = vec![Moments::default(); 3 * (scene.film.width * scene.film.height) as usize];
        for seed in 0..seeds {
            scene.integrator.seed = seed;
            let film = film(&scene, |settings| settings.samples = 0..samples);
            let channels = film.pixels().iter().flat_map(|pixel| pixel.mean());
            moments.iter_mut().zip(channels).for_each(|(moments, channel)| moments.add(channel.into()));
        }
        Self(moments)
    }

    /// Root mean square error over pixels and channels.
    pub(crate) fn rmse(&self) -> f64 {
        let sum: f64 = self.0.iter().map(|moments| moments.spread() * moments.spread()).sum();
        (sum / self.0.len() as f64).sqrt()
    }
}
