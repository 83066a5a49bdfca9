//! Pictures within the page: the reference, maps of noise and of bias, and crops of single runs.

use super::markup::{escape, png_address};
use super::plot::Shown;
use crate::commands::words::duration;
use crate::diff::{HIGHEST, LOWEST, NON_FINITE_COLOR, REL_MSE_EPSILON, scale_color};
use crate::ledger::Ledger;
use crate::ledger::spread::Spread;
use crate::ledger::table::{brief, give_or_take};
use crate::output::{ToneMap, png_bytes, png_bytes_indexed};
use crate::picture::Picture;

/// The most pixels that a map or the reference has across or down; larger ones are averaged.
const LARGEST: u32 = 256;
/// Colors of a map, so few that its noise does not make the page large.
const STEPS: u8 = 48;

/// A picture with its alternative text.
pub(super) fn image(bytes: Option<Vec<u8>>, [width, height]: [u32; 2], alternative: &str) -> String {
    // There are no bytes of a picture without pixels.
    let address = png_address(&bytes.unwrap_or_default());
    let alternative = escape(alternative);
    format!("<img src=\"{address}\" width=\"{width}\" height=\"{height}\" alt=\"{alternative}\" />")
}

/// The scene: as the reference shows it, or, where only a part was measured, at a glance; with frames around that part and
/// what the crops show.
pub(super) fn scene(ledger: &Ledger, tone: &ToneMap) -> String {
    let (region, crop) = (ledger.region, ledger.crop);
    let of_region = ([region.x0, region.y0], [region.width(), region.height()]);
    let (picture, corner) = match ledger.is_part {
        true => (&ledger.preview, ledger.preview_corner),
        false => (&ledger.reference.picture, of_region.0),
    };
    let small = smaller(picture);
    let image = image(png_bytes(&small, tone), [small.width, small.height], "The scene");
    let frame = |([x, y], [across, down]): ([u32; 2], [u32; 2])| {
        let share = |pixels: u32, of: u32| 100.0 * f64::from(pixels) / f64::from(of.max(1));
        format!(
            "<span style=\"left:{:.2}%;top:{:.2}%;width:{:.2}%;height:{:.2}%\"></span>",
            share(x - corner[0], picture.width),
            share(y - corner[1], picture.height),
            share(across, picture.width),
            share(down, picture.height)
        )
    };
    let of_crop = ([region.x0 + crop.corner[0], region.y0 + crop.corner[1]], crop.size);
    let (frames, words) = match (ledger.is_part, of_crop == of_region) {
        (true, true) => (frame(of_region), "The scene at two samples per pixel; framed: what was measured."),
        (true, false) => (
            frame(of_region) + &frame(of_crop),
            "The scene at two samples per pixel; framed: what was measured, and within it what the crops show.",
        ),
        (false, true) => (String::new(), "The reference."),
        (false, false) => (frame(of_crop), "The reference; framed: what the crops show."),
    };
    format!(
        "<figure class=\"scene\"><div class=\"picture\">{image}{frames}</div><figcaption>{words}</figcaption></figure>"
    )
}

/// A picture of which each pixel is the mean of a square of the other's, where that is too large.
fn smaller(picture: &Picture) -> Picture {
    let channel = |channel: usize| {
        let values: Vec<f64> = picture.pixels.iter().map(|pixel| f64::from(pixel[channel])).collect();
        averaged(&values, picture.width, |value| value, |mean| mean)
    };
    let [(red, width), (green, _), (blue, _)] = [0, 1, 2].map(channel);
    let pixels = red.iter().zip(&green).zip(&blue).map(|((r, g), b)| [r, g, b].map(|value| *value as f32));
    let pixels: Vec<_> = pixels.collect();
    let height = (pixels.len() as u32).checked_div(width).unwrap_or(0);
    Picture { width, height, pixels }
}

/// Means over squares of values, so that neither side is longer than [`LARGEST`], and how many are in a row.
fn averaged(values: &[f64], width: u32, from: impl Fn(f64) -> f64, back: impl Fn(f64) -> f64) -> (Vec<f64>, u32) {
    let width = width.max(1) as usize;
    let height = values.len() / width;
    let side = width.max(height).div_ceil(LARGEST as usize).max(1);
    let mut means = Vec::new();
    for y in (0..height).step_by(side) {
        for x in (0..width).step_by(side) {
            let rows = (y..(y + side).min(height)).map(|row| &values[row * width..][x..(x + side).min(width)]);
            let (mut sum, mut count) = (0.0, 0.0);
            for value in rows.flatten() {
                sum += from(*value);
                count += 1.0;
            }
            means.push(back(sum / count));
        }
    }
    (means, width.div_ceil(side) as u32)
}

/// A scale of colors: where a value stands on it, from 0 to 1, and the color there.
struct Scale {
    place: fn(f64) -> f64,
    color: fn(f64) -> [u8; 3],
    marks: &'static [(f64, &'static str)],
}

/// Relative noise, on the scale of error maps.
const NOISE: Scale = Scale {
    place: |error| libm::log10(error.clamp(LOWEST, HIGHEST) / LOWEST) / libm::log10(HIGHEST / LOWEST),
    color: |place| scale_color(LOWEST * libm::pow(HIGHEST / LOWEST, place)),
    marks: &[(0.001, "0.1 %"), (0.01, "1 %"), (0.1, "10 %"), (1.0, "100 %")],
};

/// Standard errors that a mean is off by. Grey and blue is chance; orange and yellow are beyond 3.3.
const DEVIATION: Scale = Scale {
    place: |deviation| {
        let corner = DEVIATION_CORNERS.windows(2).find(|pair| deviation < pair[1].0);
        corner
            .map_or(1.0, |pair| pair[0].1 + (deviation - pair[0].0) / (pair[1].0 - pair[0].0) * (pair[1].1 - pair[0].1))
    },
    color: |place| {
        let at = DEVIATION_COLORS.windows(2).find(|pair| place < pair[1].0);
        let Some([(low, dark), (high, bright)]) = at else { return [255, 244, 176] };
        let share = (place - low) / (high - low);
        std::array::from_fn(|channel| {
            let [dark, bright] = [dark[channel], bright[channel]].map(f64::from);
            (dark + share * (bright - dark) + 0.5) as u8
        })
    },
    marks: &[(0.0, "0"), (1.0, "1"), (3.3, "3.3"), (10.0, "10")],
};

/// Standard errors, and where they stand.
const DEVIATION_CORNERS: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.3), (3.3, 0.65), (10.0, 1.0)];
/// Lightness rises throughout; at 3.3 the hue jumps.
const DEVIATION_COLORS: [(f64, [u8; 3]); 5] = [
    (0.0, [14, 17, 23]),
    (0.3, [52, 62, 78]),
    (0.65, [86, 150, 205]),
    (0.650_001, [238, 128, 28]),
    (1.0, [255, 244, 176]),
];

impl Scale {
    fn codes(&self) -> Vec<[u8; 3]> {
        let even = (0..STEPS).map(|step| (self.color)(f64::from(step) / f64::from(STEPS - 1)));
        even.chain([NON_FINITE_COLOR]).collect()
    }

    fn map(&self, values: &[f64], width: u32) -> Option<Vec<u8>> {
        let of_value = |value: &f64| match value.is_finite() {
            true => ((self.place)(*value).clamp(0.0, 1.0) * f64::from(STEPS - 1) + 0.5) as u8,
            false => STEPS,
        };
        let pixels: Vec<u8> = values.iter().map(of_value).collect();
        png_bytes_indexed(width, (pixels.len() as u32).checked_div(width)?, &self.codes(), &pixels)
    }

    fn legend(&self, title: &str) -> String {
        let steps: Vec<u8> = (0..STEPS).collect();
        let bar = image(png_bytes_indexed(STEPS.into(), 1, &self.codes(), &steps), [480, 14], "");
        let marks = self
            .marks
            .iter()
            .map(|(value, text)| format!("<span style=\"left:{:.1}%\">{text}</span>", 100.0 * (self.place)(*value)));
        format!(
            "<div class=\"scale\"><p>{}</p>{bar}<div class=\"marks\">{}</div></div>\n",
            escape(title),
            marks.collect::<String>()
        )
    }
}

/// Standard deviation of one run, per pixel, relative to the reference as relMSE is.
fn noise(spread: &Spread, ledger: &Ledger) -> Vec<f64> {
    let of_pixel = |(variance, truth): ([f64; 3], &[f32; 3])| {
        let squares = variance.iter().zip(truth).map(|(variance, truth)| {
            let truth = f64::from(*truth);
            variance / (truth * truth + REL_MSE_EPSILON)
        });
        (squares.sum::<f64>() / 3.0).sqrt()
    };
    spread.variances().zip(&ledger.reference.picture.pixels).map(of_pixel).collect()
}

/// Maps of all levels that have a picture of their own.
pub(super) fn maps(ledger: &Ledger) -> String {
    // One run does not say how far runs scatter.
    let shown: Vec<_> =
        Shown::all(&ledger.accounts).into_iter().filter(|shown| shown.account.top().runs.len() > 1).collect();
    if shown.is_empty() {
        return "<p class=\"nothing\">One run alone does not say how far runs scatter.</p>\n".to_owned();
    }
    let squared = |values: &[f64]| averaged(values, ledger.region.width(), |value| value * value, f64::sqrt);
    let figure = |shown: &Shown<'_>, bytes: Option<Vec<u8>>, size: [u32; 2], what: &str, figures: &str| {
        let name = shown.account.name();
        let image = image(bytes, size, &format!("{what} of {name}"));
        format!("<figure>{image}<figcaption><b>{}</b> {}</figcaption></figure>\n", escape(&name), escape(figures))
    };
    let noises = shown.iter().map(|shown| {
        let (values, width) = squared(&noise(&shown.account.measured.spread, ledger));
        let top = shown.account.top();
        let error = top.estimate(|run| ledger.target.error(run));
        let figures = format!(
            "{} spp in {}, {} {}{}",
            top.spp,
            duration(top.estimate(|run| run.seconds).value),
            ledger.target.metric,
            brief(error.value),
            give_or_take(&error)
        );
        let height = (values.len() as u32).checked_div(width).unwrap_or(0);
        figure(shown, NOISE.map(&values, width), [width, height], "Map of the noise", &figures)
    });
    let deviations = shown.iter().map(|shown| {
        let all: Vec<f64> = shown.account.measured.spread.deviations(&ledger.reference).collect();
        let beyond = all.iter().filter(|deviation| **deviation > 3.3).count() as f64 / all.len().max(1) as f64;
        let (values, width) = squared(&all);
        let biased = if shown.account.is_biased() { ", biased" } else { "" };
        let figures = format!("{} % of the pixels beyond 3.3{biased}", brief(100.0 * beyond));
        let height = (values.len() as u32).checked_div(width).unwrap_or(0);
        figure(shown, DEVIATION.map(&values, width), [width, height], "Map of the systematic error", &figures)
    });
    let (noises, deviations): (String, String) = (noises.collect(), deviations.collect());
    format!(
        "<h3>Noise: how far one run is off by chance</h3>\n<p class=\"caption\">A pixel's standard deviation over runs, relative to \
         the reference as relMSE is. Levels differ in samples and in time, which stand below.</p>\n{}<div class=\"tiles\">\n{noises}\
         </div>\n<h3>Bias: how far all runs together are off, in standard errors</h3>\n<p class=\"caption\">Dark grey all over is \
         chance alone, about 1 everywhere; with few runs, a few pixels in a hundred pass 3.3 by chance, too. What stands out as a \
         shape is an error that no number of samples takes away, against what the scene asks for: more bounces than that show as \
         well as less. Pixels that are not finite are cyan.</p>\n{}<div class=\"tiles\">\n{deviations}</div>\n",
        NOISE.legend("standard deviation of one run, relative to the reference"),
        DEVIATION.legend("distance from the reference, in standard errors"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_even_where_they_should_be_and_clamp() {
        for (value, place) in [(0.0, 0.0), (1e-3, 0.0), (0.1, 2.0 / 3.0), (7.0, 1.0), (f64::INFINITY, 1.0)] {
            assert!(((NOISE.place)(value) - place).abs() < 1e-12, "{value}");
        }
        for (value, place) in [(0.0, 0.0), (0.5, 0.15), (1.0, 0.3), (3.3, 0.65), (10.0, 1.0), (1e9, 1.0)] {
            assert!(((DEVIATION.place)(value) - place).abs() < 1e-12, "{value}");
        }
        let light = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        for scale in [NOISE, DEVIATION] {
            let codes = scale.codes();
            assert_eq!(codes.len(), usize::from(STEPS) + 1);
            let steps = &codes[..usize::from(STEPS)];
            assert!(steps.windows(2).all(|pair| light(pair[1]) > light(pair[0]) - 1.0), "{steps:?}");
        }
    }

    #[test]
    fn large_maps_are_averaged() {
        let values: Vec<f64> = (0..513 * 4).map(|at| if at % 513 == 0 { 3.0 } else { 0.0 }).collect();
        let (means, width) = averaged(&values, 513, |value| value * value, f64::sqrt);
        assert_eq!((width, means.len()), (171, 342));
        assert!((means[0] - 3.0f64.sqrt()).abs() < 1e-12 && means[1] == 0.0);
        assert_eq!(averaged(&[1.0, 2.0], 2, |value| value, |mean| mean), (vec![1.0, 2.0], 2));
        assert!(averaged(&[], 0, |value| value, |mean| mean).0.is_empty());
    }
}
