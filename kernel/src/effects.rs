//! Effects are named here: one bit for each optional behaviour.
//!
//! | bit | who asks for it | what spends it | what it costs when on |
//! |---|---|---|---|
//! | `SPHERES` | a sphere in the scene | `shape::sphere`, called by `bvh::traverse` | a test per sphere met |
//! | `TRIANGLES` | a triangle in the scene | `shape::triangle`, called by `bvh::traverse`; `clearance` | a test per triangle met, the shear of each ray, a look around each hit |
//! | `SMOOTH_NORMALS` | a triangle with vertex normals | `surface` | one more normal per hit |
//! | `TEXTURES` | a material with a texture | `surface`, `texture` | texture coordinates and four texels per hit |
//! | `MIRROR` | a mirror material | `material::mirror` | a branch per hit |
//! | `GLASS` | a dielectric material | `material::dielectric`, `material::fresnel` | a branch per hit, refraction |
//! | `POINT_LIGHT` | a point light | `light::point` | a shadow ray per diffuse hit and light |
//! | `SPHERE_LIGHT` | a sphere light | `light::sphere` | a shadow ray and a cone sample per diffuse hit and light |
//! | `EMISSION` | an emitting surface that is not a light | `path` | the last segment of every path |
//! | `BACKGROUND` | a background that is not black | `path` | the last segment of every path |
//! | `INDIRECT` | `PathOptions::indirect` | `path` | all segments after the first diffuse hit |
//! | `ROULETTE` | `PathOptions::roulette_after` | `path` | a comparison and a division per bounce |
//! | `LENS` | a camera with an aperture | `camera` | a point on the lens per path |
//! | `FILTER` | a tent or Gaussian pixel filter | `camera` | square roots (and a logarithm) per path |
//! | `SOBOL` | `PathOptions::sampler` | `sampler::sobol`, called by `view` | a Philox per path and five scrambles per four numbers, for a Philox each |
//! | `AIM` | `PathOptions::aim`, and something to aim at | `aim`, called by `path` | two cones per diffuse bounce and object aimed at |
//!
//! A kernel is compiled for a set of them, an [`EffectSet`]. An effect outside of the set leaves no code behind; a
//! scene must only be given to a kernel whose set contains the scene's own ([`crate::View::required_effects`]).

use crate::accuracy::Accuracy;

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Effects(u32);

macro_rules! effects {
    ($($bit:literal $name:ident $word:literal $doc:literal;)*) => {
        impl Effects {
            $(#[doc = $doc] pub const $name: Self = Self(1 << $bit);)*
            /// Every effect there is, with its name, in order.
            pub const ALL: &[(Self, &str)] = &[$((Self::$name, $word)),*];
            /// The union of all.
            pub const EVERYTHING: Self = Self(0 $(| 1 << $bit)*);
        }
    };
}

effects! {
    0 SPHERES "spheres" "Spheres among the primitives.";
    1 TRIANGLES "triangles" "Triangles among the primitives.";
    2 SMOOTH_NORMALS "smooth-normals" "Interpolated vertex normals.";
    3 TEXTURES "textures" "Textured albedo.";
    4 MIRROR "mirror" "Perfect mirrors.";
    5 GLASS "glass" "Smooth dielectrics.";
    6 POINT_LIGHT "point-light" "Isotropic point lights.";
    7 SPHERE_LIGHT "sphere-light" "Sampled spherical lights.";
    8 EMISSION "emission" "Emitting surfaces that paths find by chance.";
    9 BACKGROUND "background" "Constant radiance from all directions.";
    10 INDIRECT "indirect" "Light that a diffuse surface passes on.";
    11 ROULETTE "roulette" "Unbiased random path ends.";
    12 LENS "lens" "A lens of finite aperture.";
    13 FILTER "filter" "Tent or Gaussian pixel reconstruction.";
    14 SOBOL "sobol" "Sample numbers that avoid each other.";
    15 AIM "aim" "Diffuse directions that aim at light and what gathers it.";
}

/// [`EffectSet`] without spheres: for searches after which only triangles are left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglesOf<E>(core::marker::PhantomData<E>);

impl<E: EffectSet> EffectSet for TrianglesOf<E> {
    const EFFECTS: Effects = E::EFFECTS.without(Effects::SPHERES);
    const ACCURACY: Accuracy = E::ACCURACY;

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        E::prefetch(soon);
    }
}

impl Effects {
    /// No effect.
    pub const NONE: Self = Self(0);

    /// Whether all of `other` are in this set.
    #[inline]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any of `other` is in this set.
    #[inline]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Both sets together.
    #[inline]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// This set without `other`.
    #[inline]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// `self` if `on`, else nothing.
    #[inline]
    pub const fn when(self, on: bool) -> Self {
        if on { self } else { Self::NONE }
    }

    /// How many effects are in the set.
    pub const fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether no effect is in the set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The names of the effects in the set, in order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::ALL.iter().filter(move |(effect, _)| self.contains(*effect)).map(|(_, name)| *name)
    }
}

/// What a kernel is compiled for.
pub trait EffectSet: Copy + Send + Sync + 'static {
    /// The effects.
    const EFFECTS: Effects;
    /// What exactness it spends its time on.
    const ACCURACY: Accuracy = Accuracy::ROBUST;

    /// Called with what is about to be read, for processors that have an instruction to fetch it meanwhile. Nothing but time
    /// depends on it, and by default it does nothing: such instructions need `unsafe` code. Sets that wrap another pass it
    /// on.
    #[inline(always)]
    fn prefetch<T>(_soon: &T) {}
}

/// The kernel that can do all there is.
#[derive(Clone, Copy, Debug)]
pub struct Everything;

impl EffectSet for Everything {
    const EFFECTS: Effects = Effects::EVERYTHING;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_effect_has_a_bit_of_its_own() {
        let union = Effects::ALL.iter().fold(Effects::NONE, |set, (effect, _)| {
            assert!(!set.intersects(*effect));
            set.union(*effect)
        });
        assert_eq!(union, Effects::EVERYTHING);
        assert_eq!(union.names().count(), Effects::ALL.len());
    }
}
