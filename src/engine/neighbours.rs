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

mod check;
mod saved;

pub(super) use saved::SavedNeighbours;

use crate::engine::cells::{Cells, Found};
use crate::model::Boundary;
use crate::particle::Vector;

/// Length of the shortest leash, over the largest diameter: for grains among
/// many.
const SHORT_LEASH: f64 = 0.2;
/// Length of the longest, for grains with hardly a neighbour.
const LONG_LEASH: f64 = 0.5;
/// How many neighbours a list should hold on average.
const WANTED: f64 = 9.0;
/// A grain whose long leash gives it more neighbours than this gets the short
/// one.
const MANY: usize = 16;
/// A grain whose short leash gives it no more than this gets the long one the
/// next time.
const FEW: usize = 3;

/// Grains farther away than this from where they started, over the largest
/// diameter, have escaped.
const ESCAPE: f64 = 2.0e6;

/// Leaves room for rounding.
const ROUND: f64 = 1.0 - 1.0e-9;

/// A grain's anchor, leash and list.
#[derive(Clone, Debug)]
struct Tie<const D: usize> {
    anchor: Vector<D>,
    leash: f64,
    /// Whether the long leash suits it.
    lonely: bool,
    list: Vec<Found<D>>,
}

/// The grid and the lists.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<const D: usize> {
    cells: Cells<D>,
    ties: Vec<Tie<D>>,
    /// Largest contact distance this was made for, in d.
    largest: f64,
    /// The long leash, in d.
    longest: f64,
    periods: [f64; D],
}

impl<const D: usize> Neighbours<D> {
    /// Without lists yet, for grains at these positions whose centres touch at
    /// no more than `largest`.
    pub(super) fn new<B: Boundary<D>>(boundary: &B, positions: &[Vector<D>], largest: f64) -> Self {
        let long = leash_for(Cells::crowding(boundary, positions, largest), D);
        // Everybody is found in adjacent cells.
        let reach = (1.0 + 2.0 * long) * largest;
        Neighbours {
            cells: Cells::new(boundary, positions, reach),
            longest: long * largest,
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

    /// Whether a position is so far outside that a grain there has escaped.
    pub(super) fn is_lost(&self, position: &Vector<D>) -> bool {
        self.cells.outside(position) > ESCAPE * self.largest
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
        loop {
            let short = SHORT_LEASH * self.largest;
            let tie = &mut self.ties[particle as usize];
            tie.leash = if tie.lonely { self.longest } else { short };
            // Half a unit of time ahead, but well within the leash.
            let ahead = if speed > 0.0 {
                f64::min(0.5, 0.75 * tie.leash / speed)
            } else {
                0.0
            };
            tie.anchor = position + velocity * ahead;
            let (anchor, leash) = (tie.anchor, tie.leash);
            let mut list = std::mem::take(&mut tie.list);
            self.cells.refile(particle, &anchor);
            self.gather(particle, &radius_of, &mut list);
            let tie = &mut self.ties[particle as usize];
            tie.list = list;
            if leash > short && tie.list.len() > MANY {
                tie.lonely = false;
                continue;
            }
            tie.lonely |= tie.list.len() <= FEW;
            break;
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
    /// it on theirs, unless it has stopped out of their reach, where it would
    /// not find them again.
    pub(super) fn release(&mut self, particle: u32, position: &Vector<D>) {
        let tie = &mut self.ties[particle as usize];
        tie.anchor = *position;
        tie.leash = 0.0;
        for other in std::mem::take(&mut tie.list) {
            let theirs = &mut self.ties[other.particle as usize];
            let mut apart = theirs.anchor - position;
            for (axis, turns) in other.turns.into_iter().enumerate() {
                apart[axis] += f64::from(turns) * self.periods[axis];
            }
            let reach = self.largest + theirs.leash;
            if apart.norm_squared() >= reach * reach {
                let entry = other.seen_from(particle);
                theirs.list.retain(|found| *found != entry);
            }
        }
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
        for place in 0..list.len() {
            let other = list[place].particle;
            list[place].turns[axis] -= turns;
            // In a narrow box several images of one grain are on the list: theirs
            // are turned all at once, or one might be taken for another that has
            // been turned already.
            if list[..place].iter().any(|found| found.particle == other) {
                continue;
            }
            let theirs = &mut self.ties[other as usize].list;
            for found in theirs.iter_mut().filter(|found| found.particle == particle) {
                found.turns[axis] += turns;
            }
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
            .for_each_near(particle, self.rings_for(particle, distance), visit);
    }

    /// Whether looking farther than `distance`, in d, finds nobody new.
    pub(super) fn is_everything(&self, particle: u32, distance: f64) -> bool {
        self.rings_for(particle, distance) >= self.cells.rings()
    }

    fn rings_for(&self, particle: u32, distance: f64) -> i32 {
        let spread = distance + self.ties[particle as usize].leash + self.longest;
        let rings = libm::ceil(spread / self.cells.least_edge());
        (rings.clamp(1.0, 1.0e6) as i32).min(self.cells.rings())
    }

    /// Lists everybody whose anchor is near enough to that of `particle`.
    fn gather(&self, particle: u32, radius_of: &impl Fn(u32) -> f64, list: &mut Vec<Found<D>>) {
        list.clear();
        let Tie { anchor, leash, .. } = self.ties[particle as usize];
        let own = radius_of(particle) + leash;
        let rings = self.rings_for(particle, radius_of(particle) + 0.5 * self.largest);
        self.cells.for_each_near(particle, rings, |found| {
            let tie = &self.ties[found.particle as usize];
            let mut apart = tie.anchor - anchor;
            if found.turns != [0; D] {
                for axis in 0..D {
                    apart[axis] += f64::from(found.turns[axis]) * self.periods[axis];
                }
            }
            let reach = own + tie.leash + radius_of(found.particle);
            if apart.norm_squared() < reach * reach {
                list.push(found);
            }
        });
    }

    /// Takes a grain off the lists of all others.
    fn untie_partners(&mut self, particle: u32) {
        let mut partners = std::mem::take(&mut self.ties[particle as usize].list);
        if self.ties[particle as usize].leash == 0.0 {
            // It was at rest: only the others know who lists it.
            let rings = self.rings_for(particle, self.largest);
            self.cells
                .for_each_near(particle, rings, |found| partners.push(found));
        }
        for other in &partners {
            let entry = other.seen_from(particle);
            let list = &mut self.ties[other.particle as usize].list;
            if let Some(place) = list.iter().position(|found| *found == entry) {
                list.swap_remove(place);
            }
        }
        // To be filled again.
        partners.clear();
        self.ties[particle as usize].list = partners;
    }
}

/// The leash, over the largest diameter, with which a grain has as many
/// neighbours as wanted where there are `crowding` centres in the volume d^D.
fn leash_for(crowding: f64, dimension: usize) -> f64 {
    // A disk or a ball; in more dimensions good enough for this purpose.
    let ball = if dimension == 2 {
        std::f64::consts::PI
    } else {
        4.0 / 3.0 * std::f64::consts::PI
    };
    let radius = libm::pow(WANTED / (crowding * ball), 1.0 / dimension as f64);
    (0.5 * (radius - 1.0)).clamp(SHORT_LEASH, LONG_LEASH)
}

impl<const D: usize> Tie<D> {
    /// At rest.
    fn at(position: Vector<D>) -> Self {
        Tie {
            anchor: position,
            leash: 0.0,
            lonely: true,
            list: Vec::new(),
        }
    }
}
