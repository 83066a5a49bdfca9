//! What the first samples foretell, against what comes.

use super::axis::{is_shown, plain, range_of};
use super::plot::{Paper, Shape, Shown, Title, each_shape, key};
use crate::ledger::Ledger;
use crate::ledger::estimate::Ratio;

/// A level with the error that came, and the one that was foretold.
type Foretold<'a> = (Shown<'a>, f64, Ratio);

/// The plot with its explanation.
pub(super) fn section(ledger: &Ledger) -> String {
    let of_level = |shown: Shown<'_>| {
        let came = shown.account.top().estimate(|run| ledger.target.error(run)).value;
        let share = shown.account.foretold?;
        let foretold = Ratio { value: came * share.value, interval: share.interval.map(|end| came * end) };
        (is_shown(came) && is_shown(foretold.value)).then_some((came, foretold))
    };
    let shown = Shown::all(&ledger.accounts);
    let levels: Vec<Foretold<'_>> = shown
        .into_iter()
        .filter_map(|shown| {
            let (came, foretold) = of_level(shown)?;
            Some((shown, came, foretold))
        })
        .collect();
    if levels.is_empty() {
        return "<p class=\"nothing\">There are too few rungs to foretell anything from.</p>\n".to_owned();
    }
    let drawn: Vec<_> = levels.iter().map(|(shown, ..)| *shown).collect();
    format!(
        "{}{}<p class=\"caption\">For each level, a straight line through its errors up to a quarter of the samples says what the \
         error will be at the end; here that stands against what it was. On the diagonal the prediction was right, above it too \
         gloomy, below too hopeful: where a bias sets in, or rare bright samples. Whiskers are 95 % intervals over runs.</p>\n",
        each_shape(|shape| plot(ledger, &levels, shape)),
        key(&drawn),
    )
}

fn plot(ledger: &Ledger, levels: &[Foretold<'_>], shape: Shape) -> String {
    // The same on both axes.
    let range = range_of(levels.iter().flat_map(|(_, came, foretold)| [*came, foretold.value]));
    let paper = Paper::new("forecast", shape, [range, range], levels.len());
    let ends = range.map(|end| paper.at([end, end]));
    let mut drawing = format!("<path class=\"target\" d=\"{}\" />", Paper::path(ends));
    let mut marks = Vec::new();
    for (shown, came, foretold) in levels.iter().rev() {
        let at = paper.at([*came, foretold.value]);
        let whisker = foretold.interval.map(|end| paper.at([*came, end]));
        drawing += &format!(
            "<g class=\"{}\"><path class=\"whisker\" d=\"{}\" />{}</g>",
            shown.classes(),
            Paper::path(whisker),
            shown.mark(at)
        );
        marks.push((*shown, at));
    }
    drawing += &paper.labels(&marks);
    let metric = ledger.target.metric;
    let (came, foretold) = (format!("{metric} that came"), format!("{metric} foretold"));
    let [x, y] = [&came, &foretold].map(|text| Title { text, value: plain });
    let title = format!("{metric} foretold against {metric} found");
    let what = "A mark for each level, and the diagonal on which a prediction is right.";
    paper.svg([&title, what], [&x, &y], &drawing)
}
