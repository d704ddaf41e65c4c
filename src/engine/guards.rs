//! Book-keeping of cascades: how often a grain has collided at one instant, and
//! with whom last.

use std::hint::black_box;
use std::ops::Index;

use serde::{Deserialize, Serialize};

use crate::engine::settings::Guards;
use crate::engine::slot::Partner;
use crate::engine::sparse::Sparse;
use crate::time::Time;

/// Collisions closer together than this, in √(d/g), are at one instant.
const INSTANT: f64 = 1.0e-12;

/// So are those closer together than this part of the exit speed over gravity
/// between which the surfaces come apart by less than `HAIR`: a grain that
/// slides along another in bounces of 10⁻¹² √(gd), which are elastic, would
/// make 10¹¹ of them in a unit of time.
const HURRY: f64 = 0.01;

/// The same, in √(d/g), where there is no exit speed.
const MOMENT: f64 = 1.0e-7;

/// Less than this, in d, does not separate two surfaces.
const HAIR: f64 = 1.0e-12;

/// How many recent contacts of a grain the hold remembers.
const HELD: usize = 6;

/// Earlier than every instant of a run.
const LONG_AGO: Time = Time::FIRST;

/// What is remembered of a grain's collisions.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Trace {
    /// Whom it left at its last event, if that was a collision.
    pub(super) partner: Partner,
    /// Collisions at the instant of the last one.
    pub(super) run: u32,
    /// When it last collided.
    pub(super) last: Time,
    /// Collisions with static grains and walls since it last met a mobile one, or woke.
    pub(super) confined: u32,
    /// When the last lot of them began.
    pub(super) confined_since: Time,
}

impl Trace {
    /// Of a grain of which nothing is remembered.
    const NONE: Trace = Trace {
        partner: Partner::Nobody,
        run: 0,
        last: Time::NEVER,
        confined: 0,
        confined_since: Time::NEVER,
    };
}

/// Static partners that a grain may not meet again before a time.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Holds {
    partners: [(u32, Time); HELD],
    next: usize,
}

impl Holds {
    const NONE: Holds = Holds {
        partners: [(u32::MAX, LONG_AGO); HELD],
        next: 0,
    };
}

/// The traces of all grains.
#[derive(Clone, Debug)]
pub(super) struct Traces {
    /// Of those that have collided, and have not slept for long.
    traces: Sparse<Trace>,
    /// Empty if the hold is off.
    holds: Vec<Holds>,
    hold: f64,
    /// Collisions closer together than this may be at one instant.
    moment: f64,
}

/// Traces as they are saved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SavedTraces {
    traces: Vec<(u32, Trace)>,
    holds: Vec<Holds>,
    hold: f64,
    moment: f64,
}

impl SavedTraces {
    /// What does not fit, in traces that have been read, if anything.
    pub(super) fn misfit(
        &self,
        guards: &Guards,
        count: usize,
        is_there: impl Fn(Partner) -> bool,
    ) -> Option<&'static str> {
        let fresh = Traces::new(guards);
        if self.hold != fresh.hold || self.moment != fresh.moment {
            return Some("they follow other guards");
        }
        let held = if self.hold > 0.0 { count } else { 0 };
        if self.holds.len() != held {
            return Some("the number of holds is not that of the grains");
        }
        if self.holds.iter().any(|holds| holds.next >= HELD) {
            return Some("a hold is out of place");
        }
        let met = |(_, trace): &(u32, Trace)| is_there(trace.partner);
        (!self.traces.iter().all(met)).then_some("a collision with nobody")
    }
}

impl Traces {
    pub(super) fn new(guards: &Guards) -> Self {
        Traces {
            traces: Sparse::new(0, Trace::NONE),
            holds: Vec::new(),
            hold: guards.hold,
            // The detector of collapse needs it if there is no projection, too.
            moment: if guards.exit_speed > 0.0 {
                HURRY * guards.exit_speed
            } else {
                MOMENT
            },
        }
    }

    pub(super) fn add(&mut self) {
        self.traces.push();
        if self.hold > 0.0 {
            self.holds.push(Holds::NONE);
        }
    }

    /// Reads a grain's trace, to have it at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        let trace = &self.traces[particle];
        black_box((trace.run, trace.confined));
    }

    pub(super) fn forget_last(&mut self) {
        self.traces.pop();
        self.holds.pop();
    }

    /// A grain whose last event was no collision, or has been undone.
    pub(super) fn forget_partner(&mut self, particle: u32) {
        if let Some(trace) = self.traces.own(particle) {
            trace.partner = Partner::Nobody;
        }
    }

    /// A grain wakes, or is set free. What it has done at this instant is not forgotten: it
    /// may go to and fro between sleep and waking.
    pub(super) fn woke(&mut self, particle: u32, now: Time) {
        self.forget_partner(particle);
        if self.is_over(&self.traces[particle], now) {
            self.traces.clear(particle);
        }
    }

    /// Whether a grain's last collision, if there was one, was at an earlier instant.
    fn is_over(&self, trace: &Trace, now: Time) -> bool {
        now - trace.last > INSTANT.max(self.moment)
    }

    /// A grain's collisions with static obstacles are counted as from now on; nothing if
    /// it has not made any.
    pub(super) fn confine_from(&mut self, particle: u32, now: Time) -> Option<f64> {
        let trace = self.traces.own(particle)?;
        let lasted = now - trace.confined_since;
        trace.confined_since = now;
        Some(lasted)
    }

    /// Gives back the room of the traces of sleepers, which will be void when they wake.
    pub(super) fn tidy(&mut self, now: Time, sleeps: impl Fn(u32) -> bool) {
        let all = self.traces.each();
        let void = all.filter(|(particle, trace)| sleeps(*particle) && self.is_over(trace, now));
        let void: Vec<u32> = void.map(|(particle, _)| particle).collect();
        for particle in void {
            self.traces.clear(particle);
        }
    }

    pub(super) fn save(&self) -> SavedTraces {
        SavedTraces {
            traces: self.traces.save(),
            holds: self.holds.clone(),
            hold: self.hold,
            moment: self.moment,
        }
    }

    /// The traces that were saved, of so many grains.
    ///
    /// # Errors
    ///
    /// If they name somebody who is not there, or one twice.
    pub(super) fn restore(saved: SavedTraces, count: usize) -> Result<Self, &'static str> {
        Ok(Traces {
            traces: Sparse::restore(saved.traces, count, Trace::NONE)?,
            holds: saved.holds,
            hold: saved.hold,
            moment: saved.moment,
        })
    }

    /// Notes a collision at this closing speed, with a static obstacle or not;
    /// returns how many the grain has made at this instant.
    pub(super) fn collided(
        &mut self,
        particle: u32,
        partner: Partner,
        is_static: bool,
        speed: f64,
        now: Time,
    ) -> u32 {
        let trace = self.traces.make(particle);
        trace.confined = if is_static {
            trace.confined.wrapping_add(1)
        } else {
            0
        };
        if trace.confined <= 1 {
            trace.confined_since = now;
        }
        let at_once = trace.last.is_finite() && {
            let wait = now - trace.last;
            wait < INSTANT || (wait < self.moment && speed * wait < HAIR)
        };
        trace.run = if at_once {
            trace.run.saturating_add(1)
        } else {
            1
        };
        trace.last = now;
        trace.partner = partner;
        trace.run
    }

    /// Keeps a pair apart after an elastic contact with a static grain; any
    /// other contact of the grain ends all its holds, so that nothing fast is
    /// ever held.
    pub(super) fn hold(&mut self, particle: u32, partner: Option<u32>, now: Time) {
        if self.hold == 0.0 {
            return;
        }
        let holds = &mut self.holds[particle as usize];
        match partner {
            Some(partner) => {
                holds.partners[holds.next] = (partner, now + self.hold);
                holds.next = (holds.next + 1) % HELD;
            }
            None => *holds = Holds::NONE,
        }
    }

    /// Whether a contact of two grains now is one that was put off.
    pub(super) fn held_at(&self, first: u32, second: u32, now: Time) -> bool {
        self.hold > 0.0 && self.held_until(first, second, LONG_AGO) == now
    }

    /// When two grains that would meet at `time` are allowed to.
    #[inline]
    pub(super) fn held_until(&self, first: u32, second: u32, time: Time) -> Time {
        if self.hold == 0.0 {
            return time;
        }
        let of = |particle: u32, partner: u32| {
            let holds = &self.holds[particle as usize].partners;
            holds
                .iter()
                .filter(move |(held, _)| *held == partner)
                .map(|(_, until)| *until)
        };
        of(first, second)
            .chain(of(second, first))
            .fold(time, Time::max)
    }
}

impl Index<u32> for Traces {
    type Output = Trace;

    #[inline]
    fn index(&self, particle: u32) -> &Trace {
        &self.traces[particle]
    }
}
