//! Standard output for data, standard error for people. What the `print` macros would panic about is an error here, or
//! nothing.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use crate::error::{Error, ExitCode};

/// Prints a line of data. A reader that went away (`| head`) wants no more of it, which is no error.
///
/// # Errors
/// `CannotWrite` where standard output takes no more, such as a full disk.
pub(super) fn print(text: impl Display) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error {
            code: ExitCode::CannotWrite,
            origin: None,
            cause: format!("cannot write to standard output: {error}"),
            remedy: "check the free space of where it goes".into(),
        }),
        _ => Ok(()),
    }
}

/// Tells people a line. Where nobody can be told, the work goes on all the same.
pub fn tell(text: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}
