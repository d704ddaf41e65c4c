use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::engine::answers::Ear;
use crate::engine::body::{World, flight_of, scale_at};
use crate::engine::candidates::Candidate;
use crate::engine::cells::Found;
use crate::engine::consistency::Vigil;
use crate::engine::counts::{Counts, ModeCounts};
use crate::engine::guards::Traces;
use crate::engine::leaning::Leaning;
use crate::engine::neighbours::Neighbours;
use crate::engine::queue::EventQueue;
use crate::engine::settings::{Collapse, Settings};
use crate::engine::slot::Slot;
use crate::engine::sparse::Sparse;
use crate::engine::speeds::Speeds;
use crate::engine::transitions::Alarm;
use crate::model::{Boundary, Commands, Dynamics, EventOf, Flight, MemoryOf, Model, SpinOf};
use crate::particle::{Mode, Particle, ParticleId};
use crate::time::Time;

/// A simulation: a model, its grains and a clock.
///
/// The generic type names are: `M` the model, `D` the dimension.
pub struct Simulation<M: Model<D>, const D: usize> {
    pub(super) model: M,
    pub(super) settings: Settings,
    pub(super) world: World<D>,
    pub(super) memories: Sparse<MemoryOf<M, D>>,
    pub(super) spins: Vec<SpinOf<M, D>>,
    pub(super) slots: Sparse<Slot>,
    pub(super) queue: EventQueue,
    pub(super) alarms: BinaryHeap<Reverse<Alarm<EventOf<M, D>>>>,
    pub(super) alarm_count: u64,
    pub(super) leaning: Leaning,
    pub(super) traces: Traces,
    pub(super) counts: Counts,
    /// Events up to the start of the present epoch.
    pub(super) epoch_events: u64,
    /// Deepest overlap found at any event, in d.
    pub(super) deepest: f64,
    pub(super) speeds: Speeds,
    /// The slot of the calendar up to which data have been fetched ahead.
    pub(super) fetched: i64,
    /// When growing diameters will have outgrown the grid.
    pub(super) regrid_at: Time,
    pub(super) collapse: Option<Collapse>,
    /// A grain that has left for good.
    pub(super) escaped: Option<ParticleId>,
    pub(super) commands: Commands<EventOf<M, D>>,
    pub(super) scratch: Vec<Found<D>>,
    pub(super) candidates: Vec<Candidate<D>>,
    pub(super) vigil: Vigil,
    pub(super) ear: Option<Ear>,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &M {
        &self.model
    }

    /// How the engine works, apart from the model.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the clock shows.
    #[must_use]
    pub fn time(&self) -> Time {
        self.world.clock
    }

    /// What has happened so far.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// How many grains there are of each mode.
    #[must_use]
    pub fn mode_counts(&self) -> ModeCounts {
        self.world.modes
    }

    /// A grain now, in the primary cell of periodic axes.
    ///
    /// # Panics
    ///
    /// If there is no such grain.
    #[must_use]
    pub fn particle(&self, id: ParticleId) -> Particle<D> {
        let mut particle = self.world.particle_now(&self.model, id.0);
        particle.position = self.model.boundary().wrapped(&particle.position);
        particle
    }

    /// All grains now, by id, in the primary cell of periodic axes. Taking a
    /// snapshot changes nothing.
    #[must_use]
    pub fn snapshot(&self) -> Vec<Particle<D>> {
        (0..self.world.bodies.len() as u32)
            .map(|id| self.particle(ParticleId(id)))
            .collect()
    }

    /// What the policy remembers of a grain; the default, where that would do as well
    /// ([`StatePolicy::may_forget`](crate::model::StatePolicy::may_forget)).
    ///
    /// # Panics
    ///
    /// If there is no such grain.
    #[must_use]
    pub fn memory(&self, id: ParticleId) -> &MemoryOf<M, D> {
        &self.memories[id.0]
    }

    /// The deepest overlap of two grains, in d, found at any event so far: of those
    /// that collide, and of those whose next contact was asked for.
    #[must_use]
    pub fn max_overlap(&self) -> f64 {
        self.deepest
    }

    /// Diameters at `time` over those at t = 0.
    pub(super) fn scale_at(&self, time: Time) -> f64 {
        scale_at::<M, D>(&self.model, time)
    }

    /// Lays the grid for where the grains are now, and makes the lists but for those
    /// that [fall](Simulation::lift_off).
    pub(super) fn lay_grid(&mut self) {
        let now = self.world.clock;
        let mut largest = self.world.largest * scale_at::<M, D>(&self.model, now);
        if self.world.bodies.is_empty() {
            // No grain, no length: any will do.
            largest = 1.0;
        }
        self.regrid_at = Time::NEVER;
        if M::Dynamics::GROWS {
            // Room to grow, so that this is rarely done.
            largest *= 1.1;
            let rate = self.model.dynamics().growth_rate();
            if rate > 0.0 {
                let until = (largest / self.world.largest - 1.0) / rate;
                self.regrid_at = Time::from_units(until).max(now);
            }
        }
        let count = self.world.bodies.len() as u32;
        let positions: Vec<_> = (0..count)
            .map(|particle| {
                let since = self.world.bodies[particle as usize].since;
                let flight = self.world.flight(&self.model, particle);
                flight.position(now - since)
            })
            .collect();
        self.world.near = Neighbours::new(self.model.boundary(), &positions, largest);
        let scale = self.listed_scale();
        for (particle, position) in (0..).zip(&positions) {
            let radius = scale * self.world.bodies[particle as usize].radius;
            self.world.near.set_radius(particle, position, radius);
        }
        self.begin_epoch();
        for particle in 0..count {
            if self.world.bodies[particle as usize].mode != Mode::Falling {
                self.tie_if_moving(particle);
            }
        }
    }

    /// All who have a list are seen from now on as they are now.
    pub(super) fn begin_epoch(&mut self) {
        self.epoch_events = self.counts.total();
        self.world.begin_epoch(&self.model, self.world.clock);
        let bodies = &self.world.bodies;
        let sleeps = |particle: u32| bodies[particle as usize].mode == Mode::Frozen;
        self.traces.tidy(self.world.clock, sleeps);
        self.tidy_memories();
        for (particle, slot) in self.slots.each() {
            self.world.glances.set_bound(particle, slot.bound());
        }
    }

    /// Sees to it that a grain has a neighbour list if it moves or may be set
    /// in motion by a hit: the list of a mobile grain at rest, too, is needed
    /// to find who comes along.
    pub(super) fn tie_if_moving(&mut self, particle: u32) {
        if !self.world.near.is_tied(particle)
            && (self.world.bodies[particle as usize].mode.is_mobile()
                || !self.world.flight(&self.model, particle).is_at_rest())
        {
            self.tie(particle);
        }
    }

    /// Diameters that lists are made for, over those at t = 0.
    pub(super) fn listed_scale(&self) -> f64 {
        listed_scale::<M, D>(self.world.near.largest(), self.world.largest)
    }

    /// Makes the neighbour list of a moving grain for where it is now.
    pub(super) fn tie(&mut self, particle: u32) {
        let World {
            bodies,
            near,
            clock,
            largest,
            ..
        } = &mut self.world;
        let body = &bodies[particle as usize];
        let flight = flight_of(&self.model, particle, body);
        let after = *clock - body.since;
        let scale = listed_scale::<M, D>(near.largest(), *largest);
        let image = near.turns(particle);
        let loose = !near.is_tied(particle);
        near.tie(
            particle,
            &flight.position(after),
            &flight.velocity(after),
            self.slots[particle].bound() - *clock,
            scale * body.radius,
            |other| {
                let body = &bodies[other as usize];
                let flight = flight_of(&self.model, other, body);
                (flight.position(*clock - body.since), scale * body.radius)
            },
        );
        if loose || near.turns(particle) != image {
            self.world.glance(&self.model, particle);
        }
        if loose {
            self.world.aloft.doubt();
        }
        self.world.stay_below(particle);
    }
}

/// As large as grains may become on this grid.
pub(super) fn listed_scale<M: Model<D>, const D: usize>(for_largest: f64, largest: f64) -> f64 {
    if M::Dynamics::GROWS {
        for_largest / largest
    } else {
        1.0
    }
}
