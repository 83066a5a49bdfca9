//! What `ocellus render` says of the error of a picture, where it was asked for one.

use serde_json::{Value, json};

use super::streams::tell;
use super::words::duration;
use crate::audit::audit;
use crate::cli::RenderArgs;
use crate::description::SceneDescription;
use crate::diff::significant;
use crate::error::Error;
use crate::film::Film;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use crate::promise::{Outlook, Target};
use crate::render::{RenderSettings, Rendering};

/// Tells people, and `report`, what is promised; whether that is what was asked for.
pub(super) fn tell_of(
    args: &RenderArgs,
    settings: &RenderSettings,
    rendering: &Rendering,
    outlook: Option<Outlook>,
    foreseen: Option<f64>,
    report: &mut Value,
) -> bool {
    let spp = settings.samples.end;
    if !rendering.interrupted && (args.target_error.is_some() || args.time.is_some()) {
        let odd_rows = settings.odd_rows_end.map(|end| format!(" --spp-odd-rows {end}")).unwrap_or_default();
        tell(format_args!("the same bits again: --spp {spp}{odd_rows}"));
    }
    let Some(target) = args.target_error else { return true };
    let met = outlook.is_some_and(|outlook| outlook.most <= target.value);
    report["target"] = json!({ "metric": target.metric.to_string(), "value": target.value, "met": met });
    report["promised_error"] =
        json!(outlook.map(|outlook| json!({ "expected": outlook.expected, "most": outlook.most })));
    tell(match outlook {
        None => format!("too few samples to tell the {}", target.metric),
        Some(outlook) => {
            let [most, expected] = [outlook.most, outlook.expected].map(|error| significant(error, 3));
            let words = format!("{} {most} at most, with a certainty of 95 %; {expected} expected", target.metric);
            let left = foreseen.map_or(0.0, |foreseen| foreseen / f64::from(spp) - 1.0);
            if met {
                words
            } else if args.unbiased {
                format!("{words}; what other rows saw was less, as happens where light is rare or the picture small")
            } else if left > 0.0 {
                format!("{words}; {} would take about {} more", target.value, duration(left * rendering.trace_seconds))
            } else {
                format!("{words}; {} is near", target.value)
            }
        }
    });
    met
}

/// Audits a picture.
pub(super) fn tell_audit(
    scene: &SceneDescription,
    settings: &RenderSettings,
    film: &Film,
    target: Target,
    interrupt: &Interrupt,
    report: &mut Value,
) -> Result<(), Error> {
    let progress = Progress::open_ended(interrupt.clone());
    let found = audit(scene, settings, film, target, &progress);
    progress.finish();
    let Some(found) = found? else { return Ok(()) };
    let (kept, all) = (found.kept(target), found.errors.len());
    report["audit"] = json!({ "errors": found.errors, "kept": kept });
    let own = significant(found.errors[0], 3);
    tell(format_args!(
        "audit: {} {own}; with fresh seeds and as many samples {kept} of {all} pictures are within {}",
        target.metric, target.value
    ));
    Ok(())
}
