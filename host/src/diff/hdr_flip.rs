//! HDR-FLIP: FLIP for pictures with more range than a screen shows, over all exposures that one may view them at.
//!
//! After Andersson, Nilsson, Shirley and Akenine-Möller, "Visualizing the Error in Rendered High Dynamic Range Images",
//! Eurographics 2021, short papers.
//!
//! Both pictures are exposed, tone-mapped and compared by [`super::flip`], at exposures from where the reference's
//! brightest pixel is just not blown out to where its median is as bright. Each pixel keeps its largest difference.
//! Tone mapping is not linear, so that nothing filtered at one exposure serves another: the cost is that of
//! [`Exposures::count`] FLIP maps. The eight that a room with a bright light takes are 0.85 s of one core for 512 x 512
//! pixels.

use super::flip::{Planes, difference, is_pair};
use super::metrics::is_finite;
use rayon::prelude::*;

/// The ACES filmic curve as Narkowicz fits it, `(a x^2 + b x) / (c x^2 + d x + e)`, with x scaled by 0.6 as the paper
/// takes it, so that it stands for the whole of ACES: a, b, c, d, e. It reaches 1 at x = 12.1, and 1.03 in the end.
const ACES: [f64; 5] = [2.51 * 0.36, 0.03 * 0.6, 2.43 * 0.36, 0.59 * 0.6, 0.14];

/// The tone-mapped value that the brightest pixel takes at the first exposure and the median at the last
/// (section 3 of the paper).
const TARGET: f64 = 0.85;

/// What red, green and blue give to luminance (ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The least median, 2^-23: where more than half of a picture is black, the exposures would go on for ever. The
/// authors' own program has the same bound since version 1.7.
const LEAST_MEDIAN: f64 = f32::EPSILON as f64;

/// The exposures at which pictures are compared with a reference, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first and darkest, in stops (powers of two).
    pub start: f64,
    /// The last and brightest, in stops, not below `start`.
    pub stop: f64,
    /// How many, both ends counted: 2 or more, about one for each stop, and at most 151.
    pub count: u32,
}

impl Exposures {
    /// The exposures for linear Rec.709 pixels of a reference, from its largest and its median luminance (the upper one
    /// of two medians).
    ///
    /// Pixels with NaN or infinities are left out and negative values count as 0. A reference of one luminance gives
    /// one exposure twice. So does a black one: there every difference of 2^-20 and more is large.
    pub fn of(reference: &[[f32; 3]]) -> Self {
        let [red, green, blue] = LUMINANCE;
        let luminance = |pixel: &[f32; 3]| {
            let [r, g, b] = pixel.map(|value| f64::from(value.max(0.0)));
            red * r + green * g + blue * b
        };
        let mut all: Vec<f64> = reference.iter().filter(|pixel| is_finite(pixel)).map(luminance).collect();
        let largest = all.iter().copied().fold(0.0, f64::max);
        let largest = if largest > 0.0 { largest } else { LEAST_MEDIAN };
        let middle = all.len() / 2;
        let median = if all.is_empty() { largest } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 };
        let median = median.max(LEAST_MEDIAN).min(largest);
        let target = libm::log2(exposed_to(TARGET));
        let count = libm::ceil(libm::log2(largest / median)).max(2.0) as u32;
        Self { start: target - libm::log2(largest), stop: target - libm::log2(median), count }
    }

    /// What pixels are multiplied by, exposure by exposure.
    fn factors(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / f64::from(self.count - 1);
        (0..self.count).map(move |index| libm::exp2(self.start + f64::from(index) * step))
    }
}

/// The HDR-FLIP map of a picture `a` against the reference `b`, both of `width` times `height` linear Rec.709 pixels: 0
/// looks the same at every exposure, 1 as different as can be at one of them at least.
///
/// Not symmetric: [`Exposures::of`] the reference set the range. Negative values count as 0. A pixel with a NaN or an
/// infinity in one of the pictures is black in both. The result is empty if the lengths do not fit the size.
pub fn hdr_flip_map(a: &[[f32; 3]], b: &[[f32; 3]], width: usize, height: usize) -> Vec<f32> {
    if !is_pair(a, b, width, height) {
        return Vec::new();
    }
    let mut worst = vec![0.0_f32; a.len()];
    for factor in Exposures::of(b).factors() {
        let show = |pixels: &[[f32; 3]]| {
            Planes::of(pixels.len(), |i| {
                if is_finite(&a[i]) && is_finite(&b[i]) {
                    pixels[i].map(|value| tone_map(value, factor))
                } else {
                    [0.0; 3]
                }
            })
        };
        let map = difference(&show(a), &show(b), width);
        worst.par_iter_mut().zip(map).for_each(|(worst, value)| *worst = worst.max(value));
    }
    worst
}

/// A linear value times `factor` on the [`ACES`] curve, in 0..=1.
fn tone_map(value: f32, factor: f64) -> f64 {
    let [a, b, c, d, e] = ACES;
    let x = f64::from(value.max(0.0)) * factor;
    (x * (a * x + b) / (x * (c * x + d) + e)).min(1.0)
}

/// The value that [`tone_map`] brings to `target`, which is below 1: the positive root of a quadratic.
fn exposed_to(target: f64) -> f64 {
    let [a, b, c, d, e] = ACES;
    let (a, b, c) = (a - target * c, b - target * d, -target * e);
    (-b + libm::sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 32;

    fn pixels(value: impl Fn(usize, usize) -> [f32; 3]) -> Vec<[f32; 3]> {
        (0..SIDE * SIDE).map(|i| value(i % SIDE, i / SIDE)).collect()
    }

    fn map(a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<f32> {
        hdr_flip_map(a, b, SIDE, SIDE)
    }

    fn mean(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        map(a, b).iter().map(|&value| f64::from(value)).sum::<f64>() / (SIDE * SIDE) as f64
    }

    struct Case {
        name: &'static str,
        a: Vec<[f32; 3]>,
        b: Vec<[f32; 3]>,
        /// Mean of the map of a against b, and of b against a.
        means: [f64; 2],
        exposures: Exposures,
    }

    /// Figures by the authors' own program (`flip-evaluator` 1.7 from PyPI): `evaluate(b, a, "HDR", applyMagma=False)`
    /// on float32 arrays of the same values, 67.0206 pixels per degree; the exposures are those of `b` and come from
    /// the dictionary that it returns.
    fn cases() -> [Case; 5] {
        let steep = |i: usize| {
            let ramp = i as f32 / 31.0;
            100.0 * ramp * ramp * ramp
        };
        let highlight = |value: f32| pixels(|x, y| [if (x / 4, y / 4) == (2, 5) { value } else { 0.1 }; 3]);
        let dark = |value: [f32; 3]| pixels(|x, _| if x < 20 { value } else { [10.0; 3] });
        let sparse = |value: [f32; 3]| pixels(|x, y| if (x ^ y) & 7 == 0 { value } else { [0.0; 3] });
        let stripe = |bit: usize| if bit & 1 == 1 { [1000.0, 2000.0, 1500.0] } else { [300.0; 3] };
        let case = |name, a, b, means, [start, stop]: [f64; 2], count| {
            let exposures = Exposures { start, stop, count };
            Case { name, a, b, means, exposures }
        };
        [
            case(
                "a highlight dimmed",
                highlight(20.0),
                highlight(50.0),
                [0.020_898, 0.010_966],
                [-4.560_559, 4.405_225],
                9,
            ),
            case(
                "a steep gradient turned",
                pixels(|x, y| [steep(x), steep(y), 1.0]),
                pixels(|x, y| [steep(y), steep(x), 1.0]),
                [0.819_014, 0.819_014],
                [-5.453_567, -3.001_376],
                3,
            ),
            case(
                "a tint in the dark",
                dark([0.01, 0.012, 0.011]),
                dark([0.01; 3]),
                [0.160_894, 0.162_821],
                [-2.238_631, 7.727_153],
                10,
            ),
            case(
                "mostly black",
                sparse([0.5; 3]),
                sparse([1.0, 0.25, 0.0]),
                [0.378_643, 0.377_516],
                [2.436_582, 24.083_298],
                22,
            ),
            case(
                "stripes far above white",
                pixels(|x, _| stripe(x >> 2)),
                pixels(|_, y| stripe(y >> 2)),
                [0.443_897, 0.443_898],
                [-9.690_913, -9.690_913],
                2,
            ),
        ]
    }

    #[test]
    fn the_authors_program_gives_the_same_figures() {
        for Case { name, a, b, means, exposures } in cases() {
            let ours = Exposures::of(&b);
            assert_eq!(ours.count, exposures.count, "{name}");
            assert!((ours.start - exposures.start).abs() < 1e-5, "{name}: {ours:?}");
            assert!((ours.stop - exposures.stop).abs() < 1e-5, "{name}: {ours:?}");
            for (ours, theirs) in [mean(&a, &b), mean(&b, &a)].into_iter().zip(means) {
                assert!((ours - theirs).abs() < 2e-5, "{name}: {ours} for {theirs}");
            }
        }
    }

    #[test]
    fn equal_pictures_give_zero_and_all_others_stay_in_0_to_1() {
        for Case { name, a, b, .. } in cases() {
            assert!(map(&a, &a).iter().all(|&value| value == 0.0), "{name}");
            let map = map(&a, &b);
            assert!(map.iter().all(|value| (0.0..=1.0).contains(value)), "{name}");
            assert!(map.iter().any(|&value| value > 0.0), "{name}");
        }
    }

    #[test]
    fn brighter_light_changes_nothing_but_the_exposures() {
        let Case { a, b, .. } = &cases()[1];
        let brighter = |picture: &[[f32; 3]]| picture.iter().map(|pixel| pixel.map(|v| 1024.0 * v)).collect::<Vec<_>>();
        let (before, after) = (Exposures::of(b), Exposures::of(&brighter(b)));
        assert!((before.start - after.start - 10.0).abs() < 1e-12 && before.count == after.count);
        let pairs = map(a, b).into_iter().zip(map(&brighter(a), &brighter(b)));
        assert!(pairs.into_iter().all(|(before, after)| (before - after).abs() < 1e-5));
    }

    #[test]
    fn what_is_not_finite_is_black_in_both_and_outside_the_range() {
        let Case { mut a, mut b, exposures, .. } = cases().into_iter().next().unwrap();
        (a[3][0], b[7][1], b[9][2]) = (f32::INFINITY, f32::NAN, f32::INFINITY);
        let broken = map(&a, &b);
        let ours = Exposures::of(&b);
        assert_eq!(ours.count, exposures.count);
        assert!((ours.start - exposures.start).abs() < 1e-5);
        for i in [3, 7, 9] {
            (a[i], b[i]) = ([0.0; 3], [0.0; 3]);
        }
        assert_eq!(map(&a, &b), broken);
        // Below zero is black too.
        (a[3], b[7]) = ([-5.0; 3], [-0.0, -1e30, 0.0]);
        assert_eq!(map(&a, &b), broken);
    }

    #[test]
    fn references_of_one_value_have_one_exposure_at_both_ends() {
        let target = libm::log2(exposed_to(TARGET));
        for (value, exposure) in [(4.0, target - 2.0), (1e-9, target - libm::log2(1e-9)), (0.0, target + 23.0)] {
            let exposures = Exposures::of(&[[value; 3]; 9]);
            assert_eq!(exposures.start, exposures.stop);
            assert!((exposures.start - exposure).abs() < 1e-6 && exposures.count == 2, "{exposures:?}");
        }
        let none = Exposures::of(&[[f32::NAN; 3]; 4]);
        assert_eq!(none, Exposures::of(&[]));
        let widest = Exposures::of(&[[0.0; 3], [0.0; 3], [f32::MAX; 3]]);
        assert_eq!(widest.count, 151);
        let map = hdr_flip_map(&[[0.0; 3], [1e-20; 3], [1.0; 3]], &[[0.0; 3], [0.0; 3], [f32::MAX; 3]], 3, 1);
        assert!(map.iter().all(|value| (0.0..=1.0).contains(value)), "{map:?}");
    }

    #[test]
    fn the_curve_meets_its_target_and_ends_in_white() {
        for (value, factor) in [(exposed_to(TARGET) as f32, 1.0), (1.0, exposed_to(TARGET))] {
            assert!((tone_map(value, factor) - TARGET).abs() < 1e-7);
        }
        assert_eq!((tone_map(0.0, 1e38), tone_map(f32::MAX, 1e38)), (0.0, 1.0));
        assert!(tone_map(12.0, 1.0) < 1.0 && tone_map(12.2, 1.0) == 1.0);
    }

    #[test]
    fn sizes_that_lie_give_nothing() {
        assert!(hdr_flip_map(&[[0.0; 3]; 4], &[[0.0; 3]; 4], 3, 2).is_empty());
        assert!(hdr_flip_map(&[], &[], 0, 5).is_empty());
        assert_eq!(hdr_flip_map(&[[1.0; 3]], &[[2.0; 3]], 1, 1).len(), 1);
    }
}
