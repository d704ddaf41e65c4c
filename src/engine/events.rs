//! The event loop.

use std::cmp::Reverse;

use crate::engine::queue::{Key, Rank};
use crate::engine::settings::{Limits, StopReason};
use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::engine::transitions::Call;
use crate::model::{Flight, Model, Observer};
use crate::particle::ParticleId;
use crate::time::Time;

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Carries out events until a limit is reached, and says which.
    ///
    /// A run can go on after any stop but a collapse or an escape; where it stopped leaves no
    /// trace in the trajectory. Whoever watches is shown each physical event
    /// just after it has happened. If nothing lies ahead the clock shows the
    /// time limit; if everything is frozen, the last event.
    pub fn run<O: Observer<D>>(&mut self, limits: &Limits, observer: &mut O) -> StopReason {
        loop {
            if let Some(collapse) = &self.collapse {
                return StopReason::Collapse(collapse.clone());
            }
            if let Some(particle) = self.escaped {
                return StopReason::Escaped(particle);
            }
            if limits.all_frozen && self.world.modes.mobile() == 0 {
                return StopReason::AllFrozen;
            }
            if self.counts.total() >= limits.events {
                return StopReason::Events;
            }
            let next = self.next_event();
            self.fetch_ahead();
            let due = next.as_ref().map_or(Time::NEVER, |(key, _)| key.time);
            if self.regrid_at < due && self.regrid_at <= limits.time {
                self.world.clock = self.regrid_at;
                self.rebuild_grid();
                continue;
            }
            let Some((key, source)) = next else {
                if limits.time.is_finite() {
                    self.world.clock = self.world.clock.max(limits.time);
                    return StopReason::Time;
                }
                return StopReason::NothingLeft;
            };
            if key.time > limits.time {
                self.world.clock = self.world.clock.max(limits.time);
                return StopReason::Time;
            }
            debug_assert!(
                key.time >= self.world.clock,
                "an event {key:?} at {} came to light only at {}",
                key.time,
                self.world.clock
            );
            self.world.clock = self.world.clock.max(key.time);
            match source {
                Source::Policy => {
                    if let Some(Reverse(alarm)) = self.alarms.pop() {
                        let particle = alarm.key.low;
                        match alarm.call {
                            Call::Asked(event) => self.policy_event(particle, event, observer),
                            Call::SupportChanged(supporter) => {
                                self.support_changed(particle, supporter, alarm.order, observer);
                            }
                            Call::Look(supporter) => {
                                self.look_again(particle, supporter, alarm.order);
                            }
                        }
                    }
                }
                Source::Particle(particle) => self.carry_out(particle, key, observer),
            }
            if self.world.aloft.risen() {
                self.expect_landing();
            }
            if cfg!(debug_assertions) {
                self.keep_vigil();
            }
        }
    }

    fn carry_out<O: Observer<D>>(&mut self, particle: u32, key: Key, observer: &mut O) {
        let slot = self.slots[particle];
        match (key.rank, slot.partner) {
            (Rank::Contact, Partner::Particle(other)) => {
                if self.world.bodies[other as usize].stamp == slot.partner_stamp {
                    self.collide_pair(particle, other, observer);
                } else {
                    // The other grain has met someone else in the meantime.
                    self.predict(particle);
                }
            }
            (Rank::Wall, Partner::Wall(wall)) => self.collide_wall(particle, wall, observer),
            (Rank::Sleep, _) => self.fall_asleep(particle, None, observer),
            _ => self.renew(particle),
        }
    }

    /// The next event and where it comes from; of two at one instant the one
    /// whose key is smaller.
    fn next_event(&mut self) -> Option<(Key, Source)> {
        let policy = self.alarms.peek().map(|Reverse(alarm)| alarm.key);
        let slots = &self.slots;
        let known = |particle: u32| slots[particle].key(particle);
        match (self.queue.peek(known), policy) {
            (None, None) => None,
            (Some((particle, key)), None) => Some((key, Source::Particle(particle))),
            (None, Some(key)) => Some((key, Source::Policy)),
            (Some((particle, key)), Some(other)) => Some(if other < key {
                (other, Source::Policy)
            } else {
                (key, Source::Particle(particle))
            }),
        }
    }

    /// A grain may have come to the end of its leash.
    fn renew(&mut self, particle: u32) {
        if self.world.is_aloft(particle) {
            self.land(particle);
            return;
        }
        let flight = self.world.flight(&self.model, particle);
        let since = self.world.bodies[particle as usize].since;
        let position = flight.position(self.world.clock - since);
        let slack = self.world.near.slack(particle, &position);
        if self.world.near.is_stretched(particle, slack) {
            if self.world.near.is_lost(&position) {
                self.escaped = Some(ParticleId(particle));
            }
            self.counts.transfer += 1;
            self.tie(particle);
            if self.world.bodies[particle as usize].mode.is_mobile()
                && self.meet_newcomers(particle)
            {
                self.find_renewal(particle);
                self.enqueue(particle);
            } else {
                self.predict_listed(particle);
            }
        } else {
            self.find_renewal(particle);
            self.enqueue(particle);
        }
    }

    /// Lays the grid anew for diameters that have outgrown it.
    pub(super) fn rebuild_grid(&mut self) {
        self.lay_grid();
        self.lift_off();
        for particle in 0..self.world.bodies.len() as u32 {
            self.predict(particle);
        }
    }
}

/// Where an event comes from.
enum Source {
    Particle(u32),
    Policy,
}
