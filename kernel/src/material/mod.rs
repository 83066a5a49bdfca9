//! What surfaces do to light. ADD A MATERIAL HERE.
//!
//! Each BSDF has `sample`: from `wo` and numbers to a [`BsdfSample`]. Directions leave the surface.

pub mod dielectric;
pub mod diffuse;
pub mod fresnel;
pub mod mirror;

pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use fresnel::Fresnel;
pub use mirror::Mirror;

use crate::real::{Real, Vec3, Vector};

/// A material: how it scatters light and what it emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<R: Real> {
    /// What it does to light that arrives.
    pub scattering: Scattering<R>,
    /// Radiance it emits on both sides, linear Rec.709; zero for most.
    pub emission: Vec3<R>,
}

impl<R: Real> Material<R> {
    /// Whether it emits anything.
    #[inline]
    pub fn is_emissive(&self) -> bool {
        self.emission != Vec3::<R>::ZERO
    }
}

/// The kinds of scattering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scattering<R: Real> {
    /// Lambertian reflection.
    Diffuse(Diffuse<R>),
    /// Perfect reflection.
    Mirror(Mirror<R>),
    /// Smooth glass or liquid.
    Dielectric(Dielectric<R>),
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample<R: Real> {
    /// Unit direction that leaves the surface.
    pub wi: Vec3<R>,
    /// `f cos / pdf`, what throughput is multiplied by.
    pub weight: Vec3<R>,
    /// Whether the direction was the only possible one, so that no light sample could have found it.
    pub delta: bool,
}
