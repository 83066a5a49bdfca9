//! The progress bar, on standard error and only on a terminal.

use indicatif::{ProgressBar, ProgressStyle};

use crate::commands::words::abridged;
use crate::interrupt::Interrupt;
use crate::render::Monitor;

/// Shows progress and passes interrupts on.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    interrupt: Interrupt,
}

impl Progress {
    /// A bar for a render of `paths` paths; `indicatif` hides it where standard error is no terminal.
    pub fn new(paths: u64, interrupt: Interrupt) -> Self {
        let bar = ProgressBar::new(paths);
        let template = "{bar:30} {percent:>3} %  {elapsed} gone, {eta} left  {per_sec}";
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let per_second = |state: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
            // A failure to format leaves the bar without the rate.
            let _ = write!(out, "{} paths/s", abridged(state.per_sec()));
        };
        bar.set_style(style.progress_chars("=> ").with_key("per_sec", per_second));
        Self { bar, interrupt }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Monitor for Progress {
    fn advance(&self, paths: u64) {
        self.bar.inc(paths);
    }

    fn stopped(&self) -> bool {
        self.interrupt.received().is_some()
    }
}
