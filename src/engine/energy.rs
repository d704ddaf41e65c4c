//! Energies, and the filing of what changes them.

use crate::engine::body::gain;
use crate::engine::ledger::{EnergyLedger, Entry, Ledger, Sum};
use crate::engine::simulation::Simulation;
use crate::model::{Dynamics, Impact, Model, Obstacle, Rebound};
use crate::particle::{Mode, Particle, ParticleId};

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Kinetic energy now, in mgd, of all grains but fixed ones.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        self.sum(Particle::kinetic_energy)
    }

    /// Potential energy now, in mgd, of all grains but fixed ones, counted from
    /// the origin. Along a periodic axis it is that of the primary cell.
    #[must_use]
    pub fn potential_energy(&self) -> f64 {
        let gravity = self.model.dynamics().gravity(self.world.clock);
        self.sum(|particle| -particle.mass * gravity.dot(&particle.position))
    }

    /// Where the energy has gone since the start, up to now.
    #[must_use]
    pub fn energy_ledger(&self) -> EnergyLedger {
        let mut now = Sum::default();
        let mut since = Ledger::default();
        let gravity = self.model.dynamics().gravity(self.world.clock);
        for (index, body) in self.world.bodies.iter().enumerate() {
            if body.mode == Mode::Fixed {
                continue;
            }
            let stored = self.world.particle_now(&self.model, index as u32);
            let weight = gravity * stored.mass;
            if body.mode == Mode::Falling {
                since.add(Entry::Fall, weight.dot(&(body.position - stored.position)));
            }
            if M::Dynamics::DRIVES {
                let (entry, work) = self.world.work_in_flight(&self.model, index as u32);
                since.add(entry, work);
            }
            let shown = self.particle(ParticleId(index as u32));
            since.add(
                Entry::Crossing,
                weight.dot(&(stored.position - shown.position)),
            );
            now.add(self.energy_of(&shown));
        }
        self.world.ledger.read(now.value(), &since)
    }

    /// Kinetic and potential energy of a grain, in mgd; none if it is fixed.
    pub(super) fn energy_of(&self, particle: &Particle<D>) -> f64 {
        if particle.mode == Mode::Fixed {
            return 0.0;
        }
        let gravity = self.model.dynamics().gravity(self.world.clock);
        particle.kinetic_energy() - particle.mass * gravity.dot(&particle.position)
    }

    fn sum(&self, of: impl Fn(&Particle<D>) -> f64) -> f64 {
        (0..self.world.bodies.len() as u32)
            .map(|id| self.particle(ParticleId(id)))
            .filter(|particle| particle.mode != Mode::Fixed)
            .map(|particle| of(&particle))
            .sum()
    }

    /// Files what a collision has changed: the work of obstacles that move, or
    /// grow, apart.
    pub(super) fn note_collision(
        &mut self,
        entry: Entry,
        impact: &Impact<D>,
        rebound: &Rebound<D>,
    ) {
        let one = &impact.particle;
        let impulse = (rebound.velocity - one.velocity) * one.mass;
        let mut gained = gain(one.mass, &one.velocity, &rebound.velocity);
        match &impact.obstacle {
            Obstacle::Particle { particle, .. } if particle.mode.is_mobile() => {
                gained += gain(particle.mass, &particle.velocity, &rebound.other_velocity);
            }
            _ => {
                let work = impulse.dot(&impact.obstacle_velocity());
                self.world.ledger.add(Entry::Moving, work);
                gained -= work;
            }
        }
        if M::Dynamics::GROWS {
            let work = impulse.dot(&impact.normal) * impact.growth;
            self.world.ledger.add(Entry::Growth, work);
            gained -= work;
        }
        self.world.ledger.add(entry, gained);
        let spared = rebound.spared_energy;
        self.world.ledger.add(Entry::ElasticSpared, spared);
    }
}
