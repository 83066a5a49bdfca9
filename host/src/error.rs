//! The one error type of the host: what failed, where, and what to try.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A place in a user's file. `line` counts from 1; 0 means the file as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The file, as the user named it.
    pub file: Arc<Path>,
    /// Line in that file, from 1; 0 for the file as a whole.
    pub line: usize,
}

impl Origin {
    /// The file as a whole.
    pub fn file(path: &Path) -> Self {
        Self { file: Arc::from(path), line: 0 }
    }

    /// Another line of the same file.
    pub fn at(&self, line: usize) -> Self {
        Self { file: Arc::clone(&self.file), line }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}", self.file.display()),
            line => write!(f, "{}:{line}", self.file.display()),
        }
    }
}

/// Why the program stops, as its exit code says it (the numbers of sysexits.h where one fits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitCode {
    /// Done.
    Done = 0,
    /// `diff` found more difference than `--tolerance` allows.
    AboveTolerance = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// The render is finished, but not as good as `--target-error` asks for.
    TargetNotMet = 3,
    /// A scene, mesh, texture or picture cannot be used as it is.
    BadScene = 65,
    /// A file that was named does not exist or cannot be read.
    MissingInput = 66,
    /// An output file cannot be created.
    CannotCreate = 73,
    /// Writing an output file failed part way.
    CannotWrite = 74,
    /// Stopped by SIGINT; the picture so far was saved.
    Interrupted = 130,
    /// Stopped by SIGTERM; the picture so far was saved.
    Terminated = 143,
}

/// What failed, where, and what to try.
#[derive(Clone, Debug, thiserror::Error)]
pub struct Error {
    /// The exit code it leads to.
    pub code: ExitCode,
    /// Where it was found, if in a file.
    pub origin: Option<Origin>,
    /// What is wrong, in one sentence without a full stop.
    pub cause: String,
    /// What the user can do about it, in one sentence without a full stop.
    pub remedy: String,
}

impl Error {
    /// Something wrong inside a scene, mesh, texture or picture file.
    pub fn bad_scene(origin: Origin, cause: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { code: ExitCode::BadScene, origin: Some(origin), cause: cause.into(), remedy: remedy.into() }
    }

    /// A named file that cannot be read; `asked_by` is the line that named it, if a file did.
    pub fn missing_input(path: &Path, error: &std::io::Error, asked_by: Option<Origin>) -> Self {
        Self {
            code: ExitCode::MissingInput,
            origin: asked_by,
            cause: format!("cannot read {}: {error}", path.display()),
            remedy: "check the path; paths in a file are relative to that file's folder".into(),
        }
    }

    /// A command line that makes no sense.
    pub fn usage(cause: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { code: ExitCode::Usage, origin: None, cause: cause.into(), remedy: remedy.into() }
    }

    /// An output that cannot be created.
    pub fn cannot_create(path: &Path, error: impl fmt::Display) -> Self {
        Self {
            code: ExitCode::CannotCreate,
            origin: None,
            cause: format!("cannot create {}: {error}", path.display()),
            remedy: "check that the folder exists and may be written, or name another with -o".into(),
        }
    }

    /// An output that could be created but not written to its end.
    pub fn cannot_write(path: &Path, error: impl fmt::Display) -> Self {
        Self {
            code: ExitCode::CannotWrite,
            origin: None,
            cause: format!("cannot write {}: {error}", path.display()),
            remedy: "check the free space of that disk, or name another file with -o".into(),
        }
    }

    /// The path that the error is about, if it is about a place in a file.
    pub fn file(&self) -> Option<PathBuf> {
        self.origin.as_ref().map(|origin| origin.file.to_path_buf())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(origin) = &self.origin {
            write!(f, "{origin}: ")?;
        }
        write!(f, "{}\n  try: {}", self.cause, self.remedy)
    }
}

/// Something the user should know that does not stop the work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where it was found.
    pub origin: Origin,
    /// What it is and what is done about it.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.origin, self.text)
    }
}
