//! What each option is worth: error and time in one figure.

use super::axis::{Axis, is_shown, plain, range_of};
use super::markup::escape;
use super::plot::{Shape, drawing_in, each_shape, uprights};
use crate::ledger::Ledger;
use crate::ledger::account::Account;
use crate::ledger::estimate::Ratio;
use crate::ledger::table::factor;

/// Intervals are drawn up to so many times the middle.
const FAR: f64 = 30.0;

/// A level with what it is worth, if that is known.
type Worth<'a> = (&'a Account, Option<Ratio>);

/// Levels with what they are worth, the best first; those of which that is not known come last.
fn sorted(ledger: &Ledger, is_same_picture: bool) -> Vec<Worth<'_>> {
    let others = ledger.accounts.iter().filter(|account| !account.is_baseline());
    let group = others.filter(|account| account.is_same_picture == is_same_picture);
    let mut group: Vec<_> =
        group.map(|account| (account, account.efficiency.filter(|ratio| is_shown(ratio.value)))).collect();
    group.sort_by(|a, b| {
        let [a, b] = [a.1, b.1].map(|ratio| ratio.map_or(0.0, |ratio| ratio.value));
        b.total_cmp(&a)
    });
    group
}

/// The chart with its explanation.
pub(super) fn section(ledger: &Ledger) -> String {
    let groups = [
        ("What changes the picture: 1 / (variance \u{d7} time)", sorted(ledger, false)),
        ("What changes the time alone: speed", sorted(ledger, true)),
    ];
    if groups.iter().all(|(_, group)| group.is_empty()) {
        return "<p class=\"nothing\">Nothing was varied.</p>\n".to_owned();
    }
    format!(
        "{}<p class=\"caption\">How many times as much the same time buys, against the scene as asked for: 2 gets to the same error \
         in half the time, 0.5 takes twice as long. Variance and processor time are taken at the largest number of samples that \
         both have; whiskers are 95 % intervals over runs. Grey: the interval holds 1, so that no difference shows. Hollow, dashed: a \
         biased level, whose bar leaves out what it is off by for good.</p>\n",
        each_shape(|shape| chart(&groups, shape))
    )
}

fn chart(groups: &[(&str, Vec<Worth<'_>>)], shape: Shape) -> String {
    let ratios = groups.iter().flat_map(|(_, group)| group.iter().filter_map(|(_, ratio)| *ratio));
    let reach = |ratio: Ratio| {
        [ratio.value, ratio.interval[0].max(ratio.value / FAR), ratio.interval[1].min(ratio.value * FAR)]
    };
    let range = range_of(ratios.flat_map(reach).chain([0.5, 2.0]));
    let (left, column, step) = if shape.is_narrow { (12.0, 62.0, 40.0) } else { (218.0, 250.0, 27.0) };
    let axis = Axis { range, ends: [left, shape.width - column] };
    let one = axis.place(1.0);

    let mut rows = String::new();
    let mut y = 8.0;
    for (heading, group) in groups.iter().filter(|(_, group)| !group.is_empty()) {
        y += 22.0;
        rows += &format!("<text class=\"title\" x=\"4\" y=\"{y}\">{heading}</text>");
        y += 10.0;
        for (account, ratio) in group {
            rows += &row(account, ratio.as_ref(), &axis, y, shape);
            y += step;
        }
    }
    let mut grid = uprights(&axis, if shape.is_narrow { 6 } else { 10 }, [36.0, y], plain);
    grid += &format!("<path class=\"one\" d=\"M{one:.1} 36V{y}\" />");
    let title = "Efficiency of each level over the scene as asked for";
    let what = "A bar for each level, with its interval; the figures are in the table of all levels below.";
    drawing_in(&format!("efficiency-{}", shape.class), shape, y + 28.0, [title, what], &format!("{grid}{rows}"))
}

/// A level's name, bar, whiskers and figure, from `y` down.
fn row(account: &Account, ratio: Option<&Ratio>, axis: &Axis, y: f64, shape: Shape) -> String {
    let [left, right] = axis.ends;
    let name = escape(&account.name());
    // Little room: the name stands above its bar.
    let (name, middle) = if shape.is_narrow {
        (format!("<text class=\"name\" x=\"{left}\" y=\"{}\">{name}</text>", y + 14.0), y + 26.0)
    } else {
        let middle = y + 13.0;
        let x = left - 12.0;
        (format!("<text class=\"name\" x=\"{x}\" y=\"{}\" text-anchor=\"end\">{name}</text>", middle + 4.0), middle)
    };
    let Some(ratio) = ratio else {
        return format!("{name}<text class=\"name\" x=\"{}\" y=\"{}\">?</text>", right + 10.0, middle + 4.0);
    };
    let (kind, words) = match () {
        () if ratio.spans(1.0) => ("same", "no difference shown"),
        () if ratio.value > 1.0 => ("gain", ""),
        () => ("loss", ""),
    };
    let biased = if account.is_biased() { "biased" } else { "" };
    let words = if shape.is_narrow { String::new() } else { [words, biased].join(" ") };
    let (one, at) = (axis.place(1.0), axis.place(ratio.value));
    let [low, high] = ratio.interval.map(|end| axis.place(end));
    format!(
        "<g class=\"{kind} {biased}\">{name}<rect class=\"bar\" x=\"{:.1}\" y=\"{}\" width=\"{:.1}\" height=\"12\" /><path class=\"whisker\" d=\"M{low:.1} {middle}H{high:.1}M{low:.1} {}v8M{high:.1} {}v8\" /><text class=\"value\" x=\"{}\" y=\"{}\">{} <tspan class=\"words\">{}</tspan></text></g>",
        one.min(at),
        middle - 6.0,
        (at - one).abs(),
        middle - 4.0,
        middle - 4.0,
        right + 10.0,
        middle + 4.0,
        escape(&factor(ratio)),
        words.trim(),
    )
}
