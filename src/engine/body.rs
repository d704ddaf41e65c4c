//! What the engine stores of grains, and where they are now.

use serde::{Deserialize, Serialize};

use crate::engine::aloft::Aloft;
use crate::engine::cells::Found;
use crate::engine::counts::ModeCounts;
use crate::engine::glances::Glances;
use crate::engine::ledger::{Entry, Ledger};
use crate::engine::neighbours::Neighbours;
use crate::model::{Boundary, Dynamics, Flight, FlightOf, Model, Motion};
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::time::Time;

/// The state of a grain at its last event.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct Body<const D: usize> {
    pub(super) position: Vector<D>,
    pub(super) velocity: Vector<D>,
    /// The instant of that event.
    pub(super) since: Time,
    /// Radius at t = 0, in d.
    pub(super) radius: f64,
    /// In m.
    pub(super) mass: f64,
    pub(super) mode: Mode,
    /// Static and not moving along.
    pub(super) still: bool,
    /// Counts the changes of this state, so that events foreseen before the
    /// last one can be told.
    pub(super) stamp: u32,
}

/// All grains, the grid and the clock.
#[derive(Clone, Debug)]
pub(super) struct World<const D: usize> {
    pub(super) bodies: Vec<Body<D>>,
    pub(super) near: Neighbours<D>,
    pub(super) clock: Time,
    pub(super) modes: ModeCounts,
    /// Largest diameter at t = 0, in d.
    pub(super) largest: f64,
    pub(super) ledger: Ledger,
    /// How far off, in d, the computed position of a grain may be for it to
    /// count as known: more than that of any whose last event is not
    /// [`LONG_AGO`].
    pub(super) blur: f64,
    pub(super) glances: Glances<D>,
    pub(super) aloft: Aloft<D>,
}

/// Positions of grains whose last event is longer ago than this, in √(d/g), may
/// be off by more than [`World::blur`].
pub(super) const LONG_AGO: f64 = 16.0;

/// Rounding of a position, over all lengths that it is made of: 64 u.
const ROUND: f64 = 32.0 * f64::EPSILON;

/// A bound on how far off a position is, computed `after` the start of a flight.
#[inline]
pub(super) fn rounding<F: Flight<D>, const D: usize>(flight: &F, after: f64) -> f64 {
    ROUND * (flight.start().amax() + flight.speed_bound(after) * after)
}

impl<const D: usize> World<D> {
    /// Keeps the bound on rounding true for a grain whose state is new, with as
    /// much again for those that fly on undisturbed.
    #[inline]
    pub(super) fn keep_blur<M: Model<D>>(&mut self, model: &M, particle: u32) {
        let flight = self.flight(model, particle);
        self.blur = self.blur.max(2.0 * rounding(&flight, LONG_AGO));
    }

    /// The flight of a grain from its last event on.
    #[inline]
    pub(super) fn flight<M: Model<D>>(&self, model: &M, particle: u32) -> FlightOf<M, D> {
        let body = &self.bodies[particle as usize];
        flight_of(model, particle, body)
    }

    /// Files the kinetic energy that a grain gains as its velocity changes.
    #[inline]
    pub(super) fn note_change(
        &mut self,
        entry: Entry,
        particle: u32,
        before: &Vector<D>,
        after: &Vector<D>,
    ) {
        let mass = self.bodies[particle as usize].mass;
        self.ledger.add(entry, gain(mass, before, after));
    }

    /// What the energy of a grain has changed by since its last event though
    /// nothing has happened to it, in mgd, and where that belongs: ground that
    /// moves has carried it, or else gravity has changed.
    pub(super) fn work_in_flight<M: Model<D>>(&self, model: &M, particle: u32) -> (Entry, f64) {
        let body = &self.bodies[particle as usize];
        let entry = match body.mode {
            Mode::Fixed => return (Entry::Field, 0.0),
            Mode::Frozen if !body.still => Entry::Moving,
            Mode::Frozen | Mode::Normal | Mode::Falling => Entry::Field,
        };
        let dynamics = model.dynamics();
        let (before, after) = (dynamics.gravity(body.since), dynamics.gravity(self.clock));
        let now = self.particle_now(model, particle);
        let start: Vector<D> = self.flight(model, particle).start_velocity();
        let mut work = gain(now.mass, &start, &now.velocity);
        if body.mode != Mode::Falling {
            work -= now.mass * after.dot(&(now.position - body.position));
        }
        work -= now.mass * (after - before).dot(&body.position);
        (entry, work)
    }

    /// A grain at the instant the clock shows, in the image it is stored in.
    pub(super) fn particle_now<M: Model<D>>(&self, model: &M, particle: u32) -> Particle<D> {
        let body = &self.bodies[particle as usize];
        let flight = flight_of(model, particle, body);
        let after = self.clock - body.since;
        Particle {
            position: flight.position(after),
            velocity: flight.velocity(after),
            diameter: 2.0 * body.radius * scale_at::<M, D>(model, self.clock),
            mass: body.mass,
            mode: body.mode,
        }
    }

    /// Writes a grain's state at the instant the clock shows. Only physical
    /// events do so.
    pub(super) fn write<M: Model<D>>(
        &mut self,
        model: &M,
        particle: u32,
        position: Vector<D>,
        velocity: Vector<D>,
        mode: Mode,
    ) {
        if M::Dynamics::DRIVES {
            let (entry, work) = self.work_in_flight(model, particle);
            self.ledger.add(entry, work);
        }
        let body = &mut self.bodies[particle as usize];
        if body.mode == Mode::Falling {
            let weight = model.dynamics().gravity(self.clock) * body.mass;
            let lost = weight.dot(&(body.position - position));
            self.ledger.add(Entry::Fall, lost);
        }
        body.position = position;
        body.velocity = velocity;
        body.since = self.clock;
        body.stamp = body.stamp.wrapping_add(1);
        let falls_no_more = body.mode == Mode::Falling && mode != Mode::Falling;
        if body.mode != mode {
            *self.modes.of(body.mode) -= 1;
            *self.modes.of(mode) += 1;
            body.mode = mode;
        }
        body.still = mode.is_static() && flight_of(model, particle, body).is_at_rest();
        for axis in 0..D {
            let Some(period) = model.boundary().period(axis) else {
                continue;
            };
            let x = body.position[axis];
            if x < period.origin || x >= period.origin + period.length {
                let turns = libm::floor((x - period.origin) / period.length);
                body.position[axis] = x - turns * period.length;
                let gravity = model.dynamics().gravity(self.clock)[axis];
                if gravity != 0.0 && mode != Mode::Fixed {
                    let weight = body.mass * gravity;
                    let gained = weight * (x - body.position[axis]);
                    self.ledger.add(Entry::Crossing, gained);
                }
                self.near.unwind(particle, axis, turns as i32);
            }
        }
        if falls_no_more && self.near.is_tied(particle) {
            self.stay_below(particle);
        }
        self.keep_blur(model, particle);
        self.glance(model, particle);
    }

    /// A grain that was found next to `one`, now, and the vector to it from
    /// there; `None` if it was found in an image that is not the nearest, so
    /// that in narrow boxes nobody is met twice.
    pub(super) fn nearest<M: Model<D>>(
        &self,
        model: &M,
        one: &Particle<D>,
        found: &Found<D>,
    ) -> Option<(Particle<D>, Vector<D>)> {
        let other = self.particle_now(model, found.particle);
        let offset = self.displacement(model, one, &other);
        let mut image = other.position - one.position - offset;
        for axis in 0..D {
            if let Some(period) = model.boundary().period(axis) {
                image[axis] += f64::from(found.turns[axis]) * period.length;
            }
        }
        // Another image is a whole period away, this one a rounding.
        (image.norm_squared().sqrt() < 0.1 * self.largest).then_some((other, offset))
    }

    /// From one grain to the nearest image of another, now.
    pub(super) fn displacement<M: Model<D>>(
        &self,
        model: &M,
        from: &Particle<D>,
        to: &Particle<D>,
    ) -> Vector<D> {
        model.boundary().displacement(&from.position, &to.position)
    }
}

#[inline]
pub(super) fn flight_of<M: Model<D>, const D: usize>(
    model: &M,
    particle: u32,
    body: &Body<D>,
) -> FlightOf<M, D> {
    model.dynamics().flight(
        &Motion {
            id: ParticleId(particle),
            position: body.position,
            velocity: body.velocity,
            mode: body.mode,
        },
        body.since,
    )
}

/// Kinetic energy gained by a mass, in mgd, as its velocity changes.
#[inline]
pub(super) fn gain<const D: usize>(mass: f64, before: &Vector<D>, after: &Vector<D>) -> f64 {
    0.5 * mass * (after - before).dot(&(after + before))
}

/// Diameters at `time` over those at t = 0.
#[inline]
pub(super) fn scale_at<M: Model<D>, const D: usize>(model: &M, time: Time) -> f64 {
    if M::Dynamics::GROWS {
        1.0 + model.dynamics().growth_rate() * time.units()
    } else {
        1.0
    }
}

/// Whether a grain's position, `after` its last event, is known well enough for
/// bounds to be told from it.
#[inline]
pub(super) fn is_known<M: Model<D>, const D: usize>(
    model: &M,
    particle: u32,
    body: &Body<D>,
    after: f64,
    blur: f64,
) -> bool {
    (0.0..=LONG_AGO).contains(&after)
        || body.still
        || (after > 0.0 && rounding(&flight_of(model, particle, body), after) <= blur)
}
