//! An MTL file's text, checked and put into the form that tobj reads, with the line of each key.
//!
//! tobj 4 panics where a color has fewer than three numbers, and its errors carry no line. So each statement that
//! matters is checked here and handed on in plain form; the others are left out.

use crate::error::Origin;
use crate::load::obj_lines::{Fault, key_and_rest, statements, without_comment};
use std::fmt::Write;

/// What stands behind a key.
#[derive(Clone, Copy)]
enum Value {
    Name,
    /// One number (grey) or three.
    Color,
    Number,
    /// An illumination model.
    Model,
    /// Kept only to say that it is ignored.
    Ignored,
    /// As `Ignored`, but without effect where its number is 0.
    IgnoredUnlessZero,
}

/// All keys that are looked at, in the spelling that tobj knows; letter case does not matter in a file.
const KEYS: [(&str, Value); 24] = [
    ("newmtl", Value::Name),
    ("illum", Value::Model),
    ("Kd", Value::Color),
    ("Ks", Value::Color),
    ("Ke", Value::Color),
    ("Tf", Value::Color),
    ("Ni", Value::Number),
    ("d", Value::Number),
    ("Tr", Value::Number),
    ("map_Kd", Value::Name),
    ("map_Ks", Value::Ignored),
    ("map_Ke", Value::Ignored),
    ("map_d", Value::Ignored),
    ("map_Bump", Value::Ignored),
    ("bump", Value::Ignored),
    ("norm", Value::Ignored),
    ("disp", Value::Ignored),
    ("refl", Value::Ignored),
    ("map_Pr", Value::Ignored),
    ("map_Pm", Value::Ignored),
    ("Pr", Value::IgnoredUnlessZero),
    ("Pm", Value::IgnoredUnlessZero),
    ("Ps", Value::IgnoredUnlessZero),
    ("Pc", Value::IgnoredUnlessZero),
];

/// Where the keys of one material stand.
#[derive(Clone, Debug)]
pub(super) struct MaterialLines {
    /// Its `newmtl` line.
    pub(super) origin: Origin,
    keys: Vec<(&'static str, usize)>,
    /// Keys that would change the look but are not simulated.
    pub(super) ignored: Vec<&'static str>,
}

impl MaterialLines {
    /// The line of a key, the last one where it is repeated, as that one counts.
    pub(super) fn line(&self, key: &str) -> Option<Origin> {
        let found = self.keys.iter().rev().find(|(known, _)| *known == key);
        found.map(|&(_, line)| self.origin.at(line))
    }
}

/// Checks an MTL file. Gives the text for tobj and the lines of each material, in file order.
///
/// # Errors
/// The first statement whose value cannot be used.
pub(super) fn prepare(source: &str, file: &Origin) -> Result<(String, Vec<MaterialLines>), Fault> {
    let mut text = String::new();
    let mut materials: Vec<MaterialLines> = Vec::new();
    for (line, statement) in statements(source) {
        let (key, rest) = key_and_rest(&statement);
        let Some(&(key, value)) = KEYS.iter().find(|(known, _)| known.eq_ignore_ascii_case(key)) else { continue };
        if key == "newmtl" {
            materials.push(MaterialLines { origin: file.at(line), keys: Vec::new(), ignored: Vec::new() });
        }
        // Keys before the first material belong to none.
        let Some(material) = materials.last_mut() else { continue };
        let fault = |cause| Fault { line, cause, remedy: REMEDY };
        let plain = match value {
            Value::Name if rest.is_empty() => return Err(fault(format!("`{key}` without a name"))),
            Value::Name => rest.to_string(),
            Value::Color => color(key, rest).map_err(fault)?,
            Value::Number => number(key, rest).map_err(fault)?.to_string(),
            Value::Model => model(rest).map_err(fault)?.to_string(),
            Value::Ignored | Value::IgnoredUnlessZero => {
                if matches!(value, Value::Ignored) || number(key, rest).is_ok_and(|number| number != 0.0) {
                    material.keys.push((key, line));
                    material.ignored.push(key);
                }
                continue;
            }
        };
        material.keys.push((key, line));
        // Writing to a String cannot fail.
        writeln!(text, "{key} {plain}").ok();
    }
    Ok((text, materials))
}

const REMEDY: &str = "write colors as three linear numbers (or one for grey), other values as one number";

/// All words before a comment or an option such as `-halo`.
fn numbers(key: &str, rest: &str) -> Result<Vec<f32>, String> {
    let words = without_comment(rest).split_whitespace().filter(|&word| word != "-halo");
    words
        .map(|word| match word.parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("`{key}`: {word} is no finite number")),
        })
        .collect()
}

fn number(key: &str, rest: &str) -> Result<f32, String> {
    numbers(key, rest)?.first().copied().ok_or_else(|| format!("`{key}` without a number"))
}

fn color(key: &str, rest: &str) -> Result<String, String> {
    match numbers(key, rest)?[..] {
        [grey] => Ok(format!("{grey} {grey} {grey}")),
        [r, g, b, ..] => Ok(format!("{r} {g} {b}")),
        ref other => Err(format!("`{key}` with {} numbers", other.len())),
    }
}

fn model(rest: &str) -> Result<u8, String> {
    let model = number("illum", rest)?;
    let exact = (0..=10).find(|&known| f32::from(known) == model);
    exact.ok_or_else(|| format!("`illum` {model} is none of the models 0 to 10"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn check(source: &str) -> Result<(String, Vec<MaterialLines>), Fault> {
        prepare(source, &Origin::file(Path::new("a.mtl")))
    }

    #[test]
    fn statements_are_made_plain_and_keep_their_lines() {
        let source = "Kd 1 1 1\r\n# c\r\nnewmtl  a b\r\n\tkd 0.5 # grey\r\nKs 1 0 .25 9\r\nillum 2.0\r\nNs 3\r\nd -halo 1\r\n\
                      MAP_KD -s 2 2 2 a b.png\r\nbump x\r\nPm 0\r\nPr .5\r\nnewmtl c\r\nKd 0 0 0\r\nKd 1 0 0";
        let (text, materials) = check(source).unwrap();
        let plain = "newmtl a b\nKd 0.5 0.5 0.5\nKs 1 0 0.25\nillum 2\nd 1\nmap_Kd -s 2 2 2 a b.png\nnewmtl c\nKd 0 0 0\nKd 1 0 0\n";
        assert_eq!(text, plain);
        let lines: Vec<_> = ["Kd", "Ks", "illum", "d", "map_Kd", "bump", "Ke"]
            .map(|key| materials[0].line(key).map(|origin| origin.line))
            .into();
        assert_eq!(lines, [Some(4), Some(5), Some(6), Some(8), Some(9), Some(10), None]);
        assert_eq!((materials[0].origin.line, materials[1].origin.line), (3, 13));
        assert_eq!(materials[1].line("Kd").map(|origin| origin.line), Some(15));
        assert_eq!(materials[0].ignored, ["bump", "Pr"]);
    }

    #[test]
    fn values_without_meaning_are_faults_with_a_line() {
        for bad in [
            "Kd",
            "Kd 1 2",
            "Kd red",
            "Kd spectral a.rfl",
            "Ke nan 0 0",
            "Ks 1e99 0 0",
            "Ni",
            "d x",
            "illum 2.5",
            "illum 11",
            "illum -1",
            "illum",
            "map_Kd",
            "newmtl",
        ] {
            let fault = check(&format!("newmtl a\n\n{bad}\n")).unwrap_err();
            assert_eq!(fault.line, 3, "{bad}");
            assert!(fault.cause.contains(bad.split(' ').next().unwrap()), "{}", fault.cause);
        }
    }
}
