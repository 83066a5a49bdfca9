//! Instructions of a program, as callgrind counts them: the same number in every run.

use std::ffi::OsStr;
use std::process::Command;

/// How many instructions `program` executes with `arguments`, and what it writes to standard output.
pub(crate) fn count<A: AsRef<OsStr>>(
    program: impl AsRef<OsStr>,
    arguments: impl IntoIterator<Item = A>,
) -> Result<(u64, Vec<u8>), String> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(arguments)
        .output()
        .map_err(|error| format!("valgrind: {error}; install it"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let counted = text.lines().find_map(|line| line.split_once("Collected :"));
    counted
        .and_then(|(_, count)| count.trim().parse().ok())
        .map(|count| (count, output.stdout))
        .ok_or_else(|| format!("callgrind printed no count: {text}"))
}
