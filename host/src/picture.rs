//! A linear picture in memory.

/// Linear Rec.709 radiance, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height` pixels, row by row.
    pub pixels: Vec<[f32; 3]>,
}
