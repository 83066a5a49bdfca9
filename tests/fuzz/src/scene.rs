//! The reader of scene files on any bytes.

use crate::files::check_files;

/// Reads `data` as a scene file.
pub fn check(data: &[u8]) {
    check_files(&[("scene.toml", data)]);
}
