//! Instruction counts beside those that were written down before.

use std::path::{Path, PathBuf};

/// By how much instructions may grow: what another compiler's choices or another C library's copies make of them.
const MARGIN: f64 = 0.03;

/// The counts of a file in this folder's parent: a name and a number in each line.
pub(crate) struct Counts {
    file: PathBuf,
    before: String,
    now: String,
    grown: Vec<String>,
}

impl Counts {
    /// Those that `file` holds.
    pub(crate) fn of(file: &str) -> Result<Self, String> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches").join(file);
        let before = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(Self { file, before, now: String::new(), grown: Vec::new() })
    }

    /// Adds what something takes now; its ratio to what it took before.
    pub(crate) fn add(&mut self, name: &str, count: f64) -> f64 {
        let was = self.before.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<f64>().ok());
        let change = was.map_or(f64::NAN, |was| count / was);
        if !(change <= 1.0 + MARGIN) {
            self.grown.push(name.to_owned());
        }
        self.now += &format!("{name} {count}\n");
        change
    }

    /// Writes them down if `OCELLUS_BLESS` is set; else it is an error if one has grown.
    pub(crate) fn finish(self) -> Result<(), String> {
        let Self { file, now, grown, .. } = self;
        if std::env::var_os("OCELLUS_BLESS").is_some() {
            return std::fs::write(&file, now).map_err(|error| format!("{}: {error}", file.display()));
        }
        if grown.is_empty() {
            return Ok(());
        }
        Err(format!("more instructions than in {} for {}: find out why", file.display(), grown.join(", ")))
    }
}
