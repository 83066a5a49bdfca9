//! What is asked on the command line.

use std::path::PathBuf;

/// How to ask.
pub(crate) const USAGE: &str = "usage: run [--rays N] [--rounds K] [--mesh bunny|bumps|sphere|FILE.obj]... \
    [--triangles N] [--only TEXT]... [--growth] \
    [--embree LIBRARY]";

/// What to measure.
pub(crate) struct Options {
    /// Embree's library; without it there are no rows of Embree.
    pub(crate) embree: Option<PathBuf>,
    /// Rays of each set.
    pub(crate) rays: usize,
    /// Rounds, of which the medians are shown.
    pub(crate) rounds: usize,
    /// Names or files of meshes.
    pub(crate) meshes: Vec<String>,
    /// Triangles of the mesh of bumps, or of the largest of the growth table.
    pub(crate) triangles: Option<usize>,
    /// Texts of which a row's name and instructions have one; all rows if there are none.
    pub(crate) only: Vec<String>,
    /// Whether to measure many sizes of one mesh.
    pub(crate) growth: bool,
}

impl Options {
    /// Reads the command line.
    pub(crate) fn parse(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            embree: None,
            rays: 1 << 20,
            rounds: 5,
            meshes: Vec::new(),
            triangles: None,
            only: Vec::new(),
            growth: false,
        };
        let mut arguments = arguments;
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} wants a value"));
            match argument.as_str() {
                "--embree" => options.embree = Some(value()?.into()),
                "--rays" => options.rays = number(&value()?)?,
                "--rounds" => options.rounds = number(&value()?)?,
                "--mesh" => options.meshes.push(value()?),
                "--triangles" => options.triangles = Some(number(&value()?)?),
                "--only" => options.only.push(value()?.to_lowercase()),
                "--growth" => options.growth = true,
                _ => return Err(format!("no option {argument}")),
            }
        }
        if options.meshes.is_empty() {
            options.meshes = ["bunny", "bumps", "sphere"].map(str::to_owned).to_vec();
        }
        Ok(options)
    }

    /// Whether a row of this name and instructions is to be measured.
    pub(crate) fn wants(&self, title: &str) -> bool {
        let title = title.to_lowercase();
        self.only.is_empty() || self.only.iter().any(|text| title.contains(text))
    }
}

/// A whole number above zero.
fn number(text: &str) -> Result<usize, String> {
    let number = text.replace('_', "").parse().ok().filter(|&number| number > 0);
    number.ok_or_else(|| format!("{text} is not a number above zero"))
}
