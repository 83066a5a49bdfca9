//! What the kernel computes, as hashes: one per operation and per picture, in both precisions. Equal hashes on two
//! targets mean equal bits of millions of results.

#![no_std]

mod numbers;
mod operations;
mod pictures;

#[cfg(target_arch = "wasm32")]
mod wasm;

/// Something that is hashed.
pub struct Item {
    /// What it is.
    pub name: &'static str,
    /// `"f32"` or `"f64"`.
    pub precision: &'static str,
    /// Its hash over the first so many queries; of a picture, whatever their number.
    pub hash: fn(queries: u32) -> u64,
}

macro_rules! items {
    ($($module:ident :: $name:ident),* $(,)?) => {
        /// Everything that is hashed.
        pub const ITEMS: &[Item] = &[$(
            Item { name: stringify!($name), precision: "f32", hash: $module::$name::<f32> },
            Item { name: stringify!($name), precision: "f64", hash: $module::$name::<f64> },
        )*];
    };
}

items! {
    operations::square_root,
    operations::sine_and_cosine,
    operations::logarithm,
    operations::normalise,
    operations::frame,
    operations::warps,
    operations::difference_of_products,
    operations::slab,
    operations::triangle,
    operations::sphere,
    operations::four_spheres,
    operations::offset,
    operations::fresnel,
    operations::texture,
    operations::camera,
    pictures::balls_through_a_lens,
    pictures::balls_with_aim,
    pictures::textured_mesh_in_the_sky,
}
