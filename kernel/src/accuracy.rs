//! What exactness is spent on: one type for each choice that trades accuracy for time.
//!
//! A kernel is compiled for one value of each, its [`Accuracy`], as it is for a set of effects: what is not chosen
//! leaves no code behind. The default, [`Accuracy::ROBUST`], is right on every hard case; what each other value saves
//! and what it loses is measured by `cargo bench -p ocellus-tests --bench prices`.
//!
//! ```
//! use ocellus_kernel::accuracy::{Accuracy, TriangleTest};
//! use ocellus_kernel::{EffectSet, Effects};
//!
//! #[derive(Clone, Copy)]
//! struct Quick;
//!
//! impl EffectSet for Quick {
//!     const EFFECTS: Effects = Effects::TRIANGLES.union(Effects::POINT_LIGHT);
//!     const ACCURACY: Accuracy = Accuracy { triangle: TriangleTest::Fast, ..Accuracy::ROBUST };
//! }
//! ```
//!
//! How dielectrics split light is a choice of the scene, [`crate::material::Fresnel`], and so is how lights are sampled,
//! [`crate::light::LightSampling`], and with which numbers, [`crate::sampler::SamplerKind`].

macro_rules! choices {
    ($($(#[$doc:meta])* $name:ident { $($(#[$value_doc:meta])* $value:ident $word:literal,)* } robust $robust:ident)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
            pub enum $name { $($(#[$value_doc])* $value,)* }

            impl $name {
                /// Every value with its name.
                pub const ALL: &[(Self, &str)] = &[$((Self::$value, $word)),*];
            }

            impl Default for $name {
                fn default() -> Self {
                    Self::$robust
                }
            }

            impl core::fmt::Display for $name {
                fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                    f.write_str(match self { $(Self::$value => $word,)* })
                }
            }
        )*
    };
}

choices! {
    /// How a ray is tested against a triangle.
    TriangleTest {
        /// Moller and Trumbore (JGT 2:1, 1997), all in the kernel's precision. Rays pass between neighbours; triangles
        /// without area may be hit.
        Fast "fast",
        /// Woop, Benthin and Wald (JCGT 2:1, 2013), all in the kernel's precision. Neighbours leave no gap, unless products
        /// of coordinates underflow; t of a sliver is as inexact as the sliver is thin.
        Narrow "narrow",
        /// The same with exact signs: products of sheared corners are formed in the wide precision.
        Watertight "watertight",
        /// The same with everything in the wide precision, from the difference of corner and origin on; the same as
        /// `Watertight` where the wide precision adds no bits.
        Wide "wide",
    }
    robust Watertight

    /// How a ray is tested against a box.
    SlabTest {
        /// Exactly as computed: rays that touch edges and corners may miss.
        Unpadded "unpadded",
        /// Larger by what rounding can take away (Ize, JCGT 2:2, 2013).
        Padded "padded",
    }
    robust Padded

    /// How a ray is tested against a sphere.
    SphereTest {
        /// In the kernel's precision, with a refined foot point and the product of the roots.
        Narrow "narrow",
        /// In the wide precision; the same as `Narrow` where that adds no bits.
        Wide "wide",
    }
    robust Wide

    /// Where rays that leave a surface start.
    RayOffset {
        /// [`CONSTANT_OFFSET`] off the surface, whatever the scene's scale.
        Constant "constant",
        /// Beyond a derived bound on the error of the point (PBR 4ed, section 6.8.6). Where two surfaces meet, a ray that
        /// leaves one may start behind the other.
        Bounded "bounded",
        /// The same, and on the right side of all triangles that are as near: the one that the ray came from, or, where
        /// they pass through a triangle, the one that it lies on. Rays that pass through a sphere start as `Bounded` has it.
        Cleared "cleared",
    }
    robust Cleared
}

/// How far off a surface rays start by [`RayOffset::Constant`], scene units.
pub const CONSTANT_OFFSET: f64 = 1e-3;

/// One value of each choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Accuracy {
    /// Of triangles.
    pub triangle: TriangleTest,
    /// Of boxes.
    pub slab: SlabTest,
    /// Of spheres.
    pub sphere: SphereTest,
    /// Of the rays that leave them.
    pub offset: RayOffset,
}

impl Accuracy {
    /// Right on every hard case.
    pub const ROBUST: Self = Self {
        triangle: TriangleTest::Watertight,
        slab: SlabTest::Padded,
        sphere: SphereTest::Wide,
        offset: RayOffset::Cleared,
    };

    /// Whether boxes are padded.
    pub(crate) const fn pads_boxes(self) -> bool {
        matches!(self.slab, SlabTest::Padded)
    }

    /// Whether `Sphere::has_in_box` can prove anything: it counts on the errors of the wide test and on padding.
    pub(crate) const fn proves_boxes_of_spheres(self) -> bool {
        self.pads_boxes() && matches!(self.sphere, SphereTest::Wide)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robust_is_the_default() {
        assert_eq!(Accuracy::default(), Accuracy::ROBUST);
    }
}
