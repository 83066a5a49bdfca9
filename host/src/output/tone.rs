//! Linear radiance to 8-bit codes and back.

use crate::error::Error;
use crate::picture::Picture;

/// How linear radiance becomes 8-bit codes. The default is the sRGB curve at exposure 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMap {
    /// Stops: radiance is multiplied by 2^`exposure_ev` first.
    pub exposure_ev: f64,
    /// `x^(1/gamma)` instead of the sRGB curve; 1 writes linear codes.
    pub gamma: Option<f64>,
}

impl ToneMap {
    /// A tone map from the user's numbers.
    ///
    /// # Errors
    /// A usage error if the exposure is not within 64 stops or the gamma not within 0.1 to 10, as in scene files.
    pub fn new(exposure_ev: f64, gamma: Option<f64>) -> Result<Self, Error> {
        if !(exposure_ev.abs() <= 64.0) {
            return Err(Error::usage(
                format!("the exposure {exposure_ev} is not a number of stops between -64 and 64"),
                "0 leaves the picture as it is, 1 makes it twice as bright, -1 half as bright",
            ));
        }
        if let Some(gamma) = gamma
            && !(0.1..=10.0).contains(&gamma)
        {
            return Err(Error::usage(
                format!("a gamma of {gamma} is not between 0.1 and 10"),
                "use a gamma such as 2.2, 1 for linear codes, or none for the sRGB curve",
            ));
        }
        Ok(Self { exposure_ev, gamma })
    }

    /// The 8-bit code of one linear value, rounded to nearest: 1 and above give 255; 0, negative values and NaN give 0.
    pub fn encode(&self, value: f32) -> u8 {
        self.encode_scaled(value, self.scale())
    }

    /// All pixels as RGB codes, row 0 on top.
    pub fn encode_picture(&self, picture: &Picture) -> Vec<u8> {
        let scale = self.scale();
        picture.pixels.iter().flatten().map(|&value| self.encode_scaled(value, scale)).collect()
    }

    fn scale(&self) -> f64 {
        libm::exp2(self.exposure_ev)
    }

    fn encode_scaled(&self, value: f32, scale: f64) -> u8 {
        let linear = f64::from(value) * scale;
        // NaN fails the comparison too.
        let positive = linear > 0.0;
        if !positive {
            return 0;
        }
        let encoded = match self.gamma {
            _ if linear >= 1.0 => 1.0,
            None => srgb_encode(linear),
            Some(gamma) => libm::pow(linear, 1.0 / gamma),
        };
        // The conversion truncates, hence the half.
        (encoded * 255.0 + 0.5) as u8
    }
}

/// The sRGB curve of IEC 61966-2-1, linear to encoded; both in 0..1.
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_encode`], encoded to linear; both in 0..1.
pub fn srgb_decode(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;

    const SRGB: ToneMap = ToneMap { exposure_ev: 0.0, gamma: None };

    #[test]
    fn every_code_is_a_fixed_point_of_decode_and_encode() {
        for code in 0..=255_u8 {
            assert_eq!(SRGB.encode(srgb_decode(f64::from(code) / 255.0) as f32), code);
            for gamma in [1.0, 1.8, 2.2] {
                let linear = libm::pow(f64::from(code) / 255.0, gamma) as f32;
                assert_eq!(ToneMap { exposure_ev: 0.0, gamma: Some(gamma) }.encode(linear), code, "gamma {gamma}");
            }
        }
    }

    #[test]
    fn what_is_no_radiance_is_black_and_what_is_too_bright_is_white() {
        for gamma in [None, Some(1.0), Some(2.2)] {
            let tone = ToneMap { exposure_ev: 0.0, gamma };
            for black in [0.0, -0.0, -1.0, f32::NAN, -f32::NAN, f32::NEG_INFINITY, 1e-45] {
                assert_eq!(tone.encode(black), 0, "{black}");
            }
            for white in [1.0, 1.5, f32::MAX, f32::INFINITY] {
                assert_eq!(tone.encode(white), 255, "{white}");
            }
        }
    }

    #[test]
    fn the_code_is_monotone_and_within_half_a_step() {
        for gamma in [None, Some(2.2), Some(1.0)] {
            let tone = ToneMap { exposure_ev: 0.0, gamma };
            let mut last = 0;
            for step in 0..=200_000_u32 {
                let linear = step as f32 / 200_000.0;
                let code = tone.encode(linear);
                assert!(code >= last, "{linear}");
                last = code;
                let exact = match gamma {
                    None => srgb_encode(f64::from(linear)),
                    Some(gamma) => libm::pow(f64::from(linear), 1.0 / gamma),
                };
                assert!((f64::from(code) - exact * 255.0).abs() <= 0.5 + 1e-9, "{linear}");
            }
            assert_eq!(last, 255);
        }
    }

    #[test]
    fn known_values_of_the_curve() {
        // Middle grey and the two ends of the straight part, from the standard's formulas.
        assert!((srgb_encode(0.214_041_140_5) - 0.5).abs() < 1e-9);
        assert!((srgb_decode(0.5) - 0.214_041_140_5).abs() < 1e-9);
        assert!((srgb_decode(0.040_45) - 0.003_130_804_95).abs() < 1e-9);
        assert!((srgb_encode(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(srgb_decode(1.0), 1.0);
        assert_eq!(SRGB.encode(0.5), 188);
        assert_eq!(ToneMap { exposure_ev: 0.0, gamma: Some(2.2) }.encode(0.5), 186);
        assert_eq!(ToneMap { exposure_ev: 0.0, gamma: Some(1.0) }.encode(0.5), 128);
    }

    #[test]
    fn exposure_is_in_stops() {
        let tone = ToneMap::new(1.0, Some(1.0)).unwrap();
        assert_eq!(tone.encode(0.25), 128);
        assert_eq!(ToneMap::new(-2.0, None).unwrap().encode(2.0), SRGB.encode(0.5));
        // 0 times infinity must not become a bright code.
        assert_eq!(ToneMap { exposure_ev: 5000.0, gamma: None }.encode(0.0), 0);
    }

    #[test]
    fn numbers_that_mean_nothing_are_usage_errors() {
        for (exposure, gamma) in [(f64::NAN, None), (f64::INFINITY, None), (0.0, Some(0.0)), (0.0, Some(f64::NAN))] {
            assert_eq!(ToneMap::new(exposure, gamma).unwrap_err().code, ExitCode::Usage);
        }
        assert_eq!(ToneMap::new(0.0, Some(-2.2)).unwrap_err().code, ExitCode::Usage);
    }
}
