//! The scenes that benches go through.

use std::path::{Path, PathBuf};

/// Every scene of `fixtures/report` and `fixtures/features`, sorted.
pub(crate) fn all() -> Vec<PathBuf> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    let mut scenes: Vec<PathBuf> = ["report", "features"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(fixtures.join(folder)).expect("the fixtures"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    scenes.sort();
    scenes
}
