//! Color textures: from an image file to linear texels, and the statement that names the file.

use crate::description::TextureDescription;
use crate::error::{Error, Origin};
use crate::output::srgb_decode;
use image::{DynamicImage, ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// Decodes a PNG, JPEG, BMP or TGA file from sRGB to linear; `asked_by` is the line that names it. Alpha is ignored.
///
/// # Errors
/// `MissingInput` if the file cannot be read, `BadScene` if it cannot be decoded.
pub(super) fn load_texture(path: &Path, asked_by: Origin) -> Result<TextureDescription, Error> {
    let bytes = std::fs::read(path).map_err(|error| Error::missing_input(path, &error, Some(asked_by.clone())))?;
    let image = decode(path, &bytes).map_err(|cause| {
        let cause = format!("cannot decode the texture {}: {cause}", path.display());
        Error::bad_scene(asked_by.clone(), cause, "use a PNG, JPEG, BMP or TGA file of 8 or 16 bits per channel")
    })?;
    let (width, height) = (image.width(), image.height());
    let texels = if has_16_bits(&image) {
        let table = linear_table(u16::MAX);
        image.into_rgb16().pixels().map(|pixel| pixel.0.map(|code| table[usize::from(code)])).collect()
    } else {
        let table = linear_table(u16::from(u8::MAX));
        image.into_rgb8().pixels().map(|pixel| pixel.0.map(|code| table[usize::from(code)])).collect()
    };
    Ok(TextureDescription { origin: asked_by, file: path.to_path_buf(), width, height, texels })
}

fn decode(path: &Path, bytes: &[u8]) -> Result<DynamicImage, String> {
    // The content tells the format; a TGA file has no mark, so its name has to.
    let format =
        image::guess_format(bytes).or_else(|_| ImageFormat::from_path(path)).map_err(|error| error.to_string())?;
    let image = ImageReader::with_format(Cursor::new(bytes), format).decode().map_err(|error| error.to_string())?;
    if image.width() == 0 || image.height() == 0 { Err("it has no pixels".into()) } else { Ok(image) }
}

fn has_16_bits(image: &DynamicImage) -> bool {
    matches!(
        image,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    )
}

/// The linear value of every code up to `largest`, which is 1.
fn linear_table(largest: u16) -> Vec<f32> {
    (0..=largest).map(|code| srgb_decode(f64::from(code) / f64::from(largest)) as f32).collect()
}

/// The options before the file name in a `map_Kd` statement: their numbers of values, and the values that change
/// nothing. An empty list means that no value changes anything that is simulated.
const OPTIONS: [(&str, usize, &[f32]); 13] = [
    ("-blendu", 1, &[]),
    ("-blendv", 1, &[]),
    ("-cc", 1, &[]),
    ("-texres", 1, &[]),
    ("-boost", 1, &[]),
    ("-bm", 1, &[]),
    ("-imfchan", 1, &[]),
    ("-type", 1, &[]),
    ("-colorspace", 1, &[]),
    ("-mm", 2, &[0.0, 1.0]),
    ("-o", 3, &[0.0; 3]),
    ("-s", 3, &[1.0; 3]),
    ("-t", 3, &[0.0; 3]),
];

/// Splits what stands behind `map_Kd` into the options that are ignored though they change the look, and the file.
pub(super) fn split_options(statement: &str) -> (Vec<&'static str>, &str) {
    let mut ignored = Vec::new();
    let mut rest = statement.trim();
    while let Some((option, after)) = rest.split_once(char::is_whitespace) {
        rest = after.trim_start();
        if option.eq_ignore_ascii_case("-clamp") {
            let (value, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            if value == "on" {
                ignored.push("-clamp");
            }
            rest = after.trim_start();
            continue;
        }
        let Some(&(option, most, neutral)) = OPTIONS.iter().find(|known| known.0.eq_ignore_ascii_case(option)) else {
            return (ignored, statement_from(statement, option));
        };
        for index in 0..most {
            // Of -o, -s and -t only the first value has to be there, so what is no number ends them.
            let Some((value, after)) = rest.split_once(char::is_whitespace) else { break };
            let number = value.parse::<f32>();
            if most == 3 && number.is_err() {
                break;
            }
            if neutral.get(index).is_some_and(|&neutral| number != Ok(neutral)) && !ignored.contains(&option) {
                ignored.push(option);
            }
            rest = after.trim_start();
        }
    }
    (ignored, rest)
}

/// `statement` from `word`, a part of it, to its end.
fn statement_from<'a>(statement: &'a str, word: &str) -> &'a str {
    statement.get(word.as_ptr() as usize - statement.as_ptr() as usize..).unwrap_or("").trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::load::test_folder::TestFolder;
    use image::{ImageBuffer, Luma, Rgb, Rgba};

    fn asked_by() -> Origin {
        Origin::file(Path::new("a.mtl")).at(7)
    }

    #[test]
    fn eight_bits_are_decoded_from_srgb_with_row_0_on_top() {
        let folder = TestFolder::new();
        for name in ["a.png", "a.bmp", "a.tga"] {
            let path = folder.path(name);
            let mut image = ImageBuffer::<Rgb<u8>, _>::new(2, 3);
            image.put_pixel(1, 0, Rgb([255, 128, 10]));
            image.put_pixel(0, 2, Rgb([1, 11, 0]));
            image.save(&path).unwrap();
            let texture = load_texture(&path, asked_by()).unwrap();
            assert_eq!((texture.width, texture.height, texture.texels.len()), (2, 3, 6), "{name}");
            // The curve at 128/255 = 0.50196 by hand: ((0.50196 + 0.055) / 1.055)^2.4.
            let [r, g, b] = texture.texels[1];
            assert_eq!(r, 1.0);
            assert!((g - 0.215_860_5).abs() < 1e-6, "{g}");
            assert!((b - 10.0 / 255.0 / 12.92).abs() < 1e-8, "{b}");
            assert!((texture.texels[4][1] - 0.003_346_5).abs() < 1e-6);
            assert_eq!(texture.origin.line, 7);
        }
    }

    #[test]
    fn grey_alpha_and_sixteen_bits_are_read() {
        let folder = TestFolder::new();
        let grey = folder.path("grey.png");
        ImageBuffer::from_pixel(1, 1, Luma([255_u8])).save(&grey).unwrap();
        assert_eq!(load_texture(&grey, asked_by()).unwrap().texels, [[1.0; 3]]);
        let alpha = folder.path("alpha.png");
        ImageBuffer::from_pixel(1, 1, Rgba([255_u8, 0, 255, 0])).save(&alpha).unwrap();
        assert_eq!(load_texture(&alpha, asked_by()).unwrap().texels, [[1.0, 0.0, 1.0]]);
        let deep = folder.path("deep.png");
        ImageBuffer::from_pixel(1, 1, Rgb([1_u16, 65535, 32896])).save(&deep).unwrap();
        let [r, g, b] = load_texture(&deep, asked_by()).unwrap().texels[0];
        assert!((r - 1.0 / 65535.0 / 12.92).abs() < 1e-10);
        assert_eq!(g, 1.0);
        assert!((b - 0.215_860_5).abs() < 1e-6);
    }

    #[test]
    fn jpeg_is_read() {
        let folder = TestFolder::new();
        let path = folder.path("a.jpg");
        ImageBuffer::from_pixel(8, 8, Rgb([128_u8, 128, 128])).save(&path).unwrap();
        let texture = load_texture(&path, asked_by()).unwrap();
        assert!(texture.texels.iter().flatten().all(|value| (value - 0.2158).abs() < 0.01));
    }

    #[test]
    fn missing_and_damaged_files_are_told_apart() {
        let folder = TestFolder::new();
        let missing = load_texture(&folder.path("none.png"), asked_by()).unwrap_err();
        assert_eq!((missing.code, missing.origin), (ExitCode::MissingInput, Some(asked_by())));
        for (name, content) in
            [("a.png", &b"\x89PNG\r\n\x1a\nrest"[..]), ("a.txt", b"text"), ("a.tga", b""), ("b.png", b"")]
        {
            let damaged = load_texture(&folder.write(name, content), asked_by()).unwrap_err();
            assert_eq!((damaged.code, damaged.origin), (ExitCode::BadScene, Some(asked_by())), "{name}");
        }
    }

    #[test]
    fn options_before_the_file_are_skipped_or_named() {
        assert_eq!(split_options("a b.png"), (vec![], "a b.png"));
        assert_eq!(split_options("-s 1 1 1 -o 0 0 0 a.png"), (vec![], "a.png"));
        assert_eq!(split_options("-s 2 a b.png "), (vec!["-s"], "a b.png"));
        assert_eq!(split_options("-o .5 1 -bm 0.3 -clamp off -mm 0 1 x\\y.png"), (vec!["-o"], "x\\y.png"));
        assert_eq!(split_options("-clamp on -mm 0.1 1 a.png"), (vec!["-clamp", "-mm"], "a.png"));
        assert_eq!(split_options("-odd name.png"), (vec![], "-odd name.png"));
        assert_eq!(split_options("-bm 1"), (vec![], "1"));
        assert_eq!(split_options(""), (vec![], ""));
    }
}
