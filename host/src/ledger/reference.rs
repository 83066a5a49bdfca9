//! What pictures are measured against, and how far off that is itself.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::description::{FresnelDescription, LightSamplingDescription, SamplerDescription, SceneDescription};
use crate::error::Error;
use crate::film::{Film, Region};
use crate::input::read_picture;
use crate::picture::Picture;
use crate::render::{Monitor, Precision, RenderSettings, with_tracer};
use ocellus_kernel::{Accuracy, Pixel};

/// A picture that is taken for the truth, with what is known of its own noise.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Linear means.
    pub picture: Picture,
    /// Squared standard error of each mean; zeros where nothing is known of it.
    pub variance: Vec<[f64; 3]>,
    /// Where it comes from.
    pub source: Source,
}

/// Where a reference comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A file, and that of its standard errors if there is one.
    File {
        /// The picture.
        picture: PathBuf,
        /// Its standard errors.
        errors: Option<PathBuf>,
    },
    /// Rendered for the purpose: in f64, with everything exact, and a seed that nothing else uses.
    Rendered {
        /// Samples per pixel.
        spp: u32,
        /// Seconds of tracing.
        seconds: f64,
    },
}

impl Reference {
    /// Reads a picture of `region` or of the whole film, and `NAME.se.exr` beside it as its standard errors.
    ///
    /// # Errors
    /// A file that cannot be read; a picture of another size.
    pub fn read(path: &Path, scene: &SceneDescription, region: Region) -> Result<Self, Error> {
        let errors = path.with_extension("se.exr");
        let errors = errors.exists().then_some(errors);
        let picture = part(read_picture(path)?, path, scene, region)?;
        let variance = match &errors {
            None => vec![[0.0; 3]; picture.pixels.len()],
            Some(errors) => {
                let square = |error: f32| f64::from(error) * f64::from(error);
                let errors = part(read_picture(errors)?, errors, scene, region)?;
                errors.pixels.into_iter().map(|pixel| pixel.map(square)).collect()
            }
        };
        Ok(Self { picture, variance, source: Source::File { picture: path.to_owned(), errors } })
    }

    /// Renders one for about so many seconds: what the scene asks for, with everything that is a matter of accuracy exact.
    ///
    /// # Errors
    /// As for rendering the scene.
    pub fn render(
        scene: &SceneDescription,
        settings: &RenderSettings,
        seconds: f64,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mut exact = scene.clone();
        exact.integrator.fresnel = FresnelDescription::Exact;
        exact.integrator.light_sampling = LightSamplingDescription::Cone;
        exact.integrator.roulette_after = None;
        // Aim stays as asked for: without it light behind glass is hardly found at all.
        // Its own noise is told by how its samples scatter, which says it only where they are independent.
        exact.integrator.sampler = SamplerDescription::Independent;
        let settings = RenderSettings { precision: Precision::F64, accuracy: Accuracy::ROBUST, ..settings.clone() };
        // Not the seed of any run, nor one that differs from those in its low bits alone.
        let seed = !scene.integrator.seed ^ 0x9E37_79B9_7F4A_7C15;
        with_tracer(&exact, &settings, |tracer| {
            let job = tracer.job(&exact.integrator, &settings)?;
            let mut film = Film::new(settings.region);
            let start = Instant::now();
            let mut spp = 0;
            // The next step takes as long as all before it.
            while spp < 4 || (2.0 * start.elapsed().as_secs_f64() < seconds && spp < 1 << 24) {
                let end = (2 * spp).max(4);
                tracer.trace(&job, seed, spp..end, &mut film, monitor);
                spp = end;
                if monitor.stopped() {
                    break;
                }
            }
            let seconds = start.elapsed().as_secs_f64();
            Ok(Self { source: Source::Rendered { spp, seconds }, ..Self::of(&film) })
        })?
    }

    /// Of a film, with what its samples say of their means' noise.
    pub fn of(film: &Film) -> Self {
        let variance = |pixel: &Pixel| pixel.variance().map(|one| one / f64::from(pixel.count().max(1)));
        let source = Source::Rendered { spp: film.samples_per_pixel()[1], seconds: 0.0 };
        Self { picture: film.picture(), variance: film.pixels().iter().map(variance).collect(), source }
    }

    /// Its own root mean squared error, as far as that is known.
    pub fn rmse(&self) -> f64 {
        let sum: f64 = self.variance.iter().flatten().sum();
        (sum / (3 * self.variance.len()) as f64).sqrt()
    }
}

/// The part of a picture that `region` is of the film.
fn part(picture: Picture, path: &Path, scene: &SceneDescription, region: Region) -> Result<Picture, Error> {
    let size = [picture.width, picture.height];
    if size == [region.width(), region.height()] {
        return Ok(picture);
    }
    let whole = [scene.film.width, scene.film.height];
    if size != whole {
        return Err(Error::usage(
            format!("{} is {}x{} pixels, the scene {}x{}", path.display(), size[0], size[1], whole[0], whole[1]),
            "give the scene that size with --size",
        ));
    }
    let rows = (region.y0..region.y1).map(|y| (y * size[0] + region.x0) as usize);
    let pixels =
        rows.flat_map(|start| picture.pixels[start..start + region.width() as usize].iter().copied()).collect();
    Ok(Picture { width: region.width(), height: region.height(), pixels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Unmonitored;

    #[test]
    fn samples_are_independent_whatever_the_scene_asks_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.toml");
        let text = "[film]\nwidth = 4\nheight = 4\n[camera]\nposition = [0, 0, 4]\nlook_at = [0, 0, 0]\n\
                    [materials]\ngrey = { kind = \"diffuse\", albedo = 0.5 }\n\
                    [[spheres]]\ncenter = [0, 0, 0]\nradius = 9\nmaterial = \"grey\"\ninverted = true\n\
                    [[lights]]\nkind = \"sphere\"\ncenter = [0, 4, 2]\nradius = 1\npower = 100\n";
        std::fs::write(&path, text).expect("a scene");
        let mut scene = crate::load::load_scene(&path).expect("a scene");
        let settings = RenderSettings { threads: 1, ..RenderSettings::of(&scene) };
        // No time at all gives four samples.
        let mut rendered = |sampler| {
            scene.integrator.sampler = sampler;
            Reference::render(&scene, &settings, 0.0, &Unmonitored).expect("a reference")
        };
        let [independent, sobol] = [SamplerDescription::Independent, SamplerDescription::Sobol].map(&mut rendered);
        assert_eq!((sobol.picture, &sobol.variance), (independent.picture, &independent.variance));
        assert!(sobol.variance.iter().flatten().all(|variance| *variance > 0.0));
    }
}
