//! Property tests that draw the same cases in every run.

use std::fmt::Debug;

use proptest::strategy::{Just, Strategy};
use proptest::test_runner::{Config, RngAlgorithm, TestCaseResult, TestRng, TestRunner};

/// Runs `test` on `cases` values of `strategy`; a failing value is shrunk and shown.
pub(crate) fn for_all<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value) -> TestCaseResult)
where
    S::Value: Debug,
{
    // No file of past failures: what fails once fails again.
    let rejects = cases.max(Config::default().max_global_rejects);
    let config = Config { cases, failure_persistence: None, max_global_rejects: rejects, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    if let Err(failure) = runner.run(&strategy, test) {
        panic!("{failure}");
    }
}

/// Numbers in -1..1 with zeros of both signs, ones and denormal-small values mixed in: components that break things.
pub(crate) fn component() -> impl Strategy<Value = f64> {
    proptest::prop_oneof![8 => -1.0..1.0, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1.0), 1 => -1e-20..1e-20]
}

/// Three of them, not all zero.
pub(crate) fn direction() -> impl Strategy<Value = [f64; 3]> {
    proptest::array::uniform3(component()).prop_filter("not zero", |v| v.iter().any(|x| *x as f32 != 0.0))
}

/// `2^k` with k uniform in a range: every magnitude alike.
pub(crate) fn power_of_two(exponents: std::ops::Range<i32>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|k| libm::ldexp(1.0, k))
}
