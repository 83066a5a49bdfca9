//! Tests whose answer is a probability. Seeds are fixed, so a test passes or fails the same way every time.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::tolerance::SIGNIFICANCE;

/// The probability of counts at least as far from `expected` as `observed`, if these were true: Pearson's
/// chi-square, with neighbouring cells pooled until 5 are expected in each.
pub(crate) fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let (mut statistic, mut cells) = (0.0, 0u32);
    let (mut seen, mut due) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        assert!(e > 0.0 || o == 0, "a sample fell where none can");
        seen += o as f64;
        due += e;
        if due >= 5.0 {
            statistic += (seen - due) * (seen - due) / due;
            cells += 1;
            (seen, due) = (0.0, 0.0);
        }
    }
    ChiSquared::new(f64::from(cells - 1)).expect("more than one cell").sf(statistic)
}

/// Fails where `observed` does not follow `expected` at the suite's significance.
#[track_caller]
pub(crate) fn assert_follows(what: &str, observed: &[u64], expected: &[f64]) {
    let p = chi_square(observed, expected);
    assert!(p > SIGNIFICANCE, "{what}: chi-square p = {p:e}");
}

/// Fails where counts are not equal but for chance.
#[track_caller]
pub(crate) fn assert_uniform(what: &str, observed: &[u64]) {
    let each = observed.iter().sum::<u64>() as f64 / observed.len() as f64;
    assert_follows(what, observed, &vec![each; observed.len()]);
}

/// Count, mean and squared deviations of numbers, one by one (Welford 1962): means that hardly vary keep their error.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    pub(crate) fn add(&mut self, x: f64) {
        self.count += 1.0;
        let before = x - self.mean;
        self.mean += before / self.count;
        self.squares += before * (x - self.mean);
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard deviation of one number.
    pub(crate) fn spread(&self) -> f64 {
        (self.variance() * self.count).sqrt()
    }

    /// Variance of the mean.
    fn variance(&self) -> f64 {
        self.squares / ((self.count - 1.0) * self.count)
    }

    /// Standard error of the mean over the mean.
    pub(crate) fn relative_error(&self) -> f64 {
        self.variance().sqrt() / self.mean
    }

    /// Fails where the mean is not `expected`: more standard errors away than chance allows. `rounding` is the
    /// relative error that arithmetic alone may add.
    #[track_caller]
    pub(crate) fn assert_mean(&self, what: &str, expected: f64, rounding: f64) {
        self.assert_distance(what, expected, 0.0, rounding);
    }

    /// Fails where the means of two samples differ by more than chance allows.
    #[track_caller]
    pub(crate) fn assert_same_mean(&self, what: &str, other: &Self) {
        self.assert_distance(what, other.mean(), other.variance(), 0.0);
    }

    #[track_caller]
    fn assert_distance(&self, what: &str, expected: f64, its_variance: f64, rounding: f64) {
        let normal = Normal::standard();
        let limit = -normal.inverse_cdf(SIGNIFICANCE * 0.5);
        let error = (self.variance() + its_variance).sqrt();
        let distance = (self.mean() - expected).abs() - rounding * expected.abs();
        assert!(distance <= limit * error, "{what}: {} is not {expected} +- {error:e}", self.mean());
    }

    /// How many standard errors the mean is from `expected`, beyond the relative error that arithmetic alone may add.
    pub(crate) fn deviations(&self, expected: f64, rounding: f64) -> f64 {
        let beyond = ((self.mean() - expected).abs() - rounding * expected.abs()).max(0.0);
        // Means that do not vary have no error to count in.
        if beyond == 0.0 { 0.0 } else { beyond / self.variance().sqrt() }
    }

    /// How many standard errors of their difference the means of two samples are apart.
    pub(crate) fn deviations_from(&self, other: &Self) -> f64 {
        (self.mean() - other.mean()).abs() / (self.variance() + other.variance()).sqrt()
    }

    /// Fails where chance alone could hide a bias of `relative`: then the test has no power.
    #[track_caller]
    pub(crate) fn assert_precise(&self, what: &str, relative: f64) {
        let error = self.relative_error();
        assert!(error <= relative, "{what}: standard error {error:e} of the mean, want {relative:e}");
    }
}

#[test]
fn chi_square_knows_fair_dice_from_loaded_ones() {
    assert!(chi_square(&[98, 103, 99, 101, 100, 99], &[100.0; 6]) > 0.5);
    assert!(chi_square(&[70, 100, 100, 100, 100, 130], &[100.0; 6]) < 0.01);
    // The 95 % quantile for five degrees of freedom is 11.0705.
    let x = (11.0705f64 / 2.0 * 1e6).sqrt();
    let observed = [1e6 + x, 1e6 - x, 1e6, 1e6, 1e6, 1e6].map(|x| x as u64);
    assert!((chi_square(&observed, &[1e6; 6]) - 0.05).abs() < 1e-4);
}
