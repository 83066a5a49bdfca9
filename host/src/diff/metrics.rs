//! Figures that compare two pictures pixel by pixel.

/// Added to the reference's square in relMSE, so that black pixels weigh something and do not divide by zero.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// Pixels of one picture with a NaN or an infinity in any channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// How many pixels.
    pub count: usize,
    /// Column and row of the first one, in rows from the top.
    pub first: Option<(u32, u32)>,
}

/// The place where two pictures differ most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// Absolute difference, in the pictures' linear values.
    pub difference: f64,
    /// Column.
    pub x: u32,
    /// Row, 0 on top.
    pub y: u32,
    /// 0, 1, 2 for R, G, B.
    pub channel: usize,
}

/// Sums over the pixels that are finite in both pictures, formed in f64 in row order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Pixels that are finite in both pictures; all else is over these.
    pub compared: usize,
    /// Root of the mean squared difference over pixels and channels.
    pub rmse: f64,
    /// Mean of `(a - b)^2 / (b^2 +` [`REL_MSE_EPSILON`]`)` over pixels and channels.
    pub rel_mse: f64,
    /// The first of the largest differences; `None` where all are zero.
    pub largest: Option<Largest>,
    /// Mean of each channel of a.
    pub mean_a: [f64; 3],
    /// Mean of each channel of b.
    pub mean_b: [f64; 3],
    /// Pixels of a that are left out.
    pub non_finite_a: NonFinite,
    /// Pixels of b that are left out.
    pub non_finite_b: NonFinite,
}

/// Whether a pixel can enter a sum.
pub(super) fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|value| value.is_finite())
}

impl Statistics {
    /// Compares `a` with the reference `b`: rows of `width` pixels, linear values, equally long.
    ///
    /// Where no pixel is finite in both, the means are NaN.
    pub fn of(a: &[[f32; 3]], b: &[[f32; 3]], width: u32) -> Self {
        let mut compared = 0_usize;
        let (mut squares, mut relative) = (0.0, 0.0);
        let (mut sum_a, mut sum_b) = ([0.0; 3], [0.0; 3]);
        let (mut non_finite_a, mut non_finite_b) = (NonFinite::default(), NonFinite::default());
        let mut largest: Option<Largest> = None;
        let width = width.max(1) as usize;
        for (index, (pixel_a, pixel_b)) in a.iter().zip(b).enumerate() {
            let place = ((index % width) as u32, (index / width) as u32);
            let (finite_a, finite_b) = (is_finite(pixel_a), is_finite(pixel_b));
            if !finite_a {
                non_finite_a.add(place);
            }
            if !finite_b {
                non_finite_b.add(place);
            }
            if !(finite_a && finite_b) {
                continue;
            }
            compared += 1;
            for channel in 0..3 {
                let (value, reference) = (f64::from(pixel_a[channel]), f64::from(pixel_b[channel]));
                let difference = (value - reference).abs();
                squares += difference * difference;
                relative += difference * difference / (reference * reference + REL_MSE_EPSILON);
                sum_a[channel] += value;
                sum_b[channel] += reference;
                if difference > largest.map_or(0.0, |largest| largest.difference) {
                    largest = Some(Largest { difference, x: place.0, y: place.1, channel });
                }
            }
        }
        let pixels = compared as f64;
        Self {
            compared,
            rmse: (squares / (3.0 * pixels)).sqrt(),
            rel_mse: relative / (3.0 * pixels),
            largest,
            mean_a: sum_a.map(|sum| sum / pixels),
            mean_b: sum_b.map(|sum| sum / pixels),
            non_finite_a,
            non_finite_b,
        }
    }
}

impl NonFinite {
    fn add(&mut self, place: (u32, u32)) {
        self.count += 1;
        self.first.get_or_insert(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_by_hand() {
        let a = [[1.0, 2.0, 3.0], [0.5, 0.0, 0.0]];
        let b = [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]];
        let statistics = Statistics::of(&a, &b, 2);
        assert_eq!(statistics.compared, 2);
        assert!((statistics.rmse - (5.25_f64 / 6.0).sqrt()).abs() < 1e-15);
        assert!((statistics.rel_mse - (1.0 / 1.01 + 4.0 / 1.01 + 0.25 / 0.01) / 6.0).abs() < 1e-12);
        assert_eq!(statistics.largest, Some(Largest { difference: 2.0, x: 0, y: 0, channel: 2 }));
        assert_eq!(statistics.mean_a, [0.75, 1.0, 1.5]);
        assert_eq!(statistics.mean_b, [0.5; 3]);
    }

    #[test]
    fn rel_mse_divides_by_the_reference() {
        let (low, high) = ([[1.0; 3]], [[2.0; 3]]);
        assert!((Statistics::of(&high, &low, 1).rel_mse - 1.0 / 1.01).abs() < 1e-15);
        assert!((Statistics::of(&low, &high, 1).rel_mse - 1.0 / 4.01).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_finite_is_counted_located_and_left_out() {
        let mut a = [[1.0; 3]; 6];
        let mut b = [[1.0; 3]; 6];
        a[1][2] = f32::NAN;
        a[4] = [f32::INFINITY; 3];
        b[4][0] = f32::NEG_INFINITY;
        b[5][1] = f32::NAN;
        let statistics = Statistics::of(&a, &b, 2);
        assert_eq!(statistics.compared, 3);
        assert_eq!(statistics.non_finite_a, NonFinite { count: 2, first: Some((1, 0)) });
        assert_eq!(statistics.non_finite_b, NonFinite { count: 2, first: Some((0, 2)) });
        assert_eq!((statistics.rmse, statistics.rel_mse, statistics.largest), (0.0, 0.0, None));
        assert_eq!(statistics.mean_a, [1.0; 3]);
    }

    #[test]
    fn the_largest_values_do_not_overflow() {
        let statistics = Statistics::of(&[[f32::MAX; 3]], &[[f32::MIN; 3]], 1);
        assert!(statistics.rmse.is_finite() && statistics.rel_mse.is_finite());
        assert!((statistics.rel_mse - 4.0).abs() < 1e-12);
    }
}
