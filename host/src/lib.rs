//! The renderer on top of `ocellus-kernel`.

pub mod assemble;
pub mod description;
pub mod diff;
pub mod error;
pub mod film;
pub mod input;
pub mod kernels;
pub mod load;
pub mod output;
pub mod picture;
pub mod render;
