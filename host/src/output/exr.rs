//! EXR: the linear truth, bit for bit.

use super::atomic::write_file;
use super::check_size;
use crate::error::Error;
use crate::picture::Picture;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, SmallVec, Text, WritableImage,
};
use std::io::Cursor;
use std::path::Path;

/// Stands before every provenance key in the header, so that none can collide with an attribute of the format.
pub const ATTRIBUTE_PREFIX: &str = "ocellus:";

/// Longest attribute name that the format allows, bytes.
const LONGEST_NAME: usize = 255;

/// Writes `picture` as one part with the 32-bit float channels B, G, R, compressed without loss: every value is read
/// back with the same bits. `provenance` goes into the header as text attributes named [`ATTRIBUTE_PREFIX`] + key.
///
/// The same picture and provenance give the same bytes.
///
/// # Errors
/// `CannotCreate` if the file cannot be created, `CannotWrite` if it cannot be written to its end, if the picture is
/// empty or its pixels do not match its size, or if a provenance key is empty, too long or holds a zero byte.
pub fn write_exr(path: &Path, picture: &Picture, provenance: &[(String, String)]) -> Result<(), Error> {
    check_size(path, picture.width, picture.height, picture.pixels.len())?;
    let bytes = encode(picture, provenance).map_err(|cause| Error::cannot_write(path, cause))?;
    write_file(path, &bytes)
}

fn encode(picture: &Picture, provenance: &[(String, String)]) -> Result<Vec<u8>, String> {
    let channel = |name: &str, index: usize| {
        let samples = picture.pixels.iter().map(|pixel| pixel[index]).collect();
        AnyChannel::new(name, FlatSamples::F32(samples))
    };
    let channels = AnyChannels::sort(SmallVec::from_iter([channel("R", 0), channel("G", 1), channel("B", 2)]));
    let size = (picture.width as usize, picture.height as usize);
    // Lines in order: tiles or any order would let the encoder's threads decide how the file looks.
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut attributes = LayerAttributes::default();
    for (key, value) in provenance {
        let name = format!("{ATTRIBUTE_PREFIX}{key}");
        if key.is_empty() || name.len() > LONGEST_NAME || name.contains('\0') {
            return Err(format!("{key:?} cannot name an attribute of an EXR file"));
        }
        // The format leaves the encoding of text open; UTF-8 is what readers expect.
        let text = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
        attributes.other.insert(Text::from_slice_unchecked(name.as_bytes()), text);
    }
    let image = Image::from_layer(Layer::new(size, attributes, encoding, channels));
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or("its header came out damaged")?;
    Ok(bytes)
}

/// Orders the header's attributes by name: the encoder keeps ours in a hash map, whose order changes from run to run.
/// The header keeps its length, so offsets into the file stay right. `None` if the header cannot be followed.
fn sort_attributes(bytes: &mut [u8]) -> Option<()> {
    // Magic number and version come first, then attributes (name, 0, type, 0, length, value) until an empty name.
    const START: usize = 8;
    let text_end = |from: usize| Some(from + bytes.get(from..)?.iter().position(|&byte| byte == 0)?);
    let mut attributes = Vec::new();
    let mut at = START;
    while *bytes.get(at)? != 0 {
        let type_end = text_end(text_end(at)? + 1)?;
        let value = type_end + 5;
        let length = u32::from_le_bytes(bytes.get(type_end + 1..value)?.try_into().ok()?);
        let end = value.checked_add(length as usize)?;
        attributes.push(bytes.get(at..end)?.to_vec());
        at = end;
    }
    attributes.sort();
    bytes[START..at].copy_from_slice(&attributes.concat());
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::input::read_picture;
    use crate::output::scratch::Scratch;
    use ::exr::prelude::MetaData;

    fn bits(picture: &Picture) -> Vec<[u32; 3]> {
        picture.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
    }

    #[test]
    fn every_float_comes_back_with_the_same_bits() {
        let special = [
            0.0,
            -0.0,
            f32::from_bits(1),
            -f32::from_bits(0x007F_FFFF),
            f32::MIN_POSITIVE,
            f32::MAX,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            f32::from_bits(0xFFC0_1234),
            1.0 / 3.0,
        ];
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from_bits(state)
        };
        // 37 rows: more than one block of 16, and a last one that is not full.
        let pixels = (0..41 * 37).map(|i| [special[i % special.len()], next(), special[(i / 7) % special.len()]]);
        let picture = Picture { width: 41, height: 37, pixels: pixels.collect() };
        let scratch = Scratch::new();
        let path = scratch.path("a.exr");
        write_exr(&path, &picture, &[]).unwrap();
        let back = read_picture(&path).unwrap();
        assert_eq!((back.width, back.height), (41, 37));
        assert_eq!(bits(&back), bits(&picture));
    }

    #[test]
    fn the_header_holds_one_part_its_channels_and_the_provenance() {
        let scratch = Scratch::new();
        let path = scratch.path("a.exr");
        let picture = Picture { width: 1, height: 2, pixels: vec![[1.0, 2.0, 3.0]; 2] };
        let provenance = [("scene", "caf\u{e9} \u{3b1}.toml"), ("seed", "7"), ("empty", "")];
        let provenance = provenance.map(|(key, value)| (key.to_string(), value.to_string()));
        write_exr(&path, &picture, &provenance).unwrap();
        let header = MetaData::read_from_file(&path, true).unwrap().headers;
        assert_eq!(header.len(), 1);
        let channels: Vec<_> = header[0].channels.list.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(channels, ["B", "G", "R"]);
        for (key, value) in &provenance {
            let name = Text::from_slice_unchecked(format!("ocellus:{key}").as_bytes());
            match &header[0].own_attributes.other[&name] {
                AttributeValue::Text(text) => assert_eq!(text.as_slice(), value.as_bytes()),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        // 32 blocks, so that the encoder's threads have an order to get wrong.
        let pixels = (0..64 * 512).map(|i| [(i * i % 1009) as f32, i as f32 / 3.0, 2.0]).collect();
        let picture = Picture { width: 64, height: 512, pixels };
        let provenance: Vec<_> = (0..12).map(|i| (format!("key{i}"), format!("value{i}"))).collect();
        let first = encode(&picture, &provenance).unwrap();
        for _ in 0..5 {
            assert!(encode(&picture, &provenance).unwrap() == first);
        }
    }

    #[test]
    fn a_key_that_is_no_attribute_name_is_an_error() {
        let scratch = Scratch::new();
        let picture = Picture { width: 1, height: 1, pixels: vec![[0.0; 3]] };
        for key in [String::new(), "k".repeat(250), "a\0b".into()] {
            let error = write_exr(&scratch.path("a.exr"), &picture, &[(key, "v".into())]).unwrap_err();
            assert_eq!(error.code, ExitCode::CannotWrite);
        }
        assert!(scratch.names().is_empty());
    }

    #[test]
    fn a_damaged_header_is_noticed() {
        assert_eq!(sort_attributes(&mut [0; 8]), None);
        assert_eq!(sort_attributes(&mut [1; 40]), None);
        let mut huge = [&[0; 8][..], b"a\0b\0", &u32::MAX.to_le_bytes(), &[0; 9]].concat();
        assert_eq!(sort_attributes(&mut huge), None);
    }
}
