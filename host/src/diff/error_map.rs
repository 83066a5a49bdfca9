//! Where two pictures differ, as a picture.

use super::metrics::{REL_MSE_EPSILON, is_finite};
use super::same_size;
use crate::error::Error;
use crate::output::write_png_rgb8;
use crate::picture::Picture;
use std::path::Path;

/// Relative error that is shown black, and below.
pub const LOWEST: f64 = 1e-3;
/// Relative error that is shown in the brightest color, and above.
pub const HIGHEST: f64 = 1.0;

/// The color of pixels that are not finite in one of the pictures: not on the scale, so that they stand out.
pub const NON_FINITE_COLOR: [u8; 3] = [0, 255, 255];

/// The scale from low to high, evenly spaced, as sRGB codes: black, purple, orange, yellow. Lightness (CIELab L) rises
/// by about 19 from each to the next, so that the order shows in grey and to color-blind readers too.
const SCALE: [[u8; 3]; 6] = [[0, 0, 0], [66, 20, 104], [144, 44, 114], [214, 92, 58], [248, 162, 42], [252, 236, 116]];

/// Errors of all pixels as colors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ErrorMap {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// sRGB codes, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl ErrorMap {
    /// Writes the map as PNG.
    ///
    /// # Errors
    /// As [`write_png_rgb8`].
    pub fn write_png(&self, path: &Path, provenance: &[(String, String)]) -> Result<(), Error> {
        write_png_rgb8(path, self.width, self.height, &self.pixels, provenance)
    }
}

/// The map of the relative error of `a` against the reference `b` in each pixel: the root of the pixel's relMSE,
/// `sqrt(mean((a - b)^2 / (b^2 + 0.01)))` over its channels, on a logarithmic scale from [`LOWEST`] (black) to
/// [`HIGHEST`] (yellow). Pixels that are not finite in both pictures are [`NON_FINITE_COLOR`].
///
/// # Errors
/// As [`super::compare`], except that pictures without one comparable pixel still have a map.
pub fn error_map(a: &Picture, b: &Picture) -> Result<ErrorMap, Error> {
    same_size(a, b)?;
    let pixels = a.pixels.iter().zip(&b.pixels).map(|(a, b)| pixel_color(a, b)).collect();
    Ok(ErrorMap { width: a.width, height: a.height, pixels })
}

fn pixel_color(a: &[f32; 3], b: &[f32; 3]) -> [u8; 3] {
    if !(is_finite(a) && is_finite(b)) {
        return NON_FINITE_COLOR;
    }
    let squares = a.iter().zip(b).map(|(&a, &b)| {
        let (a, b) = (f64::from(a), f64::from(b));
        (a - b) * (a - b) / (b * b + REL_MSE_EPSILON)
    });
    scale_color((squares.sum::<f64>() / 3.0).sqrt())
}

/// The color of a relative error that is not NaN.
pub fn scale_color(error: f64) -> [u8; 3] {
    let position = libm::log10(error.clamp(LOWEST, HIGHEST) / LOWEST) / libm::log10(HIGHEST / LOWEST);
    let position = position * (SCALE.len() - 1) as f64;
    let below = (position as usize).min(SCALE.len() - 2);
    let share = position - below as f64;
    std::array::from_fn(|channel| {
        let [low, high] = [SCALE[below], SCALE[below + 1]].map(|color| f64::from(color[channel]));
        (low + (high - low) * share + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::input::read_picture;
    use crate::output::scratch::Scratch;
    use crate::output::srgb_decode;

    /// CIELab lightness of sRGB codes.
    fn lightness(color: [u8; 3]) -> f64 {
        let [r, g, b] = color.map(|code| srgb_decode(f64::from(code) / 255.0));
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 0.008_856 { 116.0 * libm::cbrt(y) - 16.0 } else { 903.3 * y }
    }

    #[test]
    fn lightness_rises_evenly_along_the_scale() {
        for pair in SCALE.windows(2) {
            let step = lightness(pair[1]) - lightness(pair[0]);
            assert!((16.0..=22.0).contains(&step), "{step} from {:?} to {:?}", pair[0], pair[1]);
        }
        let colors: Vec<_> = (0..=300).map(|i| scale_color(libm::pow(10.0, f64::from(i) / 100.0 - 3.0))).collect();
        // One code of rounding is worth less than 0.4 in lightness.
        assert!(colors.windows(2).all(|pair| lightness(pair[1]) > lightness(pair[0]) - 0.4));
        assert!(!colors.contains(&NON_FINITE_COLOR));
    }

    #[test]
    fn the_ends_and_the_middle_of_the_scale() {
        for (error, color) in [(0.0, SCALE[0]), (LOWEST, SCALE[0]), (HIGHEST, SCALE[5]), (f64::INFINITY, SCALE[5])] {
            assert_eq!(scale_color(error), color);
        }
        // Three decades over five steps: the second color stands at 10^(-3 + 0.6).
        assert_eq!(scale_color(libm::pow(10.0, -2.4)), SCALE[1]);
    }

    #[test]
    fn each_pixel_shows_its_own_error() {
        let row = |pixels: [[f32; 3]; 4]| Picture { width: 4, height: 1, pixels: pixels.to_vec() };
        let a = row([[1.0; 3], [2.1; 3], [f32::NAN, 0.0, 0.0], [0.0; 3]]);
        let b = row([[1.0; 3], [2.0; 3], [0.0; 3], [5.0; 3]]);
        let map = error_map(&a, &b).unwrap();
        let second = scale_color(0.1 / 4.01_f64.sqrt());
        assert_eq!(map.pixels, [SCALE[0], second, NON_FINITE_COLOR, scale_color(5.0 / 25.01_f64.sqrt())]);
        let other = Picture { width: 2, height: 2, ..a };
        assert_eq!(error_map(&other, &b).unwrap_err().code, ExitCode::Usage);
    }

    #[test]
    fn the_map_is_written_with_its_codes() {
        let scratch = Scratch::new();
        let map = ErrorMap { width: 1, height: 2, pixels: vec![[188, 0, 255], NON_FINITE_COLOR] };
        map.write_png(&scratch.path("map.png"), &[]).unwrap();
        let back = read_picture(&scratch.path("map.png")).unwrap();
        assert_eq!(back.pixels[0], [srgb_decode(188.0 / 255.0) as f32, 0.0, 1.0]);
        assert_eq!(back.pixels[1], [0.0, 1.0, 1.0]);
    }
}
