//! Bounds on the speeds of all grains, each kept for a while.
//!
//! Whoever asks how soon anybody can come near need not look at everybody each time.
//! A bound follows from the states of the grains; being higher than it has to be, or
//! found anew, it only decides who is looked at.

use crate::engine::simulation::Simulation;
use crate::model::{Flight, Model};
use crate::time::Time;

/// Looks ahead no longer than these, in √(d/g), share a bound each. It covers twice
/// as long, so that it serves for as long again.
const WINDOWS: [f64; 3] = [0.25, 1.0, 4.0];

/// A bound on all speeds, in √(gd), up to an instant.
#[derive(Clone, Copy, Debug)]
struct Ceiling {
    speed: f64,
    until: Time,
}

/// A bound for each of the windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds([Ceiling; WINDOWS.len()]);

impl Speeds {
    /// Nothing known yet, at an instant.
    pub(super) fn unknown(now: Time) -> Self {
        Speeds(
            [Ceiling {
                speed: 0.0,
                until: now,
            }; WINDOWS.len()],
        )
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Keeps the bounds true after a grain's velocity has changed.
    #[inline]
    pub(super) fn note_speed(&mut self, particle: u32) {
        let flight = self.world.flight(&self.model, particle);
        for (ceiling, window) in self.speeds.0.iter_mut().zip(WINDOWS) {
            ceiling.speed = ceiling.speed.max(flight.speed_bound(2.0 * window));
        }
    }

    /// A bound on the speeds of all grains from now on for so long, in √(gd).
    pub(super) fn speed_ceiling(&mut self, within: f64) -> f64 {
        let now = self.world.clock;
        let Some(shared) = WINDOWS.iter().position(|window| within <= *window) else {
            return self.fastest(within);
        };
        if now + within > self.speeds.0[shared].until {
            let ahead = 2.0 * WINDOWS[shared];
            self.speeds.0[shared] = Ceiling {
                speed: self.fastest(ahead),
                until: now + ahead,
            };
        }
        self.speeds.0[shared].speed
    }

    /// The same, by looking at everybody.
    fn fastest(&self, within: f64) -> f64 {
        let now = self.world.clock;
        (0..self.world.bodies.len() as u32)
            .map(|particle| {
                let since = self.world.bodies[particle as usize].since;
                let flight = self.world.flight(&self.model, particle);
                flight.advanced(now - since).speed_bound(within)
            })
            .fold(0.0, f64::max)
    }
}
