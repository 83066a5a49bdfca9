//! Which cells of a grid a flat triangle covers.

/// Calls `visit` with the column, the row and the barycentric weights of each cell whose centre is in the triangle.
///
/// Coordinates are in cells; the centre of cell (0, 0) is the point (0, 0), and `size` is columns and rows.
pub(crate) fn for_each_cell([a, b, c]: [[f64; 2]; 3], size: [usize; 2], mut visit: impl FnMut(usize, usize, [f64; 3])) {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let area = side(a, b, c);
    if area == 0.0 {
        return;
    }
    let span = |axis: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]).max(0.0);
        let high = a[axis].max(b[axis]).max(c[axis]).min(size[axis] as f64 - 1.0);
        libm::ceil(low) as usize..libm::floor(high + 1.0).max(0.0) as usize
    };
    for row in span(1) {
        for column in span(0) {
            let centre = [column as f64, row as f64];
            let weights = [side(b, c, centre) / area, side(c, a, centre) / area, side(a, b, centre) / area];
            if weights.iter().all(|&weight| weight >= 0.0) {
                visit(column, row, weights);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_of_two_triangles_is_covered_once_and_weights_give_the_centre_back() {
        for triangle in [[[0.2, 0.3], [4.2, 0.3], [4.2, 4.3]], [[0.2, 0.3], [4.2, 4.3], [0.2, 4.3]]] {
            let mut count = 0;
            for_each_cell(triangle, [10, 10], |column, row, weights| {
                let at = |axis: usize| (0..3).map(|corner| triangle[corner][axis] * weights[corner]).sum::<f64>();
                assert!((at(0) - column as f64).abs() < 1e-12 && (at(1) - row as f64).abs() < 1e-12);
                count += 1;
            });
            assert!(count == 10 || count == 6, "{count}");
        }
    }

    #[test]
    fn cells_outside_the_grid_are_left_out() {
        let mut count = 0;
        for_each_cell([[-9.0, -9.0], [30.0, -9.0], [-9.0, 30.0]], [3, 2], |_, _, _| count += 1);
        assert_eq!(count, 6);
    }
}
