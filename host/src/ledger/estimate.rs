//! Means with intervals, and straight lines through points: what the figures of a few independent runs say, and how sure
//! that is.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// A value, and half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The middle of the interval.
    pub value: f64,
    /// Half its width; infinite where there are too few runs for one.
    pub half: f64,
}

impl Estimate {
    /// The mean of independent values, with Student's interval.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let half = if values.len() < 2 {
            f64::INFINITY
        } else {
            student(count - 1.0, 0.95) * (squares / (count - 1.0) / count).sqrt()
        };
        Self { value: mean, half }
    }

    /// The lower and the upper end.
    pub fn interval(&self) -> [f64; 2] {
        [self.value - self.half, self.value + self.half]
    }

    /// Whether the interval holds `value`.
    pub fn spans(&self, value: f64) -> bool {
        (self.value - value).abs() <= self.half
    }
}

/// A ratio or another number that is positive, with an interval that was made of its logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The middle, by factors.
    pub value: f64,
    /// The lower and the upper end.
    pub interval: [f64; 2],
}

impl Ratio {
    /// The geometric mean of independent positive values; `None` where one is not positive.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let logarithms: Vec<f64> = values.into_iter().map(libm::log).collect();
        let sound = !logarithms.is_empty() && logarithms.iter().all(|value| value.is_finite());
        sound.then(|| Self::exp(&Estimate::of(logarithms)))
    }

    /// Of an estimate of the logarithm.
    fn exp(logarithm: &Estimate) -> Self {
        Self { value: libm::exp(logarithm.value), interval: logarithm.interval().map(libm::exp) }
    }

    /// Whether the interval holds `value`.
    pub fn spans(&self, value: f64) -> bool {
        self.interval[0] <= value && value <= self.interval[1]
    }

    /// The upper end over the middle: by what factor it may be off.
    pub fn factor(&self) -> f64 {
        self.interval[1] / self.value
    }
}

/// Student's factor for an interval of some confidence.
pub(super) fn student(freedom: f64, confidence: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| t.inverse_cdf(0.5 + 0.5 * confidence))
}

/// A straight line by least squares: `y = level + slope x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where x is 0.
    pub level: f64,
    /// Rise per x.
    pub slope: f64,
}

impl Line {
    /// Through two points or more with different x; `None` otherwise, or where a number is not finite.
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let spread: f64 = points.iter().map(|point| (point[0] - x) * (point[0] - x)).sum();
        let both: f64 = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
        let slope = both / spread;
        let line = Self { level: y - slope * x, slope };
        (points.len() > 1 && line.level.is_finite() && slope.is_finite()).then_some(line)
    }
}

/// The value below which a share of the values lies; they are sorted in place.
pub fn percentile(values: &mut [f32], share: f64) -> f64 {
    values.sort_unstable_by(f32::total_cmp);
    let at = (share * values.len() as f64) as usize;
    values.get(at.min(values.len().saturating_sub(1))).map_or(f64::NAN, |value| f64::from(*value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_students() {
        // Mean 3, standard deviation sqrt(2.5), t of four degrees of freedom 2.7764.
        let estimate = Estimate::of([1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(estimate.value, 3.0);
        assert!((estimate.half - 2.776_445 * (2.5f64 / 5.0).sqrt()).abs() < 1e-5);
        assert!(estimate.spans(4.9) && !estimate.spans(5.0));
        assert_eq!(Estimate::of([1.0]).half, f64::INFINITY);
    }

    #[test]
    fn intervals_hold_what_they_promise() {
        // Sums of twelve even numbers are nearly normal; a 95 % interval of eight of them misses one time in twenty.
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let held = (0..4000).filter(|_| Estimate::of((0..8).map(|_| (0..12).map(|_| next()).sum::<f64>())).spans(6.0));
        let held = held.count() as f64 / 4000.0;
        assert!((held - 0.95).abs() < 0.014, "{held}");
    }

    #[test]
    fn ratios_are_symmetric_by_factors() {
        let ratio = Ratio::of([1.0, 2.0, 4.0]).unwrap();
        assert!((ratio.value - 2.0).abs() < 1e-12);
        assert!((ratio.interval[0] * ratio.interval[1] - 4.0).abs() < 1e-9);
        assert!(ratio.spans(1.0) && ratio.factor() > 2.0);
        assert_eq!(Ratio::of([1.0, -1.0]), None);
        assert_eq!(Ratio::of([]), None);
    }

    #[test]
    fn lines_and_percentiles() {
        let line = Line::through(&[[0.0, 1.0], [1.0, 0.5], [2.0, 0.0]]).unwrap();
        assert!((line.level - 1.0).abs() < 1e-12 && (line.slope + 0.5).abs() < 1e-12);
        assert_eq!(Line::through(&[[1.0, 1.0], [1.0, 2.0]]), None);
        let mut values: Vec<f32> = (0..100).rev().map(|k| k as f32).collect();
        assert_eq!([0.5, 0.95, 0.99].map(|share| percentile(&mut values, share)), [50.0, 95.0, 99.0]);
        assert!(percentile(&mut [], 0.5).is_nan());
    }
}
