//! The program as people and scripts meet it: exit codes, what it prints where, and the files it leaves.

mod run;

/// Every refusal names its cause and what to try, and leaves nothing behind.
mod refusals;

/// What `render` writes and reports.
mod render;

/// Choices that change the time and must not change a bit.
mod same_bits;

/// `explain` names the line that asks for each effect.
mod explain;

/// `--target-error` and `--time` stop where they say.
mod promise;

/// `ledger` measures what accuracy costs.
mod ledger;

/// `diff` measures and decides.
mod diff;

/// Standard output is data and standard error is for people, even when nobody listens.
mod streams;

/// Signals stop a render and keep its picture.
#[cfg(unix)]
mod signals;
