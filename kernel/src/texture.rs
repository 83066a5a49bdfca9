//! Colour textures: a view of the caller's texels, looked up bilinearly, repeating in both directions.

use crate::real::{Real, Vec3, Vector};

/// A texture of linear Rec.709 colours, row 0 on top.
#[derive(Clone, Copy, Debug)]
pub struct Texture<'a> {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: &'a [[f32; 3]],
}

impl Texture<'_> {
    /// Whether the size is that of the texels, and not zero.
    pub(crate) fn is_valid(&self) -> bool {
        let size = u64::from(self.width) * u64::from(self.height);
        size > 0 && size == self.texels.len() as u64 && self.width <= 1 << 24 && self.height <= 1 << 24
    }

    /// The colour at `(u, v)`: u to the right, v up, (0, 0) the lower left corner of the picture, repeating.
    /// Texels that the size promises and the slice lacks are black.
    #[inline]
    pub fn lookup<R: Real>(&self, [u, v]: [R; 2]) -> Vec3<R> {
        let (left, right, across) = texel_pair(u, self.width);
        let (top, bottom, down) = texel_pair(R::ONE - v, self.height);
        let at = |x: usize, y: usize| {
            let texel = self.texels.get(y * self.width as usize + x).copied().unwrap_or_default();
            Vec3::<R>::from_array(texel.map(|c| R::from_f64(f64::from(c))))
        };
        let mix = |a: Vec3<R>, b: Vec3<R>, weight: R| a * (R::ONE - weight) + b * weight;
        mix(mix(at(left, top), at(right, top), across), mix(at(left, bottom), at(right, bottom), across), down)
    }
}

/// The two texels around coordinate `x` (1 = the whole texture) and the weight of the second. Values that are not
/// finite read as 0.
#[inline]
fn texel_pair<R: Real>(x: R, size: u32) -> (usize, usize, R) {
    let turn = x - x.floor();
    let turn = if turn >= R::ZERO && turn < R::ONE { turn } else { R::ZERO };
    let at = turn * R::from_f64(f64::from(size)) - R::from_f64(0.5);
    let cell = at.floor();
    let first = cell.to_i32().checked_rem_euclid(size as i32).unwrap_or(0);
    let second = if first + 1 == size as i32 { 0 } else { first + 1 };
    (first as usize, second as usize, at - cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3 as V;

    const TEXELS: [[f32; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    const TEXTURE: Texture<'static> = Texture { width: 2, height: 2, texels: &TEXELS };

    #[test]
    fn texel_centres_are_exact_and_v_points_up() {
        for repeat in [-3.0, 0.0, 2.0] {
            assert_eq!(TEXTURE.lookup::<f32>([0.25 + repeat, 0.75]), V::new(1.0, 0.0, 0.0));
            assert_eq!(TEXTURE.lookup::<f32>([0.75, 0.75 + repeat]), V::new(0.0, 1.0, 0.0));
            assert_eq!(TEXTURE.lookup::<f32>([0.25, 0.25 + repeat]), V::new(0.0, 0.0, 1.0));
        }
        assert_eq!(TEXTURE.lookup::<f64>([0.5, 0.75]), glam::DVec3::new(0.5, 0.5, 0.0));
    }

    #[test]
    fn a_size_that_is_not_that_of_the_texels_reads_black() {
        for (width, height, texels) in [(0, 0, &TEXELS[..]), (2, 2, &[]), (u32::MAX, 3, &TEXELS)] {
            let texture = Texture { width, height, texels };
            assert!(Vector::is_finite(texture.lookup::<f32>([0.25, 0.25])), "{width} {height}");
        }
    }

    #[test]
    fn any_coordinate_has_an_answer() {
        for x in [f32::NAN, f32::INFINITY, -1e30, 1e-45, -1e-45, 1.0, 16_777_217.0] {
            assert!(Vector::is_finite(TEXTURE.lookup::<f32>([x, x])), "{x}");
        }
    }
}
