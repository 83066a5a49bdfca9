//! A view of a scene and the loop over the samples of a stretch of pixels: what a host calls.

use core::ops::Range;

use crate::camera::Camera;
use crate::effects::{EffectSet, Effects};
use crate::film::{Pixel, to_sample};
use crate::path::{PathOptions, PathSample, radiance};
use crate::real::Real;
use crate::sampler::{AddressedSampler, Block, Sampler};
use crate::scene::Scene;

/// A scene seen by a camera, with the light transport to simulate.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, R: Real> {
    /// What is seen.
    pub scene: &'a Scene<'a, R>,
    /// From where.
    pub camera: &'a Camera<R>,
    /// By which light.
    pub options: &'a PathOptions,
}

/// What a stretch of work took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Paths followed: one per pixel and sample.
    pub paths: u64,
    /// Ray queries, closest and any.
    pub rays: u64,
}

impl core::ops::Add for Work {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { paths: self.paths + other.paths, rays: self.rays + other.rays }
    }
}

impl<R: Real> View<'_, R> {
    /// The effects that a kernel must have to render this view.
    pub fn required_effects(&self) -> Effects {
        let aim = Effects::AIM.when(self.options.aim && !self.scene.aims().is_empty());
        let of_options = self.options.required_effects().union(aim);
        self.scene.required_effects().union(self.camera.required_effects()).union(of_options)
    }

    /// Sample number `sample` of the pixel in column `x` and row `y`, with the kernel's own numbers.
    #[inline(always)]
    pub fn sample<E: EffectSet>(&self, x: u32, y: u32, sample: u32) -> PathSample<R> {
        let mut sampler = AddressedSampler::new(self.options.seed, x, y, sample);
        if const { E::EFFECTS.contains(Effects::SOBOL) } {
            sampler = sampler.of_kind(self.options.sampler);
        }
        self.sample_with::<E>(x, y, &mut sampler)
    }

    /// One sample of a pixel with numbers from anywhere.
    #[inline(always)]
    pub fn sample_with<E: EffectSet>(&self, x: u32, y: u32, sampler: &mut impl Sampler) -> PathSample<R> {
        sampler.begin_vertex(0);
        let ray = self.camera.ray::<E>(x, y, sampler.numbers(Block::Scatter));
        radiance::<R, E>(self.scene, self.options, ray, sampler)
    }

    /// [`View::render`] with 64 paths side by side: the same bits, sooner.
    ///
    /// It pays in f32, in a function that is compiled for registers of 256 or 512 bits, and where glam has its feature `std`
    /// (so that square roots are instructions that the compiler knows: anybody who depends on glam can turn it on). It
    /// takes some 60 KiB of stack. Scenes of more than 16 spheres, or of triangles without a hierarchy, and f64, are
    /// rendered as [`View::render`] does.
    #[inline(always)]
    pub fn render_wavefront<E: EffectSet>(&self, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work {
        crate::wavefront::render::<R, E>(self, x, y, samples, pixels)
    }

    /// Adds `samples` to each of `pixels`, which lie side by side from column `x` of row `y`.
    ///
    /// The result depends on nothing but the view and the sample numbers: not on the order of calls, on how pixels
    /// and samples are split among them, or on `E`, as long as it has the view's [`View::required_effects`].
    ///
    /// All of the loop is inlined, so that a function that is compiled for more instructions than the target's baseline
    /// uses them throughout.
    #[inline(always)]
    pub fn render<E: EffectSet>(&self, x: u32, y: u32, samples: Range<u32>, pixels: &mut [Pixel]) -> Work {
        let mut work = Work::default();
        for (offset, pixel) in pixels.iter_mut().enumerate() {
            for sample in samples.clone() {
                let path = self.sample::<E>(x.wrapping_add(offset as u32), y, sample);
                pixel.add(to_sample::<R>(path.radiance));
                work = work + Work { paths: 1, rays: u64::from(path.rays) };
            }
        }
        work
    }
}
