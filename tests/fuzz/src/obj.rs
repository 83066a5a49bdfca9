//! The reader of OBJ and MTL files on any bytes.

use crate::files::check_files;

/// Stands between the two files: a line that is a comment in both.
const SEPARATOR: &[u8] = b"#mtl\n";

/// Reads what is before the separator as an OBJ file, and what is behind it as the file `a.mtl` beside it.
pub fn check(data: &[u8]) {
    let at = data.windows(SEPARATOR.len()).position(|part| part == SEPARATOR);
    let (obj, mtl) = at.map_or((data, &[][..]), |at| (&data[..at], &data[at + SEPARATOR.len()..]));
    check_files(&[("a.obj", obj), ("a.mtl", mtl)]);
}
