//! Starting a simulation, and what is refused.

use std::collections::BinaryHeap;

use crate::engine::aloft::Aloft;
use crate::engine::body::{Body, World, scale_at};
use crate::engine::consistency::Vigil;
use crate::engine::counts::{Counts, ModeCounts};
use crate::engine::glances::Glances;
use crate::engine::guards::Traces;
use crate::engine::leaning::Leaning;
use crate::engine::ledger::{Entry, Ledger};
use crate::engine::neighbours::Neighbours;
use crate::engine::queue::EventQueue;
use crate::engine::settings::Settings;
use crate::engine::simulation::Simulation;
use crate::engine::slot::Slot;
use crate::engine::sparse::Sparse;
use crate::engine::speeds::Speeds;
use crate::engine::walls::{check_distance, check_walls};
use crate::error::SetupError;
use crate::model::{
    Boundary, CollisionRule, Commands, Dynamics, Flight, MemoryOf, Model, SpinOf, StatePolicy,
    WakeCause, Wall,
};
use crate::particle::{Mode, Particle, ParticleId, Vector, WallId};
use crate::time::Time;

/// Overlap that is taken for rounding of the input, in d.
const TOLERANCE: f64 = 1.0e-9;

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// A simulation of these grains, with default settings.
    ///
    /// # Errors
    ///
    /// [`SetupError`] if a number is out of range, two grains overlap, a grain
    /// reaches into a wall, or a period is shorter than two diameters.
    pub fn new(model: M, particles: Vec<Particle<D>>) -> Result<Self, SetupError> {
        Simulation::with_settings(model, particles, Settings::default())
    }

    /// A simulation of these grains.
    ///
    /// # Errors
    ///
    /// As [`Simulation::new`], and if a setting is out of range.
    pub fn with_settings(
        model: M,
        particles: Vec<Particle<D>>,
        settings: Settings,
    ) -> Result<Self, SetupError> {
        check_parts(&model, &settings)?;
        let most = i32::MAX as usize;
        if particles.len() > most {
            return Err(SetupError::TooManyParticles {
                count: particles.len(),
                most,
            });
        }
        let mut largest: f64 = 0.0;
        for (place, particle) in particles.iter().enumerate() {
            validate(ParticleId(place as u32), particle)?;
            largest = largest.max(particle.diameter);
        }
        if M::Dynamics::GROWS && particles.iter().any(|grain| grain.mode == Mode::Frozen) {
            return Err(SetupError::Parameter {
                field: "growth_rate",
                value: model.dynamics().growth_rate(),
                allowed: "diameters that grow are for grains that are awake: sleepers do not notice each other",
            });
        }
        let scale = scale_at::<M, D>(&model, settings.start);
        if scale.is_nan() || scale <= 0.0 {
            return Err(SetupError::Parameter {
                field: "start",
                value: settings.start.units(),
                allowed: "a time at which diameters are positive is allowed",
            });
        }
        check_periods(&model, largest)?;
        let count = particles.len();
        let near = Neighbours::new(model.boundary(), &[], 1.0);
        let mut simulation = Simulation {
            settings,
            world: World {
                bodies: Vec::with_capacity(count),
                near,
                clock: settings.start,
                modes: ModeCounts::default(),
                largest: largest / scale,
                ledger: Ledger::default(),
                blur: 0.0,
                glances: Glances::new(count, settings.start),
                aloft: Aloft::nobody(),
            },
            epoch_events: 0,
            memories: Sparse::new(0, MemoryOf::<M, D>::default()),
            spins: vec![SpinOf::<M, D>::default(); count],
            slots: Sparse::new(count, Slot::EMPTY),
            queue: EventQueue::new(count, settings.start),
            alarms: BinaryHeap::new(),
            alarm_count: 0,
            leaning: Leaning::default(),
            traces: Traces::new(&settings.guards),
            counts: Counts::default(),
            deepest: 0.0,
            speeds: Speeds::unknown(settings.start),
            fetched: 0,
            regrid_at: Time::NEVER,
            collapse: None,
            escaped: None,
            commands: Commands::default(),
            scratch: Vec::new(),
            candidates: Vec::new(),
            vigil: Vigil::default(),
            ear: None,
            model,
        };
        for particle in particles {
            simulation.store(particle);
        }
        simulation.lay_grid();
        for particle in 0..count as u32 {
            simulation.refuse_contacts(particle)?;
        }
        simulation.lift_off();
        // Not before: the grid has just given much room back.
        simulation.memories = Sparse::new(count, MemoryOf::<M, D>::default());
        for particle in 0..count as u32 {
            simulation.tell_started(particle);
        }
        for particle in 0..count as u32 {
            simulation.predict(particle);
        }
        simulation.deepest = 0.0;
        let energy = simulation.energy_ledger().now;
        simulation.world.ledger.add(Entry::AtStart, energy);
        Ok(simulation)
    }

    /// Adds a grain now; its id is the next one.
    ///
    /// # Errors
    ///
    /// [`SetupError`] as for [`Simulation::new`]; also if its diameter is larger
    /// than all before, for which the grid was not made. The simulation is then
    /// unchanged.
    pub fn insert(&mut self, particle: Particle<D>) -> Result<ParticleId, SetupError> {
        let index = self.world.bodies.len() as u32;
        let id = ParticleId(index);
        validate(id, &particle)?;
        if particle.diameter / self.scale_at(self.world.clock) > self.world.largest {
            return Err(SetupError::Particle {
                id,
                field: "diameter",
                value: particle.diameter,
                allowed: "a grain inserted during a run may not be larger than all before",
            });
        }
        let blur = self.world.blur;
        self.store(particle);
        let position = self.world.bodies[index as usize].position;
        self.world.near.add(position);
        self.world.glances.add();
        self.memories.push();
        self.spins.push(SpinOf::<M, D>::default());
        self.slots.push();
        if let Err(error) = self.refuse_contacts(index) {
            self.forget_last();
            self.world.blur = blur;
            return Err(error);
        }
        // Even if it is at rest, for a moment: that puts it on the lists of
        // those that move.
        self.tie(index);
        self.note_speed(index);
        let energy = self.energy_of(&self.particle(id));
        self.world.ledger.add(Entry::Inserted, energy);
        self.tell_started(index);
        self.predict(index);
        self.release_if_static(index);
        self.expect_landing();
        Ok(id)
    }

    /// Sets a static grain free now: it is normal from here on, with this velocity,
    /// in √(gd). So a wall of fixed grains is taken away, or a support knocked out.
    /// Whoever leans on it is told at this instant. Energy that a fixed grain
    /// brings along counts as inserted, what a frozen one is given as given back.
    ///
    /// # Errors
    ///
    /// [`SetupError`] if there is no such grain or it is mobile, if the velocity is
    /// out of range, or if the grain overlaps another, as fixed ones may among
    /// themselves, or a wall. The simulation is then unchanged.
    pub fn set_free(&mut self, id: ParticleId, velocity: Vector<D>) -> Result<(), SetupError> {
        let refuse = |field, value, allowed| {
            Err(SetupError::Particle {
                id,
                field,
                value,
                allowed,
            })
        };
        let count = self.world.bodies.len();
        if id.index() >= count {
            return refuse("id", f64::from(id.0), "one of the grains that are there");
        }
        let (particle, was) = (id.0, self.world.bodies[id.index()].mode);
        if was.is_mobile() {
            let allowed = "a grain that is frozen or fixed is set free, not one that is free";
            return refuse("mode", was as u8 as f64, allowed);
        }
        let before = self.world.particle_now(&self.model, particle);
        let free = Particle {
            velocity,
            mode: Mode::Normal,
            ..before
        };
        validate(id, &free)?;
        // A normal grain may overlap none.
        self.refuse_contacts_of(particle, &free)?;
        let (model, place) = (&self.model, before.position);
        self.world
            .write(model, particle, place, velocity, Mode::Normal);
        if was == Mode::Fixed {
            let energy = self.energy_of(&self.particle(id));
            self.world.ledger.add(Entry::Inserted, energy);
        } else {
            self.world
                .note_change(Entry::GivenBack, particle, &before.velocity, &velocity);
        }
        self.traces.woke(particle, self.world.clock);
        self.tie_if_moving(particle);
        self.note_speed(particle);
        self.tell_woken(particle, &WakeCause::Event);
        self.tell_dependants(particle, true);
        self.predict(particle);
        self.expect_landing();
        Ok(())
    }

    /// Stores a grain's state, wrapped into the primary cell.
    fn store(&mut self, particle: Particle<D>) {
        let scale = scale_at::<M, D>(&self.model, self.world.clock);
        self.world.bodies.push(Body {
            position: self.model.boundary().wrapped(&particle.position),
            velocity: particle.velocity,
            since: self.world.clock,
            radius: 0.5 * particle.diameter / scale,
            mass: particle.mass,
            mode: particle.mode,
            still: false,
            stamp: 0,
        });
        let index = self.world.bodies.len() as u32 - 1;
        let at_rest = self.world.flight(&self.model, index).is_at_rest();
        self.world.bodies[index as usize].still = particle.mode.is_static() && at_rest;
        self.world.keep_blur(&self.model, index);
        *self.world.modes.of(particle.mode) += 1;
        self.traces.add();
        self.queue.push_empty();
    }

    /// Takes back a grain that was stored but refused.
    fn forget_last(&mut self) {
        if let Some(body) = self.world.bodies.pop() {
            *self.world.modes.of(body.mode) -= 1;
        }
        self.world.near.forget_last();
        self.world.glances.forget_last();
        self.traces.forget_last();
        self.queue.forget_last();
        self.memories.pop();
        self.spins.pop();
        self.slots.pop();
    }

    /// Refuses a grain that overlaps another or reaches into a wall.
    fn refuse_contacts(&self, particle: u32) -> Result<(), SetupError> {
        let one = self.world.particle_now(&self.model, particle);
        self.refuse_contacts_of(particle, &one)
    }

    /// The same for a grain as it would be now.
    fn refuse_contacts_of(&self, particle: u32, one: &Particle<D>) -> Result<(), SetupError> {
        let now = self.world.clock;
        for (place, wall) in self.model.boundary().walls().iter().enumerate() {
            let id = WallId(place as u16);
            check_distance(id, wall, &one.position, now)?;
            let depth = one.radius() - wall.distance(&one.position, now);
            if depth > TOLERANCE {
                return Err(SetupError::OutsideWall {
                    id: ParticleId(particle),
                    wall: id,
                    depth,
                    tolerance: TOLERANCE,
                });
            }
        }
        let mut deepest: Option<(f64, u32)> = None;
        let farthest = one.radius() + 0.5 * self.world.largest * scale_at::<M, D>(&self.model, now);
        self.world
            .for_each_within(&self.model, particle, farthest, |found| {
                let other = self.world.particle_now(&self.model, found.particle);
                // Fixed grains may be built up of overlapping ones.
                if one.mode == Mode::Fixed && other.mode == Mode::Fixed {
                    return;
                }
                let apart = self.world.displacement(&self.model, one, &other).norm();
                let depth = 0.5 * (one.diameter + other.diameter) - apart;
                if depth > TOLERANCE && deepest.is_none_or(|(so_far, _)| depth > so_far) {
                    deepest = Some((depth, found.particle));
                }
            });
        match deepest {
            None => Ok(()),
            Some((depth, other)) => Err(SetupError::Overlap {
                first: ParticleId(particle.min(other)),
                second: ParticleId(particle.max(other)),
                depth,
                tolerance: TOLERANCE,
            }),
        }
    }
}

/// Refuses a model or settings that are out of range.
pub(super) fn check_parts<M: Model<D>, const D: usize>(
    model: &M,
    settings: &Settings,
) -> Result<(), SetupError> {
    settings.guards.validate()?;
    model.dynamics().validate()?;
    model.collision_rule().validate()?;
    model.state_policy().validate()?;
    model.boundary().validate()?;
    check_walls(model.boundary())?;
    if !settings.start.is_finite() {
        return Err(SetupError::Parameter {
            field: "start",
            value: settings.start.units(),
            allowed: "a time that comes is allowed",
        });
    }
    let horizon = settings.sleep_horizon;
    if !(horizon > 0.0 && horizon.is_finite()) {
        return Err(SetupError::Parameter {
            field: "sleep_horizon",
            value: horizon,
            allowed: "a positive number is allowed",
        });
    }
    Ok(())
}

fn validate<const D: usize>(id: ParticleId, particle: &Particle<D>) -> Result<(), SetupError> {
    let refuse = |field, value, allowed| {
        Err(SetupError::Particle {
            id,
            field,
            value,
            allowed,
        })
    };
    for &x in particle.position.iter() {
        if !(-1.0e9..=1.0e9).contains(&x) {
            return refuse(
                "position",
                x,
                "coordinates between -1e9 and 1e9 are allowed",
            );
        }
    }
    for &v in particle.velocity.iter() {
        // Faster ones would leave their neighbours in no representable time.
        if v.is_nan() || v.abs() > 1.0e9 {
            return refuse("velocity", v, "components between -1e9 and 1e9 are allowed");
        }
    }
    if !(1.0e-9..=1.0e9).contains(&particle.diameter) {
        return refuse("diameter", particle.diameter, "1e-9 … 1e9 is allowed");
    }
    if !(1.0e-30..=1.0e30).contains(&particle.mass) {
        return refuse("mass", particle.mass, "1e-30 … 1e30 is allowed");
    }
    Ok(())
}

fn check_periods<M: Model<D>, const D: usize>(model: &M, largest: f64) -> Result<(), SetupError> {
    for axis in 0..D {
        if let Some(period) = model.boundary().period(axis)
            && period.length < 2.0 * largest
        {
            return Err(SetupError::PeriodTooShort {
                axis,
                length: period.length,
                least: 2.0 * largest,
            });
        }
    }
    Ok(())
}
