//! Numbers as good as exact: sums and products of a few floats are exact, roots and quotients are off by 2^-600.
//! The floats of a test case are taken as they are, so that only the kernel's own rounding is measured.
//!
//! What is asked of a number (its sign, the nearest f64) is first answered by numbers of two f64 with bounds on their
//! errors. Only where these leave it open is it computed in 600 bits, from how it came about (as CGAL's lazy numbers
//! are: Pion and Fabri, Science of Computer Programming 76:4, 2011).

use std::cell::OnceCell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::rc::Rc;

use dashu_float::{FBig, round::mode::HalfEven};
use ocellus_kernel::real::{Real, Vec3, Vector};

use super::double_double::DoubleDouble;

/// A number of 600 bits.
type Long = FBig<HalfEven, 2>;

const BITS: usize = 600;

/// What a number must be known to, relative to itself, to say which f64 is next to it: as well as if halves of the
/// last place were decided in favour of the wrong side once in 200.
const NEAREST: f64 = 1.0 / (1u64 << 61) as f64;

/// The same for what is itself an error: nine digits.
const NINE_DIGITS: f64 = 1e-9;

/// A number, and how it came about.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    near: DoubleDouble,
    origin: Origin,
}

#[derive(Clone, Debug)]
enum Origin {
    Float(f64),
    Operation(Rc<(Operation, OnceCell<Long>)>),
}

#[derive(Debug)]
enum Operation {
    Negative(Exact),
    Sum(Exact, Exact),
    Difference(Exact, Exact),
    Product(Exact, Exact),
    Quotient(Exact, Exact),
    Root(Exact),
}

impl Exact {
    fn of(near: DoubleDouble, operation: Operation) -> Self {
        Self { near, origin: Origin::Operation(Rc::new((operation, OnceCell::new()))) }
    }

    /// In 600 bits.
    fn long(&self) -> Long {
        let (operation, value) = match &self.origin {
            Origin::Float(x) => return Long::try_from(*x).expect("a finite number").with_precision(BITS).value(),
            Origin::Operation(operation) => &**operation,
        };
        let compute = || match operation {
            Operation::Negative(a) => -a.long(),
            Operation::Sum(a, b) => a.long() + b.long(),
            Operation::Difference(a, b) => a.long() - b.long(),
            Operation::Product(a, b) => a.long() * b.long(),
            Operation::Quotient(a, b) => a.long() / b.long(),
            Operation::Root(a) => a.long().sqrt(),
        };
        value.get_or_init(compute).clone()
    }

    fn rounded(&self, within: f64) -> f64 {
        self.near.known(within).unwrap_or_else(|| self.long().to_f64().value())
    }
}

/// The same number.
pub(crate) fn exact(x: f64) -> Exact {
    assert!(x.is_finite(), "{x} is no number");
    Exact { near: DoubleDouble::of(x), origin: Origin::Float(x) }
}

/// The nearest f64.
pub(crate) fn to_f64(x: &Exact) -> f64 {
    x.rounded(NEAREST)
}

/// An f64 that agrees to nine digits: for a difference that is an error, and much smaller than what it is taken of.
pub(crate) fn roughly(x: &Exact) -> f64 {
    x.rounded(NINE_DIGITS)
}

/// The square root; 0 below zero.
pub(crate) fn root(x: &Exact) -> Exact {
    if *x > exact(0.0) { Exact::of(x.near.sqrt(), Operation::Root(x.clone())) } else { exact(0.0) }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let sign = self.near.sub(other.near).sign();
        sign.map_or_else(|| self.long().partial_cmp(&other.long()), |sign| sign.partial_cmp(&0.0))
    }
}

/// An operator on numbers and references to them.
macro_rules! operators {
    ($($operator:ident $function:ident $operation:ident;)*) => { $(
        impl $operator for Exact {
            type Output = Exact;

            fn $function(self, other: Exact) -> Exact {
                Exact::of(self.near.$function(other.near), Operation::$operation(self, other))
            }
        }

        impl $operator<&Exact> for Exact {
            type Output = Exact;

            fn $function(self, other: &Exact) -> Exact {
                self.$function(other.clone())
            }
        }

        impl $operator<Exact> for &Exact {
            type Output = Exact;

            fn $function(self, other: Exact) -> Exact {
                self.clone().$function(other)
            }
        }

        impl $operator for &Exact {
            type Output = Exact;

            fn $function(self, other: &Exact) -> Exact {
                self.clone().$function(other.clone())
            }
        }
    )* };
}

operators! {
    Add add Sum;
    Sub sub Difference;
    Mul mul Product;
    Div div Quotient;
}

impl Neg for Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        Exact::of(self.near.neg(), Operation::Negative(self))
    }
}

impl Neg for &Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        -self.clone()
    }
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

/// Random expressions of floats of all sizes, many of which cancel: two f64 never claim to know what is not so, and
/// they know most of it.
#[test]
fn what_is_known_of_a_number_is_true_of_it() {
    use super::random::Random;

    let mut random = Random::new(600);
    let (mut known, mut open) = (0, 0);
    for _ in 0..20_000 {
        let size = [1.0, 1e5, 1e-150, 1e150][random.below(4)];
        let mut numbers: Vec<Exact> = (0..4).map(|_| exact(size * random.between(-1.0, 1.0))).collect();
        numbers.push(exact(random.below(5) as f64 - 2.0));
        for _ in 0..8 {
            let [a, b] = [0, 0].map(|_| numbers[random.below(numbers.len())].clone());
            let is_zero = b == exact(0.0);
            numbers.push(match random.below(7) {
                0 => a + b,
                1 => a - b,
                2 | 3 => a * b,
                4 if !is_zero => a / b,
                5 => root(&a),
                // As near to it as floats come.
                _ => match a.long().to_f64().value() {
                    nearest if nearest.is_finite() => a - exact(nearest),
                    _ => a,
                },
            });
        }
        for number in numbers {
            let (near, long) = (number.near, number.long());
            let name = || format!("{near:?} is not {long:?}");
            if near.error.is_finite() {
                let off = exact(near.high).long() + exact(near.low).long() - &long;
                assert!(off.clone().max(-off) <= exact(near.error).long(), "{}", name());
            }
            let sign = f64::from(long.partial_cmp(&exact(0.0).long()).expect("an order") as i8);
            match near.sign() {
                Some(found) => assert_eq!(found, sign, "{}", name()),
                None => open += 1,
            }
            known += u32::from(near.sign().is_some());
            assert_eq!(number > exact(0.0), sign > 0.0, "{}", name());
            assert_eq!(number == exact(0.0), sign == 0.0, "{}", name());
        }
    }
    assert!(known > 10 * open && open > 1000, "{known} known, {open} open");
}
