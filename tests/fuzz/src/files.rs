//! A folder for the readers, which take paths, and what every error and every scene of theirs must hold.

use std::path::Path;

use ocellus::assemble::{Accel, with_view};
use ocellus::error::Error;
use ocellus::load::load_scene;
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::Real;
use ocellus_kernel::{Everything, View};

thread_local! {
    /// With the files that input may name. One for all inputs: making a folder takes longer than reading a scene.
    static FOLDER: tempfile::TempDir = {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, bytes) in [
            ("gem.obj", &include_bytes!("../../../fixtures/features/gem.obj")[..]),
            ("gem.mtl", include_bytes!("../../../fixtures/features/gem.mtl")),
            ("barrel.obj", include_bytes!("../../../fixtures/features/barrel.obj")),
            ("barrel.mtl", include_bytes!("../../../fixtures/features/barrel.mtl")),
            ("tiles.png", include_bytes!("../../../fixtures/features/tiles.png")),
        ] {
            std::fs::write(folder.path().join(name), bytes).expect("a file");
        }
        folder
    };
}

/// Reads the first of `files`, written beside the others and those that are always there.
pub(crate) fn check_files(files: &[(&str, &[u8])]) {
    // Some of what such names stand for has no end.
    let is_device =
        |bytes: &[u8]| bytes.windows(4).any(|part| part == b"/dev") || bytes.windows(5).any(|part| part == b"/proc");
    if files.iter().any(|(_, bytes)| is_device(bytes)) {
        return;
    }
    FOLDER.with(|folder| {
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).expect("a file");
        }
        check_scene(&folder.path().join(files[0].0));
    });
}

fn check_scene(path: &Path) {
    let scene = match load_scene(path) {
        Ok(scene) => scene,
        Err(error) => return check_error(&error),
    };
    for warning in &scene.warnings {
        assert!(!warning.text.trim().is_empty(), "{warning:?}");
    }
    // What was read is of use to the kernel, or refused with a reason.
    with_view::<f32, _>(&scene, Accel::Bvh, |view, _| look(view)).unwrap_or_else(|error| check_error(&error));
    with_view::<f64, _>(&scene, Accel::Box, |view, _| look(view)).unwrap_or_else(|error| check_error(&error));
}

/// Follows a path through the middle of the picture, and not for long.
fn look<R: Real>(view: &View<'_, R>) {
    let options = PathOptions { max_bounces: view.options.max_bounces.min(8), ..*view.options };
    let [width, height] = view.camera.size();
    View { options: &options, ..*view }.sample::<Everything>(width / 2, height / 2, 0);
}

fn check_error(error: &Error) {
    assert!(!error.cause.trim().is_empty(), "no cause: {error:?}");
    assert!(!error.remedy.trim().is_empty(), "no remedy: {error:?}");
}
