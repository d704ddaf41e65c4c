//! Looking for missed contacts by brute force.

use std::fmt;

use crate::engine::images::for_each_turns;
use crate::engine::simulation::Simulation;
use crate::model::{Boundary, Flight, Model};
use crate::particle::{ParticleId, Vector, WallId};
use crate::time::Time;

/// What an audit has found ([`Simulation::audit`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// Pairs with a mobile grain that were looked at.
    pub pairs: u64,
    /// Those of them, and of grains and walls, that come near enough to each
    /// other before their next entries to be predicted.
    pub predicted: u64,
    /// Contacts that a guard has put off
    /// ([`Guards::hold`](crate::engine::Guards::hold)): these are not missed.
    pub deferred: u64,
    /// The deepest overlap of a mobile grain with any other now, in d.
    pub deepest: f64,
    /// Contacts that nobody would have noticed.
    pub missed: Vec<Missed>,
}

/// A contact before the next entries of those that meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// A grain.
    pub particle: ParticleId,
    /// Whom it meets, unless it meets a wall.
    pub other: Option<ParticleId>,
    /// The wall it meets.
    pub wall: Option<WallId>,
    /// When.
    pub time: Time,
    /// When the earlier of their entries in the queue is due.
    pub entry: Time,
}

impl fmt::Display for Missed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "grain {} meets ", self.particle.0)?;
        match (self.other, self.wall) {
            (Some(other), _) => write!(f, "grain {}", other.0)?,
            (None, Some(wall)) => write!(f, "wall {}", wall.0)?,
            (None, None) => write!(f, "nobody")?,
        }
        write!(f, " at {}, but is next due at {}", self.time, self.entry)
    }
}

/// A grain now, and as far as its next entry.
struct Ahead<const D: usize> {
    /// Where it is now, in the image it is stored in.
    position: Vector<D>,
    /// Radius at the end, in d.
    radius: f64,
    /// Time of its entry.
    entry: Time,
    /// A bound on its speed up to there.
    speed: f64,
    mobile: bool,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Compares the queue with brute force: for every pair with a mobile grain,
    /// in every image, and for every mobile grain and wall, the next contact
    /// must not come before the earlier of the two grains' entries, at which
    /// both are looked after. Neither lists nor grid are consulted; nothing is
    /// changed. Costs about 30 ns a pair.
    pub fn audit(&mut self) -> Audit {
        let deepest = self.deepest;
        let mut audit = Audit::default();
        let now = self.world.clock;
        let ahead: Vec<Ahead<D>> = (0..self.world.bodies.len() as u32)
            .map(|particle| self.ahead(particle))
            .collect();
        for (one, this) in ahead.iter().enumerate() {
            if !this.mobile {
                continue;
            }
            for (other, that) in ahead.iter().enumerate() {
                // Two mobile grains are one pair.
                if other == one || (that.mobile && other < one) {
                    continue;
                }
                audit.pairs += 1;
                let entry = this.entry.min(that.entry);
                let contact = this.radius + that.radius;
                let reach = contact + (this.speed + that.speed) * (entry - now);
                self.audit_pair(one as u32, other as u32, [this, that], reach, &mut audit);
            }
            for wall in 0..self.model.boundary().walls().len() {
                audit.predicted += 1;
                let wall = WallId(wall as u16);
                if let Some(time) = self.wall_contact(one as u32, wall, this.entry)
                    && time < this.entry
                {
                    audit.missed.push(Missed {
                        particle: ParticleId(one as u32),
                        other: None,
                        wall: Some(wall),
                        time,
                        entry: this.entry,
                    });
                }
            }
        }
        self.deepest = deepest;
        audit
    }

    fn ahead(&self, particle: u32) -> Ahead<D> {
        let now = self.world.clock;
        let body = &self.world.bodies[particle as usize];
        let flight = self.world.flight(&self.model, particle);
        let flight = flight.advanced(now - body.since);
        // Growing grains are all predicted anew when the grid is.
        let slot = &self.slots[particle];
        let mut entry = slot.key(particle).time.min(self.regrid_at);
        if self.world.is_aloft(particle) {
            entry = entry.min(self.world.landing(particle));
        }
        let within = (entry - now).min(1.0e9);
        Ahead {
            position: flight.position(0.0),
            radius: body.radius * self.scale_at(entry.min(Time::LAST)),
            entry,
            speed: if flight.is_at_rest() {
                0.0
            } else {
                flight.speed_bound(within)
            },
            mobile: body.mode.is_mobile(),
        }
    }

    /// Looks at a pair in every image in which it comes near enough.
    fn audit_pair(
        &mut self,
        one: u32,
        other: u32,
        [this, that]: [&Ahead<D>; 2],
        reach: f64,
        audit: &mut Audit,
    ) {
        // Of the rounding of all that has led here.
        let reach = reach * (1.0 + 1.0e-9);
        let apart = that.position - this.position;
        let mut low = [0; D];
        let mut high = [0; D];
        for axis in 0..D {
            if let Some(period) = self.model.boundary().period(axis) {
                let length = period.length;
                low[axis] = libm::ceil((-reach - apart[axis]) / length).max(-1.0e6) as i32;
                high[axis] = libm::floor((reach - apart[axis]) / length).min(1.0e6) as i32;
                // A straying entry must not make this endless.
                let nearest = libm::rint(-apart[axis] / length) as i32;
                low[axis] = low[axis].max(nearest - 2);
                high[axis] = high[axis].min(nearest + 2);
            }
        }
        for_each_turns(low, high, |turns| {
            let mut squared = 0.0;
            for axis in 0..D {
                let mut along = apart[axis];
                if let Some(period) = self.model.boundary().period(axis) {
                    along += f64::from(turns[axis]) * period.length;
                }
                squared += along * along;
            }
            if squared < reach * reach {
                self.audit_image(one, other, turns, squared, [this, that], audit);
            }
        });
    }

    fn audit_image(
        &mut self,
        one: u32,
        other: u32,
        turns: [i32; D],
        squared: f64,
        [this, that]: [&Ahead<D>; 2],
        audit: &mut Audit,
    ) {
        let bodies = &self.world.bodies;
        let sum = bodies[one as usize].radius + bodies[other as usize].radius;
        let contact = sum * self.scale_at(self.world.clock);
        if squared < contact * contact {
            audit.deepest = audit.deepest.max(contact - squared.sqrt());
        }
        audit.predicted += 1;
        let entry = this.entry.min(that.entry);
        let Some(time) = self.pair_contact(one, other, turns, entry) else {
            return;
        };
        if self.traces.held_at(one, other, time) {
            audit.deferred += 1;
        }
        if time < entry {
            audit.missed.push(Missed {
                particle: ParticleId(one),
                other: Some(ParticleId(other)),
                wall: None,
                time,
                entry,
            });
        }
    }
}
