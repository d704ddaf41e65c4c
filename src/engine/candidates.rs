//! Who on a grain's list may come first: all are told by bounds, few are asked.
//!
//! Bounds decide who is asked, never what is answered.

use crate::engine::body::{LONG_AGO, World, flight_of, is_known, scale_at};
use crate::engine::cells::{Found, Link};
use crate::engine::search::shift;
use crate::engine::simulation::Simulation;
use crate::model::{Crowd, Dynamics, Flight, LANES, Model, Nook, Predictor};

/// Somebody who may come first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<const D: usize> {
    /// Not before this, from now.
    bound: f64,
    link: Link<D>,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Notes the first contact with anybody on a grain's list, but for the one
    /// that has been asked, if it comes before what is known already: nearly all
    /// are told to come later by a bound, and the others are asked in the order
    /// of their bounds.
    pub(super) fn meet_listed(&mut self, particle: u32, asked: Option<Found<D>>) {
        let mut near = std::mem::take(&mut self.candidates);
        self.find_candidates(particle, &mut near);
        let now = self.world.clock;
        while !near.is_empty() {
            let (mut bound, mut place) = (near[0].bound, 0);
            for (other, candidate) in near.iter().enumerate().skip(1) {
                if candidate.bound < bound {
                    (bound, place) = (candidate.bound, other);
                }
            }
            if bound > self.slots[particle as usize].contact - now {
                break;
            }
            let Candidate { link, .. } = near.swap_remove(place);
            let found = self.world.near.found(particle, link);
            if asked != Some(found) {
                self.meet(particle, &found);
            }
        }
        near.clear();
        self.candidates = near;
    }

    /// Everybody on a grain's list who may meet it before its known contact, and
    /// a time before which they certainly do not, counted from now.
    fn find_candidates(&mut self, particle: u32, candidates: &mut Vec<Candidate<D>>) {
        let model = &self.model;
        let World {
            bodies,
            near,
            clock,
            blur,
            ..
        } = &mut self.world;
        let now = *clock;
        let blur = *blur;
        let scale = scale_at::<M, D>(model, now);
        let growth = if M::Dynamics::GROWS {
            model.dynamics().growth_rate() / scale
        } else {
            0.0
        };
        let body = &bodies[particle as usize];
        let flown = now - body.since;
        let own = flight_of(model, particle, body).advanced(flown);
        if !(0.0..=LONG_AGO).contains(&flown) && !is_known(model, particle, body, flown, blur) {
            // Where it is now is not known well enough to leave anybody out.
            let all = near.links(particle).iter();
            candidates.extend(all.map(|&link| Candidate { bound: 0.0, link }));
            return;
        }
        let horizon = self.slots[particle as usize].contact - now;
        let place = own.start() - near.anchor(particle);
        near.make_bed(particle, bodies);
        let near = &*near;
        let (bed, movers) = near.bed(particle);
        let slots = &self.slots;
        let mut add = |answers: [f64; LANES], few: &[Link<D>]| {
            for (bound, link) in answers.into_iter().zip(few) {
                // NaN says nothing, so it is not later than anything.
                if bound == f64::INFINITY || bound > horizon {
                    continue;
                }
                // Later than its own bound, the other finds it anyway.
                if bound > slots[link.particle() as usize].bound() - now {
                    continue;
                }
                candidates.push(Candidate {
                    bound: if bound > 0.0 { bound } else { 0.0 },
                    link: *link,
                });
            }
        };
        let still = bed.map_or(&[][..], |bed| &bed.still);
        let resting = bed.map_or(&[][..], |bed| &bed.resting);
        for (resting, few) in resting.iter().zip(still.chunks(LANES)) {
            let nook = Nook {
                own: &own,
                place,
                resting,
                scale,
                growth,
                blur,
                horizon,
            };
            add(model.predictor().not_before_resting(&nook), few);
        }
        for few in movers.chunks(LANES) {
            let found: [Link<D>; LANES] =
                std::array::from_fn(|lane| few[if lane < few.len() { lane } else { 0 }]);
            let found = found.map(|link| near.found(particle, link));
            let theirs = found.map(|other| &bodies[other.particle as usize]);
            let after = theirs.map(|body| now.since(body.since));
            let shifted = found.iter().any(|other| other.turns != [0; D]);
            let crowd = Crowd {
                after,
                shifts: shifted.then(|| found.map(|other| shift(model, other.turns, 1))),
                distances: theirs.map(|other| (body.radius + other.radius) * scale),
                growth,
                blur,
                horizon,
            };
            let flight = |lane: usize| flight_of(model, found[lane].particle, theirs[lane]);
            let mut answers = model.predictor().not_before(&own, flight, &crowd);
            if after.iter().any(|after| !(0.0..=LONG_AGO).contains(after)) {
                for (lane, answer) in answers.iter_mut().enumerate() {
                    let id = found[lane].particle;
                    if !is_known(model, id, theirs[lane], after[lane], blur) {
                        *answer = 0.0;
                    }
                }
            }
            add(answers, few);
        }
    }
}
