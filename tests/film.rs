//! The film: sums that no order, split or resume can change, and samples that are no numbers.

use ocellus_kernel::film::{ImageHash, Pixel};
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::Real;
use ocellus_kernel::{Everything, Work};
use proptest::prelude::*;

use crate::support::exact::{exact, to_f64};
use crate::support::in_both_precisions;
use crate::support::meshes::cube;
use crate::support::property::for_all;
use crate::support::scene::{CAMERA, OwnedScene, picture, with_view};
use crate::support::tolerance;
use crate::support::trials::Trials;

in_both_precisions!(a_resumed_picture_is_the_whole_picture, the_split_of_work_changes_no_bit, work_is_counted);

/// Samples of either sign whose magnitudes span 2^50.
fn sample() -> impl Strategy<Value = [f32; 3]> {
    let channel = || {
        (any::<u32>(), -25i32..25).prop_map(|(bits, exponent)| {
            let mantissa = f32::from_bits(0x3F80_0000 | (bits >> 9));
            let value = libm::ldexpf(mantissa, exponent);
            if bits & 1 == 0 { value } else { -value }
        })
    };
    [channel(), channel(), channel()]
}

/// Many of them, some with their opposite, so that sums cancel and their last bits show.
fn samples(most: usize) -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec((sample(), any::<bool>()), 1..most).prop_map(|samples| {
        let opposite = |(sample, twice): &([f32; 3], bool)| twice.then_some(sample.map(|x| -x));
        samples.iter().map(|(sample, _)| *sample).chain(samples.iter().skip(1).filter_map(opposite)).collect()
    })
}

fn pixel_of(samples: &[[f32; 3]]) -> Pixel {
    let mut pixel = Pixel::EMPTY;
    samples.iter().for_each(|sample| pixel.add(*sample));
    pixel
}

/// The bits that must not change; the variance may differ in its last ones.
fn bits(pixel: &Pixel) -> ([u32; 3], u32, u32) {
    (pixel.mean().map(f32::to_bits), pixel.count(), pixel.non_finite())
}

#[test]
fn order_and_split_change_no_bit() {
    let shuffled = samples(200).prop_flat_map(|samples| (Just(samples.clone()), Just(samples).prop_shuffle()));
    for_all(
        1000,
        (shuffled, prop::collection::vec(any::<prop::sample::Index>(), 0..8)),
        |((samples, shuffled), cuts)| {
            let whole = pixel_of(&samples);
            prop_assert_eq!(bits(&pixel_of(&shuffled)), bits(&whole));
            let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(shuffled.len())).collect();
            cuts.sort_unstable();
            cuts.push(shuffled.len());
            let mut parts = Vec::new();
            let mut start = 0;
            for cut in cuts {
                parts.push(pixel_of(&shuffled[start..cut]));
                start = cut;
            }
            // Merged from the left, from the right, and as a tree.
            let merge = |mut a: Pixel, b: &Pixel| {
                a.merge(b);
                a
            };
            prop_assert_eq!(bits(&parts.iter().fold(Pixel::EMPTY, merge)), bits(&whole));
            prop_assert_eq!(bits(&parts.iter().rev().fold(Pixel::EMPTY, merge)), bits(&whole));
            while parts.len() > 1 {
                parts = parts.chunks(2).map(|pair| pair.iter().fold(Pixel::EMPTY, merge)).collect();
            }
            prop_assert_eq!(bits(&parts[0]), bits(&whole));
            Ok(())
        },
    );
    Trials::passed::<f32>("N42", "sums in any order and split", 1000);
}

/// The mean is the exact sum, divided and rounded; the variance is that of the textbook within f64.
#[test]
fn means_are_exact_and_variances_right() {
    for_all(500, samples(100), |samples| {
        prop_assume!(samples.len() > 1);
        let pixel = pixel_of(&samples);
        let count = samples.len() as f64;
        for channel in 0..3 {
            let sum = samples.iter().fold(exact(0.0), |sum, sample| sum + exact(f64::from(sample[channel])));
            // Two roundings: the sum's to f64, the mean's to f32.
            let mean = to_f64(&sum) / count;
            prop_assert_eq!(pixel.mean()[channel], mean as f32);
            let square = |x: f64| x * x;
            let spread: f64 = samples.iter().map(|sample| square(f64::from(sample[channel]) - mean)).sum();
            let variance = spread / (count - 1.0);
            let squares: f64 = samples.iter().map(|sample| square(f64::from(sample[channel]))).sum();
            let error = (pixel.variance()[channel] - variance).abs();
            prop_assert!(error <= tolerance::VARIANCE * f64::EPSILON * squares, "{error} of {variance}");
        }
        Ok(())
    });
    assert_eq!(Pixel::EMPTY.mean(), [0.0; 3]);
    assert_eq!(pixel_of(&[[1.0; 3]]).variance(), [0.0; 3]);
}

/// 2^24 samples of one value: a running f32 sum would be off by 15 %.
#[test]
fn many_samples_do_not_drift() {
    let mut pixel = pixel_of(&[[0.1, 1e6, -1e-4]]);
    for _ in 0..24 {
        let other = pixel;
        pixel.merge(&other);
    }
    assert_eq!((pixel.mean(), pixel.count()), ([0.1, 1e6, -1e-4], 1 << 24));
    let mut pixel = Pixel::EMPTY;
    for i in 0..1 << 22 {
        pixel.add([if i % 4096 == 0 { 1e6 } else { 1e-4 }, 0.1, 0.3]);
    }
    // 1024 large ones and 4,193,280 small ones.
    let exact = (1024.0 * 1e6 + 4_193_280.0 * f64::from(1e-4f32)) / f64::from(1 << 22);
    assert_eq!(pixel.mean(), [exact as f32, 0.1, 0.3]);
    Trials::passed::<f32>("N41", "sums of up to 2^24 samples", 2);
}

#[test]
fn samples_that_are_no_numbers_are_counted_and_kept_out() {
    let finite = [[0.25f32, 0.5, 1.0], [3.0, 4.0, f32::MAX], [-1.0, 0.0, f32::MIN_POSITIVE]];
    let mut pixel = pixel_of(&finite);
    let clean = pixel;
    let bad = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for (i, (value, channel)) in bad.into_iter().flat_map(|value| [0, 1, 2].map(|channel| (value, channel))).enumerate()
    {
        let mut sample = [0.5; 3];
        sample[channel] = value;
        pixel.add(sample);
        assert_eq!((pixel.non_finite(), pixel.count()), (i as u32 + 1, 3));
        assert_eq!((pixel.mean(), pixel.variance()), (clean.mean(), clean.variance()));
    }
    let mut merged = clean;
    merged.merge(&pixel);
    assert_eq!((merged.non_finite(), merged.count(), merged.mean()), (12, 6, clean.mean()));
    Trials::passed::<f32>("N41", "samples that are no numbers", 12);
}

/// FNV-1a as published, over bytes put together here.
#[test]
fn the_image_hash_is_fnv_1a_of_size_and_means() {
    for_all(
        500,
        (any::<u32>(), any::<u32>(), prop::collection::vec(sample(), 0..20), any::<bool>()),
        |(w, h, mut means, zero)| {
            if zero && let Some(mean) = means.first_mut() {
                mean[1] = -0.0;
            }
            let mut hash = ImageHash::new(w, h);
            let mut bytes = [w.to_le_bytes(), h.to_le_bytes()].concat();
            for mean in &means {
                hash.add(*mean);
                // Adding 0 turns -0 into 0 and changes nothing else.
                bytes.extend(mean.iter().flat_map(|x| (x + 0.0).to_le_bytes()));
            }
            let fnv = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(1_099_511_628_211);
            prop_assert_eq!(hash.finish(), bytes.iter().fold(14_695_981_039_346_656_037, fnv));
            Ok(())
        },
    );
}

/// A hall with a lamp: paths of all lengths and worths.
fn hall<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let wall = scene.diffuse(0.6, 0.0);
    let glass = scene.glass(1.5, 1.0, [1.0; 3]);
    scene.mesh(&cube(1).map(|p| p.map(|x| 6.0 * x)).inside_out(), wall);
    scene.sphere([0.0; 3], 1.0, glass);
    scene.sphere_light([2.0, 3.0, 1.0], 0.5, 50.0);
    scene
}

fn a_resumed_picture_is_the_whole_picture<R: Real>() {
    with_view(&hall::<R>(), &CAMERA, &PathOptions::default(), |view| {
        let whole = picture::<R, Everything>(view, 0..64);
        let mut resumed = vec![Pixel::EMPTY; whole.len()];
        for samples in [0..20, 20..64] {
            for (y, row) in (0..).zip(resumed.chunks_mut(16)) {
                view.render::<Everything>(0, y, samples.clone(), row);
            }
        }
        let [first, second] = [0..20, 20..64].map(|samples| picture::<R, Everything>(view, samples));
        for (i, pixel) in whole.iter().enumerate() {
            // Continued in place: everything is equal, even the variance. Merged: all that may not differ.
            assert_eq!(*pixel, resumed[i], "pixel {i}");
            let mut merged = second[i];
            merged.merge(&first[i]);
            assert_eq!(bits(&merged), bits(pixel), "pixel {i}");
        }
        assert!(whole.iter().any(|pixel| pixel.mean()[0] > 0.0 && pixel.variance()[0] > 0.0));
    });
}

/// Pixels one by one, from right to left, in stretches: the address of a sample is all that counts.
fn the_split_of_work_changes_no_bit<R: Real>() {
    with_view(&hall::<R>(), &CAMERA, &PathOptions { seed: 1 << 40, ..PathOptions::default() }, |view| {
        let whole = picture::<R, Everything>(view, 0..8);
        for stretch in [1, 3, 5, 16] {
            for (y, row) in (0..).zip(whole.chunks(16)) {
                let mut pixels = [Pixel::EMPTY; 16];
                for start in (0..16).step_by(stretch).rev() {
                    let end = (start + stretch).min(16);
                    view.render::<Everything>(start as u32, y, 0..8, &mut pixels[start..end]);
                }
                assert_eq!(pixels, row, "row {y} in stretches of {stretch}");
            }
        }
        let other_seed = PathOptions { seed: 1 << 41, ..*view.options };
        let other = picture::<R, Everything>(&ocellus_kernel::View { options: &other_seed, ..*view }, 0..8);
        assert_ne!(whole, other, "the seed does not matter");
    });
}

fn work_is_counted<R: Real>() {
    with_view(&hall::<R>(), &CAMERA, &PathOptions::default(), |view| {
        let mut pixels = [Pixel::EMPTY; 16];
        let work = view.render::<Everything>(0, 3, 5..9, &mut pixels);
        let rays = (0..16).flat_map(|x| (5..9).map(move |sample| (x, sample)));
        let rays = rays.map(|(x, sample)| u64::from(view.sample::<Everything>(x, 3, sample).rays)).sum();
        assert_eq!(work, Work { paths: 64, rays });
        assert!(rays > 64 && pixels.iter().all(|pixel| pixel.count() == 4));
        assert_eq!(work + work, Work { paths: 128, rays: 2 * rays });
    });
}
