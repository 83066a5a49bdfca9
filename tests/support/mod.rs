//! What the test modules share: scenes, meshes, random numbers, statistics, exact arithmetic, tolerances.

pub(crate) mod counting_allocator;
pub(crate) mod double_double;
pub(crate) mod exact;
pub(crate) mod losses;
pub(crate) mod meshes;
pub(crate) mod noise;
pub(crate) mod pictures;
pub(crate) mod property;
pub(crate) mod random;
pub(crate) mod rays;
pub(crate) mod scene;
pub(crate) mod statistics;
pub(crate) mod tolerance;
pub(crate) mod trials;
pub(crate) mod wedge;

/// Runs each named function, generic over the precision, once as f32 (`single`) and once as f64 (`double`).
macro_rules! in_both_precisions {
    ($($name:ident),* $(,)?) => {
        mod single { $(#[test] fn $name() { super::$name::<f32>(); })* }
        mod double { $(#[test] fn $name() { super::$name::<f64>(); })* }
    };
}
pub(crate) use in_both_precisions;
