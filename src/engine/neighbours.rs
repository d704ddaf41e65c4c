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

mod bed;
mod check;
mod saved;

use bed::Bed;
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

/// A grain's leash and list.
#[derive(Clone, Debug)]
struct Tie<const D: usize> {
    leash: f64,
    /// Whether the long leash suits it.
    lonely: bool,
    list: Vec<Found<D>>,
    /// Who lies still there, if anybody does.
    bed: Option<Box<Bed<D>>>,
    /// Whether the bed is that of the list as it is now.
    divided: bool,
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
            ties: positions.iter().map(|_| Tie::LOOSE).collect(),
            largest,
            periods: std::array::from_fn(|axis| {
                boundary.period(axis).map_or(0.0, |period| period.length)
            }),
        }
    }

    /// Adds a grain at rest at a position.
    pub(super) fn add(&mut self, position: Vector<D>) {
        self.cells.add(&position);
        self.ties.push(Tie::LOOSE);
    }

    /// Says how large a grain at rest may become as long as this grid serves, in
    /// d.
    pub(super) fn set_radius(&mut self, particle: u32, radius: f64) {
        let anchor = *self.anchor(particle);
        self.cells.seat_at(particle, &anchor, radius);
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
        ROUND * tie.leash - (position - self.anchor(particle)).norm_squared().sqrt()
    }

    /// Whether little enough slack is left to make the list anew.
    pub(super) fn is_stretched(&self, particle: u32, slack: f64) -> bool {
        slack < 0.2 * self.ties[particle as usize].leash
    }

    /// Ties a moving grain to an anchor a little ahead of it and makes its list
    /// anew. `radius` is its largest as long as this grid serves, in d.
    pub(super) fn tie(
        &mut self,
        particle: u32,
        position: &Vector<D>,
        velocity: &Vector<D>,
        radius: f64,
    ) {
        self.untie_partners(particle);
        let speed = velocity.norm_squared().sqrt();
        let mut list = std::mem::take(&mut self.ties[particle as usize].list);
        loop {
            let short = SHORT_LEASH * self.largest;
            let tie = &mut self.ties[particle as usize];
            tie.leash = if tie.lonely { self.longest } else { short };
            let leash = tie.leash;
            // Half a unit of time ahead, but well within the leash.
            let ahead = if speed > 0.0 {
                f64::min(0.5, 0.75 * leash / speed)
            } else {
                0.0
            };
            let anchor = position + velocity * ahead;
            self.cells.refile(particle, &anchor, radius + leash);
            self.gather(particle, radius, &mut list);
            let tie = &mut self.ties[particle as usize];
            if leash > short && list.len() > MANY {
                tie.lonely = false;
                continue;
            }
            tie.lonely |= list.len() <= FEW;
            break;
        }
        for other in &list {
            let tie = &mut self.ties[other.particle as usize];
            if tie.leash > 0.0 {
                tie.list.push(other.seen_from(particle));
                tie.mover_changed();
            }
        }
        let tie = &mut self.ties[particle as usize];
        tie.list = list;
        tie.spoil();
    }

    /// Forgets the list of a grain that has come to rest; those that move keep
    /// it on theirs, unless it has stopped out of their reach, where it would
    /// not find them again.
    pub(super) fn release(&mut self, particle: u32, position: &Vector<D>, radius: f64) {
        let tie = &mut self.ties[particle as usize];
        tie.leash = 0.0;
        tie.bed = None;
        tie.divided = false;
        for other in std::mem::take(&mut tie.list) {
            let theirs = &mut self.ties[other.particle as usize];
            theirs.spoil();
            let mut apart = self.cells.seat(other.particle).anchor - position;
            for (axis, turns) in other.turns.into_iter().enumerate() {
                apart[axis] += f64::from(turns) * self.periods[axis];
            }
            let reach = self.largest + theirs.leash;
            if apart.norm_squared() >= reach * reach {
                let entry = other.seen_from(particle);
                theirs.list.retain(|found| *found != entry);
            }
        }
        self.cells.refile(particle, position, radius);
    }

    /// Takes `turns` periods off a grain's position.
    pub(super) fn unwind(&mut self, particle: u32, axis: usize, turns: i32) {
        self.cells.unwind(particle, axis, turns);
        let mut list = {
            let tie = &mut self.ties[particle as usize];
            tie.spoil();
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
            self.ties[other as usize].spoil();
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
    fn gather(&self, particle: u32, radius: f64, list: &mut Vec<Found<D>>) {
        list.clear();
        let own = self.cells.seat(particle);
        let rings = self.rings_for(particle, radius + 0.5 * self.largest);
        self.cells.for_each_seat(particle, rings, |found, seat| {
            let mut apart = seat.anchor - own.anchor;
            if found.turns != [0; D] {
                for axis in 0..D {
                    apart[axis] += f64::from(found.turns[axis]) * self.periods[axis];
                }
            }
            let reach = own.reach + seat.reach;
            if apart.norm_squared() < reach * reach {
                list.push(found);
            }
        });
    }

    /// Takes a grain off the lists of all others.
    fn untie_partners(&mut self, particle: u32) {
        let mut partners = std::mem::take(&mut self.ties[particle as usize].list);
        let at_rest = self.ties[particle as usize].leash == 0.0;
        if at_rest {
            // It was at rest: only the others know who lists it.
            let rings = self.rings_for(particle, self.largest);
            let anchor = *self.anchor(particle);
            self.cells.for_each_seat(particle, rings, |found, seat| {
                let leash = self.ties[found.particle as usize].leash;
                let mut apart = seat.anchor - anchor;
                for axis in 0..D {
                    apart[axis] += f64::from(found.turns[axis]) * self.periods[axis];
                }
                // Farther off than this it is on nobody's list, see `release`.
                let reach = self.largest + leash;
                if leash > 0.0 && apart.norm_squared() * ROUND < reach * reach {
                    partners.push(found);
                }
            });
        }
        for other in &partners {
            let entry = other.seen_from(particle);
            let tie = &mut self.ties[other.particle as usize];
            if let Some(place) = tie.list.iter().position(|found| *found == entry) {
                tie.list.swap_remove(place);
                if at_rest {
                    tie.spoil();
                } else {
                    tie.mover_changed();
                }
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
    const LOOSE: Tie<D> = Tie {
        leash: 0.0,
        lonely: true,
        list: Vec::new(),
        bed: None,
        divided: false,
    };
}
