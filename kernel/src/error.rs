//! What can be wrong with what a caller hands in: one small error per operation.

use core::fmt;

/// A storage that is too small. Nothing was built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapacityError {
    /// Which storage.
    pub what: Capacity,
    /// How many items it has to hold.
    pub needed: usize,
    /// How many it can hold.
    pub capacity: usize,
}

/// A storage that the caller provides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capacity {
    /// Nodes of the hierarchy; [`crate::bvh::required_nodes`].
    Nodes,
    /// Spheres of the leaves, in fours; one per sphere is enough.
    SphereQuads,
    /// Triangles of the leaves, in fours; one per triangle is enough.
    TriangleQuads,
    /// Scratch of the builder; one item per primitive.
    Scratch,
}

impl fmt::Display for CapacityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.what {
            Capacity::Nodes => "nodes",
            Capacity::SphereQuads => "sphere quads",
            Capacity::TriangleQuads => "triangle quads",
            Capacity::Scratch => "build scratch",
        };
        write!(f, "{what}: {} needed, room for {}; lend a larger slice", self.needed, self.capacity)
    }
}

impl core::error::Error for CapacityError {}

/// Primitives that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// The sphere's centre is not finite, or its radius not positive and finite.
    Sphere {
        /// Which sphere.
        index: usize,
    },
    /// A corner index is outside of the positions.
    TriangleCorner {
        /// Which triangle.
        index: usize,
        /// How many positions there are.
        positions: usize,
    },
    /// More than 2^31 primitives.
    TooMany,
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sphere { index } => {
                write!(f, "sphere {index}: centre must be finite, radius positive and finite")
            }
            Self::TriangleCorner { index, positions } => {
                write!(f, "triangle {index}: a corner index is not below the {positions} positions")
            }
            Self::TooMany => write!(f, "more than 2^31 primitives; split the scene"),
        }
    }
}

impl core::error::Error for GeometryError {}

/// Parts that do not make a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneError {
    /// The hierarchy was built for other numbers of spheres and triangles.
    Bvh {
        /// Spheres and triangles of the hierarchy.
        built_for: [usize; 2],
        /// Spheres and triangles of the geometry.
        primitives: [usize; 2],
    },
    /// Not one set of attributes per triangle.
    Attributes {
        /// How many sets there are.
        attributes: usize,
        /// How many triangles there are.
        triangles: usize,
    },
    /// A primitive's material index is out of range.
    Material {
        /// Which primitive.
        primitive: usize,
    },
    /// A triangle's normal or texture coordinate index is out of range.
    TriangleAttribute {
        /// Which triangle.
        index: usize,
    },
    /// A material's texture index is out of range.
    Texture {
        /// Which material.
        material: usize,
    },
    /// A texture without texels, or with another number of them than its size says.
    Texels {
        /// Which texture.
        index: usize,
    },
    /// A sphere light's sphere index is out of range.
    Light {
        /// Which light.
        index: usize,
    },
    /// A sphere to aim at has no finite centre, no positive finite radius, or a worth beyond 0..=1, or of 0.
    Aim {
        /// Which one.
        index: usize,
    },
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bvh { built_for: [spheres, triangles], primitives: [has_spheres, has_triangles] } => write!(
                f,
                "the BVH was built for {spheres} spheres and {triangles} triangles, the scene has {has_spheres} and \
                 {has_triangles}; build it again"
            ),
            Self::Attributes { attributes, triangles } => {
                write!(f, "{attributes} triangle attributes for {triangles} triangles; give one for each")
            }
            Self::Material { primitive } => write!(f, "primitive {primitive}: no such material"),
            Self::TriangleAttribute { index } => write!(f, "triangle {index}: no such normal or texture coordinate"),
            Self::Texture { material } => write!(f, "material {material}: no such texture"),
            Self::Texels { index } => write!(f, "texture {index}: width x height must equal its texels, not zero"),
            Self::Light { index } => write!(f, "light {index}: no such sphere"),
            Self::Aim { index } => {
                write!(
                    f,
                    "aim {index}: needs a finite centre, a positive finite radius, and a worth above 0 and up to 1"
                )
            }
        }
    }
}

impl core::error::Error for SceneError {}

/// A camera that sees nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraError {
    /// A value is NaN or infinite.
    NotFinite,
    /// Zero pixels across or down, or more than 65,535.
    Size,
    /// The field of view is not between 0 and pi.
    FieldOfView,
    /// The position and the point it looks at are the same, or up is parallel to the view.
    Orientation,
    /// A negative aperture radius, or one with a focal distance that is not positive.
    Lens,
    /// A negative filter width.
    Filter,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "camera: a value is NaN or infinite",
            Self::Size => "camera: width and height must be 1..=65535 pixels",
            Self::FieldOfView => "camera: the field of view must lie between 0 and pi",
            Self::Orientation => {
                "camera: it must look somewhere else than where it stands, and up must differ from that"
            }
            Self::Lens => "camera: the aperture radius must not be negative, the focal distance positive",
            Self::Filter => "camera: the filter's width must not be negative",
        })
    }
}

impl core::error::Error for CameraError {}
