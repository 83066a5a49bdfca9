//! What a ledger varies: options, each with levels, one of them changed at a time.

use std::fmt;

use ocellus_kernel::accuracy::{RayOffset, SlabTest, SphereTest, TriangleTest};

use crate::aims::aims;
use crate::assemble::Accel;
use crate::description::{
    FresnelDescription, IntegratorDescription, LightDescription, LightSamplingDescription, SamplerDescription,
    ScatteringDescription, SceneDescription,
};
use crate::isa::{Isa, IsaChoice};
use crate::kernels::EffectChoice;
use crate::render::{Precision, RenderSettings};

/// What can be varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Choice {
    /// Where the numbers of samples come from.
    Sampler,
    /// How spherical lights are sampled.
    LightSampling,
    /// How dielectrics share light.
    Fresnel,
    /// Half as many scattering events, and twice as many.
    MaxBounces,
    /// Paths that end at random.
    Roulette,
    /// Diffuse directions that aim at light and what gathers it.
    Aim,
    /// f32 and f64.
    Precision,
    /// How rays are tested against triangles.
    TriangleTest,
    /// How rays are tested against boxes.
    SlabTest,
    /// How rays are tested against spheres.
    SphereTest,
    /// How far off a surface rays start.
    RayOffset,
    /// How the closest surface is found.
    Accel,
    /// The smallest kernel or the one that does everything.
    Effects,
    /// Instructions that the kernel may use.
    Isa,
}

impl Choice {
    /// All there are.
    pub const ALL: [Self; 14] = [
        Self::Sampler,
        Self::LightSampling,
        Self::Fresnel,
        Self::MaxBounces,
        Self::Roulette,
        Self::Aim,
        Self::Precision,
        Self::TriangleTest,
        Self::SlabTest,
        Self::SphereTest,
        Self::RayOffset,
        Self::Accel,
        Self::Effects,
        Self::Isa,
    ];

    /// What is varied where nothing is named: what is most often asked.
    pub const USUAL: [Self; 10] = [
        Self::Sampler,
        Self::LightSampling,
        Self::Fresnel,
        Self::MaxBounces,
        Self::Roulette,
        Self::Aim,
        Self::Precision,
        Self::RayOffset,
        Self::Accel,
        Self::Effects,
    ];

    /// Whether its levels give the same picture, bit for bit, so that only the time differs.
    pub fn keeps_the_picture(self) -> bool {
        matches!(self, Self::Accel | Self::Effects | Self::Isa)
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Sampler => "sampler",
            Self::LightSampling => "light-sampling",
            Self::Fresnel => "fresnel",
            Self::MaxBounces => "max-bounces",
            Self::Roulette => "roulette",
            Self::Aim => "aim",
            Self::Precision => "precision",
            Self::TriangleTest => "triangle-test",
            Self::SlabTest => "slab-test",
            Self::SphereTest => "sphere-test",
            Self::RayOffset => "ray-offset",
            Self::Accel => "accel",
            Self::Effects => "effects",
            Self::Isa => "isa",
        })
    }
}

/// The scene as asked for, or with one option at another level.
#[derive(Clone, Debug)]
pub struct Level {
    /// The option that differs; `None` for the scene as asked for.
    pub choice: Option<Choice>,
    /// The level it is at, in the words of the command line.
    pub name: String,
    /// How light is simulated.
    pub integrator: IntegratorDescription,
    /// How it is rendered.
    pub settings: RenderSettings,
}

/// A level that is not measured, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The option.
    pub choice: Choice,
    /// Its level.
    pub name: String,
    /// The reason, for people.
    pub why: String,
}

/// More primitives than this are not tested one by one for each ray: that would take the whole budget.
const MANY_PRIMITIVES: usize = 5000;

/// The scene as it is asked for, first, and then each level of `vary` that is another one and can matter to the scene.
pub fn levels(scene: &SceneDescription, settings: &RenderSettings, vary: &[Choice]) -> (Vec<Level>, Vec<LeftOut>) {
    let baseline =
        Level { choice: None, name: String::new(), integrator: scene.integrator.clone(), settings: settings.clone() };
    let mut made = Made { baseline, levels: Vec::new(), left_out: Vec::new() };
    for choice in Choice::ALL.into_iter().filter(|choice| vary.contains(choice)) {
        made.vary(choice, scene);
    }
    let Made { baseline, levels, left_out } = made;
    (std::iter::once(baseline).chain(levels).collect(), left_out)
}

struct Made {
    baseline: Level,
    levels: Vec<Level>,
    left_out: Vec<LeftOut>,
}

impl Made {
    fn vary(&mut self, choice: Choice, scene: &SceneDescription) {
        let (integrator, settings) = (self.baseline.integrator.clone(), self.baseline.settings.clone());
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let balls = scene.spheres.len() + sphere_lights(scene);
        match choice {
            Choice::Sampler => {
                use SamplerDescription::{Independent, Sobol};
                self.each(
                    choice,
                    integrator.sampler,
                    [(Independent, "independent"), (Sobol, "sobol")],
                    |level, value| {
                        level.integrator.sampler = value;
                    },
                );
            }
            Choice::LightSampling if sphere_lights(scene) > 0 => {
                use LightSamplingDescription::{Cone, Hemisphere, None};
                self.each(
                    choice,
                    integrator.light_sampling,
                    [(Cone, "cone"), (Hemisphere, "hemisphere"), (None, "none")],
                    |level, value| {
                        level.integrator.light_sampling = value;
                    },
                );
            }
            Choice::Fresnel if has_glass(scene) => {
                use FresnelDescription::{Exact, None, Schlick};
                self.each(
                    choice,
                    integrator.fresnel,
                    [(Exact, "exact"), (Schlick, "schlick"), (None, "none")],
                    |level, value| {
                        level.integrator.fresnel = value;
                    },
                );
            }
            Choice::MaxBounces if integrator.indirect => {
                let asked = integrator.max_bounces;
                for bounces in [asked / 2, asked.saturating_mul(2).min(65_535)] {
                    self.each(choice, asked, [(bounces, &*bounces.to_string())], |level, value| {
                        level.integrator.max_bounces = value;
                    });
                }
            }
            Choice::Roulette if integrator.max_bounces > 1 && integrator.indirect => {
                self.each(choice, integrator.roulette_after, [(None, "off"), (Some(1), "after 1")], |level, value| {
                    level.integrator.roulette_after = value;
                });
            }
            Choice::Aim if integrator.indirect && !aims(scene).is_empty() => {
                self.each(choice, integrator.aim, [(false, "off"), (true, "on")], |level, value| {
                    level.integrator.aim = value;
                });
            }
            Choice::Precision => {
                self.each(
                    choice,
                    settings.precision,
                    [(Precision::F32, "f32"), (Precision::F64, "f64")],
                    |level, value| {
                        level.settings.precision = value;
                    },
                );
            }
            Choice::TriangleTest if triangles > 0 => {
                self.each(choice, settings.accuracy.triangle, TriangleTest::ALL.iter().copied(), |level, value| {
                    level.settings.accuracy.triangle = value;
                });
            }
            Choice::SlabTest if triangles + balls > 1 => {
                self.each(choice, settings.accuracy.slab, SlabTest::ALL.iter().copied(), |level, value| {
                    level.settings.accuracy.slab = value;
                });
            }
            Choice::SphereTest if balls > 0 => {
                self.each(choice, settings.accuracy.sphere, SphereTest::ALL.iter().copied(), |level, value| {
                    level.settings.accuracy.sphere = value;
                });
            }
            Choice::RayOffset => {
                self.each(choice, settings.accuracy.offset, RayOffset::ALL.iter().copied(), |level, value| {
                    level.settings.accuracy.offset = value;
                });
            }
            Choice::Accel => {
                let all = [(Accel::Bvh, "bvh"), (Accel::Box, "box"), (Accel::None, "none")];
                let primitives = triangles + balls;
                let (possible, slow): (Vec<_>, Vec<_>) =
                    all.into_iter().partition(|(accel, _)| *accel == Accel::Bvh || primitives <= MANY_PRIMITIVES);
                for (_, name) in slow {
                    let why = format!("each ray would be tested against {primitives} primitives");
                    self.left_out.push(LeftOut { choice, name: name.into(), why });
                }
                self.each(choice, settings.accel, possible, |level, value| level.settings.accel = value);
            }
            Choice::Effects => {
                let all = [(EffectChoice::Auto, "auto"), (EffectChoice::All, "all")];
                self.each(choice, settings.effects, all, |level, value| level.settings.effects = value);
            }
            Choice::Isa if Isa::available().count() > 1 => {
                let all = [(IsaChoice::Auto, "auto"), (IsaChoice::Baseline, "baseline")];
                self.each(choice, settings.isa, all, |level, value| level.settings.isa = value);
            }
            _ => {}
        }
    }

    /// A level for each value but the one that the scene is asked for with.
    fn each<'a, T: Copy + PartialEq>(
        &mut self,
        choice: Choice,
        asked: T,
        values: impl IntoIterator<Item = (T, &'a str)>,
        set: impl Fn(&mut Level, T),
    ) {
        for (value, name) in values.into_iter().filter(|(value, _)| *value != asked) {
            let mut level = Level { choice: Some(choice), name: name.to_owned(), ..self.baseline.clone() };
            set(&mut level, value);
            self.levels.push(level);
        }
    }
}

fn sphere_lights(scene: &SceneDescription) -> usize {
    scene.lights.iter().filter(|light| matches!(light, LightDescription::Sphere { .. })).count()
}

fn has_glass(scene: &SceneDescription) -> bool {
    scene.materials.iter().any(|material| matches!(material.scattering, ScatteringDescription::Dielectric { .. }))
}
