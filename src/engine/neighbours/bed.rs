//! The grains at rest on a list, laid out to be looked at all at once.
//!
//! Most events of a deposit are those of a grain that rattles among a few that
//! sleep. Their places from its anchor are kept side by side, so that nothing
//! has to be fetched from afar.

use std::hint::black_box;

use crate::engine::body::Body;
use crate::engine::cells::{Cells, Link};
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
    pub(in crate::engine) still: Vec<Link<D>>,
    movers: Vec<Link<D>>,
}

impl<const D: usize> Bed<D> {
    const EMPTY: Self = Bed {
        resting: Vec::new(),
        still: Vec::new(),
        movers: Vec::new(),
    };

    /// Makes it anew, in the room it has.
    fn make(
        &mut self,
        list: &[Link<D>],
        place: &Vector<D>,
        radius: f64,
        cells: &Cells<D>,
        bodies: &[Body<D>],
    ) {
        self.resting.clear();
        self.still.clear();
        self.movers.clear();
        // No more room than it takes: there are many beds.
        let still = list
            .iter()
            .filter(|link| bodies[link.particle() as usize].still);
        let still = still.count();
        self.resting.reserve_exact(still.div_ceil(LANES));
        self.still.reserve_exact(still);
        self.movers.reserve_exact(list.len() - still);
        for link in list {
            let body = &bodies[link.particle() as usize];
            if !body.still {
                self.movers.push(*link);
                continue;
            }
            let lane = self.still.len() % LANES;
            if lane == 0 {
                self.resting.push(Resting {
                    places: [[0.0; LANES]; D],
                    distances: [0.0; LANES],
                });
            }
            self.still.push(*link);
            // Those at rest are filed where they are.
            let home = body.position - cells.home_shift(link.particle());
            let image = cells.shift(Link::<D>::turns_of(link.image()));
            if let Some(last) = self.resting.last_mut() {
                for axis in 0..D {
                    last.places[axis][lane] = (home[axis] - place[axis]) + image[axis];
                }
                last.distances[lane] = radius + body.radius;
            }
        }
    }
}

impl<const D: usize> Bed<D> {
    /// Who moves.
    #[inline]
    pub(in crate::engine) fn movers(&self) -> &[Link<D>] {
        &self.movers
    }

    /// Reads it, to have it at hand.
    #[inline]
    pub(in crate::engine) fn touch(&self) {
        for few in &self.resting {
            for places in &few.places {
                black_box(places[0]);
            }
            black_box(few.distances);
        }
        for few in self.still.chunks(8).chain(self.movers.chunks(8)) {
            black_box(few[0]);
        }
    }
}

impl<const D: usize> Tie<D> {
    /// Takes somebody off the list who moves.
    #[inline]
    pub(super) fn forget(&mut self, link: Link<D>) {
        if let Some(place) = self.list.iter().position(|listed| *listed == link) {
            self.list.swap_remove(place);
            self.mover_changed();
        }
    }

    /// The list has changed, or one of those at rest is going to.
    #[inline]
    pub(super) fn spoil(&mut self) {
        self.divided = false;
    }

    /// Divides the list into those at rest, if there are any, and the others.
    #[inline(never)]
    fn divide(&mut self, particle: u32, cells: &Cells<D>, bodies: &[Body<D>]) {
        let is_still = |link: &Link<D>| bodies[link.particle() as usize].still;
        if self.list.iter().any(is_still) {
            let radius = bodies[particle as usize].radius;
            let bed = self.bed.get_or_insert_with(|| Box::new(Bed::EMPTY));
            bed.make(&self.list, &self.home, radius, cells, bodies);
        } else {
            self.bed = None;
        }
        self.divided = true;
    }

    /// A grain that moves has come to the list or left it: if nobody there is at
    /// rest, the list itself is all there is to know.
    #[inline]
    pub(super) fn mover_changed(&mut self) {
        self.divided &= self.bed.is_none();
    }
}

impl<const D: usize> Neighbours<D> {
    /// Sees to it that the [bed](Self::bed) of a grain is that of its list, if there is
    /// anybody at all at rest.
    #[inline]
    pub(in crate::engine) fn make_bed(
        &mut self,
        particle: u32,
        anybody_rests: bool,
        bodies: &[Body<D>],
    ) {
        if let Some(tie) = self.ties.own(particle)
            && !tie.divided
        {
            if anybody_rests {
                tie.divide(particle, &self.cells, bodies);
            } else {
                tie.bed = None;
                tie.divided = true;
            }
        }
    }

    /// Those at rest on the list of a grain, if anybody is, and those that move.
    #[inline]
    pub(in crate::engine) fn bed(&self, particle: u32) -> (Option<&Bed<D>>, &[Link<D>]) {
        let tie = &self.ties[particle];
        match &tie.bed {
            Some(bed) => (Some(bed), &bed.movers),
            None => (None, &tie.list),
        }
    }

    /// Who lies still in a bed has to, and where it is said to.
    pub(in crate::engine) fn check_bed(
        &self,
        particle: u32,
        bodies: &[Body<D>],
    ) -> Result<(), String> {
        let tie = &self.ties[particle];
        let Some(bed) = tie.bed.as_ref().filter(|_| tie.divided) else {
            return Ok(());
        };
        if bed.still.len() + bed.movers.len() != tie.list.len() {
            return Err(format!("the bed of grain {particle} is not its list"));
        }
        for (place, link) in bed.still.iter().enumerate() {
            let found = self.found(particle, *link);
            let body = &bodies[found.particle as usize];
            let (few, lane) = (&bed.resting[place / LANES], place % LANES);
            let images = self.cells.shift(found.turns);
            for axis in 0..D {
                let image = images[axis];
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
