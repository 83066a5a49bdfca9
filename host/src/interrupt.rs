//! Ctrl-C and SIGTERM: the first of them stops the render and saves the picture so far, the next ends the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::error::ExitCode;

/// Whether a signal has asked to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Listens for SIGINT and SIGTERM from now on. Where that is not possible, they end the program at once.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let again = Arc::new(AtomicBool::new(false));
        for (signal, code) in [(SIGINT, ExitCode::Interrupted), (SIGTERM, ExitCode::Terminated)] {
            // The order counts: the check for a second signal has to run before the first one is noted.
            let registered = signal_hook::flag::register_conditional_shutdown(signal, code as i32, Arc::clone(&again))
                .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&again)))
                .and_then(|_| {
                    signal_hook::flag::register_usize(signal, Arc::clone(&interrupt.signal), signal as usize)
                });
            if registered.is_err() {
                break;
            }
        }
        interrupt
    }

    /// The exit code that the signal asks for, once there was one.
    pub fn received(&self) -> Option<ExitCode> {
        match self.signal.load(Ordering::Relaxed) {
            0 => None,
            signal if signal == SIGTERM as usize => Some(ExitCode::Terminated),
            _ => Some(ExitCode::Interrupted),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signal_chooses_the_exit_code() {
        let interrupt = Interrupt::default();
        assert_eq!(interrupt.received(), None);
        let clone = interrupt.clone();
        for (signal, code) in [(SIGINT, ExitCode::Interrupted), (SIGTERM, ExitCode::Terminated)] {
            interrupt.signal.store(signal as usize, Ordering::Relaxed);
            assert_eq!(clone.received(), Some(code));
            // What a shell reports for a program that the signal killed.
            assert_eq!(code as i32, 128 + signal);
        }
    }
}
