//! Who on a grain's list may come first: all are told by bounds, few are asked.
//!
//! Bounds decide who is asked, never what is answered.

use wide::f64x4;

use crate::engine::body::{LONG_AGO, World, flight_of, is_known, scale_at};
use crate::engine::cells::Link;
use crate::engine::glances::Onlooker;
use crate::engine::search::shift;
use crate::engine::simulation::Simulation;
use crate::model::{Crowd, Dynamics, Flight, LANES, Model, Nook, Predictor};
use crate::time::Time;

/// Somebody who may come first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<const D: usize> {
    /// Not before this, from now.
    bound: f64,
    link: Link<D>,
}

impl<const D: usize> World<D> {
    /// Divides the list of a grain into those at rest and those that move.
    #[inline]
    fn make_bed(&mut self, particle: u32) {
        let anybody_rests = self.modes.frozen + self.modes.fixed > 0;
        self.near.make_bed(particle, anybody_rests, &self.bodies);
    }

    /// Those among these that the onlooker may meet soon.
    #[inline(always)]
    fn look(&self, own: &Onlooker<D>, links: &[Link<D>], candidates: &mut Vec<Candidate<D>>) {
        let World { near, glances, .. } = self;
        for few in links.chunks(LANES) {
            let links = match few {
                &[a, b, c, d] => [a, b, c, d],
                _ => std::array::from_fn(|lane| few[if lane < few.len() { lane } else { 0 }]),
            };
            let images = links.iter().fold(0, |any, link| any | link.image());
            let shifts = (images != 0).then(|| links.map(|link| near.link_shift(link)));
            let (bounds, mut soon) = glances.not_before(own, links.map(Link::particle), shifts);
            soon &= (1 << few.len()) - 1;
            if soon == 0 {
                continue;
            }
            let bounds = bounds.to_array();
            while soon != 0 {
                let lane = soon.trailing_zeros() as usize;
                soon &= soon - 1;
                candidates.push(Candidate {
                    bound: bounds[lane],
                    link: links[lane],
                });
            }
        }
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Looks at those alone whom a grain's new list names and the one before did
    /// not: what is known of the others holds. False if there is more to look at.
    pub(super) fn meet_newcomers(&mut self, particle: u32) -> bool {
        self.world.make_bed(particle);
        let (bed, _) = self.world.near.bed(particle);
        let known = self.slots[particle].contact;
        let Some(onlooker) = self.world.onlooker(particle, known) else {
            return false;
        };
        if bed.is_some() {
            return false;
        }
        let mut near = std::mem::take(&mut self.candidates);
        self.world
            .look(&onlooker, self.world.near.newcomers(), &mut near);
        self.ask(particle, None, &mut near);
        self.candidates = near;
        true
    }

    /// Asks candidates in the order of their bounds, but for one that has been
    /// asked, until one is later than the contact that is known.
    fn ask(&mut self, particle: u32, asked: Option<Link<D>>, near: &mut Vec<Candidate<D>>) {
        let now = self.world.clock;
        while !near.is_empty() {
            let (mut bound, mut place) = (near[0].bound, 0);
            for (other, candidate) in near.iter().enumerate().skip(1) {
                if candidate.bound < bound {
                    (bound, place) = (candidate.bound, other);
                }
            }
            if bound > self.slots[particle].contact - now {
                break;
            }
            let Candidate { link, .. } = near.swap_remove(place);
            if asked != Some(link) {
                let found = self.world.near.found(particle, link);
                self.meet(particle, &found);
            }
        }
        near.clear();
    }

    /// Notes the first contact with anybody on a grain's list, but for the one
    /// that has been asked, if it comes before what is known already: nearly all
    /// are told to come later by a bound, and the others are asked in the order
    /// of their bounds. To somebody it does not come `back` before a time.
    pub(super) fn meet_listed(
        &mut self,
        particle: u32,
        mut asked: Option<Link<D>>,
        mut back: Option<(Link<D>, f64)>,
    ) {
        if !self.world.is_current() && self.epoch_is_over() {
            self.begin_epoch();
        }
        let mut near = std::mem::take(&mut self.candidates);
        let now = self.world.clock;
        let known = self.slots[particle].contact;
        // It is likely to be back not much later than it can be, and bounds are
        // the better the shorter they have to look ahead.
        let mut until = back.map_or(known, |(_, bound)| known.min(now + 2.0 * bound));
        loop {
            self.find_candidates(particle, until, back, &mut near);
            self.ask(particle, asked, &mut near);
            let contact = self.slots[particle].contact;
            if contact <= until {
                break;
            }
            // Nobody comes as soon as that.
            if let Some((link, _)) = back.take() {
                asked = Some(link);
            }
            until = contact;
        }
        self.candidates = near;
    }

    /// Whether so much has happened in an epoch that looking anew at all who move is a
    /// small matter beside it.
    #[cold]
    fn epoch_is_over(&self) -> bool {
        let events = self.counts.total() - self.epoch_events;
        events >= self.world.modes.normal as u64 / 8
    }

    /// Everybody on a grain's list who may meet it before its known contact, and
    /// a time before which they certainly do not, counted from now.
    fn find_candidates(
        &mut self,
        particle: u32,
        until: Time,
        back: Option<(Link<D>, f64)>,
        candidates: &mut Vec<Candidate<D>>,
    ) {
        self.world.make_bed(particle);
        let (bed, movers) = self.world.near.bed(particle);
        let onlooker = self.world.onlooker(particle, until);
        if (bed.is_some() || onlooker.is_none())
            && !self.find_slowly(particle, until, back, candidates)
        {
            return;
        }
        if let Some(onlooker) = onlooker {
            self.world.look(&onlooker, movers, candidates);
        }
    }

    /// The same for grains at rest, and if the grain itself is none that bounds
    /// are told to by glances, for all others, too. False if nothing can be said
    /// of it, so that everybody has been noted.
    #[inline(never)]
    fn find_slowly(
        &self,
        particle: u32,
        until: Time,
        back: Option<(Link<D>, f64)>,
        candidates: &mut Vec<Candidate<D>>,
    ) -> bool {
        let model = &self.model;
        let World {
            bodies,
            near,
            clock,
            blur,
            ..
        } = &self.world;
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
            return false;
        }
        let horizon = until - now;
        let place = own.start() - near.anchor(particle);
        let (bed, movers) = near.bed(particle);
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
            let mut times = model.predictor().not_before_resting(&nook);
            if let Some((left, time)) = back
                && let Some(lane) = few.iter().position(|link| *link == left)
            {
                times[lane] = time;
            }
            note(candidates, &times, few, horizon);
        }
        if self.world.onlooker(particle, now).is_some() {
            return true;
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
            let mut times = model.predictor().not_before(&own, flight, &crowd);
            if after.iter().any(|after| !(0.0..=LONG_AGO).contains(after)) {
                for (lane, time) in times.iter_mut().enumerate() {
                    let id = found[lane].particle;
                    if !is_known(model, id, theirs[lane], after[lane], blur) {
                        *time = 0.0;
                    }
                }
            }
            for (lane, other) in found.iter().enumerate() {
                // Later than its own bound, the other finds it anyway.
                if times[lane] > self.slots[other.particle].bound() - now {
                    times[lane] = f64::INFINITY;
                }
            }
            note(candidates, &times, few, horizon);
        }
        true
    }
}

/// Notes those of a few who may come up to a time.
#[inline(always)]
fn note<const D: usize>(
    candidates: &mut Vec<Candidate<D>>,
    times: &[f64; LANES],
    few: &[Link<D>],
    until: f64,
) {
    // What is no number is not later than anything; what never comes is.
    let late = f64x4::new(*times).simd_gt(f64x4::splat(until.min(f64::MAX)));
    let mut soon = !late.to_bitmask() & ((1 << few.len()) - 1);
    while soon != 0 {
        let lane = soon.trailing_zeros() as usize;
        soon &= soon - 1;
        candidates.push(Candidate {
            bound: times[lane].max(0.0),
            link: few[lane],
        });
    }
}
