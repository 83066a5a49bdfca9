//! Runs the program in a folder of its own and keeps all that it says.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ocellus::input::read_picture;
use ocellus::picture::Picture;
use serde_json::Value;
use tempfile::TempDir;

/// A scene of one grey ball under one lamp, 8 x 8 pixels.
pub(crate) const BALL: &str = "\
[camera]
position = [0, 0, 4]
look_at = [0, 0, 0]
fov_degrees = 70

[film]
width = 8
height = 8
spp = 4

[materials.grey]
kind = \"diffuse\"

[[spheres]]
center = [0, 0, 0]
radius = 1
material = \"grey\"

[[lights]]
kind = \"sphere\"
center = [1.5, 1.5, 0]
radius = 0.7
radiance = 10
";

/// A file among the fixtures.
pub(crate) fn fixture(name: &str) -> PathBuf {
    repository().join("fixtures").join(name)
}

/// The folder that holds the whole project.
pub(crate) fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in the repository")
}

/// Every scene of `fixtures/report` and `fixtures/features`, as paths from the repository.
pub(crate) fn fixture_scenes() -> Vec<PathBuf> {
    let mut scenes = Vec::new();
    for folder in ["fixtures/report", "fixtures/features"] {
        for entry in std::fs::read_dir(repository().join(folder)).expect("the fixtures") {
            let path = Path::new(folder).join(entry.expect("an entry").file_name());
            if path.extension().is_some_and(|extension| extension == "toml") {
                scenes.push(path);
            }
        }
    }
    scenes.sort();
    assert!(scenes.len() >= 30, "only {} scenes found", scenes.len());
    scenes
}

/// The program with arguments, to be run in `folder`.
pub(crate) fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ocellus"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command
}

/// What a run left.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Outcome {
    /// Of a command that is run to its end.
    pub(crate) fn of(command: &mut Command) -> Self {
        Self::from(command.output().expect("the program starts"))
    }

    /// Itself, if the program ended with `code`.
    #[track_caller]
    pub(crate) fn with_code(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }

    /// Standard output as the one JSON object that it must be.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).expect("one JSON value and nothing else");
        assert!(value.is_object(), "{value}");
        assert_eq!(self.stdout.matches('\n').count(), 1, "one line: {}", self.stdout);
        value
    }
}

impl From<std::process::Output> for Outcome {
    fn from(output: std::process::Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the program prints UTF-8");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

/// A folder for one test, which the program runs in.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// With [`BALL`] as `ball.toml`.
    pub(crate) fn with_ball() -> Self {
        let folder = Self::new();
        folder.write("ball.toml", BALL);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("the folder can be written");
    }

    /// The program with arguments, to be run here.
    pub(crate) fn program(&self, arguments: &[&str]) -> Command {
        program(self.0.path(), arguments)
    }

    /// Runs the program here.
    pub(crate) fn run(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(&mut self.program(arguments))
    }

    /// Renders with `--json` and gives back its report.
    #[track_caller]
    pub(crate) fn render(&self, arguments: &[&str]) -> Value {
        self.run(&[&["render", "--json"], arguments].concat()).with_code(0).json()
    }

    /// The linear picture in a file.
    #[track_caller]
    pub(crate) fn picture(&self, name: &str) -> Picture {
        read_picture(&self.path(name)).expect("a picture that can be read")
    }

    /// All names here, hidden ones too, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<_> = entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
