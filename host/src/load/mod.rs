//! Loaders: from a user's files to a [`crate::description::SceneDescription`].

mod bare_obj;
mod mtl;
mod mtl_lines;
pub mod obj;
mod obj_lines;
mod obj_text;
mod polygon;
mod scene_file;
mod table;
mod texture;
mod value;

pub use bare_obj::load_bare_obj;
pub use scene_file::load_scene_file;

use crate::description::SceneDescription;
use crate::error::{Error, Origin};
use std::path::{Path, PathBuf};

/// Reads a scene: a scene file (`.toml`), or a mesh that gets a camera and a light of its own (`.obj`).
///
/// # Errors
/// `Usage` for another extension; otherwise those of [`load_scene_file`] and [`load_bare_obj`].
pub fn load_scene(path: &Path) -> Result<SceneDescription, Error> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("toml") => load_scene_file(path),
        Some("obj") => load_bare_obj(path),
        _ => {
            let cause = format!("{} is neither a .toml scene nor an .obj mesh", path.display());
            Err(Error::usage(cause, "name a scene file that ends in .toml, or a mesh that ends in .obj"))
        }
    }
}

/// The text of a file. Bytes that are not UTF-8 (old exporters write names in other encodings) become U+FFFD.
pub(crate) fn read_text(path: &Path, asked_by: Option<Origin>) -> Result<String, Error> {
    let bytes = std::fs::read(path).map_err(|error| Error::missing_input(path, &error, asked_by))?;
    let mut text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    };
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// The path that `name`, written in `file`, stands for: relative to the folder of `file`, with quotes around it
/// removed and, where nothing is found under the name as it is, with backslashes read as slashes.
pub(crate) fn resolve(file: &Path, name: &str) -> PathBuf {
    let name = name.trim();
    let name = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
    let folder = file.parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    if name.contains('\\') && !path.exists() { folder.join(name.replace('\\', "/")) } else { path }
}

#[cfg(test)]
pub(crate) mod test_folder {
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A new folder for one test, removed when dropped.
    pub(crate) struct TestFolder(PathBuf);

    impl TestFolder {
        pub(crate) fn new() -> Self {
            static COUNT: AtomicUsize = AtomicUsize::new(0);
            let name = format!("ocellus-load-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
            let path = std::env::temp_dir().join(name);
            std::fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        pub(crate) fn path(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }

        pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
            let path = self.path(name);
            std::fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).unwrap();
            std::fs::write(&path, content).unwrap();
            path
        }
    }

    impl Drop for TestFolder {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::test_folder::TestFolder;
    use super::*;
    use crate::error::ExitCode;

    #[test]
    fn the_extension_says_what_a_scene_is() {
        let folder = TestFolder::new();
        let mesh = folder.write("a.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        assert_eq!(load_scene(&mesh).unwrap().meshes.len(), 1);
        for name in ["a.ply", "a", "toml", ".obj"] {
            let error = load_scene(&folder.path(name)).unwrap_err();
            assert_eq!(error.code, ExitCode::Usage, "{name}");
            assert!(error.remedy.contains(".toml") && error.remedy.contains(".obj"));
        }
        for name in ["none.toml", "none.obj", "none.Toml"] {
            assert_eq!(load_scene(&folder.path(name)).unwrap_err().code, ExitCode::MissingInput, "{name}");
        }
    }

    #[test]
    fn names_are_relative_to_the_file_that_holds_them() {
        assert_eq!(resolve(Path::new("a/b.obj"), "c.mtl"), Path::new("a/c.mtl"));
        assert_eq!(resolve(Path::new("b.obj"), " \"c d.mtl\" "), Path::new("c d.mtl"));
        assert_eq!(resolve(Path::new("a/b.obj"), "maps\\wood.png"), Path::new("a/maps/wood.png"));
    }

    #[test]
    fn text_survives_a_byte_order_mark_and_bad_utf8() {
        let folder = TestFolder::new();
        let path = folder.write("a.obj", b"\xef\xbb\xbfv 1\nusemtl caf\xe9\n");
        assert_eq!(read_text(&path, None).unwrap(), "v 1\nusemtl caf\u{fffd}\n");
        let error = read_text(&folder.path("none"), Some(Origin::file(&path).at(3))).unwrap_err();
        assert_eq!(error.origin.unwrap().line, 3);
    }
}
