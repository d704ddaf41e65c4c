//! Neighbour lists: for every grain that moves, all it could meet soon.
//!
//! A moving grain is tied to an *anchor* by a *leash*: as long as its centre is
//! no farther from the anchor than the leash is long, its list holds everybody
//! it can touch. Two grains are on each other's lists if their anchors are
//! nearer than the contact distance and both leashes. Grains at rest have a
//! leash of length 0 and no list; those that move list them.
//! (Verlet 1967, doi:10.1103/PhysRev.159.98; one list renewed at a time as in
//! Donev, Torquato & Stillinger 2005, doi:10.1016/j.jcp.2004.08.014.)
//!
//! What is listed, and when, decides only how much has to be predicted: it
//! never changes a trajectory.

use crate::engine::cells::{Cells, Found};
use crate::model::Boundary;
use crate::particle::Vector;

/// Length of a leash among many neighbours and among few, over the largest
/// diameter.
const SHORT_LEASH: f64 = 0.2;
const LONG_LEASH: f64 = 0.5;
/// A list longer than this is made again with the short leash.
const MANY: usize = 10;

/// How near the surfaces of two grains may be, over the largest diameter, to
/// be found in adjacent cells wherever they are on their leashes.
const MARGIN: f64 = 1.1;

/// Leaves room for rounding.
const ROUND: f64 = 1.0 - 1.0e-9;

/// A grain's anchor, leash and list.
#[derive(Clone, Debug)]
struct Tie<const D: usize> {
    anchor: Vector<D>,
    leash: f64,
    list: Vec<Found<D>>,
}

/// The grid and the lists.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<const D: usize> {
    cells: Cells<D>,
    ties: Vec<Tie<D>>,
    /// Largest contact distance this was made for, in d.
    largest: f64,
    periods: [f64; D],
}

impl<const D: usize> Neighbours<D> {
    /// Without lists yet, for grains at these positions whose centres touch at
    /// no more than `largest`.
    pub(super) fn new<B: Boundary<D>>(boundary: &B, positions: &[Vector<D>], largest: f64) -> Self {
        let reach = (MARGIN + 2.0 * LONG_LEASH) * largest;
        Neighbours {
            cells: Cells::new(boundary, positions, reach),
            ties: positions
                .iter()
                .map(|position| Tie::at(*position))
                .collect(),
            largest,
            periods: std::array::from_fn(|axis| {
                boundary.period(axis).map_or(0.0, |period| period.length)
            }),
        }
    }

    /// Adds a grain at rest at a position.
    pub(super) fn add(&mut self, position: Vector<D>) {
        self.cells.add(&position);
        self.ties.push(Tie::at(position));
    }

    /// Takes back the grain that was added last.
    pub(super) fn forget_last(&mut self) {
        self.cells.forget_last();
        self.ties.pop();
    }

    /// Largest contact distance this was made for, in d.
    pub(super) fn largest(&self) -> f64 {
        self.largest
    }

    /// The list of a grain; empty if it is at rest.
    pub(super) fn list(&self, particle: u32) -> &[Found<D>] {
        &self.ties[particle as usize].list
    }

    /// Whether a grain has a list.
    pub(super) fn is_tied(&self, particle: u32) -> bool {
        self.ties[particle as usize].leash > 0.0
    }

    /// How far a grain may still move from `position`, in d; negative if too
    /// far already.
    pub(super) fn slack(&self, particle: u32, position: &Vector<D>) -> f64 {
        let tie = &self.ties[particle as usize];
        ROUND * tie.leash - (position - tie.anchor).norm()
    }

    /// Whether little enough slack is left to make the list anew.
    pub(super) fn is_stretched(&self, particle: u32, slack: f64) -> bool {
        slack < 0.2 * self.ties[particle as usize].leash
    }

    /// Ties a moving grain to an anchor a little ahead of it and makes its list
    /// anew. `radius_of` gives radii now, in d.
    pub(super) fn tie(
        &mut self,
        particle: u32,
        position: &Vector<D>,
        velocity: &Vector<D>,
        radius_of: impl Fn(u32) -> f64,
    ) {
        self.untie_partners(particle);
        let speed = velocity.norm();
        for length in [LONG_LEASH, SHORT_LEASH] {
            let leash = length * self.largest;
            let tie = &mut self.ties[particle as usize];
            tie.leash = leash;
            // Half a unit of time ahead, but well within the leash.
            let ahead = if speed > 0.0 {
                f64::min(0.5, 0.75 * leash / speed)
            } else {
                0.0
            };
            tie.anchor = position + velocity * ahead;
            let anchor = tie.anchor;
            self.cells.refile(particle, &anchor);
            let list = self.gather(particle, radius_of(particle) + leash, &radius_of);
            let enough = list.len() <= MANY;
            self.ties[particle as usize].list = list;
            if enough {
                break;
            }
        }
        let list = std::mem::take(&mut self.ties[particle as usize].list);
        for other in &list {
            let tie = &mut self.ties[other.particle as usize];
            if tie.leash > 0.0 {
                tie.list.push(other.seen_from(particle));
            }
        }
        self.ties[particle as usize].list = list;
    }

    /// Forgets the list of a grain that has come to rest; those that move keep
    /// it on theirs.
    pub(super) fn release(&mut self, particle: u32, position: &Vector<D>) {
        let tie = &mut self.ties[particle as usize];
        tie.anchor = *position;
        tie.leash = 0.0;
        tie.list = Vec::new();
        self.cells.refile(particle, position);
    }

    /// Takes `turns` periods off a grain's position.
    pub(super) fn unwind(&mut self, particle: u32, axis: usize, turns: i32) {
        self.cells.unwind(particle, axis, turns);
        let mut list = {
            let tie = &mut self.ties[particle as usize];
            tie.anchor[axis] -= f64::from(turns) * self.periods[axis];
            std::mem::take(&mut tie.list)
        };
        for other in &mut list {
            let entry = other.seen_from(particle);
            let theirs = &mut self.ties[other.particle as usize].list;
            if let Some(place) = theirs.iter().position(|found| *found == entry) {
                theirs[place].turns[axis] += turns;
            }
            other.turns[axis] -= turns;
        }
        self.ties[particle as usize].list = list;
    }

    /// Calls `visit` for every grain whose centre may be nearer to that of
    /// `particle` than `distance`, in d, and for some that are not; itself left
    /// out.
    pub(super) fn for_each_within(
        &self,
        particle: u32,
        distance: f64,
        visit: impl FnMut(Found<D>),
    ) {
        self.cells
            .for_each_near(particle, self.rings_for(distance), visit);
    }

    /// Whether looking farther than `distance`, in d, finds nobody new.
    pub(super) fn is_everything(&self, distance: f64) -> bool {
        self.rings_for(distance) >= self.cells.rings()
    }

    fn rings_for(&self, distance: f64) -> i32 {
        let spread = distance + 2.0 * LONG_LEASH * self.largest;
        let rings = libm::ceil(spread / self.cells.least_edge());
        (rings.clamp(1.0, 1.0e6) as i32).min(self.cells.rings())
    }

    /// Everybody whose anchor is near enough to that of `particle`.
    fn gather(&self, particle: u32, own: f64, radius_of: &impl Fn(u32) -> f64) -> Vec<Found<D>> {
        let anchor = self.ties[particle as usize].anchor;
        let mut list = Vec::with_capacity(16);
        self.cells.for_each_near(particle, 1, |found| {
            let tie = &self.ties[found.particle as usize];
            let mut apart = tie.anchor - anchor;
            for axis in 0..D {
                apart[axis] += f64::from(found.turns[axis]) * self.periods[axis];
            }
            let reach = own + tie.leash + radius_of(found.particle);
            if apart.norm_squared() < reach * reach {
                list.push(found);
            }
        });
        list
    }

    /// Takes a grain off the lists of all others.
    fn untie_partners(&mut self, particle: u32) {
        let mut partners = std::mem::take(&mut self.ties[particle as usize].list);
        if self.ties[particle as usize].leash == 0.0 {
            // It was at rest: only the others know who lists it.
            partners.clear();
            self.cells
                .for_each_near(particle, 1, |found| partners.push(found));
        }
        for other in &partners {
            let entry = other.seen_from(particle);
            let list = &mut self.ties[other.particle as usize].list;
            if let Some(place) = list.iter().position(|found| *found == entry) {
                list.swap_remove(place);
            }
        }
    }
}

impl<const D: usize> Tie<D> {
    /// At rest.
    fn at(position: Vector<D>) -> Self {
        Tie {
            anchor: position,
            leash: 0.0,
            list: Vec::new(),
        }
    }
}
