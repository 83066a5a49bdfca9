//! What the runs of a level say: errors, what they cost, and when a target is reached.

use super::estimate::{Estimate, Line, Ratio};
use super::measure::{Measured, Run, Rung};
use super::reference::Reference;
use super::spread::Bias;
use crate::diff::Metric;
use crate::promise::Target;

/// A level, measured, with what follows from it.
#[derive(Clone, Debug)]
pub struct Account {
    /// What was measured.
    pub measured: Measured,
    /// Systematic error at the last rung; `None` with fewer than two runs.
    pub bias: Option<Bias>,
    /// Efficiency, 1 / (variance x processor time), over that of the scene as asked for, at the same number of samples.
    /// For a level that gives the same picture: the other's processor time over its own.
    pub efficiency: Option<Ratio>,
    /// Whether the picture is the same, bit for bit, as of the scene as asked for at as many samples.
    pub is_same_picture: bool,
    /// Slope of log RMSE over log samples: -0.5 where samples are independent and nothing else is left.
    pub slope: Option<Estimate>,
    /// Seconds of tracing until the target, and samples per pixel.
    pub to_target: Option<[Ratio; 2]>,
    /// How many times sooner than the scene as asked for it reaches the target; `None` where that is not known of both.
    pub sooner: Option<Ratio>,
    /// What the rungs up to a quarter of the samples foretell for the last one, over what came: 1 if predictions are good.
    pub foretold: Option<Ratio>,
}

/// What a slope of log RMSE over log samples says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As independent samples do.
    MonteCarlo,
    /// Falls faster.
    Better,
    /// Falls slower: rare bright samples, or a bias.
    HeavyTail,
}

impl Verdict {
    /// Of an interval of slopes.
    pub fn of(slope: &Estimate) -> Self {
        match slope.interval() {
            [_, high] if high < -0.5 => Self::Better,
            [low, _] if low > -0.5 => Self::HeavyTail,
            _ => Self::MonteCarlo,
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::MonteCarlo => "Monte Carlo",
            Self::Better => "better than Monte Carlo",
            Self::HeavyTail => "heavy tail",
        }
    }
}

impl Account {
    /// The rung with the most samples.
    pub fn top(&self) -> &Rung {
        // A level without a rung has no account.
        &self.measured.rungs[self.measured.rungs.len() - 1]
    }

    /// Whether this is the scene as asked for.
    pub fn is_baseline(&self) -> bool {
        self.measured.level.choice.is_none()
    }

    /// Option and level, as `fresnel schlick`.
    pub fn name(&self) -> String {
        let level = &self.measured.level;
        level.choice.map_or_else(|| "as asked".to_owned(), |choice| format!("{choice} {}", level.name))
    }

    /// Whether a systematic error shows.
    pub fn is_biased(&self) -> bool {
        self.bias.is_some_and(|bias| bias.shows())
    }
}

impl Rung {
    /// Mean and interval of a figure over the runs.
    pub fn estimate(&self, figure: impl Fn(&Run) -> f64) -> Estimate {
        Estimate::of(self.runs.iter().map(figure))
    }
}

impl Target {
    /// What a run has of the target's metric; squared errors below zero count as none.
    pub fn error(&self, run: &Run) -> f64 {
        match self.metric {
            Metric::Rmse => run.figures.mse.max(0.0).sqrt(),
            _ => run.figures.rel_mse,
        }
    }
}

/// Accounts of all levels; the scene as asked for, if it is there, is the first.
pub fn accounts(measured: Vec<Measured>, reference: &Reference, target: Target) -> Vec<Account> {
    let biases: Vec<_> = measured.iter().map(|measured| bias(measured, reference)).collect();
    let rows: Vec<_> = measured
        .iter()
        .zip(&biases)
        .map(|(level, bias)| {
            let is_same_picture = is_same_picture(level, &measured[0]);
            let efficiency = efficiency(level, bias, &measured[0], &biases[0], is_same_picture);
            // The same picture at the same number of samples is nearer by as much as it is faster.
            let sooner = if is_same_picture { efficiency } else { sooner(level, &measured[0], target) };
            (efficiency, sooner, is_same_picture)
        })
        .collect();
    measured
        .into_iter()
        .zip(biases)
        .zip(rows)
        .map(|((measured, bias), (efficiency, sooner, is_same_picture))| Account {
            bias,
            efficiency,
            sooner,
            is_same_picture,
            slope: slope(&measured),
            to_target: to_target(&measured, target).filter(|[_, spp]| {
                // What a bias leaves is met by no line through larger errors.
                let far = 4.0 * f64::from(measured.rungs.last().map_or(0, |rung| rung.spp));
                !bias.is_some_and(|bias| bias.shows()) || spp.value < far
            }),
            foretold: foretold(&measured, target),
            measured,
        })
        .collect()
}

fn bias(measured: &Measured, reference: &Reference) -> Option<Bias> {
    let runs = &measured.rungs.last()?.runs;
    (runs.len() > 1).then(|| measured.spread.bias(reference, runs.iter().map(|run| run.figures.mean)))
}

/// The rungs of both with the most samples that both have.
fn common<'a>(one: &'a Measured, other: &'a Measured) -> Option<(&'a Rung, &'a Rung)> {
    one.rungs.iter().zip(&other.rungs).next_back()
}

/// Whether the runs of both have the same pictures at as many samples, as far as their figures tell.
fn is_same_picture(level: &Measured, baseline: &Measured) -> bool {
    common(level, baseline)
        .is_some_and(|(rung, asked)| rung.runs.iter().zip(&asked.runs).all(|(run, asked)| run.figures == asked.figures))
}

fn efficiency(
    level: &Measured,
    bias: &Option<Bias>,
    baseline: &Measured,
    baseline_bias: &Option<Bias>,
    is_same_picture: bool,
) -> Option<Ratio> {
    let (rung, asked) = common(level, baseline)?;
    // What is systematic is no matter of more samples.
    let systematic =
        |bias: &Option<Bias>| bias.filter(|bias| bias.shows()).map_or(0.0, |bias| bias.square.value.max(0.0));
    let cost = |run: &Run, bias| {
        let variance = if is_same_picture { 1.0 } else { run.figures.mse - systematic(bias) };
        variance * run.cpu_seconds
    };
    Ratio::of(rung.runs.iter().zip(&asked.runs).map(|(run, asked)| cost(asked, baseline_bias) / cost(run, bias)))
}

/// The runs of a level, each with a figure of all its rungs that are fit for logarithms.
fn courses(measured: &Measured, x: impl Fn(&Rung, &Run) -> f64, y: impl Fn(&Run) -> f64) -> Vec<Vec<[f64; 2]>> {
    let count = measured.rungs.iter().map(|rung| rung.runs.len()).min().unwrap_or(0);
    let of_run = |run: usize| {
        let points = measured.rungs.iter().map(|rung| [x(rung, &rung.runs[run]), y(&rung.runs[run])].map(libm::log));
        points.filter(|point| point.iter().all(|value| value.is_finite())).collect()
    };
    (0..count).map(of_run).collect()
}

fn slope(measured: &Measured) -> Option<Estimate> {
    let courses = courses(measured, |rung, _| f64::from(rung.spp), |run| run.figures.mse.max(0.0).sqrt());
    let slopes: Option<Vec<f64>> = courses.iter().map(|points| Some(Line::through(points)?.slope)).collect();
    slopes.filter(|slopes| slopes.len() > 1).map(Estimate::of)
}

/// Where the line through each run's errors meets the target; NaN where it does not.
fn reaches(measured: &Measured, target: Target, x: impl Fn(&Rung, &Run) -> f64) -> Vec<f64> {
    let reach = |points: &Vec<[f64; 2]>| match Line::through(points) {
        Some(line) if line.slope < 0.0 => libm::exp((libm::log(target.value) - line.level) / line.slope),
        _ => f64::NAN,
    };
    courses(measured, x, |run| target.error(run)).iter().map(reach).collect()
}

/// Where the lines through the runs' errors meet the target, in seconds and in samples per pixel.
fn to_target(measured: &Measured, target: Target) -> Option<[Ratio; 2]> {
    let seconds = Ratio::of(reaches(measured, target, |_, run| run.seconds))?;
    let spp = Ratio::of(reaches(measured, target, |rung, _| f64::from(rung.spp)))?;
    Some([seconds, spp])
}

/// Times to the target, those of the scene as asked for over the level's: runs share seeds and take turns, so that they
/// are compared one by one.
fn sooner(level: &Measured, baseline: &Measured, target: Target) -> Option<Ratio> {
    let times = |measured| reaches(measured, target, |_, run| run.seconds);
    Ratio::of(times(baseline).iter().zip(times(level)).map(|(asked, time)| asked / time))
}

fn foretold(measured: &Measured, target: Target) -> Option<Ratio> {
    let courses = courses(measured, |rung, _| f64::from(rung.spp), |run| target.error(run));
    let top = libm::log(f64::from(measured.rungs.last()?.spp));
    Ratio::of(courses.iter().map(|points| {
        let known: Vec<_> =
            points.iter().copied().filter(|point| point[0] < top - 1.5 * std::f64::consts::LN_2).collect();
        match (Line::through(&known), points.last()) {
            (Some(line), Some(last)) if last[0] == top => libm::exp(line.level + line.slope * top - last[1]),
            _ => f64::NAN,
        }
    }))
}
