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
}

impl Signals {
    /// Listens from now on.
    pub(super) fn listen() -> io::Result<Self> {
        let exit_code = Arc::new(AtomicUsize::new(0));
        let asked = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            let code = 128 + signal;
            // First, so that it sees what earlier signals have left.
            flag::register_conditional_shutdown(signal, code, Arc::clone(&asked))?;
            flag::register(signal, Arc::clone(&asked))?;
            flag::register_usize(signal, Arc::clone(&exit_code), code as usize)?;
        }
        Ok(Signals { exit_code })
    }

    /// The exit code that belongs to the signal that has come, if any.
    pub(super) fn exit_code(&self) -> Option<u8> {
        match self.exit_code.load(Ordering::Relaxed) {
            0 => None,
            code => u8::try_from(code).ok(),
        }
    }
}
