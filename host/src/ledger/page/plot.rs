//! Plots on logarithmic paper, as SVG: each twice, for wide screens and paper and for phones, of which a page shows one.

use super::axis::{Axis, ticks};
use super::labels::push_apart;
use super::markup::escape;
use crate::ledger::account::Account;

/// What a plot is drawn for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The class by which the page shows or hides it.
    pub(super) class: &'static str,
    /// Units across.
    pub(super) width: f64,
    /// Units down.
    pub(super) height: f64,
    /// Whether there is little room, so that levels have numbers instead of names.
    pub(super) is_narrow: bool,
}

const SHAPES: [Shape; 2] = [
    Shape { class: "wide", width: 960.0, height: 460.0, is_narrow: false },
    Shape { class: "narrow", width: 380.0, height: 380.0, is_narrow: true },
];

/// Units from one label to the next.
const LINE: f64 = 17.0;

/// A drawing in each shape.
pub(super) fn each_shape(draw: impl Fn(Shape) -> String) -> String {
    SHAPES.map(draw).concat()
}

/// A level as plots show it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown<'a> {
    /// What is shown.
    pub(super) account: &'a Account,
    /// Its number in plots without names.
    pub(super) number: usize,
    color: usize,
    form: usize,
}

impl<'a> Shown<'a> {
    /// All levels that have a picture of their own. Those of one option have the same color.
    pub(super) fn all(accounts: &'a [Account]) -> Vec<Self> {
        let own = accounts.iter().filter(|account| account.is_baseline() || !account.is_same_picture);
        let mut choices = Vec::new();
        own.enumerate()
            .map(|(number, account)| {
                let choice = account.measured.level.choice;
                if !choices.contains(&choice) {
                    choices.push(choice);
                }
                let place = choices.iter().position(|known| *known == choice).unwrap_or(0);
                // The scene as asked for has a color that nothing else has.
                let (round, color) = (place.saturating_sub(1) / 7, place.saturating_sub(1) % 7);
                let color = if account.is_baseline() { 0 } else { 1 + color };
                Self { account, number, color, form: (number + round) % 5 }
            })
            .collect()
    }

    /// Classes for the style sheet.
    pub(super) fn classes(&self) -> String {
        let baseline = if self.account.is_baseline() { " baseline" } else { "" };
        let biased = if self.account.is_biased() { " biased" } else { "" };
        format!("c{}{baseline}{biased}", self.color)
    }

    /// Its mark around a place: levels whose colors are the same differ in shape.
    pub(super) fn mark(&self, [x, y]: [f64; 2]) -> String {
        let size = if self.account.is_baseline() { 4.6 } else { 3.8 };
        let path = |corners: &[[f64; 2]]| {
            let corners = corners.iter().map(|[dx, dy]| format!("{:.1} {:.1}", x + dx * size, y + dy * size));
            format!("<path class=\"mark\" d=\"M{}Z\" />", corners.collect::<Vec<_>>().join("L"))
        };
        match self.form {
            0 => format!("<circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\" />"),
            1 => path(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            2 => path(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
            3 => path(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]),
            _ => path(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        }
    }
}

/// Numbers, marks and names of levels, for plots that have no room for names.
pub(super) fn key(shown: &[Shown<'_>]) -> String {
    let entries = shown.iter().map(|shown| {
        let mark = shown.mark([8.0, 8.0]);
        format!(
            "<li><svg class=\"{}\" viewBox=\"0 0 16 16\" width=\"16\" height=\"16\" aria-hidden=\"true\">{mark}</svg> {} {}</li>",
            shown.classes(),
            shown.number,
            escape(&shown.account.name()),
        )
    });
    format!("<ul class=\"key narrow\">{}</ul>\n", entries.collect::<String>())
}

/// What an axis is called, and how values read on it.
pub(super) struct Title<'a> {
    pub(super) text: &'a str,
    pub(super) value: fn(f64) -> String,
}

/// A plot's paper: an area with two axes, and a column for labels on its right.
pub(super) struct Paper {
    pub(super) shape: Shape,
    pub(super) x: Axis,
    pub(super) y: Axis,
    height: f64,
    id: String,
}

impl Paper {
    /// Paper for so many labels. `id` is the plot's alone.
    pub(super) fn new(id: &str, shape: Shape, ranges: [[f64; 2]; 2], labels: usize) -> Self {
        let column = if shape.is_narrow { 40.0 } else { 250.0 };
        let height = shape.height.max(80.0 + LINE * labels as f64);
        let x = Axis { range: ranges[0], ends: [56.0, shape.width - column] };
        let y = Axis { range: ranges[1], ends: [height - 48.0, 30.0] };
        Self { shape, x, y, height, id: format!("{id}-{}", shape.class) }
    }

    /// Where a point stands.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.place(x), self.y.place(y)]
    }

    /// A path through points of the paper.
    pub(super) fn path(points: impl IntoIterator<Item = [f64; 2]>) -> String {
        let points = points.into_iter().map(|[x, y]| format!("{x:.1} {y:.1}"));
        format!("M{}", points.collect::<Vec<_>>().join("L"))
    }

    /// What is within the area alone.
    pub(super) fn clipped(&self, drawing: &str) -> String {
        format!("<g clip-path=\"url(#{}-area)\">{drawing}</g>", self.id)
    }

    fn grid(&self, x_title: &Title<'_>, y_title: &Title<'_>) -> String {
        let ([left, right], [bottom, top]) = (self.x.ends, self.y.ends);
        let most = if self.shape.is_narrow { [5, 8] } else { [10, 10] };
        let mut text = format!(
            "<clipPath id=\"{}-area\"><rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" /></clipPath>",
            self.id,
            right - left,
            bottom - top
        );
        text += &uprights(&self.x, most[0], [top, bottom], x_title.value);
        for tick in ticks(self.y.range, most[1]) {
            let y = self.y.place(tick);
            text += &format!(
                "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\" /><text class=\"tick\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 8.0,
                y + 4.0,
                (y_title.value)(tick),
            );
        }
        text += &format!(
            "<path class=\"axes\" d=\"M{left} {top}V{bottom}H{right}\" /><text class=\"title\" x=\"4\" y=\"16\">{}</text><text class=\"title\" x=\"{right}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            escape(y_title.text),
            bottom + 40.0,
            escape(x_title.text),
        );
        text
    }

    /// Names (or numbers) of levels beside the area, each with a line to the place on the paper that it names.
    pub(super) fn labels(&self, ends: &[(Shown<'_>, [f64; 2])]) -> String {
        let ([_, right], [bottom, top]) = (self.x.ends, self.y.ends);
        let wanted: Vec<f64> = ends.iter().map(|(_, [_, y])| *y).collect();
        let places = push_apart(&wanted, LINE, [top + 4.0, bottom - 4.0]);
        let label = |((shown, from), y): (&(Shown<'_>, [f64; 2]), f64)| {
            let to = [[right + 4.0, y], [right + 10.0, y]];
            let leader = Self::path([*from].into_iter().chain(to));
            let (classes, mark) = (shown.classes(), shown.mark([right + 16.0, y]));
            let name = match (self.shape.is_narrow, shown.account.is_biased()) {
                (true, _) => String::new(),
                (false, true) => format!("{} (biased)", shown.account.name()),
                (false, false) => shown.account.name(),
            };
            let text = if self.shape.is_narrow { shown.number.to_string() } else { escape(&name) };
            let x = right + if self.shape.is_narrow { 22.0 } else { 25.0 };
            format!(
                "<g class=\"{classes}\"><path class=\"leader\" d=\"{leader}\" />{mark}<text class=\"name\" x=\"{x:.1}\" y=\"{:.1}\">{text}</text></g>",
                y + 4.0
            )
        };
        ends.iter().zip(places).map(label).collect()
    }

    /// The plot, with what it is called and what it shows for those who cannot see it.
    pub(super) fn svg(&self, what: [&str; 2], titles: [&Title<'_>; 2], drawing: &str) -> String {
        let [x, y] = titles;
        drawing_in(&self.id, self.shape, self.height, what, &format!("{}{drawing}", self.grid(x, y)))
    }
}

/// Lines at the ticks of a horizontal axis, with their values below where there is room for them.
pub(super) fn uprights(axis: &Axis, most: usize, [top, bottom]: [f64; 2], value: fn(f64) -> String) -> String {
    let mut text = String::new();
    let mut taken = f64::NEG_INFINITY;
    for tick in ticks(axis.range, most) {
        let (x, value) = (axis.place(tick), value(tick));
        text += &format!("<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\" />");
        // A digit is about as wide as this.
        let half = 4.0 * value.chars().count() as f64;
        if x - half > taken {
            taken = x + half + 4.0;
            let y = bottom + 18.0;
            text += &format!("<text class=\"tick\" x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\">{value}</text>");
        }
    }
    text
}

/// An SVG element.
pub(super) fn drawing_in(
    id: &str,
    shape: Shape,
    height: f64,
    [title, description]: [&str; 2],
    drawing: &str,
) -> String {
    format!(
        "<svg class=\"plot {}\" viewBox=\"0 0 {} {height:.0}\" role=\"img\" aria-labelledby=\"{id}-title {id}-what\"><title id=\"{id}-title\">{}</title><desc id=\"{id}-what\">{}</desc>{drawing}</svg>\n",
        shape.class,
        shape.width,
        escape(title),
        escape(description),
    )
}
