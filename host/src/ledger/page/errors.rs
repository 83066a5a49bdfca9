//! Error against time: a line for each level that has a picture of its own.

use super::axis::{is_shown, plain, plain_seconds, range_of};
use super::plot::{Paper, Shape, Shown, Title, each_shape, key};
use crate::commands::words::duration;
use crate::diff::Metric;
use crate::ledger::Ledger;
use crate::ledger::estimate::Estimate;

/// What is further away than so many times the nearest point is not worth the paper.
const NEAR: f64 = 20.0;
/// Room for words below the target, as a factor.
const BELOW_TARGET: f64 = 0.5;

/// A rung: seconds, and the error with its interval.
#[derive(Clone, Copy)]
struct Point {
    seconds: f64,
    error: Estimate,
}

/// The points that can be drawn.
fn points(ledger: &Ledger, shown: &Shown<'_>) -> Vec<Point> {
    let of_rung = |rung: &crate::ledger::measure::Rung| Point {
        seconds: rung.estimate(|run| run.seconds).value,
        error: rung.estimate(|run| ledger.target.error(run)),
    };
    let all = shown.account.measured.rungs.iter().map(of_rung);
    all.filter(|point| is_shown(point.seconds) && is_shown(point.error.value)).collect()
}

/// The plot with its explanation.
pub(super) fn section(ledger: &Ledger) -> String {
    let shown = Shown::all(&ledger.accounts);
    let lines: Vec<_> = shown.iter().map(|shown| (*shown, points(ledger, shown))).collect();
    let lines: Vec<_> = lines.into_iter().filter(|(_, points)| !points.is_empty()).collect();
    if lines.is_empty() {
        return "<p class=\"nothing\">No error that a logarithm can be taken of was measured.</p>\n".to_owned();
    }
    let drawn: Vec<_> = lines.iter().map(|(shown, _)| *shown).collect();
    let squared = ledger.target.metric == Metric::RelMse;
    format!(
        "{}{}<p class=\"caption\">Lower and further left is better. \u{201c}As asked\u{201d} is the scene with the options that it \
         was given; every other level changes one of them, in the words of the command line. Each mark is a number of samples per \
         pixel, from 1 on, twice as many each time: the mean over all runs, in a band that holds it with 95 % confidence. Along a \
         grey diagonal the error falls as that of independent samples does; what lies on a lower one is cheaper. Hollow marks on a \
         dashed line: a biased level, some of whose error no samples take away. Levels that give the same picture as the first one \
         are left out here.</p>\n",
        each_shape(|shape| plot(ledger, &lines, shape, if squared { 1.0 } else { 0.5 })),
        key(&drawn),
    )
}

fn plot(ledger: &Ledger, lines: &[(Shown<'_>, Vec<Point>)], shape: Shape, power: f64) -> String {
    let all = || lines.iter().flat_map(|(_, points)| points);
    let [_, last] = range_of(all().map(|point| point.seconds));
    let [lowest, highest] = range_of(all().map(|point| point.error.value));
    let target = ledger.target.value;
    let has_target = (lowest / NEAR..highest * NEAR).contains(&target);
    let reached = lines.iter().find(|(shown, _)| shown.account.is_baseline()).and_then(|(shown, points)| {
        let [seconds, _] = shown.account.to_target?;
        (has_target && seconds.value < NEAR * last).then_some((seconds, points.last().copied()?))
    });
    let x = range_of(all().map(|point| point.seconds).chain(reached.map(|(seconds, _)| seconds.value)));
    let y = range_of(all().map(|point| point.error.value).chain(has_target.then_some(target * BELOW_TARGET)));
    let paper = Paper::new("errors", shape, [x, y], lines.len());

    let mut drawing = paper.clipped(&guides(&paper, power));
    if has_target {
        let [left, right] = paper.x.ends;
        let at = paper.y.place(target);
        drawing += &format!(
            "<path class=\"target\" d=\"M{left} {at:.1}H{right}\" /><text class=\"note\" x=\"{}\" y=\"{:.1}\">target {}</text>",
            left + 8.0,
            at - 6.0,
            plain(target)
        );
    }
    // The scene as asked for comes first, and is drawn last, on top.
    for (shown, points) in lines.iter().rev() {
        drawing += &line(&paper, shown, points);
    }
    if let Some((seconds, last)) = reached {
        let [x, y] = paper.at([seconds.value, target]);
        let [low, high] = seconds.interval.map(|end| paper.x.place(end));
        let ahead = if seconds.value > last.seconds {
            Paper::path([paper.at([last.seconds, last.error.value]), [x, y]])
        } else {
            String::new()
        };
        drawing += &format!(
            "<g class=\"c0 baseline\"><path class=\"ahead\" d=\"{ahead}\" /><path class=\"whisker\" d=\"M{low:.1} {y:.1}H{high:.1}\" /><path class=\"reached\" d=\"M{x:.1} {:.1}v12\" /></g><text class=\"answer\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            y - 6.0,
            y + 22.0,
            duration(seconds.value)
        );
    }
    let ends = lines.iter().filter_map(|(shown, points)| {
        let last = points.last()?;
        Some((*shown, paper.at([last.seconds, last.error.value])))
    });
    drawing += &paper.labels(&ends.collect::<Vec<_>>());

    let metric = ledger.target.metric.to_string();
    let [x, y] = [Title { text: "seconds of tracing", value: plain_seconds }, Title { text: &metric, value: plain }];
    let title = format!("{metric} against seconds of tracing");
    let what = format!("A line for each of {} levels; the figures are in the table of all rungs below.", lines.len());
    paper.svg([&title, &what], [&x, &y], &drawing)
}

/// Lines along which error and time trade as independent samples make them: one for each decade of their product, the
/// highest that there is room on with its name.
fn guides(paper: &Paper, power: f64) -> String {
    let [left, right] = paper.x.ends;
    let ([bottom, top], [low, high]) = (paper.y.range.map(libm::log), paper.x.range.map(libm::log));
    let [down, up] = paper.y.ends;
    // Beyond the paper, where `place` would stop.
    let height_at = |product: f64, x: f64| {
        let seconds = low + (x - left) / (right - left) * (high - low);
        down + (product - power * seconds - bottom) / (top - bottom) * (up - down)
    };
    let step = std::f64::consts::LN_10;
    let [first, last] = [bottom + power * low, top + power * high].map(|product| product / step);
    let products: Vec<f64> =
        (libm::floor(first) as i64..=libm::ceil(last) as i64).take(50).map(|decade| decade as f64 * step).collect();
    let lines = products.iter().map(|&product| {
        let ends = [left, right].map(|x| [x, height_at(product, x)]);
        format!("<path class=\"guide\" d=\"{}\" />", Paper::path(ends))
    });
    // Words as long as these, along a line, reach so far up.
    let fall = height_at(0.0, right) - height_at(0.0, left);
    let angle = libm::atan2(fall, right - left);
    let place = right - 70.0;
    let reach = 12.0 + 60.0 * libm::sin(angle);
    let with_room = || products.iter().rev().map(|product| height_at(*product, place)).find(|y| *y > up + reach);
    let named = if paper.shape.is_narrow { None } else { with_room() };
    let name = named.map(|y| {
        let angle = angle.to_degrees();
        let law = if power == 1.0 { "error ~ 1 / time" } else { "error ~ 1 / \u{221a}time" };
        format!(
            "<text class=\"note\" transform=\"translate({place:.1} {y:.1}) rotate({angle:.1})\" y=\"-5\" text-anchor=\"middle\">{law}</text>"
        )
    });
    lines.chain(name).collect()
}

fn line(paper: &Paper, shown: &Shown<'_>, points: &[Point]) -> String {
    let at = |point: &Point, error: f64| paper.at([point.seconds, error]);
    let banded: Vec<_> = points.iter().filter(|point| point.error.half.is_finite()).collect();
    // An end below zero stands at the bottom.
    let above = banded.iter().map(|point| at(point, point.error.interval()[1]));
    let below = banded.iter().rev().map(|point| at(point, point.error.interval()[0]));
    let band = match banded.len() {
        0 => String::new(),
        1 => format!("<path class=\"whisker\" d=\"{}\" />", Paper::path(above.chain(below))),
        _ => format!("<path class=\"band\" d=\"{}Z\" />", Paper::path(above.chain(below))),
    };
    let course = Paper::path(points.iter().map(|point| at(point, point.error.value)));
    let marks: String = points.iter().map(|point| shown.mark(at(point, point.error.value))).collect();
    format!("<g class=\"{}\">{band}<path class=\"line\" d=\"{course}\" />{marks}</g>", shown.classes())
}
