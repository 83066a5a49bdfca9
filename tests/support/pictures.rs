//! Pictures of whole scenes through the host, and comparisons by region.

use std::io::Write;
use std::path::{Path, PathBuf};

use ocellus::description::SceneDescription;
use ocellus::film::Film;
use ocellus::load::load_scene;
use ocellus::render::{Precision, RenderSettings, Unmonitored, render};
use ocellus_kernel::Pixel;

/// The report's figures, by the names of their scene files.
pub(crate) const FIGURES: [&str; 9] = ["fig2a", "fig2b", "fig2c", "fig2d", "fig4", "fig5a", "fig5b", "fig5c", "fig5d"];

/// Both precisions of the host.
pub(crate) const PRECISIONS: [Precision; 2] = [Precision::F32, Precision::F64];

/// A file below `fixtures`.
pub(crate) fn fixture(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(path)
}

/// A scene below `fixtures`, in a square picture.
pub(crate) fn scene(path: impl AsRef<Path>, size: u32) -> SceneDescription {
    let mut description = load_scene(path.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    (description.film.width, description.film.height) = (size, size);
    description
}

/// A figure of the report, in a square picture.
pub(crate) fn figure(name: &str, size: u32) -> SceneDescription {
    scene(fixture(&format!("report/{name}.toml")), size)
}

/// A folder below the one that the environment variable `OCELLUS_DATA` names, which holds what is too large for the
/// repository or not ours to put there. Without it `what` is not tested, and a line says so past the test harness, which
/// would swallow it.
pub(crate) fn data_folder(what: &str, name: &str) -> Option<PathBuf> {
    if let Some(data) = std::env::var_os("OCELLUS_DATA") {
        let folder = Path::new(&data).join(name);
        assert!(folder.is_dir(), "OCELLUS_DATA is set, but {} is no folder", folder.display());
        return Some(folder);
    }
    // Where nobody reads, nobody is to be told.
    writeln!(std::io::stderr(), "skipped: {what}: OCELLUS_DATA, the folder with {name}/ in it, is not set").ok();
    None
}

/// What the scene's own settings give, changed by `change`.
pub(crate) fn film(description: &SceneDescription, change: impl FnOnce(&mut RenderSettings)) -> Film {
    let mut settings = RenderSettings::of(description);
    change(&mut settings);
    let rendering = render(description, &settings, &Unmonitored).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(rendering.film.non_finite().samples, 0, "{:?}", rendering.film.non_finite());
    rendering.film
}

/// Mean and variance of the mean over pixels, per channel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Estimate {
    pub(crate) mean: [f64; 3],
    pub(crate) variance: [f64; 3],
}

impl Estimate {
    /// Of estimates that are independent of each other.
    pub(crate) fn of(estimates: impl Iterator<Item = Self>) -> Self {
        let (mut sum, mut count) = (Self::default(), 0.0);
        for estimate in estimates {
            for channel in 0..3 {
                sum.mean[channel] += estimate.mean[channel];
                sum.variance[channel] += estimate.variance[channel];
            }
            count += 1.0;
        }
        Self { mean: sum.mean.map(|sum| sum / count), variance: sum.variance.map(|sum| sum / (count * count)) }
    }
}

impl From<&Pixel> for Estimate {
    fn from(pixel: &Pixel) -> Self {
        let count = f64::from(pixel.count());
        Self { mean: pixel.mean().map(f64::from), variance: pixel.variance().map(|variance| variance / count) }
    }
}
