//! PNG: the picture as people look at it.

use super::atomic::write_file;
use super::check_size;
use super::tone::ToneMap;
use crate::error::Error;
use crate::picture::Picture;
use ::png::{BitDepth, ColorType, Encoder, EncodingError, Filter, ScaledFloat, SrgbRenderingIntent};
use std::path::Path;

/// How the codes of a file are to be read.
enum Curve {
    Srgb,
    Gamma(f64),
}

/// Writes `picture` as 8-bit RGB. `provenance` goes into text chunks (`tEXt`; `iTXt` where a value is not Latin-1);
/// an `sRGB` chunk, or `gAMA` for a tone map with a gamma, says how to read the codes.
///
/// # Errors
/// `CannotCreate` if the file cannot be created, `CannotWrite` if it cannot be written to its end, if the picture is
/// empty or its pixels do not match its size, or if a provenance key is not 1 to 79 Latin-1 characters.
pub fn write_png(path: &Path, picture: &Picture, tone: &ToneMap, provenance: &[(String, String)]) -> Result<(), Error> {
    check_size(path, picture.width, picture.height, picture.pixels.len())?;
    let curve = tone.gamma.map_or(Curve::Srgb, Curve::Gamma);
    let bytes = encode(picture.width, picture.height, &tone.encode_picture(picture), &curve, provenance)
        .map_err(|error| Error::cannot_write(path, error))?;
    write_file(path, &bytes)
}

/// Writes sRGB codes, row by row from the top, as they are: for maps and plots.
///
/// # Errors
/// As [`write_png`].
pub fn write_png_rgb8(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; 3]],
    provenance: &[(String, String)],
) -> Result<(), Error> {
    check_size(path, width, height, pixels.len())?;
    let bytes = encode(width, height, pixels.as_flattened(), &Curve::Srgb, provenance)
        .map_err(|error| Error::cannot_write(path, error))?;
    write_file(path, &bytes)
}

/// The bytes of the file that [`write_png`] writes, without provenance; `None` where the picture's pixels do not match its
/// size.
pub fn png_bytes(picture: &Picture, tone: &ToneMap) -> Option<Vec<u8>> {
    let curve = tone.gamma.map_or(Curve::Srgb, Curve::Gamma);
    encode(picture.width, picture.height, &tone.encode_picture(picture), &curve, &[]).ok()
}

/// The bytes of a PNG of at most 256 sRGB codes, each pixel given as an index; `None` where the pixels do not match the
/// size, or there are too many codes.
pub fn png_bytes_indexed(width: u32, height: u32, codes: &[[u8; 3]], pixels: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(codes.as_flattened().to_vec());
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    // Neighbouring indices are no neighbouring numbers.
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(pixels).ok()?;
    writer.finish().ok()?;
    Some(bytes)
}

fn encode(
    width: u32,
    height: u32,
    codes: &[u8],
    curve: &Curve,
    provenance: &[(String, String)],
) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    match curve {
        Curve::Srgb => encoder.set_source_srgb(SrgbRenderingIntent::Perceptual),
        Curve::Gamma(gamma) => encoder.set_source_gamma(gama_value(*gamma)),
    }
    for (key, value) in provenance {
        if value.chars().all(|character| u32::from(character) <= 0xFF) {
            encoder.add_text_chunk(key.clone(), value.clone())?;
        } else {
            encoder.add_itxt_chunk(key.clone(), value.clone())?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes)?;
    writer.finish()?;
    Ok(bytes)
}

/// `gAMA` holds the exponent that made the codes, times 100000, in 31 bits; 0 would be meaningless.
fn gama_value(gamma: f64) -> ScaledFloat {
    ScaledFloat::from_scaled((100_000.0 / gamma).round().clamp(1.0, f64::from(i32::MAX)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::output::scratch::Scratch;
    use std::io::Cursor;

    /// Info and codes of a file, through the decoder.
    fn decode(path: &Path) -> (::png::Info<'static>, Vec<u8>) {
        let bytes = std::fs::read(path).unwrap();
        let mut reader = ::png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut codes).unwrap();
        reader.finish().unwrap();
        (reader.info().clone(), codes)
    }

    fn small() -> Picture {
        Picture { width: 2, height: 1, pixels: vec![[1.0, 0.5, 0.0], [0.25, f32::NAN, f32::INFINITY]] }
    }

    #[test]
    fn codes_curve_and_provenance_are_in_the_file() {
        let scratch = Scratch::new();
        let path = scratch.path("a.png");
        let provenance =
            [("scene".into(), "caf\u{e9}.toml".into()), ("note".into(), "\u{3b1} lines\nand more".to_string())];
        write_png(&path, &small(), &ToneMap::default(), &provenance).unwrap();
        let (info, codes) = decode(&path);
        assert_eq!((info.width, info.height, info.color_type), (2, 1, ColorType::Rgb));
        assert_eq!(codes, [255, 188, 0, 137, 0, 255]);
        assert!(info.srgb.is_some());
        assert_eq!(info.uncompressed_latin1_text.len(), 1);
        assert_eq!(info.uncompressed_latin1_text[0].keyword, "scene");
        assert_eq!(info.uncompressed_latin1_text[0].text, "caf\u{e9}.toml");
        assert_eq!(info.utf8_text[0].keyword, "note");
        assert_eq!(info.utf8_text[0].get_text().unwrap(), "\u{3b1} lines\nand more");
    }

    #[test]
    fn a_gamma_is_written_as_gama_and_not_as_srgb() {
        let scratch = Scratch::new();
        let path = scratch.path("a.png");
        write_png(&path, &small(), &ToneMap { exposure_ev: 0.0, gamma: Some(2.2) }, &[]).unwrap();
        let (info, codes) = decode(&path);
        assert!(info.srgb.is_none());
        assert_eq!(info.gama_chunk.unwrap().into_scaled(), 45_455);
        assert_eq!(codes, [255, 186, 0, 136, 0, 255]);
    }

    #[test]
    fn bytes_in_memory_are_those_of_the_file() {
        let scratch = Scratch::new();
        let path = scratch.path("a.png");
        write_png(&path, &small(), &ToneMap::default(), &[]).unwrap();
        assert_eq!(png_bytes(&small(), &ToneMap::default()), Some(std::fs::read(&path).unwrap()));
        let bytes = png_bytes_indexed(3, 1, &[[1, 2, 3], [4, 5, 6]], &[1, 0, 1]).unwrap();
        std::fs::write(&path, bytes).unwrap();
        let mut decoder = ::png::Decoder::new(Cursor::new(std::fs::read(&path).unwrap()));
        decoder.set_transformations(::png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut codes = [0; 9];
        reader.next_frame(&mut codes).unwrap();
        assert_eq!(codes, [4, 5, 6, 1, 2, 3, 4, 5, 6]);
        assert_eq!(png_bytes_indexed(3, 1, &[[0; 3]], &[0]), None);
        assert_eq!(png_bytes(&Picture { width: 0, height: 0, pixels: vec![] }, &ToneMap::default()), None);
    }

    #[test]
    fn maps_keep_their_codes_and_the_same_input_gives_the_same_bytes() {
        let scratch = Scratch::new();
        let pixels = [[1, 2, 3], [4, 5, 6]];
        for name in ["a.png", "b.png"] {
            write_png_rgb8(&scratch.path(name), 1, 2, &pixels, &[("k".into(), "v".into())]).unwrap();
        }
        assert_eq!(decode(&scratch.path("a.png")).1, [1, 2, 3, 4, 5, 6]);
        assert_eq!(std::fs::read(scratch.path("a.png")).unwrap(), std::fs::read(scratch.path("b.png")).unwrap());
    }

    #[test]
    fn what_png_cannot_hold_is_an_error() {
        let scratch = Scratch::new();
        let path = scratch.path("a.png");
        for key in [String::new(), "k".repeat(80), "\u{3b1}".into()] {
            let error = write_png(&path, &small(), &ToneMap::default(), &[(key, "v".into())]).unwrap_err();
            assert_eq!(error.code, ExitCode::CannotWrite);
        }
        let empty = Picture { width: 0, height: 0, pixels: vec![] };
        assert_eq!(write_png(&path, &empty, &ToneMap::default(), &[]).unwrap_err().code, ExitCode::CannotWrite);
        let tall = write_png_rgb8(&path, 1, 2, &[[0; 3]], &[]).unwrap_err();
        assert_eq!(tall.code, ExitCode::CannotWrite);
        assert!(scratch.names().is_empty());
    }
}
