//! Ctrl-C and SIGTERM end a run in good order.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Which signals have come. The first one asks the run to end; one more ends
/// the process at once.
pub(super) struct Signals {
    exit_code: Arc<AtomicUsize>,
    /// Whether the next signal ends the process at once.
    at_once: Arc<AtomicBool>,
}

impl Signals {
    /// Listens from now on. Until the run has begun there is nothing to end in
    /// good order: a signal ends the process at once, with its exit code.
    pub(super) fn listen() -> io::Result<Self> {
        let exit_code = Arc::new(AtomicUsize::new(0));
        let at_once = Arc::new(AtomicBool::new(true));
        for signal in [SIGINT, SIGTERM] {
            let code = 128 + signal;
            // First, so that it sees what earlier signals have left.
            flag::register_conditional_shutdown(signal, code, Arc::clone(&at_once))?;
            flag::register(signal, Arc::clone(&at_once))?;
            flag::register_usize(signal, Arc::clone(&exit_code), code as usize)?;
        }
        Ok(Signals { exit_code, at_once })
    }

    /// A run begins: a first signal asks it to end. If that has come already,
    /// while another run went on, the next one still ends the process.
    pub(super) fn begin(&self) {
        if self.exit_code().is_none() {
            self.at_once.store(false, Ordering::Relaxed);
        }
    }

    /// The exit code that belongs to the signal that has come, if any.
    pub(super) fn exit_code(&self) -> Option<u8> {
        match self.exit_code.load(Ordering::Relaxed) {
            0 => None,
            code => u8::try_from(code).ok(),
        }
    }
}
