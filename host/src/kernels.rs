//! The table of kernels: every instantiation there is, and the choice of the smallest that covers a view.
//!
//! A row exists only where it was measured to pay: `cargo bench -p ocellus --bench figures -- instructions` prints by
//! how much. Each alternative of [`Accuracy`] is there once, alone, on the kernel that does everything.

use std::marker::PhantomData;
use std::ops::Range;

use ocellus_kernel::accuracy::{RayOffset, SlabTest, SphereTest, TriangleTest};
use ocellus_kernel::{Accuracy, EffectSet, Effects, Everything, Pixel, Real, View, Work};

use crate::accuracy::describe;
use crate::error::Error;
use crate::isa::{self, Isa, Prefetching};

/// A kernel: adds samples to a stretch of pixels ([`View::render`]).
pub type Kernel<R> = fn(&View<'_, R>, u32, u32, Range<u32>, &mut [Pixel]) -> Work;

/// One effect set and accuracy, compiled for both precisions and each instruction set.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its name in `explain` and `--json`.
    pub name: &'static str,
    /// What it can do.
    pub effects: Effects,
    /// What exactness it spends time on.
    pub accuracy: Accuracy,
    f32: Kernels<f32>,
    f64: Kernels<f64>,
}

/// Which kernels a render may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum EffectChoice {
    /// The smallest kernel that covers the scene.
    #[default]
    Auto,
    /// The kernel that can do everything.
    All,
}

/// A precision that the table has a column for.
pub trait TableReal: Real {
    /// The row's kernels in this precision.
    fn kernels(row: &Row) -> &Kernels<Self>;
}

impl TableReal for f32 {
    fn kernels(row: &Row) -> &Kernels<f32> {
        &row.f32
    }
}

impl TableReal for f64 {
    fn kernels(row: &Row) -> &Kernels<f64> {
        &row.f64
    }
}

/// One effect set in one precision, for each instruction set.
#[derive(Clone, Copy, Debug)]
pub struct Kernels<R: Real> {
    baseline: Kernel<R>,
    avx2: Kernel<R>,
    avx512: Kernel<R>,
}

impl<R: Real> Kernels<R> {
    /// One path at a time; for AVX-512 as for AVX2, which keeps the program small.
    const fn single<E: EffectSet>() -> Self {
        let avx2 = with_avx2::<R, Single<E>>;
        Self { baseline: render::<R, Single<E>>, avx2, avx512: avx2 }
    }

    /// Many paths at a time where registers are wide enough for that to pay.
    const fn many<E: EffectSet>() -> Self {
        Self { baseline: render::<R, Single<E>>, avx2: with_avx2::<R, Many<E>>, avx512: with_avx512::<R, Many<E>> }
    }

    /// The one for these instructions.
    pub fn of_isa(&self, isa: Isa) -> Kernel<R> {
        match isa {
            Isa::Baseline => self.baseline,
            Isa::Avx2 => self.avx2,
            Isa::Avx512 => self.avx512,
        }
    }
}

/// A way to follow paths.
trait Way {
    fn render<R: Real>(view: &View<'_, R>, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work;
}

/// One after the other.
struct Single<E>(PhantomData<E>);

impl<E: EffectSet> Way for Single<E> {
    #[inline(always)]
    fn render<R: Real>(view: &View<'_, R>, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work {
        view.render::<Prefetching<E>>(x, y, samples, pixels)
    }
}

/// Side by side.
struct Many<E>(PhantomData<E>);

impl<E: EffectSet> Way for Many<E> {
    #[inline(always)]
    fn render<R: Real>(view: &View<'_, R>, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work {
        view.render_wavefront::<Prefetching<E>>(x, y, samples, pixels)
    }
}

/// The body of every row: a function of its own per precision, effect set and way, so that profiles and disassembly show
/// which is which.
#[inline(never)]
fn render<R: Real, W: Way>(view: &View<'_, R>, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work {
    W::render(view, x, y, samples, pixels)
}

/// [`render`] with more instructions, where the machine has them.
macro_rules! with_instructions {
    ($name:ident, $has:path, $features:literal) => {
        #[inline(never)]
        fn $name<R: Real, W: Way>(
            view: &View<'_, R>,
            x: u32,
            y: u32,
            samples: Range<u32>,
            pixels: &mut [Pixel],
        ) -> Work {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = $features)]
                fn compiled<R: Real, W: Way>(
                    view: &View<'_, R>,
                    x: u32,
                    y: u32,
                    samples: Range<u32>,
                    pixels: &mut [Pixel],
                ) -> Work {
                    W::render(view, x, y, samples, pixels)
                }

                if $has() {
                    // SAFETY: the machine has what the function was compiled for.
                    return unsafe { compiled::<R, W>(view, x, y, samples, pixels) };
                }
            }
            render::<R, W>(view, x, y, samples, pixels)
        }
    };
}

with_instructions!(with_avx2, isa::has_avx2, "avx2");
with_instructions!(with_avx512, isa::has_avx512, "avx2,avx512f,avx512bw,avx512dq,avx512vl");

/// A row whose paths are followed one by one.
const fn row<E: EffectSet>(name: &'static str) -> Row {
    Row { name, effects: E::EFFECTS, accuracy: E::ACCURACY, f32: Kernels::single::<E>(), f64: Kernels::single::<E>() }
}

/// A row whose paths are followed side by side in f32. In f64 there are fewer lanes, and spheres have no bounds.
const fn row_of_many<E: EffectSet>(name: &'static str) -> Row {
    Row { f32: Kernels::many::<E>(), ..row::<E>(name) }
}

macro_rules! table {
    ($($set:ident $name:literal $doc:literal = $($effect:ident)|+;)*) => {
        $(
            #[doc = $doc]
            #[derive(Clone, Copy, Debug)]
            pub struct $set;

            impl EffectSet for $set {
                const EFFECTS: Effects = Effects::NONE$(.union(Effects::$effect))+;
            }
        )*

        /// All kernels, the largest last.
        pub const TABLE: &[Row] = &[$(row_of_many::<$set>($name),)* row::<Everything>("everything")];
    };
}

table! {
    MatteSpheres "matte-spheres" "Diffuse spheres, point lights, direct light." =
        SPHERES | POINT_LIGHT | FILTER;
    DirectSpheres "direct-spheres" "Diffuse, mirror and glass spheres, point lights, direct light." =
        SPHERES | MIRROR | GLASS | POINT_LIGHT | FILTER;
    PointLitSpheres "point-lit-spheres" "Diffuse, mirror and glass spheres, point lights." =
        SPHERES | MIRROR | GLASS | POINT_LIGHT | INDIRECT | FILTER;
    SphereLitSpheres "sphere-lit-spheres" "Diffuse, mirror and glass spheres, spherical lights." =
        SPHERES | MIRROR | GLASS | SPHERE_LIGHT | INDIRECT | FILTER;
    LensSpheres "lens-spheres" "Diffuse, mirror and glass spheres, spherical lights, through a lens." =
        SPHERES | MIRROR | GLASS | SPHERE_LIGHT | INDIRECT | FILTER | LENS;
    SphereLitMatte "sphere-lit-matte" "Diffuse triangles and spheres, spherical lights." =
        SPHERES | TRIANGLES | SPHERE_LIGHT | INDIRECT | FILTER;
    QuietPointLitSpheres "quiet-point-lit-spheres" "Point-lit spheres with Sobol's numbers and roulette." =
        SPHERES | MIRROR | GLASS | POINT_LIGHT | INDIRECT | FILTER | SOBOL | ROULETTE;
    QuietSphereLitSpheres "quiet-sphere-lit-spheres" "Sphere-lit spheres with Sobol's numbers, roulette and aim." =
        SPHERES | MIRROR | GLASS | SPHERE_LIGHT | INDIRECT | FILTER | SOBOL | ROULETTE | AIM;
    QuietSphereLitMatte "quiet-sphere-lit-matte" "Sphere-lit matte with Sobol's numbers and roulette." =
        SPHERES | TRIANGLES | SPHERE_LIGHT | INDIRECT | FILTER | SOBOL | ROULETTE;
    PointLitTextured "point-lit-textured" "Textured and smooth diffuse triangles and spheres, point lights." =
        SPHERES | TRIANGLES | SMOOTH_NORMALS | TEXTURES | POINT_LIGHT | INDIRECT | FILTER;
}

macro_rules! alternatives {
    ($($kernel:ident $doc:literal = $choice:ident $value:expr;)*) => {
        $(
            #[doc = $doc]
            #[derive(Clone, Copy, Debug)]
            pub struct $kernel;

            impl EffectSet for $kernel {
                const EFFECTS: Effects = Effects::EVERYTHING;
                const ACCURACY: Accuracy = Accuracy { $choice: $value, ..Accuracy::ROBUST };
            }
        )*

        /// Kernels that do everything, each with one alternative of [`Accuracy`].
        pub const ALTERNATIVES: &[Row] = &[$(row::<$kernel>("everything")),*];
    };
}

alternatives! {
    FastTriangles "Triangles by Moller and Trumbore." = triangle TriangleTest::Fast;
    NarrowTriangles "Watertight triangles without wider numbers." = triangle TriangleTest::Narrow;
    WideTriangles "Watertight triangles all in wider numbers." = triangle TriangleTest::Wide;
    UnpaddedBoxes "Boxes exactly as computed." = slab SlabTest::Unpadded;
    NarrowSpheres "Spheres without wider numbers." = sphere SphereTest::Narrow;
    BoundedOffset "Rays that start off their own surfaces, and maybe beyond others." = offset RayOffset::Bounded;
    ConstantOffset "Rays that start a constant off their surfaces." = offset RayOffset::Constant;
}

/// The row with the fewest effects that has all of `required`, with this accuracy.
///
/// # Errors
/// No row has them: the effect set of a newer kernel, or more than one alternative at once.
pub fn select(required: Effects, choice: EffectChoice, accuracy: Accuracy) -> Result<&'static Row, Error> {
    if accuracy != Accuracy::ROBUST {
        return ALTERNATIVES.iter().find(|row| row.accuracy == accuracy).ok_or_else(|| {
            Error::usage(format!("no kernel has {}", describe(accuracy)), format!("choose one of: {}", available()))
        });
    }
    TABLE
        .iter()
        .filter(|row| row.effects.contains(required))
        .filter(|row| choice == EffectChoice::Auto || row.effects == Effects::EVERYTHING)
        .min_by_key(|row| row.effects.len())
        .ok_or_else(|| {
            let names: Vec<_> = required.names().collect();
            Error::usage(format!("no kernel has all of: {}", names.join(", ")), "use --effects all")
        })
}

/// The accuracies that there are kernels for, in the words of the command line.
fn available() -> String {
    let alternatives = ALTERNATIVES.iter().map(|row| describe(row.accuracy));
    alternatives.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_of_effects_has_a_row_that_covers_it() {
        for mask in 0..1u32 << Effects::ALL.len() {
            let required = Effects::ALL
                .iter()
                .enumerate()
                .filter(|(bit, _)| mask >> bit & 1 == 1)
                .fold(Effects::NONE, |set, (_, (effect, _))| set.union(*effect));
            let row = select(required, EffectChoice::Auto, Accuracy::ROBUST).unwrap();
            assert!(row.effects.contains(required));
        }
    }

    #[test]
    fn the_last_row_can_do_everything_and_names_differ() {
        assert_eq!(TABLE.last().unwrap().effects, Effects::EVERYTHING);
        for (index, row) in TABLE.iter().enumerate() {
            assert!(TABLE[..index].iter().all(|other| other.name != row.name && other.effects != row.effects));
        }
    }
}
