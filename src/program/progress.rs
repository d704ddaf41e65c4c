//! How a long run is getting on, for a terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Parts of the bar.
const PARTS: u64 = 1000;

/// A line on standard error that shows simulated time, events per second and an
/// estimate of the time left; nothing if that is no terminal.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    began: Instant,
    events: u64,
    looked: Instant,
    rate: f64,
}

impl Progress {
    pub(super) fn new(quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal();
        let bar = shown.then(|| {
            let bar = ProgressBar::new(PARTS);
            if let Ok(style) = ProgressStyle::with_template("{bar:24} {msg}") {
                bar.set_style(style);
            }
            bar
        });
        let now = Instant::now();
        Progress {
            bar,
            began: now,
            events: 0,
            looked: now,
            rate: 0.0,
        }
    }

    /// Shows that `share` (0 … 1) is done.
    pub(super) fn show(&mut self, time: f64, events: u64, share: f64) {
        let Some(bar) = &self.bar else { return };
        let passed = self.looked.elapsed();
        if passed < Duration::from_millis(200) {
            return;
        }
        self.rate = (events - self.events) as f64 / passed.as_secs_f64();
        self.events = events;
        self.looked = Instant::now();
        bar.set_position((share * PARTS as f64) as u64);
        bar.set_message(format!(
            "t = {time:.2}, {events:.2e} events, {:.0}/s, {}",
            self.rate,
            time_left(self.began.elapsed(), share)
        ));
    }

    /// Takes the line away.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// How long it will still take if it goes on as it went so far.
fn time_left(passed: Duration, share: f64) -> String {
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
