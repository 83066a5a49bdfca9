//! Packs flat charts into the unit square: each chart's outline is a bit mask on a coarse grid, and charts are
//! put, largest first, where their masks meet no other.

/// A connected flat piece of the surface: triangles with their corners in any common unit.
pub(crate) struct Chart {
    pub(crate) triangles: Vec<[[f64; 2]; 3]>,
}

/// How a chart's own coordinates become texture coordinates: scale, then shift.
#[derive(Clone, Copy)]
pub(crate) struct Placement {
    scale: f64,
    shift: [f64; 2],
}

impl Placement {
    /// Texture coordinates of a point of the chart.
    pub(crate) fn place(self, point: [f64; 2]) -> [f64; 2] {
        [point[0] * self.scale + self.shift[0], point[1] * self.scale + self.shift[1]]
    }
}

/// Cells along each side of the unit square; a row of cells is the bits of one `u128`.
const CELLS: usize = 128;

/// Empty border kept around every triangle, in cells, so that texture filtering never reaches another chart.
const MARGIN: f64 = 0.4;

/// Cells that a chart covers at some scale.
struct Mask {
    rows: Vec<u128>,
    width: usize,
    /// Lowest corner of the chart, in its own unit.
    low: [f64; 2],
}

/// Finds the largest common scale at which all charts fit (nearly: it is a search over sizes and the packing is
/// greedy) and returns where each chart goes.
pub(crate) fn pack(charts: &[Chart]) -> Vec<Placement> {
    let mut best = Vec::new();
    let (mut fits, mut too_large) = (0.0, f64::INFINITY);
    let mut scale = 1.0 / CELLS as f64;
    for _ in 0..40 {
        match try_pack(charts, scale) {
            Some(placements) => {
                best = placements;
                fits = scale;
            }
            None => too_large = scale,
        }
        scale = if too_large.is_infinite() { fits * 2.0 } else { (fits + too_large) * 0.5 };
        if too_large - fits < 0.004 * fits {
            break;
        }
    }
    best
}

fn try_pack(charts: &[Chart], scale: f64) -> Option<Vec<Placement>> {
    let masks: Vec<Mask> = charts.iter().map(|chart| mask(chart, scale)).collect::<Option<_>>()?;
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by_key(|&index| std::cmp::Reverse((masks[index].rows.len().max(masks[index].width), index)));
    let mut taken = [0_u128; CELLS];
    let mut placements = vec![Placement { scale, shift: [0.0; 2] }; charts.len()];
    for index in order {
        let mask = &masks[index];
        let (x, y) = free_place(&taken, mask)?;
        for (row, bits) in taken[y..].iter_mut().zip(&mask.rows) {
            *row |= bits << x;
        }
        let shift = |axis: usize, cell: usize| (cell as f64 + MARGIN) / CELLS as f64 - mask.low[axis] * scale;
        placements[index].shift = [shift(0, x), shift(1, y)];
    }
    Some(placements)
}

/// The lowest, then leftmost place where no cell of the mask is taken.
fn free_place(taken: &[u128; CELLS], mask: &Mask) -> Option<(usize, usize)> {
    for y in 0..=CELLS - mask.rows.len() {
        for x in 0..=CELLS - mask.width {
            if taken[y..].iter().zip(&mask.rows).all(|(row, bits)| row & (bits << x) == 0) {
                return Some((x, y));
            }
        }
    }
    None
}

/// Cells under the chart, or `None` if it is larger than the square.
fn mask(chart: &Chart, scale: f64) -> Option<Mask> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for corner in chart.triangles.iter().flatten() {
        for axis in 0..2 {
            low[axis] = low[axis].min(corner[axis]);
            high[axis] = high[axis].max(corner[axis]);
        }
    }
    let cells = |length: f64| length * scale * CELLS as f64;
    let size = |axis: usize| (cells(high[axis] - low[axis]) + 2.0 * MARGIN) as usize + 1;
    let (width, height) = (size(0), size(1));
    if width > CELLS || height > CELLS {
        return None;
    }
    let mut rows = vec![0_u128; height];
    for triangle in &chart.triangles {
        // All cells of the triangle's bounding box: triangles are small, so little is lost.
        let span = |axis: usize| {
            let place = triangle.map(|corner| cells(corner[axis] - low[axis]) + MARGIN);
            let start = place[0].min(place[1]).min(place[2]) - MARGIN;
            let end = place[0].max(place[1]).max(place[2]) + MARGIN;
            (start as usize, end as usize)
        };
        let ((left, right), (bottom, top)) = (span(0), span(1));
        for row in &mut rows[bottom..=top] {
            for cell in left..=right {
                *row |= 1 << cell;
            }
        }
    }
    Some(Mask { rows, width, low })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: f64) -> Chart {
        let corner = |x: f64, y: f64| [x * side + 7.0, y * side - 3.0];
        Chart {
            triangles: vec![
                [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)],
                [corner(0.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            ],
        }
    }

    #[test]
    fn charts_stay_inside_and_apart() {
        let charts: Vec<Chart> = [5.0, 3.0, 3.0, 1.0, 0.5, 4.0].into_iter().map(square).collect();
        let placements = pack(&charts);
        let boxes: Vec<[[f64; 2]; 2]> = charts
            .iter()
            .zip(&placements)
            .map(|(chart, placement)| [placement.place(chart.triangles[0][0]), placement.place(chart.triangles[0][2])])
            .collect();
        let gap = 2.0 * MARGIN / CELLS as f64 - 1e-12;
        for (index, [low, high]) in boxes.iter().enumerate() {
            assert!(low.iter().chain(high).all(|&coordinate| (0.0..=1.0).contains(&coordinate)));
            for [other_low, other_high] in &boxes[..index] {
                let apart = |axis: usize| low[axis] - other_high[axis] >= gap || other_low[axis] - high[axis] >= gap;
                assert!(apart(0) || apart(1));
            }
        }
        let covered: f64 = boxes.iter().map(|[low, high]| (high[0] - low[0]) * (high[1] - low[1])).sum();
        assert!(covered > 0.5, "only {covered} of the square is used");
    }
}
