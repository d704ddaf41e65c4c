//! Whether the engine's book-keeping holds.
//!
//! Builds with debug assertions check it as they run: in systems of up to
//! [`SMALL`] grains all of it after each event, in larger ones that of the
//! grains an event has touched, and the whole every so often.

use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::engine::view::View;
use crate::model::{Flight, Model, StatePolicy};
use crate::particle::{Mode, ParticleId};

/// Up to so many grains everything is checked after each event.
const SMALL: usize = 64;

/// What has still to be checked.
#[derive(Clone, Debug, Default)]
pub(super) struct Vigil {
    /// Grains whose entries have been set since the last check.
    touched: Vec<u32>,
    /// Events since everything was checked.
    since_whole: u64,
}

impl Vigil {
    /// An entry of a grain has been set.
    #[inline]
    pub(super) fn touch(&mut self, particle: u32) {
        if cfg!(debug_assertions) {
            self.touched.push(particle);
        }
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Checks the whole of the engine's book-keeping: queue, neighbour lists,
    /// grid, modes, times, and what the policy says of its memories
    /// ([`StatePolicy::check_memory`]). Builds with debug assertions do so as
    /// they run.
    ///
    /// # Panics
    ///
    /// If something is wrong, saying what: a bug of the engine or of a part of
    /// the model.
    pub fn assert_consistent(&self) {
        if let Err(fault) = self.check_everything() {
            self.report_fault(&fault);
        }
    }

    /// After an event: as much as can be afforded.
    pub(super) fn keep_vigil(&mut self) {
        let count = self.world.bodies.len();
        self.vigil.since_whole += 1;
        let mut touched = std::mem::take(&mut self.vigil.touched);
        // A whole check costs as much as some N² events.
        let squared = (count * count) as u64;
        if count <= SMALL || self.vigil.since_whole > 1024 + squared / 32 {
            self.vigil.since_whole = 0;
            self.assert_consistent();
        } else {
            for &particle in &touched {
                if let Err(fault) = self.check_grain(particle) {
                    self.report_fault(&fault);
                }
            }
        }
        touched.clear();
        self.vigil.touched = touched;
    }

    #[cold]
    fn report_fault(&self, fault: &str) -> ! {
        panic!(
            "inconsistent at {} after {} events: {fault}",
            self.world.clock,
            self.counts.total()
        );
    }

    /// Everything; what is wrong first.
    pub(super) fn check_everything(&self) -> Result<(), String> {
        let count = self.world.bodies.len();
        let lengths = [
            ("memories", self.memories.len()),
            ("spins", self.spins.len()),
            ("slots", self.slots.len()),
            ("modes", self.world.modes.total()),
        ];
        for (what, length) in lengths {
            if length != count {
                return Err(format!("{length} {what} for {count} grains"));
            }
        }
        for mode in [Mode::Normal, Mode::Falling, Mode::Frozen, Mode::Fixed] {
            let counted = self.world.bodies.iter().filter(|body| body.mode == mode);
            let mut modes = self.world.modes;
            let (found, noted) = (counted.count(), *modes.of(mode));
            if found != noted {
                return Err(format!("{noted} grains are {}, not {found}", mode.name()));
            }
        }
        self.queue.check_numbers()?;
        let scale = self.listed_scale();
        let stored = |other: u32| {
            let body = &self.world.bodies[other as usize];
            (body.position, scale * body.radius)
        };
        for particle in 0..count as u32 {
            self.check_grain(particle)?;
            self.world.near.check_complete(particle, stored)?;
        }
        for alarm in &self.alarms {
            let key = alarm.0.key;
            if key.time < self.world.clock || key.low as usize >= count {
                return Err(format!("an event of the policy is for {key:?}"));
            }
        }
        Ok(())
    }

    /// What concerns one grain.
    pub(super) fn check_grain(&self, particle: u32) -> Result<(), String> {
        let index = particle as usize;
        let now = self.world.clock;
        let body = &self.world.bodies[index];
        let flight = self.world.flight(&self.model, particle);
        if body.since > now {
            return Err(format!("grain {particle} is ahead, at {}", body.since));
        }
        let numbers = body.position.iter().chain(body.velocity.iter());
        if !numbers.chain([&body.radius]).all(|x| x.is_finite()) {
            return Err(format!("grain {particle} is nowhere: {body:?}"));
        }
        if body.still != (body.mode.is_static() && flight.is_at_rest()) {
            return Err(format!("grain {particle} is thought still: {body:?}"));
        }
        let slot = &self.slots[particle];
        for (what, time) in [
            ("contact", slot.contact),
            ("sleep", slot.sleep),
            ("renewal", slot.renewal),
        ] {
            if time < now {
                return Err(format!("the {what} of grain {particle} was due at {time}"));
            }
        }
        if body.mode.is_static() && slot.bound().is_finite() {
            return Err(format!("grain {particle} is static and waits: {slot:?}"));
        }
        match slot.partner {
            Partner::Nobody if slot.contact.is_finite() => {
                return Err(format!("grain {particle} meets nobody: {slot:?}"));
            }
            Partner::Particle(other) => {
                let Some(there) = self.world.bodies.get(other as usize) else {
                    return Err(format!("grain {particle} meets {other}, who is not there"));
                };
                if other == particle {
                    return Err(format!("grain {particle} meets itself"));
                }
                if there.stamp == slot.partner_stamp && there.since > slot.contact {
                    return Err(format!("grain {particle} met {other} in the past"));
                }
            }
            _ => {}
        }
        self.queue.check_entry(particle, slot.key(particle))?;
        self.leaning.check(particle, body.mode == Mode::Frozen)?;
        let position = flight.position(now - body.since);
        self.world.check_aloft(particle)?;
        if self.world.next_landing(particle) < slot.renewal {
            return Err(format!("grain {particle} is not told to land"));
        }
        if !self.world.is_aloft(particle) {
            if !flight.is_at_rest() && !self.world.near.is_tied(particle) {
                return Err(format!("grain {particle} moves without a list"));
            }
            self.world.near.check_tie(particle, &position)?;
        }
        self.world.near.check_bed(particle, &self.world.bodies)?;
        self.world
            .check_glance(&self.model, particle, slot.bound())?;
        let near = View {
            model: &self.model,
            world: &self.world,
        };
        let policy = self.model.state_policy();
        policy
            .check_memory(ParticleId(particle), &near, &self.memories[particle])
            .map_err(|fault| format!("grain {particle}: {fault}"))
    }
}

#[cfg(test)]
mod tests;
