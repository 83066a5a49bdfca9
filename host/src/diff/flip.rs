//! FLIP for low-dynamic-range pictures: how different two pictures look when one flips between them.
//!
//! After Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), HPG 2020.
//!
//! A color pipeline (what the eye resolves, in a perceptual space) and a feature pipeline (edges and points) are
//! combined in each pixel. All filters are separable and run as two one-dimensional passes.

use rayon::prelude::*;

/// Pixels per degree of the paper's default: 0.7 m from a screen 0.7 m and 3840 pixels wide.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

// The paper's constants: exponent of the color difference, the knee (input, output) of its redistribution, width of
// the detected features in degrees. The exponent of the feature difference, 1/2, is a square root.
const QC: f64 = 0.7;
const PC: f64 = 0.4;
const PT: f64 = 0.95;
const FEATURE_WIDTH: f64 = 0.082;

/// Contrast sensitivity as Gaussians in space: pairs of weight a and variance parameter b.
const CSF_ACHROMATIC: [(f64, f64); 1] = [(1.0, 0.0047)];
const CSF_RED_GREEN: [(f64, f64); 1] = [(1.0, 0.0053)];
const CSF_BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];
/// The largest b, which sets the support of all three filters.
const WIDEST_B: f64 = 0.04;

/// Linear Rec.709 to XYZ under D65.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_390_799_3, 0.357_584_339_4, 0.180_480_788_4],
    [0.212_639_005_9, 0.715_168_678_8, 0.072_192_315_4],
    [0.019_330_818_7, 0.119_194_779_8, 0.950_532_152_2],
];
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_969_941_9, -1.537_383_177_6, -0.498_610_760_3],
    [-0.969_243_636_3, 1.875_967_501_5, 0.041_555_057_4],
    [0.055_630_079_7, -0.203_976_958_9, 1.056_971_514_2],
];
/// XYZ of RGB white: the row sums of [`XYZ_FROM_RGB`].
const WHITE: [f64; 3] = [0.950_455_927_1, 1.0, 1.089_057_750_7];

/// The FLIP map of two pictures of `width` times `height` linear Rec.709 pixels: 0 looks the same, 1 as different as
/// can be. Values are clamped to 0..1 first: what an 8-bit screen shows at exposure 0. NaN counts as 0.
///
/// The result is empty if the lengths do not fit the size.
pub fn flip_map(a: &[[f32; 3]], b: &[[f32; 3]], width: usize, height: usize) -> Vec<f32> {
    if !is_pair(a, b, width, height) {
        return Vec::new();
    }
    // NaN fails the comparison and becomes 0.
    let shown = |pixel: &[f32; 3]| pixel.map(|value| if value > 0.0 { f64::from(value).min(1.0) } else { 0.0 });
    let planes = |pixels: &[[f32; 3]]| Planes::of(pixels.len(), |i| shown(&pixels[i]));
    difference(&planes(a), &planes(b), width)
}

/// Whether both pictures have `width` times `height` pixels, in rows that are not empty.
pub(super) fn is_pair(a: &[[f32; 3]], b: &[[f32; 3]], width: usize, height: usize) -> bool {
    width > 0 && a.len() == b.len() && width.checked_mul(height) == Some(a.len())
}

/// The FLIP map of two pictures in rows of `width` pixels.
pub(super) fn difference(a: &Planes, b: &Planes, width: usize) -> Vec<f32> {
    let colors = [a.perceived(width), b.perceived(width)];
    let features = [a.features(width), b.features(width)];
    let worst = hyab(&hunt_lab([0.0, 1.0, 0.0]), &hunt_lab([0.0, 0.0, 1.0]));
    let worst = libm::pow(worst, QC);
    (0..a.luminance.len())
        .into_par_iter()
        .map(|i| {
            let color = redistribute(libm::pow(hyab(&colors[0][i], &colors[1][i]), QC), worst);
            let [edge_a, point_a] = features[0][i];
            let [edge_b, point_b] = features[1][i];
            let feature = f64::from((edge_a - edge_b).abs().max((point_a - point_b).abs()));
            let feature = libm::sqrt(feature / std::f64::consts::SQRT_2);
            // A feature difference amplifies the color difference.
            libm::pow(color, 1.0 - feature) as f32
        })
        .collect()
}

/// A picture in the linearised opponent space YyCxCz, without the constant offset of Yy, which every
/// normalised filter keeps.
pub(super) struct Planes {
    luminance: Vec<f32>,
    red_green: Vec<f32>,
    blue_yellow: Vec<f32>,
}

impl Planes {
    /// A picture of so many pixels; `rgb` tells what the screen shows at an index, linear and in 0..=1.
    pub(super) fn of(pixels: usize, rgb: impl Fn(usize) -> [f64; 3] + Sync) -> Self {
        let plane = || vec![0.0; pixels];
        let mut planes = Self { luminance: plane(), red_green: plane(), blue_yellow: plane() };
        let Self { luminance, red_green, blue_yellow } = &mut planes;
        let chroma = red_green.par_iter_mut().zip(blue_yellow);
        luminance.par_iter_mut().zip(chroma).enumerate().for_each(|(i, (luminance, (red_green, blue_yellow)))| {
            let [x, y, z] = relative_xyz(rgb(i));
            (*luminance, *red_green, *blue_yellow) = (y as f32, (x - y) as f32, (y - z) as f32);
        });
        planes
    }

    /// What is left after the eye's contrast sensitivity, in CIELab with Hunt's adjustment.
    fn perceived(&self, width: usize) -> Vec<[f64; 3]> {
        let luminance = sensitivity(&self.luminance, width, &CSF_ACHROMATIC);
        let red_green = sensitivity(&self.red_green, width, &CSF_RED_GREEN);
        let blue_yellow = sensitivity(&self.blue_yellow, width, &CSF_BLUE_YELLOW);
        (0..luminance.len())
            .into_par_iter()
            .map(|i| {
                let y = f64::from(luminance[i]);
                let xyz = [y + f64::from(red_green[i]), y, y - f64::from(blue_yellow[i])];
                let xyz = std::array::from_fn(|axis| xyz[axis] * WHITE[axis]);
                hunt_lab(transform(&RGB_FROM_XYZ, xyz).map(|value| value.clamp(0.0, 1.0)))
            })
            .collect()
    }

    /// Strength of edges and of points in the achromatic channel, brought to 0..1.
    fn features(&self, width: usize) -> Vec<[f32; 2]> {
        // Yy is 116 y - 16; shifted and scaled to 0..1 it is y itself.
        let y = &self.luminance;
        let [smooth, slope, curvature] = feature_filters();
        let edge = [convolve(y, width, &slope, &smooth), convolve(y, width, &smooth, &slope)];
        let point = [convolve(y, width, &curvature, &smooth), convolve(y, width, &smooth, &curvature)];
        let length = |[across, down]: &[Vec<f32>; 2], i: usize| (across[i] * across[i] + down[i] * down[i]).sqrt();
        (0..y.len()).into_par_iter().map(|i| [length(&edge, i), length(&point, i)]).collect()
    }
}

/// Convolves with a sum of Gaussians `a sqrt(pi/b) exp(-pi^2 r^2 / b)`, r in degrees, normalised as a whole.
fn sensitivity(plane: &[f32], width: usize, gaussians: &[(f64, f64)]) -> Vec<f32> {
    use std::f64::consts::PI;
    let radius = (3.0 * (WIDEST_B / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let tap = |b: f64, pixel: i32| {
        let degrees = f64::from(pixel) / PIXELS_PER_DEGREE;
        libm::exp(-PI * PI * degrees * degrees / b)
    };
    let sum = |b: f64| (-radius..=radius).map(|pixel| tap(b, pixel)).sum::<f64>();
    // The sum over the square support is the square of the sum along one axis.
    let weight = |&(a, b): &(f64, f64)| a * (PI / b).sqrt() * sum(b) * sum(b);
    let total: f64 = gaussians.iter().map(weight).sum();
    let mut result = vec![0.0; plane.len()];
    for gaussian in gaussians {
        let b = gaussian.1;
        let share = weight(gaussian) / total;
        let down: Vec<f32> = (-radius..=radius).map(|pixel| (tap(b, pixel) / sum(b)) as f32).collect();
        let across: Vec<f32> = down.iter().map(|&value| (f64::from(value) * share) as f32).collect();
        for (result, term) in result.iter_mut().zip(convolve(plane, width, &across, &down)) {
            *result += term;
        }
    }
    result
}

/// A Gaussian, its first and its second derivative. The Gaussian sums to 1; each derivative's positive weights sum to 1
/// and its negative ones to -1.
fn feature_filters() -> [Vec<f32>; 3] {
    let stdev = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * stdev).ceil() as i32;
    let normalised = |shape: &dyn Fn(f64) -> f64| -> Vec<f32> {
        let values: Vec<f64> = (-radius..=radius)
            .map(|pixel| {
                let x = f64::from(pixel) / stdev;
                shape(x) * libm::exp(-0.5 * x * x)
            })
            .collect();
        let positive: f64 = values.iter().filter(|&&value| value > 0.0).sum();
        let negative: f64 = -values.iter().filter(|&&value| value < 0.0).sum::<f64>();
        let scaled = |value: f64| match value {
            _ if value > 0.0 => value / positive,
            _ if value < 0.0 => value / negative,
            _ => 0.0,
        };
        values.iter().map(|&value| scaled(value) as f32).collect()
    };
    [normalised(&|_| 1.0), normalised(&|x| -x), normalised(&|x| x * x - 1.0)]
}

/// Convolves rows with `across`, then columns with `down`; beyond the picture its edge pixels go on.
fn convolve(plane: &[f32], width: usize, across: &[f32], down: &[f32]) -> Vec<f32> {
    let height = plane.len() / width;
    let radius = across.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each_init(
        || vec![0.0; width + 2 * radius],
        |padded, (result, row)| {
            padded[..radius].fill(row[0]);
            padded[radius..radius + width].copy_from_slice(row);
            padded[radius + width..].fill(row[width - 1]);
            for (offset, &tap) in across.iter().enumerate() {
                accumulate(result, tap, &padded[offset..offset + width]);
            }
        },
    );
    let mut result = vec![0.0; plane.len()];
    result.par_chunks_mut(width).enumerate().for_each(|(y, result)| {
        for (offset, &tap) in down.iter().enumerate() {
            let from = (y + offset).saturating_sub(down.len() / 2).min(height - 1);
            accumulate(result, tap, &rows[from * width..][..width]);
        }
    });
    result
}

fn accumulate(sum: &mut [f32], tap: f32, values: &[f32]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += tap * value;
    }
}

fn transform(matrix: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

/// XYZ as fractions of white's.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = transform(&XYZ_FROM_RGB, rgb);
    std::array::from_fn(|axis| xyz[axis] / WHITE[axis])
}

/// CIELab of linear RGB, with a and b scaled by 0.01 L: colors look weaker in the dark (Hunt).
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let [x, y, z] = relative_xyz(rgb).map(|ratio| {
        if ratio > DELTA * DELTA * DELTA { libm::cbrt(ratio) } else { ratio / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Distance for large color differences: city block in lightness, Euclidean in chroma (HyAB).
fn hyab(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let [lightness, a, b] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    lightness.abs() + (a * a + b * b).sqrt()
}

/// Maps 0..`worst` to 0..1 so that the lower part, where most differences lie, takes most of the range.
fn redistribute(difference: f64, worst: f64) -> f64 {
    let knee = PC * worst;
    if difference < knee { PT / knee * difference } else { PT + (difference - knee) / (worst - knee) * (1.0 - PT) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 32;

    fn pixels(value: impl Fn(usize, usize) -> [f32; 3]) -> Vec<[f32; 3]> {
        (0..SIDE * SIDE).map(|i| value(i % SIDE, i / SIDE)).collect()
    }

    fn mean(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let map = flip_map(a, b, SIDE, SIDE);
        map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len() as f64
    }

    /// Means by the authors' own program (`flip-evaluator` 1.7 from PyPI): `evaluate(b, a, "LDR", inputsRGB=False,
    /// applyMagma=False)` on float32 arrays of the same linear values, 67.0206 pixels per degree.
    #[test]
    fn the_authors_program_gives_the_same_means() {
        let ramp = |i: usize| i as f32 / 31.0;
        let check = |bit: usize| (bit & 1) as f32;
        let cases = [
            ("a slight tint", pixels(|_, _| [0.5; 3]), pixels(|_, _| [0.45, 0.5, 0.55]), 0.164_049),
            (
                "a gradient turned",
                pixels(|x, y| [ramp(x), ramp(y), (x + y) as f32 / 62.0]),
                pixels(|x, y| [ramp(y), ramp(x), (x + y) as f32 / 62.0]),
                0.724_725,
            ),
            (
                "an edge moved by a pixel",
                pixels(|x, _| [if x < 16 { 0.2 } else { 0.8 }; 3]),
                pixels(|x, _| [if x < 17 { 0.2 } else { 0.8 }; 3]),
                0.056_624,
            ),
            (
                "one bright pixel",
                pixels(|x, y| [if (x, y) == (10, 20) { 1.0 } else { 0.1 }; 3]),
                pixels(|_, _| [0.1; 3]),
                0.006_042,
            ),
            (
                "checks and stripes",
                pixels(|x, y| [check(x ^ y), 0.3, check(x >> 2)]),
                pixels(|_, y| [0.5, 0.3, check(y >> 2)]),
                0.413_917,
            ),
        ];
        for (name, a, b, expected) in &cases {
            let ours = mean(a, b);
            assert!((ours - expected).abs() < 1e-4, "{name}: {ours} for {expected}");
            assert!((mean(b, a) - ours).abs() < 1e-9, "{name}: the order matters");
        }
    }

    #[test]
    fn equal_pictures_give_zero_and_the_worst_pair_gives_one() {
        let a = pixels(|x, y| [x as f32 / 10.0, y as f32 / 40.0, 0.3]);
        assert_eq!(mean(&a, &a), 0.0);
        let worst = mean(&pixels(|_, _| [0.0, 1.0, 0.0]), &pixels(|_, _| [0.0, 0.0, 1.0]));
        assert!((worst - 1.0).abs() < 1e-5, "{worst}");
    }

    #[test]
    fn values_are_clamped_to_what_a_screen_shows() {
        let high = pixels(|_, _| [7.0, f32::INFINITY, 1.0]);
        let low = pixels(|_, _| [-1.0, f32::NAN, f32::NEG_INFINITY]);
        assert_eq!(mean(&high, &pixels(|_, _| [1.0; 3])), 0.0);
        assert_eq!(mean(&low, &pixels(|_, _| [0.0; 3])), 0.0);
    }

    #[test]
    fn a_picture_narrower_than_the_filters_works_and_sizes_that_lie_give_nothing() {
        for (width, height) in [(1, 1), (1, 40), (3, 2)] {
            let (a, b) = (vec![[0.5; 3]; width * height], vec![[0.25; 3]; width * height]);
            let map = flip_map(&a, &b, width, height);
            assert_eq!(map.len(), width * height);
            assert!(map.iter().all(|value| (value - map[0]).abs() < 1e-4 && *value > 0.1 && *value < 1.0));
        }
        assert!(flip_map(&[[0.0; 3]; 4], &[[0.0; 3]; 4], 3, 2).is_empty());
        assert!(flip_map(&[], &[], 0, 5).is_empty());
    }

    #[test]
    fn the_filters_are_normalised() {
        let [smooth, slope, curvature] = feature_filters();
        assert_eq!(smooth.len(), 19);
        let sums = |taps: &[f32]| {
            let sum = |sign: f32| taps.iter().map(|tap| (tap * sign).max(0.0)).sum::<f32>();
            [sum(1.0), sum(-1.0)]
        };
        for (taps, expected) in [(smooth, [1.0, 0.0]), (slope, [1.0, 1.0]), (curvature, [1.0, 1.0])] {
            let sums = sums(&taps);
            assert!((sums[0] - expected[0]).abs() < 1e-6 && (sums[1] - expected[1]).abs() < 1e-6, "{sums:?}");
        }
        for gaussians in [&CSF_ACHROMATIC[..], &CSF_BLUE_YELLOW] {
            assert!(sensitivity(&[0.7; 60], 10, gaussians).iter().all(|value| (value - 0.7).abs() < 1e-6));
        }
    }
}
