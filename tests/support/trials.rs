//! What came of the trials of a numbered case: counted, measured, and written down for the table of hard cases.
//!
//! `OCELLUS_TRIALS` raises the number of trials of every class. Where `OCELLUS_TRIALS_FILE` names a file, each class
//! adds a line to it; `tests/hard_cases` prints them as one table.

use std::cell::{Cell, RefCell};
use std::io::Write as _;

use ocellus_kernel::Real;

/// How many trials to run: `least`, or `OCELLUS_TRIALS`, 100,000 by default, if that is more.
pub(crate) fn trials(least: u32) -> u32 {
    let asked = std::env::var("OCELLUS_TRIALS").ok().map(|text| text.parse().expect("OCELLUS_TRIALS is a number"));
    asked.unwrap_or(100_000).max(least)
}

/// The trials of one class of inputs of one numbered case. Shared references suffice, so that closures can use it.
pub(crate) struct Trials {
    /// Case, precision, class.
    name: [String; 3],
    /// What is measured and its limit; `None` where trials only succeed or fail.
    limit: Option<(f64, &'static str)>,
    count: Cell<u64>,
    failures: Cell<u64>,
    worst: Cell<f64>,
    /// The first few failures, in words.
    words: RefCell<Vec<String>>,
}

impl Trials {
    /// Of trials that succeed or fail.
    pub(crate) fn of<R: Real>(case: &str, class: &str) -> Self {
        let precision = if R::WIDE_IS_SELF { "f64" } else { "f32" };
        Self {
            name: [case, precision, class].map(str::to_owned),
            limit: None,
            count: Cell::new(0),
            failures: Cell::new(0),
            worst: Cell::new(0.0),
            words: RefCell::default(),
        }
    }

    /// Of trials whose errors, in `unit`, must not exceed `limit`.
    pub(crate) fn measured<R: Real>(case: &str, class: &str, limit: f64, unit: &'static str) -> Self {
        Self { limit: Some((limit, unit)), ..Self::of::<R>(case, class) }
    }

    /// `count` trials of tests that stop at the first failure, all of which were passed.
    pub(crate) fn passed<R: Real>(case: &str, class: &str, count: u32) {
        let trials = Self::of::<R>(case, class);
        trials.count.set(count.into());
        trials.end(1);
    }

    /// How many there were so far.
    pub(crate) fn count(&self) -> u64 {
        self.count.get()
    }

    /// One trial that succeeded or not.
    pub(crate) fn holds(&self, success: bool, words: impl FnOnce() -> String) {
        self.count.set(self.count.get() + 1);
        if !success {
            self.failures.set(self.failures.get() + 1);
            if self.words.borrow().len() < 3 {
                self.words.borrow_mut().push(words());
            }
        }
    }

    /// One trial with an error; a NaN fails.
    pub(crate) fn error(&self, error: f64, words: impl FnOnce() -> String) {
        let (limit, unit) = self.limit.expect("a limit");
        if !(error <= self.worst.get()) {
            self.worst.set(error);
        }
        self.holds(error <= limit, || format!("{error} {unit}: {}", words()));
    }

    /// Writes the class down, and fails if any of its trials did, or if there were fewer than `least`.
    pub(crate) fn end(self, least: u64) {
        let (count, failures) = (self.count.get(), self.failures.get());
        let [case, precision, class] = &self.name;
        let measured = match self.limit {
            Some((limit, unit)) => format!("{:.3}\t{limit} {unit}", self.worst.get()),
            None => "-\t0 failures".to_owned(),
        };
        let line = format!("{case}\t{precision}\t{class}\t{count}\t{failures}\t{measured}\n");
        print!("{line}");
        if let Some(path) = std::env::var_os("OCELLUS_TRIALS_FILE") {
            let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
            // One write per line, so that tests side by side do not mix theirs.
            file.and_then(|mut file| file.write_all(line.as_bytes())).expect("OCELLUS_TRIALS_FILE can be written");
        }
        let words = self.words.borrow().join("\n");
        assert_eq!(
            failures, 0,
            "{case} in {precision}, {class}: {failures} of {count} trials fail; the first:\n{words}"
        );
        assert!(count >= least, "{case} in {precision}, {class}: only {count} trials came about, not {least}");
    }
}
