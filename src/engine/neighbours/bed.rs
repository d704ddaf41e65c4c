//! The grains at rest on a list, laid out to be looked at all at once.
//!
//! Most events of a deposit are those of a grain that rattles among a few that
//! sleep. Their places from its anchor are kept side by side, so that nothing
//! has to be fetched from afar.

use crate::engine::body::Body;
use crate::engine::cells::Found;
use crate::engine::neighbours::Neighbours;
use crate::model::{LANES, Resting};
use crate::particle::Vector;

/// A list, divided into those at rest and those that move.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Bed<const D: usize> {
    /// Whether this is the list as it is now. A grain among the movers may have
    /// come to rest since; none of those at rest may have been moved.
    fresh: bool,
    pub(in crate::engine) resting: Vec<Resting<D>>,
    /// Who lies there, in this order.
    pub(in crate::engine) still: Vec<Found<D>>,
    /// Who moves; left empty if nobody lies there.
    movers: Vec<Found<D>>,
}

impl<const D: usize> Bed<D> {
    pub(in crate::engine) const EMPTY: Bed<D> = Bed {
        fresh: false,
        resting: Vec::new(),
        still: Vec::new(),
        movers: Vec::new(),
    };

    /// The list has changed, or one of those at rest is going to.
    #[inline]
    pub(super) fn spoil(&mut self) {
        self.fresh = false;
    }

    /// A grain that moves has come to the list or left it: if nobody there is at
    /// rest, the list itself is all there is to know.
    #[inline]
    pub(super) fn mover_changed(&mut self) {
        self.fresh &= self.resting.is_empty();
    }

    fn make(
        &mut self,
        list: &[Found<D>],
        anchor: &Vector<D>,
        radius: f64,
        periods: &[f64; D],
        bodies: &[Body<D>],
    ) {
        self.resting.clear();
        self.still.clear();
        self.movers.clear();
        if !list
            .iter()
            .any(|found| bodies[found.particle as usize].still)
        {
            self.fresh = true;
            return;
        }
        for found in list {
            let body = &bodies[found.particle as usize];
            if !body.still {
                self.movers.push(*found);
                continue;
            }
            let lane = self.still.len() % LANES;
            if lane == 0 {
                self.resting.push(Resting {
                    places: [[0.0; LANES]; D],
                    distances: [0.0; LANES],
                });
            }
            self.still.push(*found);
            if let Some(last) = self.resting.last_mut() {
                for axis in 0..D {
                    let image = f64::from(found.turns[axis]) * periods[axis];
                    last.places[axis][lane] = (body.position[axis] - anchor[axis]) + image;
                }
                last.distances[lane] = radius + body.radius;
            }
        }
        self.fresh = true;
    }
}

impl<const D: usize> Neighbours<D> {
    /// The list of a grain, divided: those at rest, and those that move.
    #[inline]
    pub(in crate::engine) fn bed(
        &mut self,
        particle: u32,
        bodies: &[Body<D>],
    ) -> (&Bed<D>, &[Found<D>]) {
        let tie = &mut self.ties[particle as usize];
        if !tie.bed.fresh {
            let radius = bodies[particle as usize].radius;
            let anchor = &self.cells.seat(particle).anchor;
            tie.bed
                .make(&tie.list, anchor, radius, &self.periods, bodies);
        }
        let movers = if tie.bed.resting.is_empty() {
            &tie.list
        } else {
            &tie.bed.movers
        };
        (&tie.bed, movers)
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
        if !tie.bed.fresh {
            return Ok(());
        }
        let divided = tie.bed.still.len() + tie.bed.movers.len();
        if divided != tie.list.len() && !tie.bed.still.is_empty() {
            return Err(format!("the bed of grain {particle} is not its list"));
        }
        for (place, found) in tie.bed.still.iter().enumerate() {
            let body = &bodies[found.particle as usize];
            let (few, lane) = (&tie.bed.resting[place / LANES], place % LANES);
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
