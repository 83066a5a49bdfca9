//! Many paths side by side (wavefront path tracing: Laine, Karras, Aila, Megakernels considered harmful, HPG 2013), so
//! that one instruction works on several.
//!
//! Each of [`LANES`] lanes holds a path. All take a step together, stage by stage: hits, surface points, light, directions.
//! A stage is a loop over the lanes around the very functions that follow a single path, which the compiler turns into
//! vectors; what is rare, or branches much, is done lane by lane. So each path has the same bits as alone. A lane whose
//! path has ended starts the next one, so that all have work until the last samples.
//!
//! What pays most is that spheres need no exact test but of the one that is met: rounded bounds on where each is met
//! ([`reach`]) say which, for all but a few rays.

#![expect(clippy::needless_range_loop, reason = "stages are loops over lanes, many columns at once")]

mod columns;
mod departures;
mod directions;
mod few;
mod glass;
mod hits;
mod light;
mod numbers;
mod queue;
mod reach;
mod step;
mod surfaces;

pub(crate) use step::render;
