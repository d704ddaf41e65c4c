//! How much processor time a run has taken.

use std::time::Duration;

/// A clock of the processor time of one thread, the one that started it and
/// reads it, or of passed time where there is none.
pub(super) struct ProcessorClock {
    start: Duration,
    #[cfg(not(unix))]
    began: std::time::Instant,
}

impl ProcessorClock {
    /// Starts now.
    pub(super) fn start() -> Self {
        #[cfg(not(unix))]
        let clock = ProcessorClock {
            start: Duration::ZERO,
            began: std::time::Instant::now(),
        };
        #[cfg(unix)]
        let clock = ProcessorClock { start: now() };
        clock
    }

    /// Seconds since the start.
    pub(super) fn seconds(&self) -> f64 {
        #[cfg(not(unix))]
        let now = self.began.elapsed();
        #[cfg(unix)]
        let now = now();
        now.saturating_sub(self.start).as_secs_f64()
    }
}

#[cfg(unix)]
fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(
        u64::try_from(time.tv_sec).unwrap_or(0),
        u32::try_from(time.tv_nsec).unwrap_or(0),
    )
}
