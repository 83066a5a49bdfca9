//! The statements of an OBJ or MTL file with their line numbers, and the search for the faulty one.
//!
//! tobj's errors carry no line. [`first_fault`] reads the text a second time, only after an error, and finds it.

use crate::error::{Error, Origin};
use std::borrow::Cow;

/// What is wrong in one statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    /// Line of the statement, from 1.
    pub(super) line: usize,
    /// What is wrong.
    pub(super) cause: String,
    /// What to do about it.
    pub(super) remedy: &'static str,
}

impl Fault {
    /// As an error in `file`.
    pub(super) fn in_file(self, file: &Origin) -> Error {
        Error::bad_scene(file.at(self.line), self.cause, self.remedy)
    }
}

/// All statements: the number of the first line, from 1, and the text without surrounding blanks. A line that ends in a
/// backslash goes on in the next one. Blank lines and comments are left out.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        loop {
            let (index, line) = lines.next()?;
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let mut statement = Cow::Borrowed(line);
            while let Some(start) = statement.strip_suffix('\\') {
                let Some((_, next)) = lines.next() else { break };
                statement = Cow::Owned(format!("{start} {}", next.trim()));
            }
            return Some((index + 1, statement));
        }
    })
}

/// A statement's key and the rest, without the blanks between them.
pub(super) fn key_and_rest(statement: &str) -> (&str, &str) {
    match statement.split_once(char::is_whitespace) {
        Some((key, rest)) => (key, rest.trim_start()),
        None => (statement, ""),
    }
}

/// The part of a statement of numbers that is no comment. (Names may hold a `#`, numbers may not.)
pub(super) fn without_comment(rest: &str) -> &str {
    rest.split('#').next().unwrap_or("").trim_end()
}

/// What a corner of a face refers to.
pub(super) const KINDS: [&str; 3] = ["position", "texture coordinate", "normal"];
const KEYS: [&str; 3] = ["v", "vt", "vn"];

/// The corner `word` of a face, `v/vt/vn`, as indices from 1 in that order; `None` is absent. `counts` says how many of
/// each kind stand before the face; relative indices count back from there.
pub(super) fn parse_corner(word: &str, counts: [usize; 3]) -> Result<[Option<u32>; 3], String> {
    let mut corner = [None; 3];
    for (kind, part) in word.split('/').enumerate() {
        if kind == 3 {
            return Err(format!("the corner {word} has more than three indices"));
        }
        if part.is_empty() {
            continue;
        }
        let index: i64 = part.parse().map_err(|_| format!("{part} in the corner {word} is no index"))?;
        let absolute = if index < 0 { counts[kind] as i64 + 1 + index.max(-i64::from(u32::MAX)) } else { index };
        match u32::try_from(absolute) {
            Ok(absolute @ 1..) => corner[kind] = Some(absolute),
            _ if index == 0 => return Err(format!("index 0 in the corner {word}")),
            _ => return Err(out_of_range(kind, index, counts[kind])),
        }
    }
    if corner[0].is_none() {
        return Err(format!("the corner {word} has no position"));
    }
    Ok(corner)
}

fn out_of_range(kind: usize, index: i64, count: usize) -> String {
    format!("a face refers to {} {index}, but {count} `{}` lines stand before it", KINDS[kind], KEYS[kind])
}

pub(super) const CORNER_REMEDY: &str =
    "write v, v/vt, v//vn or v/vt/vn; indices count from 1, or back from -1, over lines above the face";
const NUMBER_REMEDY: &str = "write plain decimal numbers; export the mesh again if it was damaged";

/// The first statement of an OBJ file that cannot be used, or `None` if each can.
pub(super) fn first_fault(text: &str) -> Option<Fault> {
    let mut counts = [0; 3];
    for (line, statement) in statements(text) {
        let (key, rest) = key_and_rest(&statement);
        let rest = without_comment(rest);
        let checked = match key {
            "f" => check_face(rest, counts).map_err(|cause| (cause, CORNER_REMEDY)),
            _ => check_numbers(key, rest).map_err(|cause| (cause, NUMBER_REMEDY)),
        };
        if let Err((cause, remedy)) = checked {
            return Some(Fault { line, cause, remedy });
        }
        if let Some(kind) = KEYS.iter().position(|&known| known == key) {
            counts[kind] += 1;
        }
    }
    None
}

fn check_face(rest: &str, counts: [usize; 3]) -> Result<(), String> {
    for word in rest.split_whitespace() {
        for (kind, index) in parse_corner(word, counts)?.into_iter().enumerate() {
            if let Some(index) = index.filter(|&index| index as usize > counts[kind]) {
                return Err(out_of_range(kind, i64::from(index), counts[kind]));
            }
        }
    }
    Ok(())
}

fn check_numbers(key: &str, rest: &str) -> Result<(), String> {
    let least = match key {
        "v" | "vn" => 3,
        "vt" => 1,
        _ => return Ok(()),
    };
    let mut numbers = Vec::new();
    for word in rest.split_whitespace() {
        numbers.push(word.parse::<f32>().map_err(|_| format!("`{key}`: {word} is no number"))?);
    }
    if numbers.len() < least {
        return Err(format!("`{key}` with {} numbers where {least} are needed", numbers.len()));
    }
    if key == "v" && numbers.len() == 5 {
        return Err("`v` with 5 numbers; 3, 4 (with weight) or 6 (with a color) have a meaning".into());
    }
    let weight = if key == "v" && numbers.len() == 4 { numbers[3] } else { 1.0 };
    if weight == 0.0 {
        return Err("`v` with weight 0, a point at infinity".into());
    }
    // A normal that is no direction counts as missing, so it is not a fault.
    let used = if key == "vt" { 2.min(numbers.len()) } else { 3 };
    match numbers[..used].iter().find(|&&number| key != "vn" && !(number / weight).is_finite()) {
        Some(_) => Err(format!("`{key} {rest}` is not finite in single precision")),
        None => Ok(()),
    }
}

/// The line of the `number`th face, from 0, with at least three corners.
pub(super) fn face_line(text: &str, number: usize) -> Option<usize> {
    statements(text)
        .filter(|(_, statement)| {
            let (key, rest) = key_and_rest(statement);
            key == "f" && without_comment(rest).split_whitespace().nth(2).is_some()
        })
        .nth(number)
        .map(|(line, _)| line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> (usize, String) {
        let fault = first_fault(text).expect("a fault");
        (fault.line, fault.cause)
    }

    #[test]
    fn statements_keep_the_number_of_their_first_line() {
        let text = "# c\\\nv 1 \\\n 2 3\r\n\n\t f 1 2 3\\";
        let found: Vec<_> = statements(text).map(|(line, text)| (line, text.into_owned())).collect();
        assert_eq!(found, [(2, "v 1  2 3".to_string()), (5, "f 1 2 3\\".to_string())]);
        assert_eq!(key_and_rest("usemtl \t a b"), ("usemtl", "a b"));
        assert_eq!(key_and_rest("f"), ("f", ""));
    }

    #[test]
    fn corners_of_all_forms_are_read() {
        let counts = [8, 4, 2];
        assert_eq!(parse_corner("3", counts), Ok([Some(3), None, None]));
        assert_eq!(parse_corner("3/2", counts), Ok([Some(3), Some(2), None]));
        assert_eq!(parse_corner("3//1", counts), Ok([Some(3), None, Some(1)]));
        assert_eq!(parse_corner("-8/-1/-2", counts), Ok([Some(1), Some(4), Some(1)]));
        assert_eq!(parse_corner("1/", counts), Ok([Some(1), None, None]));
        for bad in ["", "/1", "0", "1/0", "a", "1/2/3/4", "-9", "1//-3", "4294967296", "-9223372036854775808", "1.5"] {
            assert!(parse_corner(bad, counts).is_err(), "{bad}");
        }
    }

    #[test]
    fn faults_are_found_with_line_and_cause() {
        let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        assert_eq!(fault(&format!("{head}\nf 1 2 4")).0, 5);
        assert!(fault(&format!("{head}f 1 2 4")).1.contains("position 4, but 3 `v` lines"));
        assert!(fault(&format!("{head}f 1/1 2/1 3/1")).1.contains("texture coordinate 1, but 0 `vt`"));
        assert!(fault(&format!("{head}f 1//1 2//1 3//1")).1.contains("normal 1"));
        assert!(fault(&format!("{head}f 1 2 0")).1.contains("index 0"));
        assert!(fault(&format!("{head}f 1 2 -4")).1.contains("position -4"));
        assert_eq!(fault("v 0 0 0\nv 1 x 0").0, 2);
        assert!(fault("v 1 2").1.contains("2 numbers where 3"));
        assert!(fault("vn 1 2").1.contains("`vn`"));
        assert!(fault("vt").1.contains("`vt`"));
        assert!(fault("v 1 2 3 4 5").1.contains("5 numbers"));
        assert!(fault("v 1 2 3 0").1.contains("weight 0"));
        for value in ["nan", "inf", "1e39"] {
            assert!(fault(&format!("# a comment\nv 0 {value} 0")).1.contains("not finite"), "{value}");
        }
        assert!(fault("v 1e38 0 0 1e-3").1.contains("not finite"));
        assert_eq!(first_fault(&format!("{head}vn nan 0 0\nvt 1\nf 1/1 2/-1 3/1 # all right")), None);
    }

    #[test]
    fn faces_are_counted_without_points_and_lines() {
        let text = "f 1 2\nf 1 2 3 # one\n\nf 1\nf 2 3 4";
        assert_eq!(face_line(text, 0), Some(2));
        assert_eq!(face_line(text, 1), Some(5));
        assert_eq!(face_line(text, 2), None);
    }
}
