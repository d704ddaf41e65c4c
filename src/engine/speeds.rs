//! Bounds on the speeds of all grains, each kept for a while.
//!
//! Whoever asks how soon anybody can come near need not look at everybody each time.
//! A bound follows from the states of the grains; being higher than it has to be, or
//! found anew, it only decides who is looked at.

use crate::engine::simulation::Simulation;
use crate::model::{Flight, Model};
use crate::time::Time;

/// Looks ahead no longer than these, in √(d/g), share a bound each. It covers at least
/// twice as long, so that it serves for as long again.
const WINDOWS: [f64; 3] = [0.25, 1.0, 4.0];

/// It covers no more than so many windows, however little happens: the longer it covers
/// the higher it is.
const LONGEST: f64 = 16.0;

/// Where less happens in between than so many events for each grain, looking at everybody
/// is no small matter.
const FEW: f64 = 0.125;

/// A bound on all speeds, in √(gd), up to an instant.
#[derive(Clone, Copy, Debug)]
struct Ceiling {
    speed: f64,
    until: Time,
    /// How long it covered from the start, in √(d/g).
    covers: f64,
    /// How many events there had been then.
    events: u64,
}

/// A bound for each of the windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds([Ceiling; WINDOWS.len()]);

impl Speeds {
    /// Nothing known yet, at an instant.
    pub(super) fn unknown(now: Time) -> Self {
        Speeds(WINDOWS.map(|window| Ceiling {
            speed: 0.0,
            until: now,
            covers: window,
            events: 0,
        }))
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Keeps the bounds true after a grain's velocity has changed.
    #[inline]
    pub(super) fn note_speed(&mut self, particle: u32) {
        let flight = self.world.flight(&self.model, particle);
        for ceiling in &mut self.speeds.0 {
            ceiling.speed = ceiling.speed.max(flight.speed_bound(ceiling.covers));
        }
    }

    /// A bound on the speeds of all grains from now on for so long, in √(gd).
    pub(super) fn speed_ceiling(&mut self, within: f64) -> f64 {
        let now = self.world.clock;
        let Some(shared) = WINDOWS.iter().position(|window| within <= *window) else {
            return self.fastest(within);
        };
        let known = self.speeds.0[shared];
        if now + within > known.until {
            let events = self.counts.total();
            let passed = events.saturating_sub(known.events) as f64;
            let covers = if passed < FEW * self.world.bodies.len() as f64 {
                f64::min(2.0 * known.covers, LONGEST * WINDOWS[shared])
            } else {
                f64::max(0.5 * known.covers, 2.0 * WINDOWS[shared])
            };
            self.speeds.0[shared] = Ceiling {
                speed: self.fastest(covers),
                until: now + covers,
                covers,
                events,
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
