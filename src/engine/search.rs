//! Prediction: each grain's next contact, with grains and with walls.
//!
//! What holds between events, and what makes one entry a grain enough: for
//! every pair that may meet next to each other's cells, the time of their
//! contact is not earlier than the earlier of the two grains' *bounds*, the
//! instants at which each will be predicted anew against everybody. A contact
//! that lies after the partner's bound need not be noted, for it will be found
//! again then. Static grains own no entry and have no bound; whoever meets one
//! notes it, and a grain that becomes static tells its neighbours.
//!
//! The instant of a contact depends on the states of the two grains alone, not
//! on when it is asked for: it is always counted from the later of their last
//! events, and the one with the smaller id comes first.

use crate::engine::body::scale_at;
use crate::engine::cells::Found;
use crate::engine::simulation::Simulation;
use crate::engine::slot::{Partner, contact_key};
use crate::model::{Approach, Boundary, Dynamics, Encounter, Flight, Forecast, Model, Predictor};
use crate::particle::{Vector, WallId};
use crate::time::Time;

/// Squared distance, over that at contact, within which two grains that have
/// just collided are in the image in which they did.
const IMAGE: f64 = 1.0 + 1.0e-6;

/// Covers the rounding of a comparison of squared distances.
const ROUND: f64 = 1.0 + 1.0e-12;

/// A contact later than this, in √(d/g), bounds nobody's reach.
const FAR: f64 = 1.0e3;

/// Where a mobile grain is at its last event, and how far its surface comes
/// before its next known contact.
struct Sight<const D: usize> {
    position: Vector<D>,
    since: Time,
    within: f64,
    reach: f64,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Finds what lies ahead of a grain whose state has just changed, or whose
    /// foreseen contact has lost its partner.
    pub(super) fn predict(&mut self, particle: u32) {
        let slot = &mut self.slots[particle as usize];
        slot.contact = Time::NEVER;
        slot.partner = Partner::Nobody;
        if self.world.bodies[particle as usize].mode.is_static() {
            slot.sleep = Time::NEVER;
        }
        self.predict_listed(particle);
    }

    /// Looks at everybody on a grain's list, keeping what is known already.
    pub(super) fn predict_listed(&mut self, particle: u32) {
        let mut found = std::mem::take(&mut self.scratch);
        found.clear();
        found.extend_from_slice(self.world.near.list(particle));
        if self.world.bodies[particle as usize].mode.is_static() {
            self.tell_neighbours(particle, &found);
        } else {
            // The grain just left comes first: it is often the next, and a
            // near contact spares work on all others.
            if let Partner::Particle(last) = self.traces[particle as usize].partner
                && let Some(place) = found.iter().position(|other| other.particle == last)
            {
                found.swap(0, place);
            }
            let mut sight = self.sight(particle);
            for (place, other) in found.iter().enumerate() {
                let mut nearer = false;
                if place == 1 {
                    nearer = self.meet_walls(particle);
                }
                nearer |= self.meet(&sight, particle, other);
                if nearer {
                    sight = self.sight(particle);
                }
            }
            if found.len() < 2 {
                self.meet_walls(particle);
            }
        }
        self.scratch = found;
        self.find_renewal(particle);
        self.enqueue(particle);
    }

    pub(super) fn enqueue(&mut self, particle: u32) {
        let key = self.slots[particle as usize].key(particle);
        self.queue.set(particle, key);
        self.vigil.touch(particle);
    }

    /// Lets every mobile neighbour note its contact with a static grain.
    fn tell_neighbours(&mut self, particle: u32, found: &[Found<D>]) {
        for other in found {
            if self.world.bodies[other.particle as usize].mode.is_mobile() {
                let sight = self.sight(other.particle);
                if self.meet(&sight, other.particle, &other.seen_from(particle)) {
                    self.enqueue(other.particle);
                }
            }
        }
    }

    /// Where a mobile grain is and how far it comes.
    #[inline]
    fn sight(&self, particle: u32) -> Sight<D> {
        let body = &self.world.bodies[particle as usize];
        let flight = self.world.flight(&self.model, particle);
        let within = self.slots[particle as usize].contact - body.since;
        let travel = if within < FAR && !M::Dynamics::GROWS {
            flight.speed_bound(within) * within
        } else {
            f64::INFINITY
        };
        Sight {
            position: flight.position(0.0),
            since: body.since,
            within,
            reach: body.radius + travel,
        }
    }

    /// Whether another grain is out of a mobile grain's reach up to the grain's
    /// next known contact. Most are, and this is cheap.
    #[inline]
    fn is_out_of_reach(&self, sight: &Sight<D>, other: &Found<D>) -> bool {
        let far = &self.world.bodies[other.particle as usize];
        let mut reach = sight.reach + far.radius;
        let mut apart = far.position - sight.position;
        if !far.still {
            let since_far = sight.since - far.since;
            if since_far < 0.0 || reach == f64::INFINITY {
                return false;
            }
            let flight = self.world.flight(&self.model, other.particle);
            apart = flight.position(since_far) - sight.position;
            reach += flight.speed_bound(since_far + sight.within) * sight.within;
        }
        if other.turns != [0; D] {
            apart += self.shift(other.turns, 1);
        }
        apart.norm_squared() > ROUND * reach * reach
    }

    /// Notes a mobile grain's contact with another if it comes first; true if
    /// it did.
    #[inline]
    fn meet(&mut self, sight: &Sight<D>, particle: u32, other: &Found<D>) -> bool {
        if self.is_out_of_reach(sight, other) {
            return false;
        }
        let until = self.slots[particle as usize].contact;
        let Some(time) = self.pair_contact(particle, other.particle, other.turns, until) else {
            return false;
        };
        let slot = self.slots[particle as usize];
        let partner = Partner::Particle(other.particle);
        let first = contact_key(particle, time, partner) < slot.contact_key(particle);
        if !first || time > self.slots[other.particle as usize].bound() {
            return false;
        }
        let partner_stamp = self.world.bodies[other.particle as usize].stamp;
        let slot = &mut self.slots[particle as usize];
        slot.contact = time;
        slot.partner = partner;
        slot.partner_stamp = partner_stamp;
        true
    }

    /// Notes a grain's contact with a wall if it comes first; true if it did.
    fn meet_walls(&mut self, particle: u32) -> bool {
        let mut nearer = false;
        for wall in 0..self.model.boundary().walls().len() {
            let wall = WallId(wall as u16);
            let slot = self.slots[particle as usize];
            let Some(time) = self.wall_contact(particle, wall, slot.contact) else {
                continue;
            };
            let partner = Partner::Wall(wall);
            if contact_key(particle, time, partner) < slot.contact_key(particle) {
                let slot = &mut self.slots[particle as usize];
                slot.contact = time;
                slot.partner = partner;
                nearer = true;
            }
        }
        nearer
    }

    /// The first contact of two grains after the later of their last events and
    /// not after `until`.
    pub(super) fn pair_contact(
        &mut self,
        one: u32,
        other: u32,
        turns: [i32; D],
        until: Time,
    ) -> Option<Time> {
        let (first, second, sign) = if one < other {
            (one, other, 1)
        } else {
            (other, one, -1)
        };
        let (a, b) = (
            &self.world.bodies[first as usize],
            &self.world.bodies[second as usize],
        );
        if a.mode.is_static() && b.mode.is_static() {
            return None;
        }
        let mut base = a.since.max(b.since);
        let mut horizon = until - base;
        if horizon < 0.0 {
            return None;
        }
        let model = &self.model;
        let mut flight_a = self.world.flight(model, first);
        if a.since < base {
            flight_a = flight_a.advanced(base - a.since);
        }
        let mut flight_b = self.world.flight(model, second);
        if b.since < base {
            flight_b = flight_b.advanced(base - b.since);
        }
        let shift = self.shift(turns, sign);
        let sum = a.radius + b.radius;
        let mut distance = sum * scale_at::<M, D>(model, base);
        let growth = if M::Dynamics::GROWS {
            sum * model.dynamics().growth_rate()
        } else {
            0.0
        };
        let apart = flight_b.position(0.0) + shift - flight_a.position(0.0);
        let squared = apart.norm_squared();
        let contact = distance * distance;
        if squared < contact && base == self.world.clock {
            self.deepest = self.deepest.max(distance - squared.sqrt());
        }
        // In a narrow box the two may also meet in another image.
        let mut touching = self.touching(first, second) && squared < IMAGE * contact;
        loop {
            let forecast = model.predictor().pair(&Approach {
                first: flight_a,
                second: flight_b,
                shift,
                distance,
                growth,
                touching,
                horizon,
            });
            match forecast {
                Forecast::Never => return None,
                Forecast::Contact(after) => {
                    let time = self.traces.held_until(first, second, base + after);
                    return (time <= until).then_some(time);
                }
                Forecast::AskAgain(after) => {
                    if after >= horizon {
                        return None;
                    }
                    base = base + after;
                    horizon = until - base;
                    flight_a = flight_a.advanced(after);
                    flight_b = flight_b.advanced(after);
                    distance += growth * after;
                    touching = false;
                }
            }
        }
    }

    /// The first contact of a grain with a wall after its last event and not
    /// after `until`.
    pub(super) fn wall_contact(&self, particle: u32, wall: WallId, until: Time) -> Option<Time> {
        let body = &self.world.bodies[particle as usize];
        let model = &self.model;
        let mut base = body.since;
        let mut horizon = until - base;
        if horizon < 0.0 {
            return None;
        }
        let mut flight = self.world.flight(model, particle);
        let mut touching = self.traces[particle as usize].partner == Partner::Wall(wall);
        let mut radius = body.radius * scale_at::<M, D>(model, base);
        let growth = if M::Dynamics::GROWS {
            body.radius * model.dynamics().growth_rate()
        } else {
            0.0
        };
        loop {
            let forecast = model.predictor().wall(&Encounter {
                flight,
                wall: &model.boundary().walls()[wall.index()],
                since: base,
                radius,
                growth,
                touching,
                horizon,
            });
            match forecast {
                Forecast::Never => return None,
                Forecast::Contact(after) => {
                    let time = base + after;
                    return (time <= until).then_some(time);
                }
                Forecast::AskAgain(after) => {
                    if after >= horizon {
                        return None;
                    }
                    base = base + after;
                    horizon = until - base;
                    flight = flight.advanced(after);
                    radius += growth * after;
                    touching = false;
                }
            }
        }
    }

    /// Two grains have just collided with each other and nothing has happened
    /// to either since.
    fn touching(&self, first: u32, second: u32) -> bool {
        let (a, b) = (
            &self.world.bodies[first as usize],
            &self.world.bodies[second as usize],
        );
        let first_left = self.traces[first as usize].partner == Partner::Particle(second);
        let second_left = self.traces[second as usize].partner == Partner::Particle(first);
        match (a.mode.is_mobile(), b.mode.is_mobile()) {
            (true, true) => first_left && second_left && a.since == b.since,
            (true, false) => first_left && b.since <= a.since,
            (false, true) => second_left && a.since <= b.since,
            (false, false) => false,
        }
    }

    /// The vector of `turns` periods, in d.
    fn shift(&self, turns: [i32; D], sign: i32) -> Vector<D> {
        let mut shift = Vector::zeros();
        if turns != [0; D] {
            for axis in 0..D {
                if let Some(period) = self.model.boundary().period(axis) {
                    shift[axis] = f64::from(sign * turns[axis]) * period.length;
                }
            }
        }
        shift
    }

    /// Finds until when a grain is certain to stay within its leash.
    pub(super) fn find_renewal(&mut self, particle: u32) {
        let flight = self.world.flight(&self.model, particle);
        let slot = &mut self.slots[particle as usize];
        slot.renewal = Time::NEVER;
        if flight.is_at_rest() {
            return;
        }
        let after = self.world.clock - self.world.bodies[particle as usize].since;
        let flight = flight.advanced(after);
        let slack = self
            .world
            .near
            .slack(particle, &flight.position(0.0))
            .max(0.0);
        // Within a time t it goes no farther than its top speed then times t.
        let safe = |window: f64| f64::min(window, slack / flight.speed_bound(window));
        let mut certain = safe(1.0);
        // A slow grain needs looking after no more often than a fast one needs
        // in the time it takes to go as far.
        loop {
            let longer = safe(2.0 * certain);
            if longer <= certain {
                break;
            }
            certain = longer;
        }
        slot.renewal = self.world.clock + certain;
    }
}
