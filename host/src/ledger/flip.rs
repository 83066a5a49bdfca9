//! What an eye sees of the difference from the reference: FLIP and HDR-FLIP of the crop.
//!
//! They are taken of every run at every rung, and of whole pictures that would take longer than the runs themselves.

use crate::diff::compare;
use crate::picture::Picture;

/// Means of both maps over a crop; 0 looks the same, 1 as different as can be. NaN where no pixel is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flips {
    /// On a screen at exposure 0.
    pub flip: f64,
    /// At any exposure that the reference calls for.
    pub hdr_flip: f64,
}

impl Flips {
    /// Of a crop against the reference's.
    pub fn of(crop: &Picture, truth: &Picture) -> Self {
        compare(crop, truth).map_or(Self { flip: f64::NAN, hdr_flip: f64::NAN }, |comparison| Self {
            flip: comparison.flip,
            hdr_flip: comparison.hdr_flip,
        })
    }
}

/// Looks at the crops of one run, at the same ones once: many levels differ in time alone.
#[derive(Debug)]
pub struct Eye<'a> {
    truth: &'a Picture,
    seen: Vec<(Picture, Flips)>,
}

impl<'a> Eye<'a> {
    /// Compares with `truth`, the reference's crop.
    pub fn new(truth: &'a Picture) -> Self {
        Self { truth, seen: Vec::new() }
    }

    /// What it sees.
    pub fn look(&mut self, crop: &Picture) -> Flips {
        if let Some((_, flips)) = self.seen.iter().find(|(seen, _)| seen == crop) {
            return *flips;
        }
        let flips = Flips::of(crop, self.truth);
        self.seen.push((crop.clone(), flips));
        flips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(value: impl Fn(usize) -> f32) -> Picture {
        Picture { width: 12, height: 10, pixels: (0..120).map(|at| [value(at); 3]).collect() }
    }

    #[test]
    fn they_are_those_of_diff_and_none_where_nothing_can_be_seen() {
        let truth = picture(|at| at as f32 / 120.0);
        let crop = picture(|at| (119 - at) as f32 / 120.0);
        let expected = compare(&crop, &truth).expect("two pictures");
        let found = Flips::of(&crop, &truth);
        assert_eq!(found, Flips { flip: expected.flip, hdr_flip: expected.hdr_flip });
        assert!(found.flip > 0.1 && found.hdr_flip > 0.1, "{found:?}");
        assert_eq!(Flips::of(&truth, &truth), Flips { flip: 0.0, hdr_flip: 0.0 });
        assert!(Flips::of(&picture(|_| f32::NAN), &truth).flip.is_nan());
    }

    #[test]
    fn each_crop_is_looked_at_once() {
        let truth = picture(|at| at as f32);
        let mut eye = Eye::new(&truth);
        let [one, other] = [1.0, 2.0].map(|value| picture(|_| value));
        let found = [&one, &other, &one].map(|crop| eye.look(crop));
        assert_eq!(found, [&one, &other, &one].map(|crop| Flips::of(crop, &truth)));
        assert_eq!(eye.seen.len(), 2);
    }
}
