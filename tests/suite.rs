//! The whole suite in one binary, so that it links once.

mod support;

/// Vectors, frames and ray origins: what every bound stands on.
mod vectors;

/// Pixels to rays: symmetric, sharp, inside their filter.
mod camera;

/// Hits against exact arithmetic; closed meshes that must not leak.
mod intersections;

/// Rays that leave surfaces among others.
mod departures;

/// Boxes against exact arithmetic.
mod slabs;

/// All that a ray crosses, each surface once.
mod crossings;

/// Structures change the time, never a bit; builds end on any input.
mod bvh;

/// Samples follow their densities; the generator is even.
mod sampling;

/// Sobol's numbers fill their space evenly, differ wherever they should, and give the same pictures with less noise.
mod sobol;

/// Pictures with known answers.
mod closed_forms;

/// Lossless surfaces lose nothing, path by path; glass shares light as Fresnel says.
mod furnace;

/// Sums that no order, split or resume can change.
mod film;

/// Each effect is found, does something, and leaves no trace where it is not asked for.
mod effects;

/// Paths side by side are the same as paths alone.
mod wavefront;

/// Building and tracing never allocate.
mod no_alloc;

/// Every error of the kernel, and its words.
mod errors_kernel;

/// What the compiler made of a specialised kernel.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod machine_code;

/// Whole pictures against converged ones of another renderer.
mod references;

/// The report's figures: golden hashes, and the report's own pictures.
mod figures;

/// However it is rendered, a scene gives the same bits.
mod invariance;

/// Where two walls meet, neither hides the light from the other.
mod seams;

/// Hard cases of geometry: boxes and rays without end, degenerate triangles, extreme scales, moved scenes.
mod hard_cases;

/// What each alternative of accuracy loses.
mod accuracy;

/// Rays and triangles that some test got wrong, bit by bit.
mod kept_rays;

/// Hard cases of light: chains of mirrors, refraction against exact arithmetic, lights of triangles.
mod light_cases;

/// Lights over a floor have their form factors, however they are sampled.
mod form_factors;

/// Picture files keep what they are given.
mod picture_files;

/// The hard cases by their numbers.
mod cases;
