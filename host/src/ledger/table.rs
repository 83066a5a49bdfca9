//! The ledger as a table for people, within 100 columns, and its answer as a sentence.

use std::fmt::Write as _;

use super::Ledger;
use super::account::{Account, Verdict};
use super::estimate::{Estimate, Ratio};
use super::reference::Source;
use crate::commands::words::duration;
use crate::diff::{Metric, REL_MSE_FORMULA, significant};

/// Beyond so many times the samples that were taken, a prediction is not told.
const TOO_FAR: f64 = 1e4;
/// Columns of a terminal that the table fits in.
const COLUMNS: usize = 100;
/// An interval whose ends are further apart by factors is not told.
const TOO_VAGUE: f64 = 1e3;

/// A level's row, as text; empty where a figure means nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cells {
    /// Samples per pixel.
    pub spp: String,
    /// Seconds that a run takes.
    pub seconds: String,
    /// The target's metric.
    pub error: String,
    /// When the target is reached.
    pub time: String,
    /// Over that of the first row.
    pub efficiency: String,
    /// Of log RMSE over log spp.
    pub slope: String,
}

impl Ledger {
    /// The table, with what it was made of above and the answer below.
    pub fn table(&self) -> String {
        let mut text = self.how().join("\n") + "\n\n";
        // Writing to a string cannot fail.
        let time = format!("time to {}", self.target.value);
        let _ = writeln!(
            text,
            "  what differs                 spp  s a run  {:<14}{time:<24}{:<8}slope",
            self.target.metric, "worth",
        );
        for account in &self.accounts {
            let _ = writeln!(text, "  {}", self.row(account).trim_end());
        }
        for left_out in &self.left_out {
            let _ = writeln!(text, "  {} {}: left out, {}", left_out.choice, left_out.name, left_out.why);
        }
        text += "\n";
        for note in self.notes() {
            text += &note;
            text += "\n";
        }
        text + "\n" + &wrapped(&self.sentence())
    }

    /// How it was measured: a line of what and how often, and one of the reference.
    pub fn how(&self) -> [String; 2] {
        let region = self.region;
        let of = if self.is_part { "the middle " } else { "" };
        let runs = self.accounts.first().map_or(0, |account| account.top().runs.len());
        let reference = match &self.reference.source {
            Source::Rendered { spp, seconds } => {
                format!("rendered in f64, everything exact, {spp} spp in {}", duration(*seconds))
            }
            Source::File { picture, errors } => {
                let noise = if errors.is_some() { "" } else { ", its noise unknown" };
                format!("{}{noise}", picture.display())
            }
        };
        let of_what = format!(
            "{of}{} x {} pixels, {runs} independent runs of each, {} threads, {}",
            region.width(),
            region.height(),
            self.threads,
            duration(self.seconds),
        );
        [of_what, format!("reference: {reference}")]
    }

    fn row(&self, account: &Account) -> String {
        let Cells { spp, seconds, error, time, efficiency, slope } = self.cells(account);
        let bias = if account.is_biased() { "*" } else { "" };
        let name = account.name();
        format!("{name:<25} {spp:>6} {seconds:>8}  {error:<13} {time:<23} {efficiency:<7} {slope}{bias}")
    }

    /// A level's row.
    pub fn cells(&self, account: &Account) -> Cells {
        let (rung, target) = (account.top(), self.target);
        let error = rung.estimate(|run| target.error(run));
        let seconds = rung.estimate(|run| run.seconds).value;
        let is_same = account.is_same_picture && !account.is_baseline();
        let error = match is_same {
            true => "same picture".to_owned(),
            false if error.value > 0.0 => format!("{}{}", brief(error.value), give_or_take(&error)),
            // The reference is off by as much.
            false => "in the noise".to_owned(),
        };
        let time = if is_same { String::new() } else { self.time(account) };
        let efficiency = match account.efficiency {
            _ if account.is_baseline() => "1".to_owned(),
            Some(ratio) => factor(&ratio),
            None => "?".to_owned(),
        };
        let slope = match account.slope {
            _ if is_same => String::new(),
            Some(slope) => format!("{:.2}", slope.value),
            None => "?".to_owned(),
        };
        Cells { spp: rung.spp.to_string(), seconds: duration(seconds), error, time, efficiency, slope }
    }

    /// Whether a level's errors come near enough to the target to tell when they reach it.
    fn is_in_sight(account: &Account) -> bool {
        account.to_target.is_some_and(|[_, spp]| spp.value < TOO_FAR * f64::from(account.top().spp))
    }

    /// When a level reaches the target.
    fn time(&self, account: &Account) -> String {
        match account.to_target {
            Some([seconds, _]) if Self::is_in_sight(account) => {
                let [low, high] = seconds.interval;
                if is_vague(&seconds) {
                    format!("about {}", brief(seconds.value))
                } else {
                    format!("{} ({}..{})", brief(seconds.value), brief(low), brief(high))
                }
            }
            Some(_) => "far away".to_owned(),
            None => "not in sight".to_owned(),
        }
    }

    /// What is to be known beside the table.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![format!(
            "time: seconds of tracing to {}, with their 95 % interval. worth: 1 / (variance x processor\ntime) over that of the first row, or speed where the picture is the same; ~ no difference shown",
            self.target
        )];
        if self.target.metric == Metric::RelMse {
            notes.push(format!("relMSE = {REL_MSE_FORMULA}, less what the reference itself is off by"));
        }
        for account in self.accounts.iter().filter(|account| account.is_biased()) {
            let Some(bias) = account.bias else { continue };
            let mean = if bias.mean.value.is_finite() {
                format!("mean {:+.2} % (+-{:.2}), ", 100.0 * bias.mean.value, 100.0 * bias.mean.half)
            } else {
                // The reference is black.
                String::new()
            };
            notes.push(format!(
                "* {} is biased: {mean}no samples take away {} of RMSE",
                account.name(),
                brief(bias.square.value.max(0.0).sqrt()),
            ));
        }
        if let Some(baseline) = self.accounts.first() {
            if let Some(slope) = baseline.slope {
                let [low, high] = slope.interval();
                notes.push(format!(
                    "RMSE falls as spp^{:.2} ({low:.2}..{high:.2}): {}",
                    slope.value,
                    Verdict::of(&slope).words()
                ));
            }
            if let Some(foretold) = baseline.foretold {
                let [low, high] = foretold.interval;
                let interval = if high.is_finite() { format!(" ({low:.2}..{high:.2})") } else { String::new() };
                notes.push(format!(
                    "what a quarter of the samples foretold for the last row's error, over what came: {:.2}{interval}",
                    foretold.value
                ));
            }
            let worst = baseline.top().estimate(|run| run.figures.worst_share).value;
            if worst > 0.2 {
                notes.push(format!("the worst 0.1 % of the pixels hold {:.0} % of the squared error", 100.0 * worst));
            }
        }
        if self.interrupted {
            notes.push("stopped early: not all runs were done".to_owned());
        }
        notes
    }

    /// The answer in a sentence.
    pub fn sentence(&self) -> String {
        let Some(baseline) = self.accounts.first() else { return "nothing was measured".to_owned() };
        let Some([seconds, _]) = baseline.to_target.filter(|_| Self::is_in_sight(baseline)) else {
            return format!(
                "as asked, the picture's {} is not seen to reach {}",
                self.target.metric, self.target.value
            );
        };
        let asked = format!("as asked, the picture reaches {} in {}", self.target, within(&seconds));
        // What is sure to be different, and without a bias. Of less than one sample nobody knows how long it takes.
        let takes_a_sample = |account: &Account| account.to_target.is_some_and(|[_, spp]| spp.value >= 1.0);
        let is_compared = |account: &&Account| {
            !account.is_biased() && Self::is_in_sight(account) && [baseline, account].into_iter().all(takes_a_sample)
        };
        let is_sure = |ratio: &Ratio| !ratio.spans(1.0) && !is_vague(ratio);
        let others = self.accounts[1..].iter().filter(is_compared);
        let differing = others.filter_map(|account| Some((account, account.sooner.filter(is_sure)?)));
        let (sooner, later): (Vec<_>, Vec<_>) = differing.partition(|(_, ratio)| ratio.value > 1.0);
        let best = sooner.into_iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value));
        let worst = later.into_iter().min_by(|a, b| a.1.value.total_cmp(&b.1.value));
        let best = best.map(|(account, ratio)| format!("{:.1}x sooner with {}", ratio.value, account.name()));
        let worst = worst.map(|(account, ratio)| format!("{:.1}x later with {}", 1.0 / ratio.value, account.name()));
        match (best, worst) {
            (None, None) => format!("{asked}; no option that was varied changes that for sure"),
            (Some(one), None) | (None, Some(one)) => format!("{asked}, {one}"),
            (Some(best), Some(worst)) => format!("{asked}, {best}, {worst}"),
        }
    }
}

/// A sentence in lines of at most [`COLUMNS`].
fn wrapped(sentence: &str) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in sentence.split(' ') {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > COLUMNS {
            text += "\n";
            column = 0;
        } else if column > 0 {
            text += " ";
            column += 1;
        }
        text += word;
        column += length;
    }
    text
}

/// Whether an interval says too little to be told.
fn is_vague(ratio: &Ratio) -> bool {
    let [low, high] = ratio.interval;
    // So does a NaN.
    !(high < TOO_VAGUE * low)
}

/// Seconds with their interval, for a sentence.
fn within(seconds: &Ratio) -> String {
    let [low, high] = seconds.interval;
    if is_vague(seconds) {
        format!("about {}", duration(seconds.value))
    } else {
        format!("{} ({} to {})", duration(seconds.value), duration(low), duration(high))
    }
}

/// Half of an interval as a share of the middle.
pub fn give_or_take(estimate: &Estimate) -> String {
    let share = 100.0 * estimate.half / estimate.value.abs();
    match share {
        _ if !share.is_finite() => String::new(),
        // As good as nothing is known, and the columns are narrow.
        _ if share > 99.0 => " +->99%".to_string(),
        _ => format!(" +-{share:.0} %"),
    }
}

/// A factor and whether it is one.
pub fn factor(ratio: &Ratio) -> String {
    let digits = if ratio.value < 9.95 { 2 } else { 0 };
    let value =
        if ratio.value < 0.00995 { format!("{:.1e}", ratio.value) } else { format!("{:.digits$}", ratio.value) };
    if ratio.spans(1.0) { format!("~{value}") } else { value }
}

/// In few digits, which say enough of an estimate; `?` for what is no number.
pub fn brief(value: f64) -> String {
    match value.abs() {
        1e-3..1e5 | 0.0 => significant(value, 3),
        _ if value.is_finite() => format!("{value:.1e}"),
        _ => "?".to_owned(),
    }
}
