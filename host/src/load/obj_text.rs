//! An OBJ file's text, put into the form that tobj reads without loss.
//!
//! What tobj 4 would get wrong is settled here, before it reads:
//! - A corner without a normal or texture coordinate silently gets that of the corner before it. So faces are put into
//!   groups of their own by what all their corners have, and the group's name, a [`Has`], says what that is.
//! - A `l` statement with three points becomes a triangle; here it is left out, as faces of one or two corners are.
//! - Index 0 passes as "absent" and far-off relative indices overflow; here both are faults with their line.
//! - Comments behind numbers, continued lines, tabs after `usemtl`, `vt` with one number and colors on only some
//!   vertices are errors to tobj; here they are brought into the plain form.
//! - Objects and groups would only split the mesh; they are left out.

use crate::load::obj_lines::{CORNER_REMEDY, Fault, key_and_rest, parse_corner, statements, without_comment};
use std::collections::BTreeMap;

/// What every corner of a face has beside its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Has {
    /// A texture coordinate.
    pub(super) uvs: bool,
    /// A normal.
    pub(super) normals: bool,
}

impl Has {
    /// The name of the group of faces that have this.
    fn group(self) -> &'static str {
        match (self.uvs, self.normals) {
            (false, false) => "v",
            (true, false) => "v/vt",
            (false, true) => "v//vn",
            (true, true) => "v/vt/vn",
        }
    }

    /// The inverse of [`Has::group`].
    pub(super) fn of_group(name: &str) -> Self {
        Self { uvs: name.starts_with("v/vt"), normals: name.ends_with("vn") }
    }
}

/// An OBJ file ready for tobj, with what only its lines tell.
#[derive(Debug, Default)]
pub(super) struct ObjText {
    /// All statements that tobj has to see, except `mtllib`.
    pub(super) text: String,
    /// The `mtllib` statements: line and what they name.
    pub(super) libraries: Vec<(usize, String)>,
    /// The names of all materials asked for, each with the first line that asks.
    pub(super) materials: BTreeMap<String, usize>,
    /// The first `vn` statement.
    pub(super) first_normal: Option<usize>,
    /// The number of faces with at least three corners.
    pub(super) faces: usize,
    /// Whether a face refers to something that the file does not have.
    pub(super) out_of_range: bool,
    /// What was left out: the first line of each kind and a sentence.
    pub(super) left_out: Vec<(usize, &'static str)>,
}

/// Puts `source` into the form that tobj reads without loss.
///
/// # Errors
/// The first face with a corner that has no meaning, or the first `usemtl` or `mtllib` without a name. Numbers are not
/// looked at here.
pub(super) fn prepare(source: &str) -> Result<ObjText, Fault> {
    let mut prepared = ObjText { text: String::with_capacity(source.len() + source.len() / 16), ..Default::default() };
    let mut counts = [0; 3];
    let mut largest = [0; 3];
    let mut group = "";
    for (line, statement) in statements(source) {
        let (key, rest) = key_and_rest(&statement);
        match key {
            "v" => {
                counts[0] += 1;
                let numbers = without_comment(rest);
                if let Some((position, _)) = split_color(numbers) {
                    prepared.leave_out(line, "vertex colors are ignored");
                    push_statement(&mut prepared.text, key, position);
                } else {
                    push_statement(&mut prepared.text, key, numbers);
                }
            }
            "vt" => {
                counts[1] += 1;
                let numbers = without_comment(rest);
                push_statement(&mut prepared.text, key, numbers);
                if !numbers.is_empty() && !numbers.contains(char::is_whitespace) {
                    prepared.text.truncate(prepared.text.len() - 1);
                    prepared.text.push_str(" 0\n");
                }
            }
            "vn" => {
                counts[2] += 1;
                prepared.first_normal.get_or_insert(line);
                push_statement(&mut prepared.text, key, without_comment(rest));
            }
            "f" => {
                let words = without_comment(rest);
                let (has, corners) = read_face(words, counts, &mut largest).map_err(|cause| Fault {
                    line,
                    cause,
                    remedy: CORNER_REMEDY,
                })?;
                if corners < 3 {
                    prepared.leave_out(line, "faces with fewer than three corners are ignored");
                    continue;
                }
                prepared.faces += 1;
                if has.group() != group {
                    group = has.group();
                    push_statement(&mut prepared.text, "g", group);
                }
                push_statement(&mut prepared.text, key, words);
            }
            "usemtl" | "mtllib" if rest.is_empty() => {
                let remedy = "name a material after usemtl, a file after mtllib, or remove the line";
                return Err(Fault { line, cause: format!("`{key}` without a name"), remedy });
            }
            "usemtl" => {
                push_statement(&mut prepared.text, key, rest);
                if !prepared.materials.contains_key(rest) {
                    prepared.materials.insert(rest.into(), line);
                }
            }
            "mtllib" => prepared.libraries.push((line, rest.into())),
            "curv" | "curv2" | "surf" => prepared.leave_out(line, "free-form curves and surfaces are ignored"),
            _ => {}
        }
    }
    prepared.out_of_range = (0..3).any(|kind| largest[kind] as usize > counts[kind]);
    Ok(prepared)
}

impl ObjText {
    fn leave_out(&mut self, line: usize, what: &'static str) {
        if self.left_out.iter().all(|&(_, known)| known != what) {
            self.left_out.push((line, what));
        }
    }
}

fn push_statement(text: &mut String, key: &str, rest: &str) {
    for part in [key, " ", rest, "\n"] {
        text.push_str(part);
    }
}

/// The first three of six or more numbers, and the others.
fn split_color(numbers: &str) -> Option<(&str, &str)> {
    let mut words = numbers.split_whitespace();
    let fourth = words.by_ref().nth(3)?;
    words.nth(1)?;
    // Both are parts of one string, so the difference of their addresses is an offset in it.
    numbers.split_at_checked(fourth.as_ptr() as usize - numbers.as_ptr() as usize)
}

/// What all corners of a face have, and how many there are; `largest` keeps the largest index of each kind.
fn read_face(words: &str, counts: [usize; 3], largest: &mut [u32; 3]) -> Result<(Has, usize), String> {
    let mut has = Has { uvs: true, normals: true };
    let mut corners = 0;
    for word in words.split_whitespace() {
        let corner = parse_corner(word, counts)?;
        for (largest, index) in largest.iter_mut().zip(corner) {
            *largest = (*largest).max(index.unwrap_or(0));
        }
        has.uvs &= corner[1].is_some();
        has.normals &= corner[2].is_some();
        corners += 1;
    }
    Ok((has, corners))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_grouped_by_what_all_their_corners_have() {
        let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
        let faces =
            "o box\nf 1//1 2//1 3//1\ng other\nf 1//1 2//1 3//1\nf 1/1/1 2/1 3/1/1\nf 1 2/1 3/1\nf 1/1/1 2/1/1 3/1/1";
        let prepared = prepare(&format!("{head}{faces}")).unwrap();
        let groups = "g v//vn\nf 1//1 2//1 3//1\nf 1//1 2//1 3//1\ng v/vt\nf 1/1/1 2/1 3/1/1\ng v\nf 1 2/1 3/1\ng v/vt/vn\nf 1/1/1 2/1/1 3/1/1\n";
        assert_eq!(prepared.text, format!("{head}{groups}"));
        assert_eq!((prepared.faces, prepared.first_normal, prepared.out_of_range), (5, Some(5), false));
        for (uvs, normals) in [(false, false), (true, false), (false, true), (true, true)] {
            let has = Has { uvs, normals };
            assert_eq!(Has::of_group(has.group()), has);
        }
    }

    #[test]
    fn what_tobj_cannot_read_is_made_plain() {
        let source = "v 1 2 3 # a\nv 1 2 3 .5 .5 .5\nv 1 2 \\\n3 1\nvt .5\nl 1 2 3\np 1\nf 1 2\nf\nf 1 \\\n 2 3#x\nusemtl\ta b \nmtllib  c d.mtl\n";
        let prepared = prepare(source).unwrap();
        let plain = "v 1 2 3\nv 1 2 3 \nv 1 2  3 1\nvt .5 0\ng v\nf 1  2 3\nusemtl a b\n";
        assert_eq!(prepared.text, plain);
        assert_eq!(prepared.libraries, [(13, "c d.mtl".to_string())]);
        assert_eq!(prepared.materials.get("a b"), Some(&12));
        assert_eq!(prepared.left_out.iter().map(|&(line, _)| line).collect::<Vec<_>>(), [2, 8]);
    }

    #[test]
    fn faults_of_faces_and_names_have_their_line() {
        for (text, line) in
            [("v 0 0 0\nf 1 1 0", 2), ("\nf -1 1 1", 2), ("f a b c", 1), ("usemtl ", 1), ("\n\nmtllib", 3)]
        {
            assert_eq!(prepare(text).unwrap_err().line, line, "{text}");
        }
        assert!(prepare("v 0 0 0\nf 1 1 2").unwrap().out_of_range);
        assert!(!prepare("f 1 1 2\nv 0 0 0\nv 0 0 0").unwrap().out_of_range);
    }
}
