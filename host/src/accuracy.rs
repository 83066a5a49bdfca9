//! Accuracy on the command line: one option for each choice of the kernel's.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use ocellus_kernel::Accuracy;
use ocellus_kernel::accuracy::{RayOffset, SlabTest, SphereTest, TriangleTest};

/// What exactness is spent on. At most one may differ from its default.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Accuracy (one at a time)")]
pub struct AccuracyArgs {
    /// How rays are tested against triangles.
    #[arg(long, value_name = "TEST", default_value_t, value_parser = named(TriangleTest::ALL))]
    pub triangle_test: TriangleTest,
    /// How rays are tested against boxes.
    #[arg(long, value_name = "TEST", default_value_t, value_parser = named(SlabTest::ALL))]
    pub slab_test: SlabTest,
    /// How rays are tested against spheres.
    #[arg(long, value_name = "TEST", default_value_t, value_parser = named(SphereTest::ALL))]
    pub sphere_test: SphereTest,
    /// How far off a surface rays start that leave it.
    #[arg(long, value_name = "OFFSET", default_value_t, value_parser = named(RayOffset::ALL))]
    pub ray_offset: RayOffset,
}

impl From<AccuracyArgs> for Accuracy {
    fn from(args: AccuracyArgs) -> Self {
        Self { triangle: args.triangle_test, slab: args.slab_test, sphere: args.sphere_test, offset: args.ray_offset }
    }
}

/// A value of a choice by its name.
fn named<T: Copy + Send + Sync + 'static>(
    all: &'static [(T, &'static str)],
) -> impl TypedValueParser<Value = T> + use<T> {
    PossibleValuesParser::new(all.iter().map(|(_, name)| *name)).try_map(move |chosen| {
        let known = all.iter().find(|(_, name)| *name == chosen);
        known.map(|(value, _)| *value).ok_or("no such value")
    })
}

/// What differs from [`Accuracy::ROBUST`], as options of the command line; `robust` if nothing does.
pub fn describe(accuracy: Accuracy) -> String {
    let robust = Accuracy::ROBUST;
    let options = [
        (accuracy.triangle != robust.triangle).then(|| format!("--triangle-test {}", accuracy.triangle)),
        (accuracy.slab != robust.slab).then(|| format!("--slab-test {}", accuracy.slab)),
        (accuracy.sphere != robust.sphere).then(|| format!("--sphere-test {}", accuracy.sphere)),
        (accuracy.offset != robust.offset).then(|| format!("--ray-offset {}", accuracy.offset)),
    ];
    let differing: Vec<_> = options.into_iter().flatten().collect();
    if differing.is_empty() { "robust".to_owned() } else { differing.join(" ") }
}
