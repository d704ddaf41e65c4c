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
use crate::engine::cells::{Found, Link};
use crate::engine::neighbours::Neighbours;
use crate::engine::simulation::Simulation;
use crate::engine::slot::{Partner, contact_key};
use crate::model::{Approach, Boundary, Dynamics, Encounter, Flight, Forecast, Model, Predictor};
use crate::particle::{Vector, WallId};
use crate::time::Time;

/// Squared distance, over that at contact, within which two grains that have
/// just collided are in the image in which they did.
const IMAGE: f64 = 1.0 + 1.0e-6;

/// How often a grain's way is followed on for as long as it is certain to stay
/// on its leash.
const MOST_STEPS: usize = 16;

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Finds what lies ahead of a grain whose state has just changed, or whose
    /// foreseen contact has lost its partner.
    #[inline]
    pub(super) fn predict(&mut self, particle: u32) {
        if let Some(slot) = self.slots.own(particle) {
            slot.contact = Time::NEVER;
            slot.partner = Partner::Nobody;
        }
        self.predict_listed(particle);
    }

    /// Looks at everybody on a grain's list, keeping what is known already.
    pub(super) fn predict_listed(&mut self, particle: u32) {
        if self.world.bodies[particle as usize].mode.is_static() {
            self.tell_neighbours(particle);
        } else {
            // The grain just left is often the next, and a near contact spares
            // work on all others. Where the two see each other move uniformly they
            // part for ever, and a glance will do.
            let (mut asked, mut back) = (None, None);
            if let Partner::Particle(last) = self.traces[particle].partner
                && !self.world.see_each_other(particle, last)
                && let Some(link) = self.world.near.listed(particle, last)
            {
                let bound = self.not_back_before(particle, link);
                if bound > 0.0 {
                    back = Some((link, bound));
                } else {
                    let found = self.world.near.found(particle, link);
                    self.meet(particle, &found);
                    asked = Some(link);
                }
            }
            self.meet_walls(particle);
            self.meet_listed(particle, asked, back);
        }
        self.find_renewal(particle);
        self.enqueue(particle);
    }

    /// A time, from now, before which a grain certainly does not come back to the
    /// one it has left, if that is at rest and it has done so just now.
    #[inline]
    fn not_back_before(&self, particle: u32, link: Link<D>) -> f64 {
        let (own, other) = (
            &self.world.bodies[particle as usize],
            &self.world.bodies[link.particle() as usize],
        );
        if M::Dynamics::GROWS || !other.still || own.since != self.world.clock {
            return 0.0;
        }
        // A difference of two places next to each other is exact but for u σ; a
        // period would bring in the rounding of its own length.
        if self.world.near.found(particle, link).turns != [0; D] {
            return 0.0;
        }
        let place = other.position - own.position;
        let flight = self.world.flight(&self.model, particle);
        self.model.predictor().not_back_before(&flight, &place)
    }

    pub(super) fn enqueue(&mut self, particle: u32) {
        let slot = &self.slots[particle];
        let key = slot.key(particle);
        self.world.glances.set_bound(particle, slot.bound());
        self.queue.set(particle, key);
        self.vigil.touch(particle);
    }

    /// Lets every mobile neighbour note its contact with a static grain.
    fn tell_neighbours(&mut self, particle: u32) {
        let mut found = std::mem::take(&mut self.scratch);
        found.clear();
        found.extend(self.world.near.list(particle));
        for other in &found {
            if self.world.bodies[other.particle as usize].mode.is_mobile()
                && self.meet(other.particle, &other.seen_from(particle))
            {
                self.enqueue(other.particle);
            }
        }
        self.scratch = found;
    }

    /// Notes a mobile grain's contact with another if it comes first; true if
    /// it did.
    #[inline]
    pub(super) fn meet(&mut self, particle: u32, other: &Found<D>) -> bool {
        let until = self.slots[particle].contact;
        let Some(time) = self.pair_contact(particle, other.particle, other.turns, until) else {
            return false;
        };
        // Later than its own bound, the other finds it anyway.
        if self.is_predicted_before(other.particle, time) {
            return false;
        }
        let partner = Partner::Particle(other.particle);
        let partner_stamp = self.world.bodies[other.particle as usize].stamp;
        let slot = self.slots.make(particle);
        if contact_key(particle, time, partner) >= slot.contact_key(particle) {
            return false;
        }
        slot.contact = time;
        slot.partner = partner;
        slot.partner_stamp = partner_stamp;
        true
    }

    /// Whether a grain is certain to be predicted anew before a time.
    #[inline]
    fn is_predicted_before(&self, particle: u32, time: Time) -> bool {
        let glances = &self.world.glances;
        // Likely to be at hand, other than its slot.
        if glances.is_unknown(particle) {
            time > self.slots[particle].bound()
        } else {
            glances.is_bound_before(particle, time)
        }
    }

    /// Notes a grain's contact with a wall if it comes first; true if it did.
    fn meet_walls(&mut self, particle: u32) -> bool {
        let mut nearer = false;
        for wall in 0..self.model.boundary().walls().len() {
            let wall = WallId(wall as u16);
            let slot = self.slots[particle];
            let Some(time) = self.wall_contact(particle, wall, slot.contact) else {
                continue;
            };
            let partner = Partner::Wall(wall);
            if contact_key(particle, time, partner) < slot.contact_key(particle) {
                let slot = self.slots.make(particle);
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
        let shift = shift(model, turns, sign);
        let sum = a.radius + b.radius;
        let mut distance = sum * scale_at::<M, D>(model, base);
        let growth = if M::Dynamics::GROWS {
            sum * model.dynamics().growth_rate()
        } else {
            0.0
        };
        let apart = flight_b.start() + shift - flight_a.start();
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
                    if !base.is_finite() {
                        return None;
                    }
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
        let mut touching = self.traces[particle].partner == Partner::Wall(wall);
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
                    if !base.is_finite() {
                        return None;
                    }
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
        let left = |one: u32, other: u32| self.traces[one].partner == Partner::Particle(other);
        match (a.mode.is_mobile(), b.mode.is_mobile()) {
            (true, true) => a.since == b.since && left(first, second) && left(second, first),
            (true, false) => b.since <= a.since && left(first, second),
            (false, true) => a.since <= b.since && left(second, first),
            (false, false) => false,
        }
    }

    /// Finds until when a grain is certain to stay within its leash; never, if
    /// something comes first after which it is found again.
    #[inline]
    pub(super) fn find_renewal(&mut self, particle: u32) {
        let flight = self.world.flight(&self.model, particle);
        if self.world.is_aloft(particle) {
            let landing = self.world.next_landing(particle);
            // Nearly all of them have nothing to wait for.
            if landing.is_finite() || self.slots.has(particle) {
                self.slots.make(particle).renewal = landing;
            }
            return;
        }
        let mut bound = Time::NEVER;
        if let Some(slot) = self.slots.own(particle) {
            slot.renewal = Time::NEVER;
            bound = slot.bound();
        }
        if flight.is_at_rest() {
            return;
        }
        let now = self.world.clock;
        let known = bound - now;
        let flight = flight.advanced(now - self.world.bodies[particle as usize].since);
        let near = &self.world.near;
        let anchor = near.anchor(particle);
        let certain = match flight.stays_within(&anchor, near.leash(particle)) {
            Some(certain) => certain,
            None => stepped(near, particle, &flight, known),
        };
        if certain <= known {
            self.slots.make(particle).renewal = now + certain;
        }
    }
}

/// The same in steps of at most the top speed.
fn stepped<F: Flight<D>, const D: usize>(
    near: &Neighbours<D>,
    particle: u32,
    flight: &F,
    known: f64,
) -> f64 {
    let mut slack = near.slack(particle, &flight.start()).max(0.0);
    if slack > flight.speed_bound(known) * known {
        return f64::INFINITY;
    }
    // From a time on it goes no farther within another than its top speed up
    // to the end of both times that other.
    let step = |from: f64, slack: f64| {
        let safe = |window: f64| f64::min(window, slack / flight.speed_bound(from + window));
        let mut certain = safe(1.0);
        let mut longer = safe(2.0 * certain);
        // A slow grain needs looking after no more often than a fast one
        // needs in the time it takes to go as far.
        while longer > certain && certain >= 1.0 {
            certain = longer;
            longer = safe(2.0 * certain);
        }
        certain.max(longer)
    };
    let mut certain = step(0.0, slack);
    // An event of its own comes first, or it has to be tied anew then, or
    // that is very long.
    for _ in 0..MOST_STEPS {
        if certain > known {
            break;
        }
        slack = near.slack(particle, &flight.position(certain));
        if near.is_stretched(particle, slack) {
            break;
        }
        certain += step(certain, slack);
    }
    certain
}

/// The vector of `turns` periods, in d.
#[inline]
pub(super) fn shift<M: Model<D>, const D: usize>(
    model: &M,
    turns: [i32; D],
    sign: i32,
) -> Vector<D> {
    let mut shift = Vector::zeros();
    if turns != [0; D] {
        for axis in 0..D {
            if let Some(period) = model.boundary().period(axis) {
                shift[axis] = f64::from(sign * turns[axis]) * period.length;
            }
        }
    }
    shift
}
