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

    /// A line for a render whose end is not known.
    pub fn open_ended(interrupt: Interrupt) -> Self {
        let bar = ProgressBar::no_length();
        let style = ProgressStyle::with_template("{elapsed} gone{msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
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

    fn tell(&self, words: &str) {
        self.bar.set_message(format!(": {words}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::{ProgressDrawTarget, TermLike};
    use std::io;
    use std::sync::{Arc, Mutex};

    /// A terminal that keeps the line it shows.
    #[derive(Clone, Debug, Default)]
    struct OneLine(Arc<Mutex<String>>);

    impl OneLine {
        fn shown(&self) -> String {
            self.0.lock().expect("no test panics while it draws").clone()
        }
    }

    impl TermLike for OneLine {
        fn width(&self) -> u16 {
            80
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().expect("no test panics while it draws").push_str(text);
            Ok(())
        }

        fn clear_line(&self) -> io::Result<()> {
            self.0.lock().expect("no test panics while it draws").clear();
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn the_bar_tells_how_far_the_work_is_and_goes_away() {
        let progress = Progress::new(4_000_000, Interrupt::default());
        let terminal = OneLine::default();
        progress.bar.set_draw_target(ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        progress.advance(1_000_000);
        progress.bar.tick();
        let shown = terminal.shown();
        for text in [" 25 %", " gone, ", " left  ", "paths/s"] {
            assert!(shown.contains(text), "no {text:?} in {shown:?}");
        }
        assert!(shown.trim_end().len() < 80, "{shown:?}");
        progress.finish();
        assert_eq!(terminal.shown(), "");
    }

    #[test]
    fn without_a_signal_the_work_goes_on() {
        assert!(!Progress::new(1, Interrupt::default()).stopped());
    }
}
