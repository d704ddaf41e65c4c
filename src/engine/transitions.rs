//! Falling asleep, waking, and the policy's own events.

use std::cmp::Ordering;
use std::cmp::Reverse;

use serde::{Deserialize, Serialize};

use crate::engine::ledger::Entry;
use crate::engine::queue::{Key, Rank};
use crate::engine::simulation::Simulation;
use crate::engine::view::View;
use crate::model::{
    Dynamics, EventOf, Flight, MemoryOf, Model, Observer, Occurrence, OccurrenceKind, Reason,
    Response, StatePolicy, WakeCause, Waking,
};
use crate::particle::{Mode, ParticleId, Vector};

/// Why the policy is asked about a grain.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum Call<E> {
    /// It has asked for this event.
    Asked(E),
    /// A grain that this one leans on has changed.
    SupportChanged(u32),
    /// A grain that this one leans on may be about to leave: the engine looks.
    Look(u32),
}

/// The policy is to be asked about a grain.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Alarm<E> {
    pub(super) key: Key,
    /// Tells apart what was asked for one grain and one instant: first asked,
    /// first served.
    pub(super) order: u64,
    pub(super) call: Call<E>,
}

impl<E> PartialEq for Alarm<E> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<E> Eq for Alarm<E> {}

impl<E> PartialOrd for Alarm<E> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<E> Ord for Alarm<E> {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.key, self.order).cmp(&(other.key, other.order))
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// A grain falls asleep where it is now.
    pub(super) fn fall_asleep<O: Observer<D>>(
        &mut self,
        particle: u32,
        reason: Option<Reason>,
        observer: &mut O,
    ) {
        let model = &self.model;
        let now = self.world.clock;
        let state = self.world.particle_now(model, particle);
        model.state_policy().on_sleep(
            ParticleId(particle),
            &View {
                model,
                world: &self.world,
            },
            self.memories.make(particle),
            &mut self.commands,
        );
        let rest = model.dynamics().ground_velocity(&state.position, now);
        self.world
            .write(model, particle, state.position, rest, Mode::Frozen);
        self.world
            .note_change(Entry::Sleep, particle, &state.velocity, &rest);
        self.slots.clear(particle);
        self.traces.forget_partner(particle);
        // Ground that moves may be faster than the grain was.
        self.note_speed(particle);
        self.schedule();
        self.tell_dependants(particle, true);
        self.counts.sleep += 1;
        self.report(
            &Occurrence {
                time: now,
                kind: OccurrenceKind::Sleep,
                particle: ParticleId(particle),
                other: None,
                wall: None,
                impact_speed: 0.0,
                impulse: (rest - state.velocity) * state.mass,
                velocity: rest,
                other_velocity: Vector::zeros(),
                elastic: false,
                reason,
            },
            observer,
        );
        self.predict(particle);
        self.release_if_static(particle);
    }

    /// A static grain at rest needs no neighbour list of its own.
    pub(super) fn release_if_static(&mut self, particle: u32) {
        let body = &self.world.bodies[particle as usize];
        if body.mode.is_static() && self.world.flight(&self.model, particle).is_at_rest() {
            let position = body.position;
            let radius = self.listed_scale() * body.radius;
            self.world.near.release(particle, &position, radius);
            self.world.glance(&self.model, particle);
            self.world.aloft.doubt();
            self.world.stay_below(particle);
        }
    }

    /// The policy hears that a grain has woken.
    pub(super) fn tell_woken(&mut self, particle: u32, cause: &WakeCause<D>) {
        self.let_go(particle);
        self.model.state_policy().on_wake(
            ParticleId(particle),
            cause,
            &View {
                model: &self.model,
                world: &self.world,
            },
            self.memories.make(particle),
            &mut self.commands,
        );
        self.schedule();
    }

    /// The policy hears of a grain for the first time.
    pub(super) fn tell_started(&mut self, particle: u32) {
        let (id, mut memory) = (ParticleId(particle), MemoryOf::<M, D>::default());
        let near = View {
            model: &self.model,
            world: &self.world,
        };
        let policy = self.model.state_policy();
        policy.on_start(id, &near, &mut memory, &mut self.commands);
        if !policy.may_forget(id, &near, &memory) {
            *self.memories.make(particle) = memory;
        }
        self.schedule();
    }

    /// Gives back the room of what the policy may forget of sleepers.
    pub(super) fn tidy_memories(&mut self) {
        let policy = self.model.state_policy();
        let near = View {
            model: &self.model,
            world: &self.world,
        };
        let void = self.memories.each().filter(|(particle, memory)| {
            self.world.bodies[*particle as usize].mode == Mode::Frozen
                && policy.may_forget(ParticleId(*particle), &near, memory)
        });
        let void: Vec<u32> = void.map(|(particle, _)| particle).collect();
        for particle in void {
            self.memories.clear(particle);
        }
    }

    /// Files what the policy has asked for.
    pub(super) fn schedule(&mut self) {
        self.lean();
        let known = self.world.bodies.len() as u32;
        let now = self.world.clock;
        for (id, after, event) in self.commands.drain() {
            let time = now + after.max(0.0);
            if id.0 >= known || !time.is_finite() {
                continue;
            }
            self.alarm_count += 1;
            self.alarms.push(Reverse(Alarm {
                key: Key {
                    time,
                    rank: Rank::Policy,
                    low: id.0,
                    high: id.0,
                },
                order: self.alarm_count,
                call: Call::Asked(event),
            }));
        }
    }

    /// An event that the policy has asked for is due now.
    pub(super) fn policy_event<O: Observer<D>>(
        &mut self,
        particle: u32,
        event: EventOf<M, D>,
        observer: &mut O,
    ) {
        let response = self.model.state_policy().on_event(
            ParticleId(particle),
            event,
            &View {
                model: &self.model,
                world: &self.world,
            },
            self.memories.make(particle),
            &mut self.commands,
        );
        self.schedule();
        self.counts.check += u64::from(!matches!(response, Response::Ignore));
        self.carry_out_response(particle, response, observer);
    }

    /// Does what the policy has answered about a grain.
    pub(super) fn carry_out_response<O: Observer<D>>(
        &mut self,
        particle: u32,
        response: Response<D>,
        observer: &mut O,
    ) {
        let mode = self.world.bodies[particle as usize].mode;
        match response {
            Response::Ignore | Response::Keep => {}
            Response::Sleep(reason) => {
                if mode.is_mobile() {
                    self.fall_asleep(particle, Some(reason), observer);
                }
            }
            Response::Wake(waking, reason) => {
                if mode == Mode::Frozen {
                    self.wake_up(particle, &waking, reason, observer);
                }
            }
        }
    }

    fn wake_up<O: Observer<D>>(
        &mut self,
        particle: u32,
        waking: &Waking<D>,
        reason: Reason,
        observer: &mut O,
    ) {
        let before = self.world.particle_now(&self.model, particle);
        let velocity = waking.velocity;
        self.world.write(
            &self.model,
            particle,
            before.position,
            velocity,
            Mode::Normal,
        );
        self.world
            .note_change(Entry::GivenBack, particle, &before.velocity, &velocity);
        self.traces.woke(particle, self.world.clock);
        self.tie_if_moving(particle);
        self.note_speed(particle);
        self.counts.check_wake += 1;
        self.tell_woken(particle, &WakeCause::Event);
        self.tell_dependants(particle, true);
        self.report(
            &Occurrence {
                time: self.world.clock,
                kind: OccurrenceKind::CheckWake,
                particle: ParticleId(particle),
                other: None,
                wall: None,
                impact_speed: 0.0,
                impulse: (velocity - before.velocity) * before.mass,
                velocity,
                other_velocity: Vector::zeros(),
                elastic: false,
                reason: Some(reason),
            },
            observer,
        );
        self.predict(particle);
    }
}
