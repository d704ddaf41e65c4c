//! How a long run is getting on, for a terminal.

use std::io::IsTerminal;
use std::mem;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Parts of the bar.
const PARTS: u64 = 1000;

/// A bar on standard error; `None` if that is no terminal.
pub(super) fn bar(quiet: bool) -> Option<ProgressBar> {
    let shown = !quiet && std::io::stderr().is_terminal();
    shown.then(|| {
        let bar = ProgressBar::new(PARTS);
        if let Ok(style) = ProgressStyle::with_template("{bar:24} {msg}") {
            bar.set_style(style);
        }
        bar
    })
}

/// Shows on a bar that `share` (0 … 1) is done, and a message.
pub(super) fn show_on(bar: &ProgressBar, share: f64, message: String) {
    bar.set_position((share * PARTS as f64) as u64);
    bar.set_message(message);
}

/// How one of many runs is getting on, to be read by another thread.
#[derive(Debug, Default)]
pub(super) struct Gauge {
    /// Bits of the share that is done.
    share: AtomicU64,
    notes: Mutex<Vec<String>>,
}

impl Gauge {
    /// That `share` (0 … 1) of the run is done.
    pub(super) fn set(&self, share: f64) {
        self.share.store(share.to_bits(), Ordering::Relaxed);
    }

    /// What share is done.
    pub(super) fn share(&self) -> f64 {
        f64::from_bits(self.share.load(Ordering::Relaxed))
    }

    /// Something that people should know.
    pub(super) fn note(&self, text: String) {
        let mut notes = self.notes.lock().unwrap_or_else(PoisonError::into_inner);
        notes.push(text);
    }

    /// What people should know, each once.
    pub(super) fn take_notes(&self) -> Vec<String> {
        mem::take(&mut *self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A line on standard error that shows simulated time, events per second and an
/// estimate of the time left; nothing if that is no terminal. One of many runs
/// has a gauge instead.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    gauge: Option<Arc<Gauge>>,
    began: Instant,
    events: u64,
    looked: Instant,
    rate: f64,
}

impl Progress {
    pub(super) fn new(quiet: bool, gauge: Option<Arc<Gauge>>) -> Self {
        let now = Instant::now();
        Progress {
            bar: bar(quiet || gauge.is_some()),
            gauge,
            began: now,
            events: 0,
            looked: now,
            rate: 0.0,
        }
    }

    /// Shows that `share` (0 … 1) is done.
    pub(super) fn show(&mut self, time: f64, events: u64, share: f64) {
        if let Some(gauge) = &self.gauge {
            gauge.set(share);
        }
        let Some(bar) = &self.bar else { return };
        let passed = self.looked.elapsed();
        if passed < Duration::from_millis(200) {
            return;
        }
        self.rate = (events - self.events) as f64 / passed.as_secs_f64();
        self.events = events;
        self.looked = Instant::now();
        let left = time_left(self.began.elapsed(), share);
        let message = format!(
            "t = {time:.2}, {events:.2e} events, {:.0}/s, {left}",
            self.rate
        );
        show_on(bar, share, message);
    }

    /// Takes the line away.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// How long it will still take if it goes on as it went so far.
pub(super) fn time_left(passed: Duration, share: f64) -> String {
    if !(share > 0.005 && share < 1.0) {
        return "time left unknown".to_owned();
    }
    let seconds = passed.as_secs_f64() * (1.0 - share) / share;
    if seconds < 90.0 {
        format!("about {seconds:.0} s left")
    } else if seconds < 5400.0 {
        format!("about {:.0} min left", seconds / 60.0)
    } else {
        format!("about {:.1} h left", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_as_the_past() {
        let minute = Duration::from_secs(60);
        assert_eq!(time_left(minute, 0.5), "about 60 s left");
        assert_eq!(time_left(minute, 0.1), "about 9 min left");
        assert_eq!(time_left(minute, 0.01), "about 1.6 h left");
        assert_eq!(time_left(minute, 0.0), "time left unknown");
    }
}
