//! N44. Picture files: floats keep their bits in an EXR, and codes of a PNG are the nearest there are.

use ocellus::input::read_picture;
use ocellus::output::{ToneMap, write_picture};
use ocellus::picture::Picture;

use crate::support::random::Random;
use crate::support::rays::magnitude;
use crate::support::tolerance;
use crate::support::trials::{Trials, trials};

/// Every kind of float: any bits, and -0, denormal numbers, infinities and NaN among them.
#[test]
fn floats_keep_their_bits_in_an_exr() {
    let mut random = Random::new(44);
    let (width, height) = (trials(100_000).div_ceil(300), 100);
    let special = [0, 0x8000_0000, 1, 0x807F_FFFF, 0x0080_0000, 0x7F7F_FFFF, 0x7F80_0000, 0xFF80_0000, 0x7FC0_0000];
    let mut float = || {
        let bits = random.bits();
        f32::from_bits(special.get(bits as usize % 64).copied().unwrap_or((bits >> 32) as u32))
    };
    let pixels = (0..width * height).map(|_| [float(), float(), float()]).collect();
    let picture = Picture { width, height, pixels };
    let path = std::env::temp_dir().join(format!("ocellus-floats-{}.exr", std::process::id()));
    let tone = ToneMap::new(0.0, None).expect("a tone map");
    write_picture(&path, &picture, &tone, &[]).unwrap_or_else(|error| panic!("{error}"));
    let back = read_picture(&path).unwrap_or_else(|error| panic!("{error}"));
    std::fs::remove_file(&path).expect("the picture");
    let same = Trials::of::<f32>("N44", "floats written to an EXR and read again");
    for (a, b) in picture.pixels.iter().flatten().zip(back.pixels.iter().flatten()) {
        same.holds(a.to_bits() == b.to_bits(), || format!("{a:?} {b:?}"));
    }
    same.end(100_000);
}

/// The code of a number is the nearest to its place on the sRGB curve (IEC 61966-2-1), and the number of a code has that
/// code again; what is no light is black, and what is too much of it is white.
#[test]
fn codes_of_a_png_are_the_nearest() {
    let mut random = Random::new(45);
    let tone = ToneMap::new(0.0, None).expect("a tone map");
    let place = |x: f64| 255.0 * if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 };
    let near = Trials::measured::<f32>("N44", "codes of a PNG", tolerance::CODE, "codes");
    for _ in 0..trials(100_000) {
        let x = magnitude(&mut random, -6.0, 0.0) as f32;
        let code = tone.encode(x);
        near.error((f64::from(code) - place(f64::from(x))).abs(), || format!("{x}: {code}"));
    }
    near.end(100_000);
    let ends = Trials::of::<f32>("N44", "codes of codes, and of what has none");
    for code in 0..=255u8 {
        let encoded = f64::from(code) / 255.0;
        let x = if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
        ends.holds(tone.encode(x as f32) == code, || format!("{code}"));
    }
    for (x, code) in [(f32::NAN, 0), (-1.0, 0), (f32::NEG_INFINITY, 0), (-0.0, 0), (f32::INFINITY, 255), (2.0, 255)] {
        ends.holds(tone.encode(x) == code, || format!("{x}"));
    }
    ends.end(262);
}
