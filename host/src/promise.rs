//! Stopping at a promised error: what is promised, and when it is kept.
//!
//! Samples go in turn to two films of equal size. The variance within pixels says what squared error to expect of the
//! picture. How far its true error strays from that shows in the halves: a quarter of their squared difference is
//! distributed as the error of the whole is, tile by tile. The promise is kept once the expected error and so many times
//! that straying are below the target.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::diff::{Metric, REL_MSE_EPSILON};
use crate::film::Film;
use ocellus_kernel::Pixel;

/// An error to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// RMSE or relMSE.
    pub metric: Metric,
    /// Its value.
    pub value: f64,
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.metric, self.value)
    }
}

/// Samples per pixel at the first look: with fewer, a pixel's variance is hardly known.
pub const FIRST_LOOK: u32 = 16;

/// The chance that the error of a picture is above what was promised.
const RISK: f64 = 0.05;

/// Side of a tile in pixels: large enough to hold what a path's neighbours share, and small enough for many.
const TILE: usize = 8;

/// The number of samples per pixel at the look after the one at `spp`, halves of equal size: about a twelfth more, so
/// that the last look is not far beyond need.
pub fn next_look(spp: u32) -> u32 {
    if spp < FIRST_LOOK { FIRST_LOOK } else { spp.saturating_add(2 * (spp / 24).max(1)) }
}

/// What the error of a picture is expected to be, and what it is at most, but for a chance of 5 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// Expected.
    pub expected: f64,
    /// At most.
    pub most: f64,
}

impl Outlook {
    /// Of two halves with as many samples each, looked at as often as [`next_look`] says. `None` where a pixel has too
    /// few samples.
    pub fn of(halves: &[Film; 2], metric: Metric) -> Option<Self> {
        let [a, b] = halves.each_ref().map(Film::pixels);
        let width = halves[0].region().width() as usize;
        let tiles_across = width.div_ceil(TILE);
        let tiles = tiles_across * (a.len() / width.max(1)).div_ceil(TILE);
        let mut expected = vec![0.0; tiles];
        let mut halved = vec![0.0; tiles];
        let [around_a, around_b] = [a, b].map(|half| denoised(half, width));
        let mut spp = u32::MAX;
        for (index, (a, b)) in a.iter().zip(b).enumerate() {
            let tile = index / width / TILE * tiles_across + index % width / TILE;
            spp = spp.min(a.count().saturating_add(b.count()));
            for channel in 0..3 {
                let weight = |around: &[[f64; 3]]| match metric {
                    Metric::Rmse => 1.0,
                    _ => 1.0 / (around[index][channel] * around[index][channel] + REL_MSE_EPSILON),
                };
                let (weight_a, weight_b) = (weight(&around_a), weight(&around_b));
                // The mean of both halves has a quarter of the sum of their squared errors.
                expected[tile] += 0.25 * (noise(a)[channel] * weight_b + noise(b)[channel] * weight_a);
                let difference = f64::from(a.mean()[channel]) - f64::from(b.mean()[channel]);
                halved[tile] += 0.25 * difference * difference * 0.5 * (weight_a + weight_b);
            }
        }
        if spp < FIRST_LOOK {
            return None;
        }
        let values = 3.0 * a.len() as f64;
        let mean = expected.iter().sum::<f64>() / values;
        let strayed: f64 = expected.iter().zip(&halved).map(|(e, h)| (h - e) * (h - e)).sum();
        let most = mean + quantile(spp) * strayed.sqrt() / values;
        let of_metric = |square: f64| if metric == Metric::Rmse { square.sqrt() } else { square };
        Some(Self { expected: of_metric(mean), most: of_metric(most) })
    }
}

/// At how many samples per pixel the target will be met, by the last look: squared errors fall as the number of samples
/// grows. Half of what the picture may stray counts, since of rare samples more make its error surer.
pub fn foreseen(spp: u32, outlook: Outlook, target: Target) -> f64 {
    let halfway = 0.5 * (outlook.expected + outlook.most);
    let ratio = halfway / target.value;
    f64::from(spp) * if target.metric == Metric::Rmse { ratio * ratio } else { ratio }
}

/// The squared error to expect of a pixel's mean.
fn noise(pixel: &Pixel) -> [f64; 3] {
    pixel.variance().map(|variance| variance / f64::from(pixel.count().max(1)))
}

/// Means with less noise, for relMSE to divide by: each is drawn toward the mean of the five by five around it, the more
/// the less those differ beyond their noise (Lee: Digital image enhancement and noise filtering by use of local
/// statistics. IEEE PAMI 2:2, 1980).
///
/// The variance of one half is weighed by the means of the other: rare bright samples raise a half's mean and its
/// variance alike, so that by its own mean just those would count too little.
fn denoised(pixels: &[Pixel], width: usize) -> Vec<[f64; 3]> {
    let of_pixel = |pixel: &Pixel| {
        let (mean, noise) = (pixel.mean().map(f64::from), noise(pixel));
        std::array::from_fn(|channel| [mean[channel], mean[channel] * mean[channel], noise[channel]])
    };
    let values: Vec<[[f64; 3]; 3]> = pixels.iter().map(of_pixel).collect();
    let local = box_means(&values, width);
    values
        .iter()
        .zip(&local)
        .map(|(own, local)| {
            std::array::from_fn(|channel| {
                let [mean, square, noise] = local[channel];
                let differing = square - mean * mean;
                let share = if differing > noise { 1.0 - noise / differing } else { 0.0 };
                mean + share * (own[channel][0] - mean)
            })
        })
        .collect()
}

/// The mean of the five by five values around each, the nearest ones again where the picture ends.
fn box_means(values: &[[[f64; 3]; 3]], width: usize) -> Vec<[[f64; 3]; 3]> {
    let height = values.len() / width.max(1);
    let along = |from: &[[[f64; 3]; 3]], at: &dyn Fn(usize, usize, usize) -> usize| -> Vec<[[f64; 3]; 3]> {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let mean = |(x, y): (usize, usize)| {
            let mut sum = [[0.0; 3]; 3];
            for tap in 0..5 {
                let value = &from[at(x, y, tap)];
                for (sum, value) in sum.as_flattened_mut().iter_mut().zip(value.as_flattened()) {
                    *sum += 0.2 * value;
                }
            }
            sum
        };
        places.map(mean).collect()
    };
    let tap = |at: usize, tap: usize, end: usize| (at + tap).saturating_sub(2).min(end - 1);
    let rows = along(values, &|x, y, k| y * width + tap(x, k, width));
    along(&rows, &|x, y, k| tap(y, k, height) * width + x)
}

/// How many standard deviations leave the risk above. It is shared by the looks: those within a doubling of the samples
/// see nearly the same picture and count as one (Bonferroni).
fn quantile(spp: u32) -> f64 {
    let looks = 1.0 + libm::log2(f64::from(spp) / f64::from(FIRST_LOOK)).max(0.0);
    Normal::standard().inverse_cdf(1.0 - RISK / looks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Region;

    #[test]
    fn looks_grow_by_a_twelfth_and_split_in_halves() {
        let mut spp = 0;
        for _ in 0..80 {
            let next = next_look(spp);
            assert!(next > spp && next.is_multiple_of(2) && (next - spp).is_multiple_of(2));
            assert!(spp < FIRST_LOOK || f64::from(next) <= 1.09 * f64::from(spp) + 2.0);
            spp = next;
        }
    }

    #[test]
    fn what_falls_evenly_is_foreseen() {
        for (metric, spp) in [(Metric::RelMse, 800.0), (Metric::Rmse, 40_000.0)] {
            let target = Target { metric, value: 0.01 };
            assert!((foreseen(16, Outlook { expected: 0.4, most: 0.6 }, target) - spp).abs() < 1e-9);
        }
    }

    /// Made-up pictures with errors that are known: even noise, and noise that few pixels have.
    #[test]
    fn promises_are_kept() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let region = Region::whole(32, 32);
        for rare in [false, true] {
            let (mut kept, mut tight) = (0, 0);
            for _ in 0..200 {
                let mut halves = [Film::new(region), Film::new(region)];
                for half in &mut halves {
                    for (index, pixel) in half.pixels.iter_mut().enumerate() {
                        for _ in 0..32 {
                            let bright = rare && index % 7 == 0 && next() < 0.05;
                            let value = if bright { 10.0 } else { 0.5 + next() };
                            pixel.add([value as f32; 3]);
                        }
                    }
                }
                let outlook = Outlook::of(&halves, Metric::Rmse).expect("enough samples");
                let squares = halves[0].pixels().iter().zip(halves[1].pixels()).enumerate().map(|(index, (a, b))| {
                    let truth = if rare && index % 7 == 0 { 0.05 * 10.0 + 0.95 } else { 1.0 };
                    let mean = 0.5 * (f64::from(a.mean()[0]) + f64::from(b.mean()[0]));
                    (mean - truth) * (mean - truth)
                });
                let rmse = (squares.sum::<f64>() / 1024.0).sqrt();
                kept += u32::from(rmse <= outlook.most);
                tight += u32::from(outlook.most < 1.3 * outlook.expected);
            }
            assert!(kept >= 186 && tight >= 190, "{kept} kept and {tight} tight of 200");
        }
    }
}
