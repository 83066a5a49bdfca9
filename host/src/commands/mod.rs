//! The subcommands: from arguments to what is printed and written.

mod diff;
mod explain;
mod ledger;
mod origins;
mod promise;
mod render;
mod streams;
pub(crate) mod words;

pub use streams::tell;

use std::path::Path;

use crate::cli::{Cli, Command, SceneArgs};
use crate::description::SceneDescription;
use crate::error::{Error, ExitCode, Origin};
use crate::load::load_scene;

/// Runs the program.
///
/// # Errors
/// Whatever stopped it, with its exit code.
pub fn run(cli: &Cli) -> Result<ExitCode, Error> {
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Explain(args) => explain::run(&args.scene),
        Command::Ledger(args) => ledger::run(args),
        Command::Diff(args) => diff::run(args),
    }
}

/// Loads a scene, applies what the command line changes, and tells the user what the loaders noticed.
fn load(args: &SceneArgs) -> Result<SceneDescription, Error> {
    let mut scene = load_scene(&args.scene)?;
    if let Some([width, height]) = args.size {
        (scene.film.width, scene.film.height) = (width, height);
    }
    if let Some(max_bounces) = args.max_bounces {
        scene.integrator.max_bounces = max_bounces;
    }
    if let Some(seed) = args.seed {
        scene.integrator.seed = seed;
    }
    if let Some(fresnel) = args.fresnel {
        scene.integrator.fresnel = fresnel;
    }
    if let Some(sampler) = args.sampler {
        scene.integrator.sampler = sampler;
        scene.integrator.sampler_origin = Origin::file(Path::new("--sampler"));
    }
    for warning in &scene.warnings {
        tell(format_args!("warning: {warning}"));
    }
    Ok(scene)
}
