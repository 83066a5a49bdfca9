//! Numbers of two f64, about 106 bits, each with a bound on how far it is from the number that it stands for.
//!
//! The operations and the bounds on their relative errors are those of Joldes, Muller and Popescu (ACM Transactions on
//! Mathematical Software 44:2, 2017; sum 3 u^2, product 5 u^2, quotient 15 u^2) and, for the root, of Lefevre, Louvet,
//! Muller, Picot and Rideau (the same journal, 49:1, 2023; 25/8 u^2), where u = 2^-53. What the bounds are themselves
//! rounded by is allowed for.

/// More than the relative error of any operation: 16 u^2.
const ROUNDING: f64 = 1.0 / (1u128 << 102) as f64;

/// More than the relative error of any bound: eight roundings.
const OF_BOUND: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Below this, 2^-900, the errors of products are no f64 any more.
const SMALL: f64 = f64::from_bits((1023 - 900) << 52);

/// A number within `error` of `high + low`; an infinite `error` says nothing of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble {
    pub(crate) high: f64,
    pub(crate) low: f64,
    pub(crate) error: f64,
}

/// The sum of two numbers and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

/// The same where `a` is the larger (Dekker).
fn fast_two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    [sum, b - (sum - a)]
}

/// The product of two numbers and its rounding error (Dekker and Veltkamp).
fn two_product(a: f64, b: f64) -> [f64; 2] {
    let halves = |x: f64| {
        let large = x * 134_217_729.0;
        let high = large - (large - x);
        [high, x - high]
    };
    let ([a_high, a_low], [b_high, b_low]) = (halves(a), halves(b));
    let product = a * b;
    [product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low]
}

impl DoubleDouble {
    /// Exactly this.
    pub(crate) fn of(x: f64) -> Self {
        Self { high: x, low: 0.0, error: 0.0 }
    }

    /// The sum of two parts, `error` off at most; nothing is known where they are not finite.
    fn new([high, low]: [f64; 2], error: f64) -> Self {
        // Any other comparison lets a NaN through.
        let known = high.is_finite() && low.is_finite() && error < f64::INFINITY;
        Self { high, low, error: if known { error * OF_BOUND } else { f64::INFINITY } }
    }

    pub(crate) fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low, ..self }
    }

    pub(crate) fn add(self, other: Self) -> Self {
        let [sum, sum_error] = two_sum(self.high, other.high);
        let inherited = self.error + other.error;
        if self.low == 0.0 && other.low == 0.0 {
            return Self::new([sum, sum_error], inherited);
        }
        let [lows, lows_error] = two_sum(self.low, other.low);
        let [high, low] = fast_two_sum(sum, sum_error + lows);
        let parts = fast_two_sum(high, lows_error + low);
        Self::new(parts, inherited + ROUNDING * parts[0].abs())
    }

    pub(crate) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        if [self, other].iter().any(|x| x.high == 0.0 && x.error == 0.0) {
            return Self::of(0.0);
        }
        let [product, error] = two_product(self.high, other.high);
        let inherited = self.high.abs() * other.error + self.error * other.high.abs() + self.error * other.error;
        if !(product.abs() > SMALL) {
            return Self::new([product, error], f64::INFINITY);
        }
        if self.low == 0.0 && other.low == 0.0 {
            return Self::new([product, error], inherited);
        }
        let parts = fast_two_sum(product, error + (self.high * other.low + self.low * other.high));
        // The magnitude of a pair is at most a roundoff more than that of its higher part.
        Self::new(parts, (1.0 + f64::EPSILON) * inherited + ROUNDING * parts[0].abs())
    }

    pub(crate) fn div(self, other: Self) -> Self {
        if self.high == 0.0 && self.error == 0.0 && other.high.abs() > other.error {
            return Self::of(0.0);
        }
        let first = self.high / other.high;
        // The divisor times that.
        let [product, error] = two_product(other.high, first);
        let [product, low] = fast_two_sum(product, other.low * first);
        let [product, error] = fast_two_sum(product, low + error);
        let parts = fast_two_sum(first, ((self.high - product) + (self.low - error)) / other.high);
        let least = other.high.abs() * (1.0 - f64::EPSILON) - other.error;
        if !(self.high.abs() > SMALL && first.abs() > SMALL && least > SMALL) {
            return Self::new(parts, f64::INFINITY);
        }
        let inherited = (self.error + (1.0 + f64::EPSILON) * parts[0].abs() * other.error) / least;
        Self::new(parts, inherited + ROUNDING * parts[0].abs())
    }

    /// The square root of a number that is known to be positive.
    pub(crate) fn sqrt(self) -> Self {
        let first = self.high.sqrt();
        let [square, error] = two_product(first, first);
        let rest = self.low + ((self.high - square) - error);
        let parts = fast_two_sum(first, rest / (2.0 * first));
        if !(self.high > SMALL && self.high > 2.0 * self.error) {
            return Self::new(parts, f64::INFINITY);
        }
        // No root of anything within the error is further away than that, divided by the root.
        Self::new(parts, (1.0 + f64::EPSILON) * self.error / first + ROUNDING * first)
    }

    /// -1, 0 or 1, if that is known.
    pub(crate) fn sign(self) -> Option<f64> {
        if self.high.abs() * (1.0 - f64::EPSILON) > self.error {
            Some(self.high.signum())
        } else {
            (self.high == 0.0 && self.error == 0.0).then_some(0.0)
        }
    }

    /// The nearest f64, if the number is known to a share `within` of itself.
    pub(crate) fn known(self, within: f64) -> Option<f64> {
        (self.error <= within * self.high.abs()).then_some(self.high)
    }
}
