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

/// The number of samples per pixel at the look after the one at `spp`, halves of equal size: about a sixth more, so
/// that the last look is not far beyond need.
pub fn next_look(spp: u32) -> u32 {
    if spp < FIRST_LOOK { FIRST_LOOK } else { spp.saturating_add(2 * (spp / 12).max(1)) }
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
        let mut spp = u32::MAX;
        for (index, (a, b)) in a.iter().zip(b).enumerate() {
            let tile = index / width / TILE * tiles_across + index % width / TILE;
            spp = spp.min(a.count().saturating_add(b.count()));
            spread(a, b, metric, |expects, strays| {
                expected[tile] += expects;
                halved[tile] += strays;
            });
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

    /// How many times as many samples the target needs, at least about: the square of an error falls as their number
    /// grows.
    pub fn shortfall(&self, target: Target) -> f64 {
        let ratio = self.most / target.value;
        if target.metric == Metric::Rmse { ratio * ratio } else { ratio }
    }
}

/// Shows, for each channel of a pixel, the squared error to expect of its mean, and how large it came out between the
/// halves; both weighed as the metric does.
///
/// Rare bright samples raise a half's mean and its variance alike. So each half's variance is weighed by the mean of the
/// other: by its own, just those would count too little.
fn spread(a: &Pixel, b: &Pixel, metric: Metric, mut see: impl FnMut(f64, f64)) {
    let [of_a, of_b] = [a, b].map(|half| (half.mean(), half.variance(), f64::from(half.count())));
    for channel in 0..3 {
        let part = |half: &([f32; 3], [f64; 3], f64)| (f64::from(half.0[channel]), half.1[channel] / half.2);
        let ((mean_a, square_a), (mean_b, square_b)) = (part(&of_a), part(&of_b));
        let [weight_a, weight_b] = [(mean_a, square_a), (mean_b, square_b)].map(|(mean, square)| match metric {
            Metric::Rmse => 1.0,
            _ => weight(mean, square),
        });
        let difference = mean_a - mean_b;
        // Of the mean of both halves: a quarter of the sum of their squared errors.
        let expects = 0.25 * (square_a * weight_b + square_b * weight_a);
        see(expects, 0.25 * difference * difference * 0.5 * (weight_a + weight_b));
    }
}

/// What relMSE divides by, inverted, of a mean that is known but for a variance: without what that adds on average, to
/// second order.
fn weight(mean: f64, variance: f64) -> f64 {
    let sum = mean * mean + REL_MSE_EPSILON;
    let bent = (3.0 * mean * mean - REL_MSE_EPSILON) / (sum * sum);
    1.0 / (sum * (1.0 + (bent * variance).max(0.0)))
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
    fn looks_grow_by_a_sixth_and_split_in_halves() {
        let mut spp = 0;
        for _ in 0..80 {
            let next = next_look(spp);
            assert!(next > spp && next % 2 == 0 && (next - spp) % 2 == 0);
            assert!(spp < FIRST_LOOK || f64::from(next) <= 1.17 * f64::from(spp) + 2.0);
            spp = next;
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
