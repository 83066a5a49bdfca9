//! The ledger as data: CSV with a line for each rung, and JSON with everything.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::Ledger;
use super::account::{Account, Verdict};
use super::estimate::{Estimate, Ratio};
use super::measure::{Run, Rung};
use super::reference::Source;
use crate::diff::{REL_MSE_EPSILON, REL_MSE_FORMULA};

/// A figure of a run, by its name.
type Figure = (&'static str, fn(&Run) -> f64);

/// What is told of each rung, as mean and half of its 95 % interval over runs.
const FIGURES: [Figure; 14] = [
    ("seconds", |run| run.seconds),
    ("cpu_seconds", |run| run.cpu_seconds),
    ("rays", |run| run.rays as f64),
    ("rmse", |run| run.figures.mse.max(0.0).sqrt()),
    ("mse", |run| run.figures.mse),
    ("relmse", |run| run.figures.rel_mse),
    ("max_error", |run| run.figures.largest),
    ("p50_error", |run| run.figures.percentiles[0]),
    ("p95_error", |run| run.figures.percentiles[1]),
    ("p99_error", |run| run.figures.percentiles[2]),
    ("worst_share", |run| run.figures.worst_share),
    ("mean", |run| run.figures.mean),
    ("crop_flip", |run| run.flips.flip),
    ("crop_hdr_flip", |run| run.flips.hdr_flip),
];

impl Ledger {
    /// Comma-separated values: a line for each level and number of samples.
    pub fn csv(&self) -> String {
        let mut text = "option,level,spp,runs".to_owned();
        for (name, _) in FIGURES {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{name},{name}_half");
        }
        text += "\n";
        for account in &self.accounts {
            let level = &account.measured.level;
            let choice = level.choice.map(|choice| choice.to_string()).unwrap_or_default();
            for rung in &account.measured.rungs {
                let _ = write!(text, "{choice},{},{},{}", level.name, rung.spp, rung.runs.len());
                for (_, figure) in FIGURES {
                    let Estimate { value, half } = rung.estimate(figure);
                    let _ = write!(text, ",{value:e},{half:e}");
                }
                text += "\n";
            }
        }
        text
    }

    /// Everything, as one JSON object.
    pub fn to_json(&self) -> Value {
        let (region, reference) = (self.region, &self.reference);
        let ([x, y], [width, height]) = (self.crop.corner, self.crop.size);
        let crop = [region.x0 + x, region.y0 + y, region.x0 + x + width, region.y0 + y + height];
        let source = match &reference.source {
            Source::Rendered { spp, seconds } => json!({ "spp": spp, "seconds": seconds, "precision": "f64" }),
            Source::File { picture, errors } => json!({ "file": picture, "standard_errors": errors }),
        };
        let left_out = self.left_out.iter().map(
            |left_out| json!({ "option": left_out.choice.to_string(), "level": left_out.name, "why": left_out.why }),
        );
        json!({
            "program": concat!("ocellus ", env!("CARGO_PKG_VERSION")),
            "region": [region.x0, region.y0, region.x1, region.y1],
            "is_part": self.is_part,
            "threads": self.threads,
            "seconds": self.seconds,
            "interrupted": self.interrupted,
            "interval": "95 %, Student's t over runs; of ratios and times by their logarithms",
            "relmse_formula": REL_MSE_FORMULA,
            "relmse_epsilon": REL_MSE_EPSILON,
            "target": { "metric": self.target.metric.to_string(), "value": self.target.value },
            "crop": crop,
            "reference": { "source": source, "rmse": reference.rmse() },
            "levels": self.accounts.iter().map(Account::to_json).collect::<Vec<_>>(),
            "left_out": left_out.collect::<Vec<_>>(),
            "sentence": self.sentence(),
        })
    }
}

impl Account {
    fn to_json(&self) -> Value {
        let measured = &self.measured;
        let bias = self.bias.map(|bias| {
            json!({ "mean_relative": of_estimate(&bias.mean), "mean_square": of_estimate(&bias.square), "shows": bias.shows() })
        });
        json!({
            "option": measured.level.choice.map(|choice| choice.to_string()),
            "level": measured.level.name,
            "kernel": measured.kernel,
            "setup_seconds": measured.setup.seconds,
            "image_hash": format!("{:016x}", measured.image_hash),
            "same_picture": self.is_same_picture,
            "rungs": measured.rungs.iter().map(Rung::to_json).collect::<Vec<_>>(),
            "variance": measured.spread.variance(),
            "bias": bias,
            "efficiency_over_first": self.efficiency.as_ref().map(of_ratio),
            "times_sooner_than_first": self.sooner.as_ref().map(of_ratio),
            "slope": self.slope.as_ref().map(of_estimate),
            "verdict": self.slope.as_ref().map(|slope| Verdict::of(slope).words()),
            "seconds_to_target": self.to_target.as_ref().map(|[seconds, _]| of_ratio(seconds)),
            "spp_to_target": self.to_target.as_ref().map(|[_, spp]| of_ratio(spp)),
            "foretold_over_found": self.foretold.as_ref().map(of_ratio),
        })
    }
}

impl Rung {
    fn to_json(&self) -> Value {
        let mut value = json!({ "spp": self.spp, "runs": self.runs.len() });
        for (name, figure) in FIGURES {
            value[name] = of_estimate(&self.estimate(figure));
        }
        value
    }
}

fn of_estimate(estimate: &Estimate) -> Value {
    json!({ "value": estimate.value, "half": estimate.half })
}

fn of_ratio(ratio: &Ratio) -> Value {
    json!({ "value": ratio.value, "interval": ratio.interval })
}
