//! What must hold for any input. Each module checks one part and panics where something does not hold.

pub mod bvh;
mod files;
pub mod intersectors;
mod numbers;
pub mod obj;
pub mod scene;

/// A check of arbitrary bytes.
pub type Check = fn(&[u8]);

/// All checks, by the name of their target.
pub const CHECKS: [(&str, Check); 4] =
    [("bvh", bvh::check), ("intersectors", intersectors::check), ("scene", scene::check), ("obj", obj::check)];
