//! How far one picture is from the reference.

use super::estimate::percentile;
use super::reference::Reference;
use crate::diff::REL_MSE_EPSILON;
use crate::picture::Picture;

/// The figures of one picture. Squared errors are without the reference's own, as far as that is known; so they can come
/// out below zero where a picture is better than the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Mean squared difference over pixels and channels, less the reference's variance.
    pub mse: f64,
    /// Mean of squared differences over the reference's squares, [`crate::diff::REL_MSE_FORMULA`]; less the same of the
    /// reference's variance.
    pub rel_mse: f64,
    /// The largest difference of a channel.
    pub largest: f64,
    /// The root mean squared difference of a pixel's channels below which 50, 95 and 99 % of the pixels are.
    pub percentiles: [f64; 3],
    /// The share that the worst thousandth of the pixels has in the mean squared difference: a thousandth if all are
    /// alike.
    pub worst_share: f64,
    /// Mean over pixels and channels.
    pub mean: f64,
    /// The same of the reference.
    pub reference_mean: f64,
}

impl Figures {
    /// Of a picture of the reference's size. Pixels that are not finite in either are left out.
    pub fn of(picture: &Picture, reference: &Reference) -> Self {
        let (mut count, mut squares, mut relative, mut largest) = (0.0, 0.0, 0.0, 0.0f64);
        let (mut noise, mut relative_noise) = (0.0, 0.0);
        let (mut mean, mut reference_mean) = (0.0, 0.0);
        let mut errors = Vec::with_capacity(picture.pixels.len());
        for ((pixel, truth), variance) in picture.pixels.iter().zip(&reference.picture.pixels).zip(&reference.variance)
        {
            if !pixel.iter().chain(truth).all(|value| value.is_finite()) {
                continue;
            }
            count += 3.0;
            let mut of_pixel = 0.0;
            for channel in 0..3 {
                let (value, truth) = (f64::from(pixel[channel]), f64::from(truth[channel]));
                let square = (value - truth) * (value - truth);
                let weight = 1.0 / (truth * truth + REL_MSE_EPSILON);
                of_pixel += square;
                relative += square * weight;
                noise += variance[channel];
                relative_noise += variance[channel] * weight;
                largest = largest.max(square);
                mean += value;
                reference_mean += truth;
            }
            squares += of_pixel;
            errors.push((of_pixel / 3.0).sqrt() as f32);
        }
        let percentiles = [0.5, 0.95, 0.99].map(|share| percentile(&mut errors, share));
        let worst: f64 =
            errors.iter().rev().take(errors.len().div_ceil(1000)).map(|&e| 3.0 * f64::from(e) * f64::from(e)).sum();
        Self {
            mse: (squares - noise) / count,
            rel_mse: (relative - relative_noise) / count,
            largest: largest.sqrt(),
            percentiles,
            // Without a difference nobody has a share in it.
            worst_share: if squares > 0.0 { worst / squares } else { 0.0 },
            mean: mean / count,
            reference_mean: reference_mean / count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::Source;
    use super::*;

    fn reference(pixels: Vec<[f32; 3]>, variance: f64) -> Reference {
        let picture = Picture { width: pixels.len() as u32, height: 1, pixels };
        let variance = vec![[variance; 3]; picture.pixels.len()];
        Reference { picture, variance, source: Source::Rendered { spp: 1, seconds: 0.0 } }
    }

    #[test]
    fn figures_by_hand() {
        let reference = reference(vec![[1.0; 3], [0.0; 3], [f32::NAN; 3]], 0.25);
        let picture = Picture { width: 3, height: 1, pixels: vec![[2.0, 1.0, 1.0], [0.0, 0.0, 2.0], [1.0; 3]] };
        let figures = Figures::of(&picture, &reference);
        assert!((figures.mse - (5.0 / 6.0 - 0.25)).abs() < 1e-12);
        let [bright, dark] = [1.01f64, 0.01].map(f64::recip);
        let expected = (bright + 4.0 * dark) / 6.0 - 0.25 * 0.5 * (bright + dark);
        assert!((figures.rel_mse - expected).abs() < 1e-9, "{figures:?}");
        assert_eq!((figures.largest, figures.mean, figures.reference_mean), (2.0, 1.0, 0.5));
        assert!((figures.worst_share - 0.8).abs() < 1e-6);
        assert!((figures.percentiles[2] - (4.0f64 / 3.0).sqrt()).abs() < 1e-6);
    }
}
