//! When to stop and look around.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

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
            // From 2⁵³ on, adding one changes nothing.
            self.count = (self.count + 1.0).max(self.count.next_up());
        }
        true
    }
}

/// How far the samples have got.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SavedSamples {
    rows: f64,
    frames: f64,
    events: u64,
    idle: u32,
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

    pub(super) fn save(&self) -> SavedSamples {
        SavedSamples {
            rows: self.rows.count,
            frames: self.frames.count,
            events: self.events,
            idle: self.idle,
        }
    }

    /// Samples that have got as far; `None` if nothing can have.
    pub(super) fn restore(rows: f64, frames: f64, saved: &SavedSamples) -> Option<Self> {
        // The shortest interval fits so often into the longest run.
        let is_count = |count: f64| (1.0..1.0e19).contains(&count);
        (is_count(saved.rows) && is_count(saved.frames)).then_some(Samples {
            rows: Beat {
                every: rows,
                count: saved.rows,
            },
            frames: Beat {
                every: frames,
                count: saved.frames,
            },
            events: saved.events,
            idle: saved.idle,
        })
    }

    /// When the next sample is due.
    pub(super) fn next(&self) -> Time {
        if self.is_idle() {
            Time::NEVER
        } else {
            self.rows.next().min(self.frames.next())
        }
    }

    /// Whether no more samples are taken until something happens.
    pub(super) fn is_idle(&self) -> bool {
        self.idle >= IDLE_SAMPLES
    }

    /// Something has happened again, now: samples are taken from here on.
    pub(super) fn wake(&mut self, now: Time, events: u64) {
        (self.events, self.idle) = (events, 0);
        self.rows.pass(now);
        self.frames.pass(now);
    }

    /// What is due now, after `events` events; to be asked whenever something
    /// is, and only then, so that it does not depend on the computer's speed.
    pub(super) fn due(&mut self, now: Time, events: u64) -> Due {
        if events == self.events {
            self.idle += 1;
        } else {
            (self.events, self.idle) = (events, 0);
        }
        Due {
            row: self.rows.pass(now),
            frame: self.frames.pass(now),
        }
    }
}

/// When to write a checkpoint.
pub(super) struct Cadence {
    /// At the multiples of a simulated time, or by the clock on the wall.
    beat: Option<Beat>,
    last: Instant,
    took: Duration,
}

/// By the clock on the wall, a checkpoint is written this often, …
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);
/// … but less often if it takes more than this part of the time.
const CHECKPOINT_SHARE: u32 = 50;

impl Cadence {
    /// Every `every` √(d/g) after `now`, never if that is 0, or else by the
    /// clock on the wall.
    pub(super) fn new(every: Option<f64>, now: Time) -> Self {
        let mut beat = every.map(Beat::new);
        if let Some(beat) = &mut beat {
            beat.pass(now);
        }
        Cadence {
            beat,
            last: Instant::now(),
            took: Duration::ZERO,
        }
    }

    /// Until when the next one can wait.
    pub(super) fn next(&self) -> Time {
        self.beat.as_ref().map_or(Time::NEVER, Beat::next)
    }

    /// Whether one is due now.
    pub(super) fn is_due(&mut self, now: Time) -> bool {
        match &mut self.beat {
            Some(beat) => beat.pass(now),
            None => {
                let pause = CHECKPOINT_EVERY.max(self.took * CHECKPOINT_SHARE);
                self.last.elapsed() >= pause
            }
        }
    }

    /// One has been written, which was begun at an instant.
    pub(super) fn written(&mut self, begun: Instant) {
        self.last = Instant::now();
        self.took = self.last - begun;
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
        let back = Samples::restore(1.0, 0.0, &samples.save()).unwrap();
        assert_eq!(back.next(), samples.next());
    }

    #[test]
    fn checkpoints_are_at_the_multiples() {
        let mut cadence = Cadence::new(Some(0.5), Time::from_units(3.2));
        assert_eq!(cadence.next(), Time::from_units(3.5));
        assert!(!cadence.is_due(Time::from_units(3.4)));
        assert!(cadence.is_due(Time::from_units(3.5)));
        assert_eq!(cadence.next(), Time::from_units(4.0));
        let late = Time::from_units(7.9e9);
        let short = Cadence::new(Some(1.0e-9), late);
        assert!(short.next() > late);
        let mut never = Cadence::new(Some(0.0), Time::ZERO);
        assert!(!never.is_due(Time::from_units(1.0e9)));
        assert_eq!(never.next(), Time::NEVER);
    }

    #[test]
    fn an_idle_system_is_left_alone() {
        let mut samples = Samples::new(1.0, 0.0);
        for _ in 0..IDLE_SAMPLES {
            assert!(samples.due(samples.next(), 0).row);
        }
        assert_eq!(samples.next(), Time::NEVER);
        assert!(samples.is_idle());
        samples.wake(Time::from_units(2.0e6 + 0.5), 1);
        assert_eq!(samples.next(), Time::from_units(2_000_001.0));
        assert!(samples.due(samples.next(), 1).row);
    }
}
