//! What independent runs of one level say pixel by pixel: their mean, how far they scatter, and whether that explains how
//! far the mean is from the reference.

use super::estimate::{Estimate, student};
use super::reference::Reference;
use crate::film::Region;
use crate::picture::Picture;

/// Sums over the pictures of independent runs.
#[derive(Clone, Debug)]
pub struct Spread {
    /// What part of the film the pictures show.
    pub region: Region,
    count: u32,
    mean: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
}

/// Systematic error: what would be left of the difference from the reference with endless samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// Mean over pixels and channels of its square; the interval is over pixels. Below zero by chance where there is none.
    pub square: Estimate,
    /// The mean of the pictures over the mean of the reference, less 1; the interval is over runs.
    pub mean: Estimate,
    /// Beyond this the mean is off for sure: half its 99.9 % interval.
    pub certain: f64,
}

impl Bias {
    /// Whether it shows: beyond what chance does once in a thousand times. (Of few pixels that hold most of the error, five
    /// standard errors are not too many; runs are few, which Student's factor knows.)
    pub fn shows(&self) -> bool {
        let by_pixels = self.square.value > 2.5 * self.square.half;
        by_pixels || self.mean.value.abs() > self.certain
    }
}

impl Spread {
    /// Of no pictures yet.
    pub fn new(region: Region) -> Self {
        let pixels = region.width() as usize * region.height() as usize;
        Self { region, count: 0, mean: vec![[0.0; 3]; pixels], squares: vec![[0.0; 3]; pixels] }
    }

    /// Adds a picture (Welford 1962).
    pub fn add(&mut self, picture: &Picture) {
        self.count += 1;
        for ((pixel, mean), squares) in picture.pixels.iter().zip(&mut self.mean).zip(&mut self.squares) {
            for channel in 0..3 {
                let value = f64::from(pixel[channel]);
                let before = value - mean[channel];
                mean[channel] += before / f64::from(self.count);
                squares[channel] += before * (value - mean[channel]);
            }
        }
    }

    /// The mean of all pictures.
    pub fn picture(&self) -> Picture {
        let pixels = self.mean.iter().map(|pixel| pixel.map(|value| value as f32)).collect();
        Picture { width: self.region.width(), height: self.region.height(), pixels }
    }

    /// Variance of one picture, per pixel and channel; NaN below two pictures.
    pub fn variances(&self) -> impl Iterator<Item = [f64; 3]> {
        let freedom = f64::from(self.count) - 1.0;
        self.squares.iter().map(move |squares| squares.map(|square| square / freedom))
    }

    /// Mean variance of one picture over pixels and channels: the mean squared error that chance alone makes.
    pub fn variance(&self) -> f64 {
        self.variances().flatten().sum::<f64>() / (3 * self.mean.len()) as f64
    }

    /// How far the mean is from the reference, in standard errors of both, as the root mean square over a pixel's channels:
    /// about 1 where there is no bias. 0 where nothing varies.
    pub fn deviations<'a>(&'a self, reference: &'a Reference) -> impl Iterator<Item = f64> + 'a {
        self.differences(reference).map(|(difference, variance)| {
            let square: f64 = difference.iter().map(|d| d * d).sum();
            let variance: f64 = variance.iter().sum();
            if variance > 0.0 { (square / variance).sqrt() } else { 0.0 }
        })
    }

    /// The difference of each pixel of the mean from the reference, and its variance.
    fn differences<'a>(&'a self, reference: &'a Reference) -> impl Iterator<Item = ([f64; 3], [f64; 3])> + 'a {
        let truths = reference.picture.pixels.iter().zip(&reference.variance);
        self.mean.iter().zip(self.variances()).zip(truths).map(move |((mean, variance), (truth, noise))| {
            let difference = std::array::from_fn(|channel| mean[channel] - f64::from(truth[channel]));
            let variance = std::array::from_fn(|channel| variance[channel] / f64::from(self.count) + noise[channel]);
            (difference, variance)
        })
    }

    /// The systematic error of `means`, the means of each picture's pixels, and of these pictures.
    pub fn bias(&self, reference: &Reference, means: impl IntoIterator<Item = f64>) -> Bias {
        let excess = self.differences(reference).map(|(difference, variance)| {
            (0..3).map(|channel| difference[channel] * difference[channel] - variance[channel]).sum::<f64>() / 3.0
        });
        let truth = reference.picture.pixels.iter().flatten().map(|value| f64::from(*value)).sum::<f64>();
        let truth = truth / (3 * self.mean.len()) as f64;
        let noise = reference.variance.iter().flatten().sum::<f64>().sqrt() / (3 * self.mean.len()) as f64;
        let mean = Estimate::of(means.into_iter().map(|mean| mean / truth - 1.0));
        // What the reference's mean may be off by, two standard errors of it, with the rest.
        let half = libm::hypot(mean.half, 1.96 * noise / truth);
        let freedom = f64::from(self.count) - 1.0;
        let certain = libm::hypot(mean.half * student(freedom, 0.999) / student(freedom, 0.95), 3.3 * noise / truth);
        let square = Estimate::of(excess.filter(|excess| excess.is_finite()));
        Bias { square, mean: Estimate { half, ..mean }, certain }
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::Source;
    use super::*;

    /// Numbers around 0 that look random, of variance 1/12.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5
        }
    }

    #[test]
    fn a_shift_is_told_from_chance() {
        let mut next = numbers();
        let region = Region::whole(40, 40);
        let mut shown = [0, 0];
        for (at, shift) in [0.0f32, 0.02].into_iter().enumerate() {
            for _ in 0..300 {
                let mut picture = |mean: f32, noise: f32| Picture {
                    width: 40,
                    height: 40,
                    pixels: (0..1600).map(|_| [0; 3].map(|_| mean + noise * next())).collect(),
                };
                let truth = picture(1.0, 0.1);
                let reference = Reference {
                    picture: truth,
                    variance: vec![[0.01 / 12.0; 3]; 1600],
                    source: Source::Rendered { spp: 1, seconds: 0.0 },
                };
                let mut spread = Spread::new(region);
                let mut means = Vec::new();
                for _ in 0..6 {
                    let run = picture(1.0 + shift, 0.5);
                    means.push(run.pixels.iter().flatten().map(|value| f64::from(*value)).sum::<f64>() / 4800.0);
                    spread.add(&run);
                }
                let bias = spread.bias(&reference, means);
                shown[at] += u32::from(bias.shows());
                assert!((spread.variance() - 0.25 / 12.0).abs() < 0.15 * 0.25 / 12.0);
                if shift > 0.0 {
                    assert!((bias.mean.value - f64::from(shift)).abs() < 0.01, "{bias:?}");
                }
            }
        }
        assert!(shown[0] <= 6 && shown[1] > 290, "{shown:?} of 300");
    }
}
