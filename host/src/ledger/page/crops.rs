//! Single runs side by side: what the same time buys, and what the same error looks like.

use super::axis::is_shown;
use super::markup::escape;
use super::pictures::image;
use super::plot::Shown;
use crate::commands::words::duration;
use crate::ledger::Ledger;
use crate::ledger::account::Account;
use crate::ledger::measure::Run;
use crate::ledger::reference::Source;
use crate::ledger::table::brief;
use crate::output::{ToneMap, png_bytes};
use crate::picture::Picture;

/// A level whose best error is so many times the one that is asked for does not reach it.
const REACHED: f64 = 1.5;

/// A rung of the first run with its picture.
struct Step<'a> {
    spp: u32,
    run: &'a Run,
    crop: &'a Picture,
}

/// The steps of a level's first run.
fn steps(account: &Account) -> Vec<Step<'_>> {
    let rungs = account.measured.rungs.iter().zip(&account.measured.crops);
    rungs.filter_map(|(rung, crop)| Some(Step { spp: rung.spp, run: rung.runs.first()?, crop })).collect()
}

/// Both comparisons.
pub(super) fn section(ledger: &Ledger, tone: &ToneMap) -> String {
    let levels: Vec<_> = Shown::all(&ledger.accounts)
        .into_iter()
        .map(|shown| (shown.account, steps(shown.account)))
        .filter(|(_, steps)| !steps.is_empty())
        .collect();
    let Some(seconds) = levels.iter().filter_map(|(_, steps)| Some(steps.last()?.run.seconds)).reduce(f64::min) else {
        return String::new();
    };
    let truth = ledger.crop.cut(&ledger.reference.picture);
    let truth = tile(&truth, tone, "reference", "");
    let metric = ledger.target.metric;
    let mut text = format!(
        "<p class=\"caption\">{} First run of each level, tone mapped like the scene's PNG; {metric} is that of all pixels that were \
         measured.</p>\n\
         <h3>The same time: at most {}</h3>\n<p class=\"caption\">Samples double from rung to rung, so that a level may have used as \
         little as half of it.</p>\n<div class=\"tiles crops\">\n{truth}",
        place(ledger),
        duration(seconds)
    );
    for (account, steps) in &levels {
        let within = steps.iter().rev().find(|step| step.run.seconds <= seconds);
        let (step, note) = match within {
            Some(step) => (step, ""),
            None => (&steps[0], ", no sample takes less"),
        };
        text += &of_step(ledger, account, step, tone, note);
    }
    text += "</div>\n";
    if let Some(error) = common_error(ledger, &levels) {
        text += &format!(
            "<h3>The same error: {metric} of about {}</h3>\n<div class=\"tiles crops\">\n{truth}",
            escape(&brief(error))
        );
        for (account, steps) in &levels {
            let way = |step: &&Step<'_>| {
                let found = ledger.target.error(step.run);
                if is_shown(found) { libm::log(found / error).abs() } else { f64::INFINITY }
            };
            let Some(step) = steps.iter().min_by(|a, b| way(a).total_cmp(&way(b))) else { continue };
            let is_reached = steps.iter().any(|step| ledger.target.error(step.run) < REACHED * error);
            text += &of_step(ledger, account, step, tone, if is_reached { "" } else { ", never nearer" });
        }
        text += "</div>\n";
    }
    text
}

/// Which pixels are shown, and why.
fn place(ledger: &Ledger) -> String {
    let whole = &ledger.reference.picture;
    if ledger.crop.size == [whole.width, whole.height] {
        return "All pixels that were measured.".to_owned();
    }
    let why = match &ledger.reference.source {
        Source::File { errors: None, .. } => "the middle",
        _ => "where the reference is noisiest",
    };
    let [x, y] = [ledger.region.x0 + ledger.crop.corner[0], ledger.region.y0 + ledger.crop.corner[1]];
    let [width, height] = ledger.crop.size;
    format!("{width} x {height} pixels from column {x}, row {y}: {why}, framed in the picture at the top.")
}

/// The least error that all levels reach. One that is hopeless, so that the scene as asked for is better than it at four
/// samples already, is not waited for.
fn common_error(ledger: &Ledger, levels: &[(&Account, Vec<Step<'_>>)]) -> Option<f64> {
    let errors = |steps: &[Step<'_>]| -> Vec<f64> {
        steps.iter().map(|step| ledger.target.error(step.run)).filter(|error| is_shown(*error)).collect()
    };
    let (_, first) = levels.first()?;
    let asked = errors(first);
    let most = *asked.get(2).or(asked.last())?;
    let best = levels.iter().filter_map(|(_, steps)| errors(steps).into_iter().reduce(f64::min));
    best.reduce(f64::max).map(|error| error.min(most))
}

fn of_step(ledger: &Ledger, account: &Account, step: &Step<'_>, tone: &ToneMap, note: &str) -> String {
    let (metric, error) = (ledger.target.metric, brief(ledger.target.error(step.run)));
    let figures = format!("{} spp in {}, {metric} {error}{note}", step.spp, duration(step.run.seconds));
    tile(step.crop, tone, &account.name(), &figures)
}

fn tile(crop: &Picture, tone: &ToneMap, name: &str, figures: &str) -> String {
    let image = image(png_bytes(crop, tone), [2 * crop.width, 2 * crop.height], &format!("Crop of {name}"));
    format!("<figure>{image}<figcaption><b>{}</b> {}</figcaption></figure>\n", escape(name), escape(figures))
}
