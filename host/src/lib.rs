//! The renderer on top of `ocellus-kernel`.

pub mod description;
pub mod error;
pub mod picture;
