//! `ocellus diff`: how far one picture is from a reference, in figures, in a sentence and as a map.

mod error_map;
pub mod flip;
pub mod hdr_flip;
mod metrics;

use crate::error::{Error, ExitCode};
use crate::picture::Picture;
use hdr_flip::Exposures;
use serde_json::{Value, json};
use std::fmt;
use std::str::FromStr;

pub use error_map::{ErrorMap, HIGHEST, LOWEST, NON_FINITE_COLOR, error_map, scale_color};
pub use metrics::{Largest, NonFinite, REL_MSE_EPSILON, Statistics};

/// relMSE as it is printed; the number is [`REL_MSE_EPSILON`].
pub const REL_MSE_FORMULA: &str = "mean((a-b)^2 / (b^2 + 0.01))";

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A figure that a tolerance may be set for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Root mean squared difference, in the pictures' linear values.
    Rmse,
    /// Relative mean squared difference, [`REL_MSE_FORMULA`].
    RelMse,
    /// Mean of the FLIP map, 0 to 1: what shows on a screen at exposure 0.
    Flip,
    /// Mean of the HDR-FLIP map, 0 to 1: what shows at any of the exposures that the reference calls for. It is made for
    /// linear pictures. Those of 8 or 16 bits are clipped at white already, so that [`Metric::Flip`] says more of them.
    HdrFlip,
}

impl FromStr for Metric {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name.to_ascii_lowercase().as_str() {
            "rmse" => Ok(Self::Rmse),
            "relmse" => Ok(Self::RelMse),
            "flip" => Ok(Self::Flip),
            "hdr-flip" => Ok(Self::HdrFlip),
            _ => Err(Error::usage(format!("there is no metric {name:?}"), "use rmse, relmse, flip or hdr-flip")),
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Rmse => "RMSE",
            Self::RelMse => "relMSE",
            Self::Flip => "FLIP",
            Self::HdrFlip => "HDR-FLIP",
        })
    }
}

/// All figures of `a` against the reference `b`. `Display` renders them for people, within 80 columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Pixels across, of both.
    pub width: u32,
    /// Pixels down, of both.
    pub height: u32,
    /// The figures made pixel by pixel.
    pub statistics: Statistics,
    /// Mean of the FLIP map over the pixels that are finite in both, 0 (looks the same) to 1.
    pub flip: f64,
    /// Mean of the HDR-FLIP map over the same pixels, 0 (looks the same at every exposure) to 1.
    pub hdr_flip: f64,
    /// The exposures of the HDR-FLIP map, which are those of `b`.
    pub exposures: Exposures,
}

/// Compares `a` with the reference `b`, both linear.
///
/// Pixels that are not finite in one of the pictures are left out of all figures, counted and located; for FLIP and
/// HDR-FLIP, whose filters look at neighbours, they are black in both.
///
/// # Errors
/// A usage error if the sizes differ; `BadScene` if the pictures are empty, their pixels do not match their size, or no
/// pixel is finite in both.
pub fn compare(a: &Picture, b: &Picture) -> Result<Comparison, Error> {
    same_size(a, b)?;
    let statistics = Statistics::of(&a.pixels, &b.pixels, a.width);
    if statistics.compared == 0 {
        return Err(unusable("no pixel is finite in both pictures".into()));
    }
    let finite: Vec<bool> =
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| metrics::is_finite(a) && metrics::is_finite(b)).collect();
    let mean = |map: &[f32]| {
        let sum: f64 = map.iter().zip(&finite).filter(|(_, finite)| **finite).map(|(&value, _)| f64::from(value)).sum();
        sum / statistics.compared as f64
    };
    let shown = |picture: &Picture| -> Vec<[f32; 3]> {
        let pixels = picture.pixels.iter().zip(&finite);
        pixels.map(|(&pixel, &finite)| if finite { pixel } else { [0.0; 3] }).collect()
    };
    let (width, height) = (a.width as usize, a.height as usize);
    Ok(Comparison {
        width: a.width,
        height: a.height,
        statistics,
        flip: mean(&flip::flip_map(&shown(a), &shown(b), width, height)),
        hdr_flip: mean(&hdr_flip::hdr_flip_map(&a.pixels, &b.pixels, width, height)),
        exposures: Exposures::of(&b.pixels),
    })
}

/// What [`compare`] and [`error_map`] ask of two pictures.
fn same_size(a: &Picture, b: &Picture) -> Result<(), Error> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(Error::usage(
            format!("a is {}x{} pixels and b is {}x{}", a.width, a.height, b.width, b.height),
            "compare pictures of one size; render one of them again with --size",
        ));
    }
    for picture in [a, b] {
        let pixels = u64::from(picture.width) * u64::from(picture.height);
        if pixels == 0 || picture.pixels.len() as u64 != pixels {
            let (width, height, held) = (picture.width, picture.height, picture.pixels.len());
            return Err(unusable(format!("{held} pixels do not make a {width}x{height} picture")));
        }
    }
    Ok(())
}

fn unusable(cause: String) -> Error {
    let remedy = "render the pictures again; `ocellus diff` needs at least one finite pixel".into();
    Error { code: ExitCode::BadScene, origin: None, cause, remedy }
}

impl Comparison {
    /// The figure that `metric` names.
    pub fn value(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Rmse => self.statistics.rmse,
            Metric::RelMse => self.statistics.rel_mse,
            Metric::Flip => self.flip,
            Metric::HdrFlip => self.hdr_flip,
        }
    }

    /// Whether `metric` is at most `tolerance`. Never where a pixel is finite in one picture alone: such a pixel enters
    /// no figure, yet no tolerance allows it.
    pub fn is_within(&self, metric: Metric, tolerance: f64) -> bool {
        self.same_non_finite() && self.value(metric) <= tolerance
    }

    /// Whether the same pixels are not finite in both: then all that are left out are left out for both.
    fn same_non_finite(&self) -> bool {
        let left_out = u64::from(self.width) * u64::from(self.height) - self.statistics.compared as u64;
        [self.statistics.non_finite_a, self.statistics.non_finite_b].iter().all(|set| set.count as u64 == left_out)
    }

    /// RMSE as a fraction of the mean of b over pixels and channels, where that is positive.
    pub fn relative_rmse(&self) -> Option<f64> {
        let mean = self.statistics.mean_b.iter().sum::<f64>() / 3.0;
        (mean > 0.0).then(|| self.statistics.rmse / mean)
    }

    /// Mean of a over mean of b in each channel, where the latter is not zero.
    pub fn mean_ratio(&self) -> [Option<f64>; 3] {
        let Statistics { mean_a, mean_b, .. } = self.statistics;
        std::array::from_fn(|channel| (mean_b[channel] != 0.0).then(|| mean_a[channel] / mean_b[channel]))
    }

    /// The one sentence that answers the question.
    pub fn sentence(&self) -> String {
        let blind = if self.same_non_finite() { "" } else { ", and some pixels are finite in one alone" };
        if self.statistics.largest.is_none() {
            let all =
                if self.statistics.non_finite_b.count == 0 && blind.is_empty() { "every" } else { "every finite" };
            return format!("a equals b in {all} pixel{blind}");
        }
        match self.relative_rmse() {
            Some(relative) => format!("a is {} % RMSE from b{blind}", significant(100.0 * relative, 3)),
            None => format!("a is {} RMSE from b{blind}", significant(self.statistics.rmse, 3)),
        }
    }

    /// All figures as one JSON object.
    pub fn to_json(&self) -> Value {
        let Statistics { compared, rmse, rel_mse, largest, mean_a, mean_b, non_finite_a, non_finite_b } =
            self.statistics;
        let non_finite = |set: NonFinite| json!({ "pixels": set.count, "first": set.first.map(|(x, y)| [x, y]) });
        let Exposures { start, stop, count } = self.exposures;
        json!({
            "width": self.width,
            "height": self.height,
            "pixels_compared": compared,
            "rmse": rmse,
            "rmse_over_mean_b": self.relative_rmse(),
            "relmse": rel_mse,
            "relmse_formula": REL_MSE_FORMULA,
            "relmse_epsilon": REL_MSE_EPSILON,
            "flip": self.flip,
            "flip_pixels_per_degree": flip::PIXELS_PER_DEGREE,
            "hdr_flip": self.hdr_flip,
            "hdr_flip_exposures": { "start": start, "stop": stop, "count": count },
            "max_abs_difference": largest.map_or(0.0, |largest| largest.difference),
            "max_at": largest.map(|at| json!({ "x": at.x, "y": at.y, "channel": CHANNELS[at.channel] })),
            "mean_a": mean_a,
            "mean_b": mean_b,
            "mean_a_over_b": self.mean_ratio(),
            "non_finite_a": non_finite(non_finite_a),
            "non_finite_b": non_finite(non_finite_b),
        })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Statistics { rmse, rel_mse, largest, mean_a, mean_b, non_finite_a, non_finite_b, .. } = self.statistics;
        let mut line = |name: &str, value: f64, note: &str| {
            writeln!(f, "{}", format!("  {name:<10}{:<12}{note}", significant(value, 4)).trim_end())
        };
        let percent =
            self.relative_rmse().map(|relative| format!("{} % of the mean of b", significant(100.0 * relative, 3)));
        let place = largest.map(|at| format!("channel {} at x {}, y {}", CHANNELS[at.channel], at.x, at.y));
        let density = flip::PIXELS_PER_DEGREE;
        line("RMSE", rmse, &percent.unwrap_or_default())?;
        line("relMSE", rel_mse, REL_MSE_FORMULA)?;
        line("FLIP", self.flip, &format!("0 looks the same, 1 is worst; {density:.0} pixels per degree"))?;
        let Exposures { start, stop, count } = self.exposures;
        line("HDR-FLIP", self.hdr_flip, &format!("worst of {count} exposures, {start:.1} to {stop:.1} stops"))?;
        line("max |a-b|", largest.map_or(0.0, |at| at.difference), &place.unwrap_or_default())?;

        writeln!(f, "\n  {:<10}{:<12}{:<12}B", "mean", "R", "G")?;
        let ratio = self.mean_ratio().map(|ratio| ratio.map_or_else(|| "-".into(), |ratio| significant(ratio, 6)));
        let [mean_a, mean_b] = [mean_a, mean_b].map(|mean| mean.map(|value| significant(value, 6)));
        for (name, [r, g, b]) in [("a", mean_a), ("b", mean_b), ("a / b", ratio)] {
            writeln!(f, "  {name:<10}{r:<12}{g:<12}{b}")?;
        }

        if non_finite_a.count + non_finite_b.count > 0 {
            writeln!(f, "\n  not finite, left out of every figure above:")?;
            for (name, set) in [("a", non_finite_a), ("b", non_finite_b)] {
                let first = set.first.map(|(x, y)| format!(", first at x {x}, y {y}")).unwrap_or_default();
                writeln!(f, "  {name:<10}{} pixels{first}", set.count)?;
            }
        }
        write!(f, "\n{}", self.sentence())
    }
}

/// A number with so many significant digits, as a plain decimal where that stays short.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let scientific = format!("{value:.*e}", digits - 1);
    // Taken after rounding, so that 9.999 counts as 10.
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        Some(exponent @ -4..=6) => format!("{value:.*}", (digits as i32 - 1 - exponent).max(0) as usize),
        _ => scientific,
    }
}

#[cfg(test)]
mod tests;
