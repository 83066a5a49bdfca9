//! The whole suite in one binary, so that it links once.

mod support;

/// Vectors, frames and ray origins: what every bound stands on.
mod vectors;

/// Pixels to rays: symmetric, sharp, inside their filter.
mod camera;

/// Hits against exact arithmetic; closed meshes that must not leak.
mod intersections;

/// Structures change the time, never a bit; builds end on any input.
mod bvh;

/// Samples follow their densities; the generator is even.
mod sampling;

/// Pictures with known answers.
mod closed_forms;

/// Lossless surfaces lose nothing, path by path; glass shares light as Fresnel says.
mod furnace;
