//! Timed runs.

use serde::Serialize;

use crate::engine::{Limits, Simulation, StopReason};
use crate::model::{Model, Observer};
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;

/// So many events are carried out between two looks at the clock on the wall.
const PORTION: u64 = 100_000;

/// What carrying out events took.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Cost {
    /// Physical events.
    pub(super) events: u64,
    /// Processor time, in seconds.
    pub(super) seconds: f64,
}

impl Cost {
    /// Nanoseconds of processor time for each event.
    pub(super) fn nanoseconds(self) -> f64 {
        1.0e9 * self.seconds / self.events as f64
    }

    /// Events in a second of processor time.
    pub(super) fn rate(self) -> f64 {
        self.events as f64 / self.seconds
    }
}

/// Carries out events until a limit is reached, and says what it took and which
/// limit it was. On a terminal it shows how far it is. The stops in between
/// leave no trace in the trajectory.
pub(super) fn timed<M: Model<D>, O: Observer<D>, const D: usize>(
    simulation: &mut Simulation<M, D>,
    limits: &Limits,
    observer: &mut O,
    progress: &mut Progress,
) -> (Cost, StopReason) {
    let before = simulation.counts().total();
    let start = simulation.time();
    let clock = ProcessorClock::start();
    let reason = loop {
        let portion = Limits {
            events: limits
                .events
                .min(simulation.counts().total().saturating_add(PORTION)),
            ..*limits
        };
        let reason = simulation.run(&portion, observer);
        let total = simulation.counts().total();
        if reason != StopReason::Events || total >= limits.events {
            break reason;
        }
        let share = if limits.time.is_finite() {
            (simulation.time() - start) / (limits.time - start)
        } else {
            (total - before) as f64 / (limits.events - before) as f64
        };
        progress.show(simulation.time().units(), total, share);
    };
    let cost = Cost {
        events: simulation.counts().total() - before,
        seconds: clock.seconds(),
    };
    (cost, reason)
}
