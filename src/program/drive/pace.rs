//! When to stop and look around.

use std::time::{Duration, Instant};

use crate::time::Time;

/// Slices take about this long, so that signals are noticed soon.
const SHORT: Duration = Duration::from_millis(20);
const LONG: Duration = Duration::from_millis(150);
/// The most events of a slice.
const EVENTS: u64 = 100_000;
/// After this many samples between which nothing has happened, no more are
/// taken until something does: a system in which nothing happens any more must
/// not fill the disk.
const IDLE_SAMPLES: u32 = 1000;

/// How far to run in one go. It follows the computer's speed, which no
/// trajectory sees: stopping at a time changes nothing.
pub(super) struct Pace {
    slice: f64,
    began: Instant,
}

impl Pace {
    pub(super) fn new() -> Self {
        Pace {
            slice: 1.0e-2,
            began: Instant::now(),
        }
    }

    pub(super) fn slice_after(&self, now: Time) -> Time {
        now + self.slice
    }

    pub(super) fn events(&self) -> u64 {
        EVENTS
    }

    pub(super) fn begin(&mut self) {
        self.began = Instant::now();
    }

    /// The slice is over; `whole` if nothing else had ended it before.
    pub(super) fn end(&mut self, whole: bool) {
        let took = self.began.elapsed();
        if took < SHORT && whole {
            self.slice = (self.slice * 2.0).min(1.0e9);
        } else if took > LONG {
            self.slice = (self.slice / 2.0).max(1.0e-9);
        }
    }
}

/// A run without an end in time ends when nothing has happened for so long, in
/// √(d/g).
const QUIET: f64 = 1.0e6;

/// Whether anything still happens.
pub(super) struct Quiet {
    events: u64,
    since: Time,
}

impl Quiet {
    pub(super) fn new(now: Time) -> Self {
        Quiet {
            events: 0,
            since: now,
        }
    }

    /// True if nothing has happened for a very long time.
    pub(super) fn lasts(&mut self, now: Time, events: u64) -> bool {
        if events != self.events {
            (self.events, self.since) = (events, now);
        }
        now - self.since >= QUIET
    }
}

/// The times at which rows and frames are due: the multiples of two intervals.
pub(super) struct Samples {
    rows: Beat,
    frames: Beat,
    events: u64,
    idle: u32,
}

/// What is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Due {
    pub(super) row: bool,
    pub(super) frame: bool,
}

/// The multiples of an interval; none if that is 0.
struct Beat {
    every: f64,
    count: f64,
}

impl Beat {
    fn new(every: f64) -> Self {
        Beat { every, count: 1.0 }
    }

    fn next(&self) -> Time {
        if self.every > 0.0 {
            Time::from_units(self.count * self.every)
        } else {
            Time::NEVER
        }
    }

    /// Passes everything up to `now`; true if something lay there.
    fn pass(&mut self, now: Time) -> bool {
        if self.next() > now {
            return false;
        }
        self.count = (now.units() / self.every).floor().max(self.count);
        while self.next() <= now {
            self.count += 1.0;
        }
        true
    }
}

impl Samples {
    pub(super) fn new(rows: f64, frames: f64) -> Self {
        Samples {
            rows: Beat::new(rows),
            frames: Beat::new(frames),
            events: 0,
            idle: 0,
        }
    }

    /// When the next sample is due.
    pub(super) fn next(&self) -> Time {
        if self.idle < IDLE_SAMPLES {
            self.rows.next().min(self.frames.next())
        } else {
            Time::NEVER
        }
    }

    /// What is due now, after `events` events.
    pub(super) fn due(&mut self, now: Time, events: u64) -> Due {
        let mut due = Due {
            row: self.rows.pass(now),
            frame: self.frames.pass(now),
        };
        if events != self.events {
            (self.events, self.idle) = (events, 0);
        } else if self.idle >= IDLE_SAMPLES {
            due = Due {
                row: false,
                frame: false,
            };
        } else if due.row || due.frame {
            self.idle += 1;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_at_the_multiples() {
        let mut samples = Samples::new(0.1, 0.25);
        let mut rows = Vec::new();
        let mut frames = 0;
        for events in 1.. {
            let next = samples.next();
            if next > Time::from_units(1.0) {
                break;
            }
            let due = samples.due(next, events);
            if due.row {
                rows.push(next.units());
            }
            frames += u32::from(due.frame);
        }
        let wanted: Vec<f64> = (1..=10).map(|k| f64::from(k) * 0.1).collect();
        assert_eq!(rows, wanted);
        assert_eq!(frames, 4);
    }

    #[test]
    fn nothing_is_due_between() {
        let mut samples = Samples::new(1.0, 0.0);
        let due = samples.due(Time::from_units(0.5), 3);
        assert!(!due.row && !due.frame);
        assert_eq!(samples.next(), Time::from_units(1.0));
    }

    #[test]
    fn an_idle_system_is_left_alone() {
        let mut samples = Samples::new(1.0, 0.0);
        for _ in 0..IDLE_SAMPLES {
            assert!(samples.due(samples.next(), 0).row);
        }
        assert_eq!(samples.next(), Time::NEVER);
        assert!(!samples.due(Time::from_units(1.0e6), 0).row);
        assert!(!samples.due(Time::from_units(2.0e6 + 0.5), 1).row || samples.idle == 0);
        assert_eq!(samples.next(), Time::from_units(2_000_001.0));
    }
}
