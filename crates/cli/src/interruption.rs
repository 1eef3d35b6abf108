//! Being asked to stop: Ctrl-C, or the signal with which batch systems announce the end of a job's time.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Whether somebody has asked to stop.
#[derive(Clone, Debug, Default)]
pub struct Interruption {
    asked: Arc<AtomicBool>,
    /// Which signal it was.
    signal: Arc<AtomicUsize>,
}

/// What shells say of programs that a signal ended.
const BY_SIGNAL: i32 = 128;

impl Interruption {
    /// From now on the first signal is noted, and the second one ends the program at once. Files are written under
    /// another name first, so that nothing is left half written.
    pub fn listen() -> io::Result<Self> {
        let heard = Interruption::default();
        for signal in [SIGINT, SIGTERM] {
            // Comes first, and does nothing the first time.
            flag::register_conditional_shutdown(signal, BY_SIGNAL + signal, Arc::clone(&heard.asked))?;
            flag::register(signal, Arc::clone(&heard.asked))?;
            flag::register_usize(signal, Arc::clone(&heard.signal), signal as usize)?;
        }
        Ok(heard)
    }

    /// Whether it is time to stop.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The exit code of a program that was stopped: 130 after Ctrl-C.
    pub fn exit_code(&self) -> u8 {
        let signal = self.signal.load(Ordering::Relaxed);
        // Signals are small numbers.
        u8::try_from(BY_SIGNAL as usize + signal).unwrap_or(u8::MAX)
    }
}
