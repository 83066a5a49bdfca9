//! The part of the picture whose pixels are kept, to be looked at.

use super::reference::Reference;
use crate::diff::REL_MSE_EPSILON;
use crate::picture::Picture;

/// The most pixels that it has across and down: the pictures of all levels at all rungs are kept at once.
const LARGEST: u32 = 96;

/// A part of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Its first column and row, counted from those of the region.
    pub corner: [u32; 2],
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl Crop {
    /// Where the reference says that noise is strongest, relative to the picture; the middle where it says nothing of
    /// noise.
    pub fn of(reference: &Reference) -> Self {
        let whole = [reference.picture.width, reference.picture.height];
        let size = whole.map(|side| side.min(LARGEST));
        let sums = Sums::of(reference);
        let middle = [0, 1].map(|axis| (whole[axis] - size[axis]) / 2);
        let mut best = (sums.within(middle, size), middle);
        // A finer search finds no other place.
        for y in (0..=whole[1] - size[1]).step_by(8) {
            for x in (0..=whole[0] - size[0]).step_by(8) {
                let noise = sums.within([x, y], size);
                // Sums of the same numbers in another order differ by rounding.
                if noise > best.0 * (1.0 + 1e-9) {
                    best = (noise, [x, y]);
                }
            }
        }
        Self { corner: best.1, size }
    }

    /// The part of a picture of the region.
    pub fn cut(&self, picture: &Picture) -> Picture {
        let [width, height] = self.size;
        let rows = (self.corner[1]..self.corner[1] + height).map(|y| (y * picture.width + self.corner[0]) as usize);
        let pixels = rows.flat_map(|start| picture.pixels[start..start + width as usize].iter().copied()).collect();
        Picture { width, height, pixels }
    }
}

/// Sums of relative noise over all pixels above and to the left.
struct Sums {
    stride: usize,
    sums: Vec<f64>,
}

impl Sums {
    fn of(reference: &Reference) -> Self {
        let (width, height) = (reference.picture.width as usize, reference.picture.height as usize);
        let stride = width + 1;
        let mut sums = vec![0.0; stride * (height + 1)];
        for y in 0..height {
            let mut row = 0.0;
            for x in 0..width {
                let at = y * width + x;
                let of_channels = reference.variance[at].iter().zip(reference.picture.pixels[at]);
                let noise = of_channels.map(|(variance, truth)| {
                    let truth = f64::from(truth);
                    (variance / (truth * truth + REL_MSE_EPSILON)).sqrt()
                });
                let noise: f64 = noise.sum();
                row += if noise.is_finite() { noise } else { 0.0 };
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
            }
        }
        Self { stride, sums }
    }

    fn within(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> f64 {
        let at = |x: u32, y: u32| self.sums[y as usize * self.stride + x as usize];
        at(x + width, y + height) - at(x, y + height) - at(x + width, y) + at(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::Source;
    use super::*;

    fn reference(width: u32, height: u32, noise: impl Fn(u32, u32) -> f64) -> Reference {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let pixels = places.clone().map(|[x, y]| [x as f32, y as f32, 0.0]).collect();
        let variance = places.map(|[x, y]| [noise(x, y); 3]).collect();
        let picture = Picture { width, height, pixels };
        Reference { picture, variance, source: Source::Rendered { spp: 1, seconds: 0.0 } }
    }

    #[test]
    fn the_crop_is_where_noise_is_or_in_the_middle() {
        assert_eq!(Crop::of(&reference(300, 200, |_, _| 0.0)), Crop { corner: [102, 52], size: [96, 96] });
        assert_eq!(Crop::of(&reference(40, 200, |_, _| 0.0)), Crop { corner: [0, 52], size: [40, 96] });
        let noisy = Crop::of(&reference(300, 200, |x, y| if x > 200 && y < 90 { f64::from(x * x) } else { 0.0 }));
        assert!(noisy.corner[0] > 190 && noisy.corner[1] < 8, "{noisy:?}");
        assert_eq!(Crop::of(&reference(100, 1, |_, _| f64::NAN)).corner, [2, 0]);
    }

    #[test]
    fn a_cut_holds_its_pixels() {
        let crop = Crop { corner: [2, 1], size: [2, 2] };
        let picture = crop.cut(&reference(5, 4, |_, _| 0.0).picture);
        assert_eq!(picture.pixels, [[2.0, 1.0, 0.0], [3.0, 1.0, 0.0], [2.0, 2.0, 0.0], [3.0, 2.0, 0.0]]);
    }
}
