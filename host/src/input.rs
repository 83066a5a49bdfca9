//! Reading pictures back: EXR as linear floats, PNG decoded to linear.

use crate::error::{Error, Origin};
use crate::output::srgb_decode;
use crate::picture::Picture;
use ::exr::prelude::{AnyChannels, FlatSamples, Layer, MetaData, ReadChannels, ReadLayers, read};
use ::png::{BitDepth, ColorType, Decoder, Transformations};
use std::fmt;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Most pixels that are read from one file: a damaged size must not claim all memory.
const MOST_PIXELS: u64 = 1 << 28;

/// How a file stores its values, and so what was done to make them linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// Floats, taken as linear as they stand.
    Linear,
    /// Integer codes of `bits` bits on the sRGB curve.
    Srgb {
        /// Bits per channel, 8 or 16.
        bits: u8,
    },
    /// Integer codes of `bits` bits, decoded as `code^exponent` as the file's `gAMA` chunk says.
    Power {
        /// Bits per channel, 8 or 16.
        bits: u8,
        /// From code to linear, both in 0..1.
        exponent: f64,
    },
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => write!(f, "linear float"),
            Self::Srgb { bits } => write!(f, "{bits}-bit, decoded from sRGB"),
            Self::Power { bits, exponent } => write!(f, "{bits}-bit, decoded with gamma {exponent:.4}"),
        }
    }
}

/// Reads a picture file; its first bytes, not its name, tell the format.
///
/// EXR: the first part with channels R, G and B, or with Y alone as grey; half, float and integer samples, in any
/// channel order; other channels are ignored; the data window is the picture. PNG: 8 or 16 bits (fewer and palettes
/// are expanded), grey or RGB, alpha ignored, decoded from sRGB; a file with `gAMA` and no `sRGB` chunk is decoded as
/// it says, which is what [`crate::output::write_png`] writes for a gamma.
///
/// # Errors
/// `MissingInput` if the file cannot be read, `BadScene` if what it holds is no picture of these kinds.
pub fn read_picture(path: &Path) -> Result<Picture, Error> {
    read_picture_and_encoding(path).map(|(picture, _)| picture)
}

/// [`read_picture`] that also tells how the file stored its values.
///
/// # Errors
/// As [`read_picture`].
pub fn read_picture_and_encoding(path: &Path) -> Result<(Picture, Encoding), Error> {
    let bytes = std::fs::read(path).map_err(|error| Error::missing_input(path, &error, None))?;
    let decoded = match bytes.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => decode_exr(&bytes).map(|picture| (picture, Encoding::Linear)),
        [0x89, b'P', b'N', b'G', ..] => decode_png(&bytes),
        _ => Err("it is neither a PNG nor an EXR file".to_string()),
    };
    decoded.map_err(|cause| {
        let remedy = "use a PNG, or an EXR with channels R G B or Y; if it should be one, write it again";
        Error::bad_scene(Origin::file(path), format!("cannot decode the picture: {cause}"), remedy)
    })
}

fn check_size(width: u64, height: u64) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err(format!("it is {width}x{height} pixels, which is empty"));
    }
    match width.checked_mul(height) {
        Some(pixels) if pixels <= MOST_PIXELS => Ok(()),
        _ => Err(format!("it claims {width}x{height} pixels, above the limit of {MOST_PIXELS}")),
    }
}

type ExrLayer = Layer<AnyChannels<FlatSamples>>;

fn decode_exr(bytes: &[u8]) -> Result<Picture, String> {
    // The decoder asserts what a damaged file can break; on this thread (`non_parallel`) that can be caught.
    let decoded = catch_unwind(AssertUnwindSafe(|| {
        let headers =
            MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?.headers;
        for header in &headers {
            check_size(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
        }
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .map_err(|error| error.to_string())
    }));
    let image = decoded.unwrap_or_else(|_| Err("its data are damaged".into()))?;
    let layers = image.layer_data.as_slice();
    layers.iter().find_map(|layer| rgb(layer, ["R", "G", "B"])).or_else(|| layers.iter().find_map(grey)).unwrap_or_else(
        || {
            let names =
                layers.iter().flat_map(|layer| &layer.channel_data.list).map(|channel| channel.name.to_string());
            Err(format!("it has no channels R, G and B, nor Y alone, but: {}", names.collect::<Vec<_>>().join(" ")))
        },
    )
}

/// Y is the whole of a grey picture only where no chroma goes with it.
fn grey(layer: &ExrLayer) -> Option<Result<Picture, String>> {
    let chroma = layer.channel_data.list.iter().any(|channel| channel.name.eq("RY") || channel.name.eq("BY"));
    if chroma { None } else { rgb(layer, ["Y"; 3]) }
}

/// The picture of three channels by name, or `None` where the layer lacks one.
fn rgb(layer: &ExrLayer, names: [&str; 3]) -> Option<Result<Picture, String>> {
    let find = |name| layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
    let channels = [find(names[0])?, find(names[1])?, find(names[2])?];
    let (width, height) = (layer.size.width(), layer.size.height());
    if channels.iter().any(|channel| channel.sample_data.len() != width * height) {
        return Some(Err("its channels do not have one sample in each pixel".into()));
    }
    let [mut r, mut g, mut b] = channels.map(|channel| channel.sample_data.values_as_f32());
    let pixels = std::iter::from_fn(|| Some([r.next()?, g.next()?, b.next()?])).collect();
    // Both fit: their product was checked.
    Some(Ok(Picture { width: width as u32, height: height as u32, pixels }))
}

fn decode_png(bytes: &[u8]) -> Result<(Picture, Encoding), String> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(|error| error.to_string())?;
    check_size(u64::from(info.width), u64::from(info.height))?;
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let mut codes = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    let frame = reader.next_frame(&mut codes).map_err(|error| error.to_string())?;

    let (bits, bytes_per_code) = if frame.bit_depth == BitDepth::Sixteen { (16, 2) } else { (8, 1) };
    let info = reader.info();
    let exponent = match info.gama_chunk.map(|gamma| gamma.into_scaled()) {
        Some(scaled) if scaled > 0 && info.srgb.is_none() => Some(100_000.0 / f64::from(scaled)),
        _ => None,
    };
    let linear = linear_table(bits, exponent);
    let channels = frame.color_type.samples();
    let color = matches!(frame.color_type, ColorType::Rgb | ColorType::Rgba);
    let pixels = codes[..frame.buffer_size()].chunks_exact(channels * bytes_per_code).map(|pixel| {
        let value = |channel: usize| {
            let code = &pixel[channel * bytes_per_code..][..bytes_per_code];
            linear[code.iter().fold(0, |code, &byte| code << 8 | usize::from(byte))]
        };
        if color { [value(0), value(1), value(2)] } else { [value(0); 3] }
    });
    let picture = Picture { width: frame.width, height: frame.height, pixels: pixels.collect() };
    Ok((picture, exponent.map_or(Encoding::Srgb { bits }, |exponent| Encoding::Power { bits, exponent })))
}

/// The linear value of every code: `code^exponent`, or the sRGB curve where there is none.
fn linear_table(bits: u8, exponent: Option<f64>) -> Vec<f32> {
    let most = (1_u32 << bits) - 1;
    let decode = |code: u32| {
        let encoded = f64::from(code) / f64::from(most);
        exponent.map_or_else(|| srgb_decode(encoded), |exponent| libm::pow(encoded, exponent)) as f32
    };
    (0..=most).map(decode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::output::scratch::Scratch;
    use crate::output::{ToneMap, write_exr, write_png};
    use ::exr::prelude::{
        AnyChannel, Compression, Encoding as ExrEncoding, Image, LayerAttributes, SmallVec, WritableImage, f16,
    };
    use ::png::{Encoder, ScaledFloat};

    /// Gives the encoder its special chunks.
    type Extras = fn(&mut Encoder<'_, &mut Vec<u8>>);

    fn png(width: u32, kind: (ColorType, BitDepth), data: &[u8], extras: Extras) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, width, 1);
        encoder.set_color(kind.0);
        encoder.set_depth(kind.1);
        extras(&mut encoder);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        bytes
    }

    fn exr(width: usize, height: usize, compression: Compression, channels: &[(&str, FlatSamples)]) -> Vec<u8> {
        let channels = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
        let channels = AnyChannels::sort(SmallVec::from_iter(channels));
        let encoding = ExrEncoding { compression, ..ExrEncoding::UNCOMPRESSED };
        let image = Image::from_layer(Layer::new((width, height), LayerAttributes::default(), encoding, channels));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn halves(values: &[f32]) -> FlatSamples {
        FlatSamples::F16(values.iter().map(|&value| f16::from_f32(value)).collect())
    }

    fn read_bytes(bytes: &[u8]) -> Result<(Picture, Encoding), Error> {
        let scratch = Scratch::new();
        std::fs::write(scratch.path("picture"), bytes).unwrap();
        read_picture_and_encoding(&scratch.path("picture"))
    }

    #[test]
    fn png_codes_are_decoded_from_srgb_in_every_layout() {
        let linear = |code: u16, most: u16| srgb_decode(f64::from(code) / f64::from(most)) as f32;
        let (rgb, grey) = ([10_u16, 128, 255], [128; 3]);
        let cases = [
            ((ColorType::Rgb, BitDepth::Eight), &[10, 128, 255][..], rgb),
            ((ColorType::Rgba, BitDepth::Eight), &[10, 128, 255, 0], rgb),
            ((ColorType::Grayscale, BitDepth::Eight), &[128], grey),
            ((ColorType::GrayscaleAlpha, BitDepth::Eight), &[128, 3], grey),
            ((ColorType::Grayscale, BitDepth::One), &[0x80], [255; 3]),
        ];
        for (kind, data, expected) in cases {
            let (picture, encoding) = read_bytes(&png(1, kind, data, |_| {})).unwrap();
            assert_eq!(encoding, Encoding::Srgb { bits: 8 });
            assert_eq!(picture.pixels, [expected.map(|code| linear(code, 255))], "{kind:?}");
        }
        let deep = png(1, (ColorType::Rgb, BitDepth::Sixteen), &[0x12, 0x34, 0, 1, 0xFF, 0xFF], |_| {});
        let (picture, encoding) = read_bytes(&deep).unwrap();
        assert_eq!(encoding, Encoding::Srgb { bits: 16 });
        assert_eq!(picture.pixels, [[0x1234, 1, 0xFFFF].map(|code| linear(code, 0xFFFF))]);
        let palette = png(2, (ColorType::Indexed, BitDepth::Eight), &[1, 0], |encoder| {
            encoder.set_palette(vec![1, 2, 3, 10, 128, 255]);
        });
        assert_eq!(read_bytes(&palette).unwrap().0.pixels, [rgb, [1, 2, 3]].map(|p| p.map(|c| linear(c, 255))));
    }

    #[test]
    fn a_png_with_gamma_alone_is_decoded_with_it() {
        let bytes = png(1, (ColorType::Grayscale, BitDepth::Eight), &[51], |encoder| {
            encoder.set_source_gamma(ScaledFloat::from_scaled(50_000));
        });
        let (picture, encoding) = read_bytes(&bytes).unwrap();
        assert_eq!(encoding, Encoding::Power { bits: 8, exponent: 2.0 });
        assert_eq!(encoding.to_string(), "8-bit, decoded with gamma 2.0000");
        assert!((picture.pixels[0][0] - 0.04).abs() < 1e-7);
    }

    #[test]
    fn what_is_written_is_read_back_within_half_a_code() {
        let scratch = Scratch::new();
        let pixels = (0..256).map(|i| [i as f32 / 255.0, (i * i) as f32 / 65_025.0, 0.5]).collect();
        let picture = Picture { width: 16, height: 16, pixels };
        for gamma in [None, Some(1.0), Some(2.2)] {
            let tone = ToneMap { exposure_ev: 0.0, gamma };
            write_png(&scratch.path("a.png"), &picture, &tone, &[]).unwrap();
            let back = read_picture(&scratch.path("a.png")).unwrap();
            assert_eq!(tone.encode_picture(&back), tone.encode_picture(&picture), "{gamma:?}");
            for (back, original) in back.pixels.iter().flatten().zip(picture.pixels.iter().flatten()) {
                assert!((back - original).abs() < 0.006, "{gamma:?}: {back} for {original}");
            }
        }
    }

    #[test]
    fn exr_halves_in_any_order_among_other_channels() {
        for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::PIZ] {
            let channels = [
                ("Z", FlatSamples::F32(vec![9.0; 4])),
                ("R", halves(&[1.0, 65_504.0, f32::INFINITY, -0.0])),
                ("A", halves(&[0.0; 4])),
                ("B", FlatSamples::F32(vec![1e-30, 2.0, 3.0, 4.0])),
                ("G", halves(&[0.1, 0.2, 0.3, f32::NAN])),
            ];
            let (picture, encoding) = read_bytes(&exr(2, 2, compression, &channels)).unwrap();
            assert_eq!((picture.width, picture.height, encoding), (2, 2, Encoding::Linear));
            let half = |value| f16::from_f32(value).to_f32();
            assert_eq!(picture.pixels[0], [1.0, half(0.1), 1e-30]);
            assert_eq!(picture.pixels[1], [65_504.0, half(0.2), 2.0]);
            assert_eq!(picture.pixels[2], [f32::INFINITY, half(0.3), 3.0]);
            assert!(picture.pixels[3][0].is_sign_negative() && picture.pixels[3][1].is_nan());
        }
    }

    #[test]
    fn luminance_alone_is_grey_but_not_beside_chroma() {
        let y = ("Y", halves(&[0.25, 4.0]));
        let grey = exr(2, 1, Compression::ZIP16, &[y.clone(), ("A", halves(&[1.0, 1.0]))]);
        assert_eq!(read_bytes(&grey).unwrap().0.pixels, [[0.25; 3], [4.0; 3]]);
        for others in [["RY", "BY"], ["R", "G"]] {
            let channels: Vec<_> = others.iter().map(|&name| (name, halves(&[0.0, 0.0]))).collect();
            let with_y = exr(2, 1, Compression::ZIP16, &[&channels[..], std::slice::from_ref(&y)].concat());
            assert_eq!(read_bytes(&with_y).is_ok(), others == ["R", "G"]);
            let error = read_bytes(&exr(2, 1, Compression::ZIP16, &channels)).unwrap_err();
            assert_eq!(error.code, ExitCode::BadScene);
            assert!(error.cause.contains(others[0]), "{error}");
        }
    }

    #[test]
    fn what_is_missing_and_what_cannot_be_decoded_differ() {
        let scratch = Scratch::new();
        let missing = read_picture(&scratch.path("none.exr")).unwrap_err();
        assert_eq!(missing.code, ExitCode::MissingInput);
        assert!(missing.cause.contains("none.exr"));
        assert_eq!(read_picture(scratch.as_ref()).unwrap_err().code, ExitCode::MissingInput);
        for bytes in
            [&b""[..], b"JFIF", b"\x89PNG", b"\x89PNG\r\n\x1a\n", &[0x76, 0x2f, 0x31, 0x01], b"\x76\x2f\x31\x01\x02"]
        {
            let error = read_bytes(bytes).unwrap_err();
            assert_eq!(error.code, ExitCode::BadScene, "{bytes:?}");
            assert!(error.file().is_some() && !error.remedy.is_empty());
        }
    }

    #[test]
    fn a_size_beyond_all_memory_is_refused_before_it_is_taken() {
        let mut bytes = png(1, (ColorType::Rgb, BitDepth::Eight), &[0; 3], |_| {});
        bytes[16..24].copy_from_slice(&[0x7F, 0xFF, 0xFF, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF]);
        // The checksum of IHDR (17 bytes from its type on) must fit, or that would be the error.
        let crc = bytes[12..29].iter().fold(!0_u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 })
        });
        bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
        let error = read_bytes(&bytes).unwrap_err();
        assert!(error.cause.contains("limit"), "{error}");
        assert!(check_size(1 << 14, 1 << 14).is_ok());
        assert!(check_size(u64::MAX, 2).is_err());
        assert!(check_size(5, 0).is_err());
    }

    #[test]
    fn no_damage_to_a_file_panics() {
        let picture = Picture { width: 20, height: 20, pixels: (0..400).map(|i| [i as f32, 0.5, -1.0]).collect() };
        let scratch = Scratch::new();
        write_exr(&scratch.path("a.exr"), &picture, &[]).unwrap();
        write_png(&scratch.path("a.png"), &picture, &ToneMap::default(), &[]).unwrap();
        let samples: Vec<_> = (0..400).map(|i| i as f32).collect();
        let channels = ["R", "G", "B"].map(|name| (name, halves(&samples)));
        let mut files =
            vec![std::fs::read(scratch.path("a.exr")).unwrap(), std::fs::read(scratch.path("a.png")).unwrap()];
        files.extend([Compression::PIZ, Compression::RLE, Compression::B44].map(|c| exr(20, 20, c, &channels)));
        let path = scratch.path("damaged");
        let mut state = 1_u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for original in &files {
            for _ in 0..150 {
                let mut bytes = original.clone();
                for _ in 0..=next(3) {
                    let at = next(bytes.len());
                    bytes[at] = next(256) as u8;
                }
                if next(4) == 0 {
                    bytes.truncate(next(bytes.len()));
                }
                std::fs::write(&path, &bytes).unwrap();
                if let Ok(picture) = read_picture(&path) {
                    assert_eq!(picture.pixels.len() as u64, u64::from(picture.width) * u64::from(picture.height));
                }
            }
        }
    }
}
