//! All figures: the levels as the terminal shows them, and every rung.

use super::markup::escape;
use crate::commands::words::duration;
use crate::ledger::Ledger;
use crate::ledger::account::Account;
use crate::ledger::measure::{Run, Rung};
use crate::ledger::table::{Cells, brief, give_or_take};

/// The levels, with what is to be known beside them.
pub(super) fn levels(ledger: &Ledger) -> String {
    let heads = [
        "what differs".to_owned(),
        "spp".to_owned(),
        "a run takes".to_owned(),
        ledger.target.metric.to_string(),
        format!("seconds to {}", ledger.target.value),
        "efficiency".to_owned(),
        "slope".to_owned(),
    ];
    let rows: String = ledger.accounts.iter().map(|account| level(ledger, account)).collect();
    let notes: String = ledger.notes().iter().map(|note| format!("<li>{}</li>", escape(note))).collect();
    let left_out = ledger.left_out.iter().map(|left_out| {
        format!(
            "<li>{}: left out, {}</li>",
            escape(&format!("{} {}", left_out.choice, left_out.name)),
            escape(&left_out.why)
        )
    });
    format!(
        "<div class=\"scroll\"><table>\n{}<tbody>\n{rows}</tbody></table></div>\n<ul class=\"notes\">{notes}{}</ul>\n",
        head(&heads),
        left_out.collect::<String>()
    )
}

fn level(ledger: &Ledger, account: &Account) -> String {
    let Cells { spp, seconds, error, time, efficiency, slope } = ledger.cells(account);
    let biased = if account.is_biased() { " <em>biased</em>" } else { "" };
    let name = format!("{}{biased}", escape(&account.name()));
    row(&name, [spp, seconds, error, time, efficiency, slope])
}

fn head(heads: &[String]) -> String {
    let cells: String = heads.iter().map(|head| format!("<th scope=\"col\">{}</th>", escape(head))).collect();
    format!("<thead><tr>{cells}</tr></thead>\n")
}

/// A row; its name is markup already.
fn row(name: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells.into_iter().map(|cell| format!("<td>{}</td>", escape(&cell))).collect();
    format!("<tr><th scope=\"row\">{name}</th>{cells}</tr>\n")
}

/// A figure of a run, by its name.
type Figure = (&'static str, fn(&Run) -> f64);

/// What the table of rungs tells of each run.
const FIGURES: [Figure; 9] = [
    ("relMSE", |run| run.figures.rel_mse),
    ("RMSE", |run| run.figures.mse.max(0.0).sqrt()),
    ("median error", |run| run.figures.percentiles[0]),
    ("99 % below", |run| run.figures.percentiles[2]),
    ("largest", |run| run.figures.largest),
    ("mean", |run| run.figures.mean),
    ("FLIP of the crop", |run| run.flips.flip),
    ("HDR-FLIP of the crop", |run| run.flips.hdr_flip),
    ("rays", |run| run.rays as f64),
];

/// Every rung of every level, folded.
pub(super) fn rungs(ledger: &Ledger) -> String {
    let heads = ["level", "spp", "runs", "seconds"].into_iter().chain(FIGURES.map(|(name, _)| name)).map(str::to_owned);
    let of_rung = |account: &Account, rung: &Rung| {
        let seconds = rung.estimate(|run| run.seconds);
        let own = [
            rung.spp.to_string(),
            rung.runs.len().to_string(),
            format!("{}{}", duration(seconds.value), give_or_take(&seconds)),
        ];
        let figures = FIGURES.map(|(_, figure)| {
            let estimate = rung.estimate(figure);
            format!("{}{}", brief(estimate.value), give_or_take(&estimate))
        });
        row(&escape(&account.name()), own.into_iter().chain(figures))
    };
    let rows =
        ledger.accounts.iter().flat_map(|account| account.measured.rungs.iter().map(move |rung| (account, rung)));
    let rows: String = rows.map(|(account, rung)| of_rung(account, rung)).collect();
    format!(
        "<details><summary>Every level at every number of samples</summary>\n<div class=\"scroll\"><table>\n{}<tbody>\n{rows}</tbody></table></div>\n\
         <p class=\"caption\">Means over runs with half of their 95 % intervals. ledger.csv and ledger.json hold the same, with more \
         digits.</p></details>\n",
        head(&heads.collect::<Vec<_>>()),
    )
}
