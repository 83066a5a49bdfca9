//! Arithmetic of 600 bits: sums and products of a few floats are exact in it, roots and quotients as good as exact.
//! The floats of a test case are taken as they are, so that only the kernel's own rounding is measured.

use std::ops::{Add, Mul, Sub};

use dashu_float::{FBig, round::mode::HalfEven};
use ocellus_kernel::real::{Real, Vec3, Vector};

/// A number of 600 bits.
pub(crate) type Exact = FBig<HalfEven, 2>;

const BITS: usize = 600;

/// The same number.
pub(crate) fn exact(x: f64) -> Exact {
    Exact::try_from(x).expect("a finite number").with_precision(BITS).value()
}

/// The nearest f64.
pub(crate) fn to_f64(x: &Exact) -> f64 {
    x.to_f64().value()
}

/// The square root; 0 below zero.
pub(crate) fn root(x: &Exact) -> Exact {
    if *x > exact(0.0) { x.sqrt() } else { exact(0.0) }
}

/// A vector of such numbers.
#[derive(Clone, Debug)]
pub(crate) struct ExactVec(pub(crate) [Exact; 3]);

impl ExactVec {
    pub(crate) fn new<R: Real>(v: Vec3<R>) -> Self {
        Self(v.to_array().map(|x| exact(x.to_f64())))
    }

    pub(crate) fn dot(&self, other: &Self) -> Exact {
        let [a, b, c] = [0, 1, 2].map(|i| &self.0[i] * &other.0[i]);
        a + b + c
    }

    pub(crate) fn cross(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        Self([[1, 2], [2, 0], [0, 1]].map(|[i, j]| &a[i] * &b[j] - &a[j] * &b[i]))
    }

    pub(crate) fn length(&self) -> Exact {
        root(&self.dot(self))
    }

    pub(crate) fn unit(&self) -> Self {
        self * &(exact(1.0) / self.length())
    }
}

impl Sub for &ExactVec {
    type Output = ExactVec;

    fn sub(self, other: Self) -> ExactVec {
        ExactVec([0, 1, 2].map(|i| &self.0[i] - &other.0[i]))
    }
}

impl Add for &ExactVec {
    type Output = ExactVec;

    fn add(self, other: Self) -> ExactVec {
        ExactVec([0, 1, 2].map(|i| &self.0[i] + &other.0[i]))
    }
}

impl Mul<&Exact> for &ExactVec {
    type Output = ExactVec;

    fn mul(self, factor: &Exact) -> ExactVec {
        ExactVec([0, 1, 2].map(|i| &self.0[i] * factor))
    }
}
