//! A film in memory: the samples of a rectangle of pixels, which can be added to and merged.

use ocellus_kernel::{ImageHash, Pixel};

use crate::picture::Picture;

/// Pixels `x0 <= x < x1`, `y0 <= y < y1` of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row, from the top.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Region {
    /// All of a picture.
    pub fn whole(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }
}

/// Films that show different things cannot be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("films of different regions cannot be merged: {0:?} and {1:?}")]
pub struct RegionMismatch(pub Region, pub Region);

/// There is no memory for a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a film of {} x {} pixels needs more memory than there is", .0.width(), .0.height())]
pub struct FilmTooLarge(pub Region);

/// The pixels of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    region: Region,
    pub(crate) pixels: Vec<Pixel>,
}

/// Where a sample was not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonFinite {
    /// How many samples were not finite.
    pub samples: u64,
    /// Column and row of the first pixel that has one.
    pub first: Option<[u32; 2]>,
}

impl Film {
    /// A film without samples. Aborts without memory for it, as `Vec` does; [`Film::try_new`] does not.
    pub fn new(region: Region) -> Self {
        Self { region, pixels: vec![Pixel::EMPTY; region.width() as usize * region.height() as usize] }
    }

    /// A film without samples.
    ///
    /// # Errors
    /// [`FilmTooLarge`] where the system refuses the memory. (Systems that promise more memory than they have may
    /// break that promise later.)
    pub fn try_new(region: Region) -> Result<Self, FilmTooLarge> {
        let count = region.width() as usize * region.height() as usize;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| FilmTooLarge(region))?;
        pixels.resize(count, Pixel::EMPTY);
        Ok(Self { region, pixels })
    }

    /// What part of the picture this is.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Its pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// Adds all samples of another film: the same bits as if they had been rendered here.
    ///
    /// # Errors
    /// [`RegionMismatch`] where the other film shows another region.
    pub fn merge(&mut self, other: &Self) -> Result<(), RegionMismatch> {
        if self.region != other.region {
            return Err(RegionMismatch(self.region, other.region));
        }
        self.add(other);
        Ok(())
    }

    /// [`Film::merge`] of a film that is known to show the same region.
    pub(crate) fn add(&mut self, other: &Self) {
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            pixel.merge(other);
        }
    }

    /// The fewest and the most samples that a pixel has, finite or not.
    pub fn samples_per_pixel(&self) -> [u32; 2] {
        let counts = || self.pixels.iter().map(|pixel| pixel.count().saturating_add(pixel.non_finite()));
        [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
    }

    /// The linear picture of the means.
    pub fn picture(&self) -> Picture {
        Picture {
            width: self.region.width(),
            height: self.region.height(),
            pixels: self.pixels.iter().map(Pixel::mean).collect(),
        }
    }

    /// The hash of the picture: size and f32 means.
    pub fn image_hash(&self) -> u64 {
        let mut hash = ImageHash::new(self.region.width(), self.region.height());
        for pixel in &self.pixels {
            hash.add(pixel.mean());
        }
        hash.finish()
    }

    /// Estimated root mean square error of the picture over pixels and channels, from the spread of each pixel's
    /// samples; `None` where a pixel has fewer than two. For independent samples: those of Sobol's sequence avoid each
    /// other, and then the error is smaller than this.
    pub fn estimated_rmse(&self) -> Option<f64> {
        if self.pixels.iter().any(|pixel| pixel.count() < 2) {
            return None;
        }
        let of_pixel = |pixel: &Pixel| pixel.variance().iter().sum::<f64>() / f64::from(pixel.count());
        let sum: f64 = self.pixels.iter().map(of_pixel).sum();
        Some((sum / (3 * self.pixels.len()) as f64).sqrt())
    }

    /// The samples that were not finite.
    pub fn non_finite(&self) -> NonFinite {
        let samples = self.pixels.iter().map(|pixel| u64::from(pixel.non_finite())).sum();
        let first = self.pixels.iter().position(|pixel| pixel.non_finite() > 0).map(|index| {
            let (index, width) = (index as u32, self.region.width());
            [self.region.x0 + index % width, self.region.y0 + index / width]
        });
        NonFinite { samples, first }
    }
}
