//! The three files: OBJ, MTL and PNG, as bytes.

use crate::CatModel;
use crate::texture::Texture;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};
use std::fmt::Write;

/// The material library that `cat.obj` names.
pub(crate) const MTL: &str = "\
# The cat's coat: a diffuse texture.
newmtl cat
Kd 1 1 1
map_Kd cat.png
illum 1
";

/// Text of the OBJ file; `command` is what a reader has to type to make it again.
pub(crate) fn obj(model: &CatModel, command: &str) -> String {
    let mut text = format!(
        "# A cat: {} triangles, closed; faces +x, y up, feet at y = 0; model units.\n# Made by: {command}\n",
        model.mesh.triangles.len()
    );
    text.push_str("mtllib cat.mtl\no cat\n");
    for point in &model.mesh.positions {
        line(&mut text, "v", &point.to_array());
    }
    for coordinate in &model.unwrapping.coordinates {
        line(&mut text, "vt", coordinate);
    }
    for normal in &model.normals {
        line(&mut text, "vn", &normal.to_array());
    }
    text.push_str("usemtl cat\n");
    for (corners, coordinates) in model.mesh.triangles.iter().zip(&model.unwrapping.corners) {
        text.push('f');
        for (vertex, coordinate) in corners.iter().zip(coordinates) {
            let (vertex, coordinate) = (vertex + 1, coordinate + 1);
            // Writing to a String cannot fail.
            let _ = write!(text, " {vertex}/{coordinate}/{vertex}");
        }
        text.push('\n');
    }
    text
}

/// One line of numbers with six decimals; "-0.000000" would look like a mistake, so it never appears.
fn line(text: &mut String, keyword: &str, numbers: &[f64]) {
    text.push_str(keyword);
    for number in numbers {
        let start = text.len();
        let _ = write!(text, " {number:.6}");
        if &text[start..] == " -0.000000" {
            text.replace_range(start.., " 0.000000");
        }
    }
    text.push('\n');
}

/// Colors are rounded to this many steps per channel: half of what a byte holds, not seen in a coat, and it makes the
/// file a fifth smaller.
const COLOR_STEPS: f64 = 127.0;

/// Bytes of the PNG file: 8 bits per channel, sRGB.
pub(crate) fn png(texture: &Texture) -> Result<Vec<u8>, ImageError> {
    let quantised =
        |value: f64| (libm::floor(value.clamp(0.0, 1.0) * COLOR_STEPS + 0.5) * (255.0 / COLOR_STEPS) + 0.5) as u8;
    let bytes: Vec<u8> = texture.texels.iter().flat_map(|texel| texel.to_array().map(quantised)).collect();
    let mut file = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive);
    encoder.write_image(&bytes, texture.size as u32, texture.size as u32, ExtendedColorType::Rgb8)?;
    Ok(file)
}
