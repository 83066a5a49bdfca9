//! The two fields of a picture, its even rows and its odd ones, each of which decides when the other one has enough.
//!
//! Where the samples of a picture decide when it is done, its mean comes out a little wrong: as long as rare bright samples
//! have not come yet, the picture looks finished, and just then it ends. Fields make every pixel's mean exact. Both are
//! rendered side by side and looked at, at numbers of samples that are fixed before. The number N of a field is that of the
//! first look at which the samples of the *other* field promise the error. Numbers of different pixels are independent, so
//! N is independent of all samples of the field itself, and the mean m(N) of one of its pixels is expected to be
//! `sum over n of P(N = n) E[m(n)]`, where each m(n), of a fixed number of samples, is expected to be exact.
//!
//! For that, a field that has its number is rendered on as long as the other one waits for it: it must be able to promise
//! at each look, whatever its own number is. Those samples do nothing but decide, and are thrown away. Were they kept, the
//! field's number would be the larger of both, and the other one's hangs on its own samples.
//!
//! What is told of the picture's error is made of its own samples, which decide nothing: where light is rare, or the picture
//! small, it may turn out to be above what the other field promised. And where `--time` ends the picture, the clock decides,
//! which hangs a little on how long its own paths took.

use crate::diff::Metric;
use crate::film::{Film, Region};
use crate::promise::{Outlook, Target};

/// The fields of a picture on its way: even rows of the film, and odd ones.
#[derive(Debug, Default)]
pub(crate) struct Fields {
    ended: [Option<Ended>; 2],
}

/// A field that has enough.
#[derive(Debug)]
struct Ended {
    /// Samples of each pixel.
    spp: u32,
    /// Its rows.
    halves: [Film; 2],
}

impl Fields {
    /// Looks at a picture that has `spp` samples in two halves; the worse outlook of its fields. `None` where a pixel has
    /// too few samples.
    pub(crate) fn look(&mut self, spp: u32, halves: &[Film; 2], target: Target) -> Option<Outlook> {
        let fields = [0, 1].map(|parity| halves.each_ref().map(|half| rows(half, parity)));
        let outlook = |field| Outlook::of(field, target.metric);
        let [even, odd] = [outlook(&fields[0]), outlook(&fields[1])];
        for ((ended, halves), other) in self.ended.iter_mut().zip(fields).zip([odd, even]) {
            if ended.is_none() && other.is_some_and(|other| other.most <= target.value) {
                *ended = Some(Ended { spp, halves });
            }
        }
        even.zip(odd).map(|(even, odd)| if even.most > odd.most { even } else { odd })
    }

    /// Whether both have enough.
    pub(crate) fn are_done(&self) -> bool {
        self.ended.iter().all(Option::is_some)
    }

    /// The number of samples of each field in a picture that has `spp`.
    pub(crate) fn spp(&self, spp: u32) -> [u32; 2] {
        self.ended.each_ref().map(|ended| ended.as_ref().map_or(spp, |ended| ended.spp))
    }

    /// Takes those samples away that only decided, and says what the error of the picture is.
    pub(crate) fn finish(&self, halves: &mut [Film; 2], metric: Metric) -> Option<Outlook> {
        for (parity, ended) in self.ended.iter().enumerate() {
            let Some(ended) = ended else { continue };
            for (film, rows) in halves.iter_mut().zip(&ended.halves) {
                put_back(film, rows, parity as u32);
            }
        }
        Outlook::of(halves, metric)
    }
}

/// Which rows of a region are even rows of the film, or odd ones, counted from its first.
fn rows_of(region: Region, parity: u32) -> impl Iterator<Item = usize> {
    (region.y0..region.y1).filter(move |y| y % 2 == parity).map(move |y| (y - region.y0) as usize)
}

/// Every other row of a film, as a film.
fn rows(film: &Film, parity: u32) -> Film {
    let region = film.region();
    let width = region.width() as usize;
    let count = rows_of(region, parity).count() as u32;
    let mut field = Film::new(Region { y0: 0, y1: count, ..region });
    let from = rows_of(region, parity).flat_map(|row| &film.pixels()[row * width..(row + 1) * width]);
    field.pixels.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
    field
}

/// Puts a field where it belongs.
fn put_back(film: &mut Film, field: &Film, parity: u32) {
    let region = film.region();
    let width = region.width() as usize;
    for (row, from) in rows_of(region, parity).zip(field.pixels().chunks(width)) {
        film.pixels[row * width..(row + 1) * width].copy_from_slice(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ocellus_kernel::Pixel;

    /// Made-up halves of 16 x 16 pixels from row 3 on: `noise` of even rows and of odd ones.
    fn halves(spp: u32, noise: [f32; 2]) -> [Film; 2] {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5
        };
        [(); 2].map(|()| {
            let mut film = Film::new(Region { x0: 5, y0: 3, x1: 21, y1: 19 });
            for (index, pixel) in film.pixels.iter_mut().enumerate() {
                for _ in 0..spp / 2 {
                    pixel.add([1.0 + noise[(index / 16 + 3) % 2] * next(); 3]);
                }
            }
            film
        })
    }

    const TARGET: Target = Target { metric: Metric::Rmse, value: 0.01 };

    #[test]
    fn each_field_ends_where_the_other_one_says() {
        // Even rows are noisy: odd ones wait for them, and have nothing to wait for themselves.
        let mut fields = Fields::default();
        let noise = [0.5, 0.01];
        let first = halves(16, noise);
        let outlook = fields.look(16, &first, TARGET).expect("enough samples");
        assert!(outlook.most > 0.01 && !fields.are_done());
        assert_eq!(fields.spp(16), [16, 16]);
        let second = halves(64, noise);
        fields.look(64, &second, TARGET);
        assert_eq!(fields.spp(64), [16, 64]);
        assert!(!fields.are_done());
        let mut last = halves(1024, noise);
        fields.look(1024, &last, TARGET);
        assert_eq!(fields.spp(1024), [16, 1024]);
        assert!(fields.are_done());

        // Even rows are those of the look at which they ended; the rest is as it is.
        let before = last.clone();
        let told = fields.finish(&mut last, TARGET.metric).expect("enough samples");
        for ((found, first), before) in last.iter().zip(&first).zip(&before) {
            for (row, pixels) in found.pixels().chunks(16).enumerate() {
                let expected = if (row + 3) % 2 == 0 { first } else { before };
                assert_eq!(pixels, &expected.pixels()[row * 16..(row + 1) * 16]);
            }
        }
        // The picture is noisy in the rows that odd ones thought enough for, and is known to be.
        assert!(told.expected > 0.02, "{told:?}");
    }

    #[test]
    fn what_a_field_has_is_no_matter_of_its_own_samples() {
        for own in [0.0, 0.1, 100.0] {
            let mut fields = Fields::default();
            for spp in [16, 32, 64, 128, 256] {
                fields.look(spp, &halves(spp, [own, 0.2]), TARGET);
            }
            assert_eq!(fields.spp(256)[0], 64);
        }
        // Nor whether they are finite.
        let mut fields = Fields::default();
        for spp in [16, 32, 64, 128, 256] {
            let mut halves = halves(spp, [0.1, 0.2]);
            for half in &mut halves {
                half.pixels[16] = Pixel::EMPTY;
            }
            fields.look(spp, &halves, TARGET);
        }
        assert_eq!(fields.spp(256), [64, 256]);
    }

    #[test]
    fn fields_with_too_few_samples_do_not_end() {
        let mut fields = Fields::default();
        assert_eq!(fields.look(8, &halves(8, [0.0; 2]), TARGET), None);
        assert_eq!(fields.spp(8), [8, 8]);
    }
}
