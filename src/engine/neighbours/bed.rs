//! The grains at rest on a list, laid out to be looked at all at once.
//!
//! Most events of a deposit are those of a grain that rattles among a few that
//! sleep. Their places from its anchor are kept side by side, so that nothing
//! has to be fetched from afar.

use crate::engine::body::Body;
use crate::engine::cells::Found;
use crate::engine::neighbours::{Neighbours, Tie};
use crate::model::{LANES, Resting};
use crate::particle::Vector;

/// A list with somebody at rest on it, divided into those and the ones that
/// move. A grain among these may have come to rest since; none of those at rest
/// may have been moved.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Bed<const D: usize> {
    pub(in crate::engine) resting: Vec<Resting<D>>,
    /// Who lies there, in this order.
    pub(in crate::engine) still: Vec<Found<D>>,
    movers: Vec<Found<D>>,
}

impl<const D: usize> Bed<D> {
    fn make(
        list: &[Found<D>],
        anchor: &Vector<D>,
        radius: f64,
        periods: &[f64; D],
        bodies: &[Body<D>],
    ) -> Self {
        let mut bed = Bed {
            resting: Vec::new(),
            still: Vec::new(),
            movers: Vec::new(),
        };
        for found in list {
            let body = &bodies[found.particle as usize];
            if !body.still {
                bed.movers.push(*found);
                continue;
            }
            let lane = bed.still.len() % LANES;
            if lane == 0 {
                bed.resting.push(Resting {
                    places: [[0.0; LANES]; D],
                    distances: [0.0; LANES],
                });
            }
            bed.still.push(*found);
            if let Some(last) = bed.resting.last_mut() {
                for axis in 0..D {
                    let image = f64::from(found.turns[axis]) * periods[axis];
                    last.places[axis][lane] = (body.position[axis] - anchor[axis]) + image;
                }
                last.distances[lane] = radius + body.radius;
            }
        }
        bed
    }
}

impl<const D: usize> Tie<D> {
    /// The list has changed, or one of those at rest is going to.
    #[inline]
    pub(super) fn spoil(&mut self) {
        self.divided = false;
    }

    /// A grain that moves has come to the list or left it: if nobody there is at
    /// rest, the list itself is all there is to know.
    #[inline]
    pub(super) fn mover_changed(&mut self) {
        self.divided &= self.bed.is_none();
    }
}

impl<const D: usize> Neighbours<D> {
    /// Those at rest on the list of a grain, if anybody is, and those that move.
    #[inline]
    pub(in crate::engine) fn bed(
        &mut self,
        particle: u32,
        bodies: &[Body<D>],
    ) -> (Option<&Bed<D>>, &[Found<D>]) {
        let tie = &mut self.ties[particle as usize];
        if !tie.divided {
            let is_still = |found: &Found<D>| bodies[found.particle as usize].still;
            tie.bed = tie.list.iter().any(is_still).then(|| {
                let radius = bodies[particle as usize].radius;
                let anchor = &self.cells.seat(particle).anchor;
                Box::new(Bed::make(&tie.list, anchor, radius, &self.periods, bodies))
            });
            tie.divided = true;
        }
        match &tie.bed {
            Some(bed) => (Some(bed), &bed.movers),
            None => (None, &tie.list),
        }
    }

    /// The place that a grain is tied to.
    #[inline]
    pub(in crate::engine) fn anchor(&self, particle: u32) -> &Vector<D> {
        &self.cells.seat(particle).anchor
    }

    /// Who lies still in a bed has to, and where it is said to.
    pub(in crate::engine) fn check_bed(
        &self,
        particle: u32,
        bodies: &[Body<D>],
    ) -> Result<(), String> {
        let tie = &self.ties[particle as usize];
        let Some(bed) = tie.bed.as_ref().filter(|_| tie.divided) else {
            return Ok(());
        };
        if bed.still.len() + bed.movers.len() != tie.list.len() {
            return Err(format!("the bed of grain {particle} is not its list"));
        }
        for (place, found) in bed.still.iter().enumerate() {
            let body = &bodies[found.particle as usize];
            let (few, lane) = (&bed.resting[place / LANES], place % LANES);
            for axis in 0..D {
                let image = f64::from(found.turns[axis]) * self.periods[axis];
                let apart = body.position[axis] + image - self.anchor(particle)[axis];
                let rounding = 1.0e-12 * (body.position[axis].abs() + image.abs() + 1.0);
                if !body.still || (apart - few.places[axis][lane]).abs() > rounding {
                    return Err(format!(
                        "grain {} does not lie in the bed of grain {particle}",
                        found.particle
                    ));
                }
            }
        }
        Ok(())
    }
}
