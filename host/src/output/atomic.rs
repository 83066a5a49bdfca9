//! Files that appear whole or not at all.

use crate::error::Error;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Names tried for one temporary file before giving up; the first is taken only if a killed run left it behind.
const TEMPORARY_NAMES: u32 = 100;

/// Writes `bytes` beside `path` and renames the result, so that `path` is either as before or complete.
///
/// A link is followed: what it points to is replaced, not the link.
///
/// # Errors
/// `CannotCreate` if the folder is missing or may not be written, or if `path` is a folder, a device or
/// write-protected; `CannotWrite` if writing stops part way. The temporary file is removed in both cases.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_through(path, |file| file.write_all(bytes))
}

/// Tells whether [`write_file`] could begin: creates the temporary file and removes it again.
///
/// # Errors
/// `CannotCreate`, as [`write_file`].
pub fn check_writable(path: &Path) -> Result<(), Error> {
    Temporary::beside(path).map(drop).map_err(|error| Error::cannot_create(path, error))
}

fn write_through(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<(), Error> {
    let mut temporary = Temporary::beside(path).map_err(|error| Error::cannot_create(path, error))?;
    fill(&mut temporary.file)
        // A full disk may show only when the data leave the cache.
        .and_then(|()| temporary.file.sync_all())
        .and_then(|()| temporary.rename())
        .map_err(|error| Error::cannot_write(path, error))
}

/// A file under a name of its own in the folder of its target; removed when dropped, unless renamed.
struct Temporary {
    file: File,
    name: PathBuf,
    target: PathBuf,
    renamed: bool,
}

impl Temporary {
    fn beside(path: &Path) -> io::Result<Self> {
        let target = replaceable(path)?;
        let file_name = target.file_name().ok_or_else(|| io::Error::other("it does not end in a file name"))?;
        for attempt in 0..TEMPORARY_NAMES {
            let name = format!(".{}.{}-{attempt}.tmp", file_name.to_string_lossy(), std::process::id());
            let name = target.with_file_name(name);
            match OpenOptions::new().write(true).create_new(true).open(&name) {
                Ok(file) => return Ok(Self { file, name, target, renamed: false }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::other("its folder is full of unfinished temporary files (.*.tmp)"))
    }

    fn rename(&mut self) -> io::Result<()> {
        fs::rename(&self.name, &self.target)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Nothing better can be done about a temporary file that cannot be removed.
            let _ = fs::remove_file(&self.name);
        }
    }
}

/// The file that a rename may put in the place of `path`; renaming would otherwise replace devices and protected files.
fn replaceable(path: &Path) -> io::Result<PathBuf> {
    let metadata = match fs::metadata(path) {
        Ok(metadata) => metadata,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(path.to_path_buf()),
        Err(error) => return Err(error),
    };
    if metadata.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !metadata.is_file() {
        return Err(io::Error::other("it is not an ordinary file"));
    }
    if metadata.permissions().readonly() {
        return Err(io::Error::other("the existing file is write-protected"));
    }
    fs::canonicalize(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ExitCode;
    use crate::output::scratch::Scratch;

    #[test]
    fn a_file_is_written_and_replaced_and_nothing_else_stays() {
        let scratch = Scratch::new();
        let path = scratch.path("a.bin");
        write_file(&path, b"first").unwrap();
        write_file(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(scratch.names(), ["a.bin"]);
    }

    #[test]
    fn a_failure_part_way_keeps_the_old_file_and_removes_the_temporary_one() {
        let scratch = Scratch::new();
        let path = scratch.path("a.bin");
        write_file(&path, b"old").unwrap();
        let error = write_through(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert_eq!(error.code, ExitCode::CannotWrite);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(scratch.names(), ["a.bin"]);
    }

    #[test]
    fn what_cannot_be_created_is_found_beforehand_with_the_same_error() {
        let scratch = Scratch::new();
        let protected = scratch.path("protected.bin");
        fs::write(&protected, b"keep").unwrap();
        let mut permissions = fs::metadata(&protected).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&protected, permissions).unwrap();
        fs::create_dir(scratch.path("folder")).unwrap();

        let bad = [scratch.path("none/a.bin"), scratch.path("protected.bin/a.bin"), protected, scratch.path("folder")];
        for path in bad {
            let before = check_writable(&path).unwrap_err();
            let during = write_file(&path, b"x").unwrap_err();
            assert_eq!(before.code, ExitCode::CannotCreate, "{}", path.display());
            assert_eq!(before.cause, during.cause);
            assert!(before.cause.contains(&path.display().to_string()));
        }
        assert_eq!(fs::read(scratch.path("protected.bin")).unwrap(), b"keep");
        assert_eq!(scratch.names(), ["folder", "protected.bin"]);
    }

    #[test]
    fn checking_leaves_an_existing_file_alone() {
        let scratch = Scratch::new();
        let path = scratch.path("a.bin");
        write_file(&path, b"old").unwrap();
        check_writable(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(scratch.names(), ["a.bin"]);
    }

    #[test]
    fn a_name_left_behind_by_a_killed_run_is_stepped_over() {
        let scratch = Scratch::new();
        let stale = scratch.path(&format!(".a.bin.{}-0.tmp", std::process::id()));
        fs::write(&stale, b"stale").unwrap();
        write_file(&scratch.path("a.bin"), b"new").unwrap();
        assert_eq!(fs::read(&stale).unwrap(), b"stale");
        assert_eq!(fs::read(scratch.path("a.bin")).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_is_refused() {
        let scratch = Scratch::new();
        write_file(&scratch.path("real.bin"), b"old").unwrap();
        std::os::unix::fs::symlink("real.bin", scratch.path("link.bin")).unwrap();
        write_file(&scratch.path("link.bin"), b"new").unwrap();
        assert!(fs::symlink_metadata(scratch.path("link.bin")).unwrap().is_symlink());
        assert_eq!(fs::read(scratch.path("real.bin")).unwrap(), b"new");
        assert_eq!(check_writable(Path::new("/dev/null")).unwrap_err().code, ExitCode::CannotCreate);
    }
}
