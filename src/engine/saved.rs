//! A simulation's whole state, to be written down and gone on from.
//!
//! Besides the grains it holds the grid, the lists and what lies ahead of each
//! grain, in the order in which they are looked at: so a simulation that goes
//! on is the same as one that was never saved, down to the counts that are not
//! physical. Only the queue is made anew, for the order of its entries follows
//! from their keys.

use std::cmp::Reverse;

use serde::{Deserialize, Serialize};

use crate::engine::aloft::{Aloft, SavedAloft};
use crate::engine::body::{Body, World, flight_of};
use crate::engine::consistency::Vigil;
use crate::engine::counts::{Counts, ModeCounts};
use crate::engine::glances::Glances;
use crate::engine::guards::{SavedTraces, Traces};
use crate::engine::leaning::{Edge, Leaning};
use crate::engine::ledger::Ledger;
use crate::engine::neighbours::{Neighbours, SavedNeighbours};
use crate::engine::queue::{EventQueue, Rank};
use crate::engine::settings::{Collapse, Settings};
use crate::engine::setup::check_parts;
use crate::engine::simulation::{Simulation, listed_scale};
use crate::engine::slot::{Partner, Slot};
use crate::engine::sparse::Sparse;
use crate::engine::speeds::Speeds;
use crate::engine::transitions::{Alarm, Call};
use crate::error::SetupError;
use crate::model::{Boundary, Commands, Dynamics, EventOf, Flight, MemoryOf, Model, SpinOf};
use crate::particle::ParticleId;
use crate::time::Time;

/// Everything that a [`Simulation`] of a given model needs to go on, bit for bit.
///
/// It says nothing of the model: who restores it has to bring an equal one. Any
/// format of `serde` that keeps all bits of numbers will do; how it is laid out
/// may change between versions of this crate.
///
/// The generic type names are: `R` what is remembered of each grain, `E` the
/// policy's events, `S` the inner states of grains, `D` the dimension;
/// [`SavedOf`] takes them from a model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Saved<R, E, S, const D: usize> {
    settings: Settings,
    clock: Time,
    bodies: Vec<Body<D>>,
    /// Of those of whom the policy has not forgotten all, in order.
    memories: Vec<(u32, R)>,
    spins: Vec<S>,
    /// Of those who have something ahead of them, in order.
    slots: Vec<(u32, Slot)>,
    /// In the order in which they are due.
    alarms: Vec<Alarm<E>>,
    alarm_count: u64,
    leaning: Vec<Vec<Edge>>,
    traces: SavedTraces,
    near: SavedNeighbours<D>,
    largest: f64,
    ledger: Ledger,
    counts: Counts,
    deepest: f64,
    regrid_at: Time,
    blur: f64,
    epoch: Time,
    epoch_events: u64,
    collapse: Option<Collapse>,
    escaped: Option<ParticleId>,
    aloft: Option<SavedAloft<D>>,
}

/// What is saved of a simulation of a model.
pub type SavedOf<M, const D: usize> = Saved<MemoryOf<M, D>, EventOf<M, D>, SpinOf<M, D>, D>;

/// Why a saved state can't be gone on from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// The model or a setting is out of range.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The state is none that a simulation of this model can be in.
    #[error("no state of a simulation of this model: {reason}")]
    Inconsistent {
        /// What is wrong.
        reason: String,
    },
}

fn wrong(reason: impl Into<String>) -> RestoreError {
    RestoreError::Inconsistent {
        reason: reason.into(),
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// The whole state now. Taking it changes nothing.
    #[must_use]
    pub fn save(&self) -> SavedOf<M, D> {
        let mut alarms: Vec<_> = self.alarms.iter().map(|Reverse(alarm)| *alarm).collect();
        alarms.sort_unstable();
        Saved {
            settings: self.settings,
            clock: self.world.clock,
            bodies: self.world.bodies.clone(),
            memories: self.memories.save(),
            spins: self.spins.clone(),
            slots: self.slots.save(),
            alarms,
            alarm_count: self.alarm_count,
            leaning: self.leaning.save(),
            traces: self.traces.save(),
            near: self.world.near.save(),
            largest: self.world.largest,
            ledger: self.world.ledger.clone(),
            counts: self.counts,
            deepest: self.deepest,
            regrid_at: self.regrid_at,
            blur: self.world.blur,
            epoch: self.world.glances.epoch(),
            epoch_events: self.epoch_events,
            collapse: self.collapse.clone(),
            escaped: self.escaped,
            aloft: self.world.save_aloft(),
        }
    }

    /// The simulation whose state was saved: it goes on as if it had never been
    /// stopped. `model` has to be equal to the one that the state is of.
    ///
    /// # Errors
    ///
    /// [`RestoreError`] if the state is none that a simulation of this model can
    /// be in.
    pub fn restore(model: M, saved: SavedOf<M, D>) -> Result<Self, RestoreError> {
        check_parts(&model, &saved.settings)?;
        saved.check(&model)?;
        let count = saved.bodies.len();
        let stored = |largest: f64, id: u32| {
            let body = &saved.bodies[id as usize];
            let scale = listed_scale::<M, D>(largest, saved.largest);
            (body.position, scale * body.radius)
        };
        let near =
            Neighbours::restore(model.boundary(), &saved.near, count, stored).map_err(wrong)?;
        let mut modes = ModeCounts::default();
        let mut bodies = saved.bodies;
        for (id, body) in bodies.iter_mut().enumerate() {
            *modes.of(body.mode) += 1;
            let flight = flight_of(&model, id as u32, body);
            body.still = body.mode.is_static() && flight.is_at_rest();
        }
        let slots = Sparse::restore(saved.slots, count, Slot::EMPTY).map_err(wrong)?;
        let memories =
            Sparse::restore(saved.memories, count, MemoryOf::<M, D>::default()).map_err(wrong)?;
        let mut queue = EventQueue::new(count, saved.clock);
        for id in 0..count as u32 {
            queue.push_empty();
            queue.set(id, slots[id].key(id));
        }
        let mut restored = Simulation {
            settings: saved.settings,
            world: World {
                bodies,
                near,
                clock: saved.clock,
                modes,
                largest: saved.largest,
                ledger: saved.ledger,
                blur: saved.blur,
                glances: Glances::new(count, saved.epoch),
                aloft: Aloft::nobody(),
            },
            epoch_events: saved.epoch_events,
            memories,
            spins: saved.spins,
            slots,
            queue,
            alarms: saved.alarms.into_iter().map(Reverse).collect(),
            alarm_count: saved.alarm_count,
            leaning: Leaning::restore(saved.leaning, count).map_err(wrong)?,
            traces: Traces::restore(saved.traces, count).map_err(wrong)?,
            counts: saved.counts,
            deepest: saved.deepest,
            speeds: Speeds::unknown(saved.clock),
            fetched: 0,
            regrid_at: saved.regrid_at,
            collapse: saved.collapse,
            escaped: saved.escaped,
            commands: Commands::default(),
            scratch: Vec::new(),
            candidates: Vec::new(),
            vigil: Vigil::default(),
            ear: None,
            model,
        };
        restored.restore_aloft(saved.aloft).map_err(wrong)?;
        restored.world.begin_epoch(&restored.model, saved.epoch);
        for id in 0..count as u32 {
            let bound = restored.slots[id].bound();
            restored.world.glances.set_bound(id, bound);
            restored.world.keep_blur(&restored.model, id);
            restored.check_grain(id).map_err(wrong)?;
        }
        if restored.world.blur != saved.blur {
            return Err(wrong("a bound that is none"));
        }
        Ok(restored)
    }
}

/// No coordinate, in d, and no component of a velocity, in √(gd), gets larger.
const LARGEST: f64 = 1.0e18;
/// No run has more events.
const MOST_EVENTS: u64 = 1 << 60;

impl<R, E, S, const D: usize> Saved<R, E, S, D> {
    /// Whether a simulation can be in this state; the grid and the lists are
    /// looked at when they are made.
    fn check<M: Model<D>>(&self, model: &M) -> Result<(), RestoreError> {
        let count = self.bodies.len();
        if count > i32::MAX as usize {
            return Err(wrong("more grains than can be named"));
        }
        if self.spins.len() != count {
            return Err(wrong("something is there for some grains only"));
        }
        if !self.clock.is_finite() || self.clock < self.settings.start {
            return Err(wrong("the clock shows no time of the run"));
        }
        let walls = model.boundary().walls().len();
        let is_there = |partner| match partner {
            Partner::Nobody => true,
            Partner::Particle(id) => (id as usize) < count,
            Partner::Wall(wall) => wall.index() < walls,
        };
        let guards = &self.settings.guards;
        if let Some(reason) = self.traces.misfit(guards, count, is_there) {
            return Err(wrong(reason));
        }
        if !self.slots.iter().all(|(_, slot)| is_there(slot.partner)) {
            return Err(wrong("a grain is to meet somebody who is not there"));
        }
        for id in 0..count {
            if let Some(reason) = self.misfit(id, model) {
                return Err(wrong(format!("grain {id} {reason}")));
            }
        }
        for alarm in &self.alarms {
            let key = alarm.key;
            if key.rank != Rank::Policy
                || key.low as usize >= count
                || key.high != key.low
                || key.time < self.clock
                || !key.time.is_finite()
                || matches!(
                    alarm.call,
                    Call::SupportChanged(id) | Call::Look(id) if id as usize >= count
                )
            {
                return Err(wrong("an event of the policy that cannot be"));
            }
        }
        let is_size = |number: f64| (0.0..f64::INFINITY).contains(&number);
        if !is_size(self.deepest) || self.largest <= 0.0 {
            return Err(wrong("a bound that is none"));
        }
        if !is_size(self.blur) || self.epoch > self.clock {
            return Err(wrong("an epoch that has not begun"));
        }
        if count > 0 && !is_size(self.largest) {
            return Err(wrong("the largest diameter is none"));
        }
        let may_regrid = M::Dynamics::GROWS || !self.regrid_at.is_finite();
        if self.regrid_at < self.clock || !may_regrid {
            return Err(wrong("the grid was to be laid anew before"));
        }
        let named = self.collapse.iter().flat_map(|it| &it.particles);
        if named.chain(&self.escaped).any(|id| id.index() >= count) {
            return Err(wrong("the end of the run names a grain that is not there"));
        }
        let counts = self.counts;
        let all = [
            counts.pair,
            counts.frozen,
            counts.wake,
            counts.sleep,
            counts.check,
            counts.check_wake,
            counts.support,
            counts.wall,
            counts.transfer,
            counts.elastic,
            counts.guard,
            self.alarm_count,
            self.epoch_events,
        ];
        if all.iter().any(|number| *number > MOST_EVENTS) {
            return Err(wrong("more events than any run has"));
        }
        Ok(())
    }

    /// What is wrong with a grain, if anything.
    fn misfit<M: Model<D>>(&self, id: usize, model: &M) -> Option<&'static str> {
        let body = &self.bodies[id];
        let is_number = |x: &f64| x.abs() <= LARGEST;
        if !body.position.iter().chain(&body.velocity).all(is_number) {
            return Some("is nowhere");
        }
        for axis in 0..D {
            if let Some(period) = model.boundary().period(axis) {
                let turns = (body.position[axis] - period.origin) / period.length;
                if !(-1.0e-6..=1.0 + 1.0e-6).contains(&turns) {
                    return Some("is outside the primary cell");
                }
            }
        }
        let is_amount = |number: f64| number > 0.0 && number.is_finite();
        (!is_amount(body.radius) || !is_amount(body.mass)).then_some("has no size or mass")
    }
}
