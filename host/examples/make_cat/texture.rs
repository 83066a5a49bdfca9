//! Paints the coat into the texture, triangle by triangle.

use crate::mesh::Mesh;
use crate::raster::for_each_cell;
use crate::uv::Unwrapping;
use glam::DVec3;

/// Square picture of sRGB colors, row 0 at the top.
pub(crate) struct Texture {
    pub(crate) size: usize,
    pub(crate) texels: Vec<DVec3>,
}

/// Rounds of growing the charts outwards, so that filtering at a seam sees coat and not background.
const GUTTER: usize = 4;

/// Texture in which each texel under a triangle has the color of the place it covers; the rest is `background`.
pub(crate) fn paint(
    mesh: &Mesh,
    unwrapping: &Unwrapping,
    size: usize,
    background: DVec3,
    color: impl Fn(DVec3) -> DVec3,
) -> Texture {
    let mut texels = vec![None; size * size];
    for (triangle, corners) in unwrapping.corners.iter().enumerate() {
        let at = corners.map(|corner| {
            let [u, v] = unwrapping.coordinates[corner as usize];
            [u * size as f64 - 0.5, (1.0 - v) * size as f64 - 0.5]
        });
        for_each_cell(at, [size, size], |column, row, weights| {
            let [a, b, c] = mesh.corners(triangle);
            texels[row * size + column] = Some(color(a * weights[0] + b * weights[1] + c * weights[2]));
        });
    }
    for _ in 0..GUTTER {
        texels = grown(&texels, size);
    }
    Texture { size, texels: texels.into_iter().map(|texel| texel.unwrap_or(background)).collect() }
}

/// The texels, with each empty one that has painted neighbours filled with their mean.
fn grown(texels: &[Option<DVec3>], size: usize) -> Vec<Option<DVec3>> {
    let mut next = texels.to_vec();
    for y in 0..size {
        for x in 0..size {
            if texels[y * size + x].is_some() {
                continue;
            }
            let (mut sum, mut count) = (DVec3::ZERO, 0.0);
            for row in y.saturating_sub(1)..=(y + 1).min(size - 1) {
                for column in x.saturating_sub(1)..=(x + 1).min(size - 1) {
                    if let Some(color) = texels[row * size + column] {
                        sum += color;
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 {
                next[y * size + x] = Some(sum / count);
            }
        }
    }
    next
}
