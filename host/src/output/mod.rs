//! Picture files: PNG for looking at, EXR for the linear truth.
//!
//! Each is made whole in memory, written beside its final name and renamed, so that a reader never sees half a
//! picture and an older one survives a failure.

mod atomic;
mod exr;
mod png;
mod tone;

use crate::error::Error;
use crate::picture::Picture;
use std::path::{Path, PathBuf};

pub use atomic::{check_writable, write_file};
pub use exr::{ATTRIBUTE_PREFIX, write_exr};
pub use png::{png_bytes, png_bytes_indexed, write_png, write_png_rgb8};
pub use tone::{ToneMap, srgb_decode, srgb_encode};

/// What a picture file's extension asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit RGB through a [`ToneMap`].
    Png,
    /// Linear 32-bit floats, as rendered.
    Exr,
}

impl Format {
    /// The format that `path` names by its extension, in any case.
    ///
    /// # Errors
    /// A usage error that lists what is accepted.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Error::usage(
                format!("{} does not say which picture format to write", path.display()),
                "name an output that ends in .png (8-bit, tone mapped) or .exr (linear float)",
            )),
        }
    }
}

/// Finds out before a long render whether `path` can be written at its end.
///
/// # Errors
/// As [`Format::of`] and [`check_writable`].
pub fn check_output(path: &Path) -> Result<Format, Error> {
    let format = Format::of(path)?;
    check_writable(path)?;
    Ok(format)
}

/// Refuses an output that would replace a file that was read, or another output.
///
/// # Errors
/// A usage error that names the file.
pub fn check_replaces_nothing(outputs: &[PathBuf], inputs: &[&Path]) -> Result<(), Error> {
    // A file that is not there yet has no canonical path.
    let whole = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_default();
    for (index, output) in outputs.iter().enumerate() {
        let same = |other: &Path| whole(output) == whole(other);
        if inputs.iter().any(|input| same(input)) {
            let cause = format!("{} is read here and would be replaced", output.display());
            return Err(Error::usage(cause, "name another output with -o"));
        }
        if outputs[..index].iter().any(|earlier| same(earlier)) {
            let cause = format!("{} is named twice as an output", output.display());
            return Err(Error::usage(cause, "name each output once"));
        }
    }
    Ok(())
}

/// Writes `picture` in the format that `path` names. `tone` matters to PNG only.
///
/// # Errors
/// As [`Format::of`], [`write_png`] and [`write_exr`].
pub fn write_picture(
    path: &Path,
    picture: &Picture,
    tone: &ToneMap,
    provenance: &[(String, String)],
) -> Result<(), Error> {
    match Format::of(path)? {
        Format::Png => write_png(path, picture, tone, provenance),
        Format::Exr => write_exr(path, picture, provenance),
    }
}

/// Refuses a picture that no file could hold: the encoders take its size on trust.
fn check_size(path: &Path, width: u32, height: u32, pixels: usize) -> Result<(), Error> {
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) != pixels as u64 {
        return Err(Error::cannot_write(path, format!("{pixels} pixels do not make a {width}x{height} picture")));
    }
    Ok(())
}

/// A folder of its own for one test, gone when the test ends.
#[cfg(test)]
pub(crate) mod scratch {
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicU32, Ordering};

    pub(crate) struct Scratch(PathBuf);

    impl Scratch {
        pub(crate) fn new() -> Self {
            static COUNT: AtomicU32 = AtomicU32::new(0);
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let folder = std::env::temp_dir().join(format!("ocellus-output-{}-{count}", std::process::id()));
            std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
            Self(folder)
        }

        pub(crate) fn path(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }

        /// Names in the folder, sorted.
        pub(crate) fn names(&self) -> Vec<String> {
            let entries = std::fs::read_dir(&self.0).expect("the folder exists");
            let mut names: Vec<_> =
                entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
            names.sort();
            names
        }
    }

    impl AsRef<Path> for Scratch {
        fn as_ref(&self) -> &Path {
            &self.0
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            // A folder that stays behind in the temporary folder is no reason to fail a test.
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;

    #[test]
    fn the_extension_chooses_the_format_in_any_case() {
        assert_eq!(Format::of(Path::new("a/b.png")).unwrap(), Format::Png);
        assert_eq!(Format::of(Path::new("b.EXR")).unwrap(), Format::Exr);
        for wrong in ["picture", "picture.jpg", ".png", "png", ""] {
            let error = Format::of(Path::new(wrong)).unwrap_err();
            assert_eq!(error.code, ExitCode::Usage, "{wrong}");
            assert!(error.remedy.contains(".png") && error.remedy.contains(".exr"));
        }
    }

    #[test]
    fn an_output_is_checked_without_leaving_anything_behind() {
        let scratch = scratch::Scratch::new();
        assert_eq!(check_output(&scratch.path("a.png")).unwrap(), Format::Png);
        assert_eq!(check_output(&scratch.path("none/a.png")).unwrap_err().code, ExitCode::CannotCreate);
        assert!(scratch.names().is_empty());
    }

    #[test]
    fn a_picture_whose_pixels_do_not_match_its_size_is_an_error() {
        let scratch = scratch::Scratch::new();
        let picture = Picture { width: 2, height: 2, pixels: vec![[0.0; 3]; 3] };
        for name in ["a.png", "a.exr"] {
            let error = write_picture(&scratch.path(name), &picture, &ToneMap::default(), &[]).unwrap_err();
            assert_eq!(error.code, ExitCode::CannotWrite);
        }
        assert!(scratch.names().is_empty());
    }
}
