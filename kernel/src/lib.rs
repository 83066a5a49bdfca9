//! A path tracing kernel: `no_std`, no allocator, no threads, no globals, the same bits on every target.
//!
//! ```text
//!     sampler      camera          bvh/traverse       surface          material/  light/           film
//!     numbers -> lens, film -> Ray -> intersect -> Hit -> SurfacePoint -> BsdfSample, LightSample -> radiance -> Pixel
//!                    ^                                    |  (occluded for shadow rays)
//!                    +------ path: throughput *= weight; departure starts the next Ray <--+
//! ```
//!
//! [`View::render`] follows one path after the other; [`View::render_wavefront`] many side by side, through the same
//! functions.
//!
//! # Conventions
//! Right-handed, y up; a camera's picture has row 0 on top; counter-clockwise front faces. Scene units are whatever
//! the caller's are; angles are radians; light is linear Rec.709 radiance. Directions `wo` and `wi` leave a surface.
//! Everything is generic over [`Real`] (f32, f64) and over an [`EffectSet`]; the kernel instantiates nothing.
//!
//! # Same bits
//! Only IEEE `+ - * / sqrt` and comparisons in a fixed order, bit operations, and the `libm` crate. Results depend on
//! scene, seed and sample index alone.
//!
//! # To add
//! - an effect: a bit in [`effects`], its code behind `if const`, its line in `required_effects`;
//! - an alternative of accuracy: a value in [`accuracy`], its code behind `match const`, its row in the host's table;
//! - a shape, a material, a light: a variant in [`shape`], [`material`], [`light`], one file for it, then follow the
//!   compiler.
#![no_std]
#![forbid(unsafe_code)]

pub mod accuracy;
pub mod aim;
pub mod bvh;
pub mod camera;
mod clearance;
mod departure;
pub mod effects;
mod elementary;
pub mod error;
pub mod film;
pub mod lanes;
pub mod light;
pub mod material;
pub mod path;
pub mod ray;
pub mod real;
pub mod robust;
pub mod sampler;
pub mod scene;
pub mod shape;
pub mod surface;
pub mod texture;
mod vector;
pub mod view;
pub mod warp;
mod wavefront;

pub use accuracy::Accuracy;
pub use aim::Aim;
pub use camera::{Camera, CameraSettings, Filter};
pub use effects::{EffectSet, Effects, Everything};
pub use film::{ImageHash, Pixel};
pub use path::PathOptions;
pub use ray::{Hit, Ray};
pub use real::Real;
pub use sampler::SamplerKind;
pub use scene::{Scene, SceneParts};
pub use view::{View, Work};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeExamples;
