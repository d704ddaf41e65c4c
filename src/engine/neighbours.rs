//! Neighbour lists: for every grain that moves, all it could meet soon.
//!
//! A moving grain is tied to an *anchor* by a *leash*: as long as its centre is
//! no farther from the anchor than the leash is long, its list holds everybody
//! it can touch. Two grains are on each other's lists if their anchors are
//! nearer than the contact distance and both leashes, and perhaps if they are
//! farther apart by a rounding to seven digits. Grains at rest have a
//! leash of length 0 and no list; those that move list them.
//! (Verlet 1967, doi:10.1103/PhysRev.159.98; one list renewed at a time as in
//! Donev, Torquato & Stillinger 2005, doi:10.1016/j.jcp.2004.08.014.)
//!
//! What is listed, and when, decides only how much has to be predicted: it
//! never changes a trajectory.

mod bed;
mod changes;
mod check;
mod saved;

use std::hint::black_box;

use bed::Bed;
use changes::Changes;
pub(super) use saved::SavedNeighbours;

use crate::engine::cells::{Cells, Found, Link};
use crate::engine::sparse::Sparse;
use crate::model::Boundary;
use crate::particle::Vector;

/// Length of the shortest leash, over the largest diameter: for grains among
/// many.
const SHORT_LEASH: f64 = 0.2;
/// Length of the longest, for grains with hardly a neighbour.
const LONG_LEASH: f64 = 0.6;
/// How many neighbours a list should hold on average.
const WANTED: f64 = 10.0;
/// A grain whose long leash gives it more neighbours than this gets the short
/// one.
const MANY: usize = 16;
/// A grain whose short leash gives it no more than this gets the long one the
/// next time.
const FEW: usize = 3;

/// Grains farther away than this from where they started, over the largest
/// diameter, have escaped.
const ESCAPE: f64 = 2.0e6;

/// Edge of a cell, over the distance of two grains that may be on each other's lists.
/// Of longer cells fewer have to be looked at, with more grains in them.
const EDGE: f64 = 1.5;

/// Leaves room for rounding.
const ROUND: f64 = 1.0 - 1.0e-9;

/// A grain's leash and list.
#[derive(Clone, Debug)]
struct Tie<const D: usize> {
    /// The anchor, in the image that lies in the grid; in d.
    home: Vector<D>,
    /// How far from there its surface may be, in d.
    reach: f64,
    leash: f64,
    /// Whether the long leash suits it.
    lonely: bool,
    list: Vec<Link<D>>,
    /// Who lies still there, if anybody does.
    bed: Option<Box<Bed<D>>>,
    /// Whether the bed is that of the list as it is now.
    divided: bool,
}

/// The grid and the lists.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<const D: usize> {
    cells: Cells<D>,
    ties: Sparse<Tie<D>>,
    /// Largest contact distance this was made for, in d.
    largest: f64,
    /// The long leash, in d.
    longest: f64,
    /// Room for a list in the making.
    fresh: Vec<Link<D>>,
    /// Who was not on the list made last before it was made, or is no longer on it.
    changes: Changes<D>,
}

impl<const D: usize> Neighbours<D> {
    /// Without lists yet, for grains at these positions whose centres touch at
    /// no more than `largest`.
    pub(super) fn new<B: Boundary<D>>(boundary: &B, positions: &[Vector<D>], largest: f64) -> Self {
        let long = leash_for(Cells::crowding(boundary, positions, largest), D);
        let reach = (1.0 + 2.0 * long) * largest;
        Neighbours {
            cells: Cells::new(boundary, positions, EDGE * reach),
            longest: long * largest,
            ties: Sparse::new(positions.len(), Tie::loose()),
            largest,
            fresh: Vec::new(),
            changes: Changes::NONE,
        }
    }

    /// Lets nobody find some of the grains, before they are tied or released.
    pub(super) fn leave_out(&mut self, left_out: impl Fn(u32) -> bool) {
        self.cells.leave_out(left_out);
    }

    /// Adds a grain at rest at a position.
    pub(super) fn add(&mut self, position: Vector<D>) {
        self.cells.add(&position);
        self.ties.push();
    }

    /// Says how large a grain without a list may become as long as this grid serves, in
    /// d.
    pub(super) fn set_radius(&mut self, particle: u32, position: &Vector<D>, radius: f64) {
        self.cells.refile(particle, position, radius);
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

    /// Reads where a grain is filed and how it is tied, to have that at hand.
    #[inline]
    pub(super) fn touch(&self, particle: u32) {
        black_box(self.ties[particle].leash);
        black_box(self.cells.turns(particle)[0]);
    }

    /// The same for its list.
    #[inline]
    pub(super) fn touch_list(&self, particle: u32) {
        let tie = &self.ties[particle];
        if let Some(bed) = &tie.bed {
            black_box((bed.resting.len(), bed.still.len(), bed.movers().len()));
            return;
        }
        // A cache line holds eight.
        for few in tie.list.chunks(8) {
            black_box(few[0]);
        }
    }

    /// The list of a grain; empty if it is at rest.
    pub(super) fn list(&self, particle: u32) -> impl Iterator<Item = Found<D>> {
        let list = self.ties[particle].list.iter();
        list.map(move |link| self.cells.found(particle, *link))
    }

    /// Whom the list that has just been made names and the one before did not.
    pub(super) fn newcomers(&self) -> &[Link<D>] {
        &self.changes.come
    }

    /// Somebody on the list of a grain.
    pub(super) fn listed(&self, particle: u32, other: u32) -> Option<Link<D>> {
        let mut list = self.ties[particle].list.iter();
        list.find(|link| link.particle() == other).copied()
    }

    /// The same, as it is kept.
    #[inline]
    pub(super) fn links(&self, particle: u32) -> &[Link<D>] {
        &self.ties[particle].list
    }

    /// A link of a grain's list, in terms of where grains are stored.
    #[inline]
    pub(super) fn found(&self, particle: u32, link: Link<D>) -> Found<D> {
        self.cells.found(particle, link)
    }

    /// From the image of a grain in the grid to the one that is stored, in d.
    #[inline]
    pub(super) fn home_shift(&self, particle: u32) -> Vector<D> {
        self.cells.home_shift(particle)
    }

    /// What to add to the place of a grain in the grid to get the image of a
    /// link, in d.
    #[inline]
    pub(super) fn link_shift(&self, link: Link<D>) -> Vector<D> {
        self.cells.shift(Link::<D>::turns_of(link.image()))
    }

    /// From the image of a grain in the grid to the one that is stored, in
    /// periods.
    #[inline]
    pub(super) fn turns(&self, particle: u32) -> [i32; D] {
        self.cells.turns(particle)
    }

    /// The place that a grain with a list is tied to, in the image it is stored in.
    #[inline]
    pub(super) fn anchor(&self, particle: u32) -> Vector<D> {
        self.ties[particle].home + self.home_shift(particle)
    }

    /// Where a grain is filed, in the image that lies in the grid, in d: at its anchor, or
    /// where it is, in the image that is stored, if it has no list.
    #[inline]
    fn home(&self, particle: u32, stored: &Vector<D>) -> Vector<D> {
        if self.ties.has(particle) {
            self.ties[particle].home
        } else {
            stored - self.home_shift(particle)
        }
    }

    /// Whether a position is so far outside that a grain there has escaped.
    pub(super) fn is_lost(&self, position: &Vector<D>) -> bool {
        self.cells.outside(position) > ESCAPE * self.largest
    }

    /// Who has a list, in order.
    pub(super) fn tied(&self) -> impl Iterator<Item = u32> {
        self.ties.each().map(|(particle, _)| particle)
    }

    /// Whether somebody lies still on the list of a grain.
    #[inline]
    pub(super) fn has_bed(&self, particle: u32) -> bool {
        self.ties[particle].bed.is_some()
    }

    /// Whether a grain has a list.
    pub(super) fn is_tied(&self, particle: u32) -> bool {
        self.ties.has(particle)
    }

    /// How far from its anchor a grain may go, in d.
    #[inline]
    pub(super) fn leash(&self, particle: u32) -> f64 {
        ROUND * self.ties[particle].leash
    }

    /// How far from its anchor a grain with a list reaches as long as this grid serves,
    /// in d.
    pub(super) fn reach(&self, particle: u32) -> f64 {
        self.ties[particle].reach
    }

    /// How far a grain with a list may still move from `position`, in d; negative if too
    /// far already.
    #[inline]
    pub(super) fn slack(&self, particle: u32, position: &Vector<D>) -> f64 {
        self.leash(particle) - (position - self.anchor(particle)).norm_squared().sqrt()
    }

    /// Whether little enough slack is left to make the list anew.
    pub(super) fn is_stretched(&self, particle: u32, slack: f64) -> bool {
        slack < 0.2 * self.ties[particle].leash
    }

    /// Ties a moving grain to an anchor a little ahead of it and makes its list
    /// anew. Something happens to it in `wait`, in √(d/g); `radius` is its largest as long
    /// as this grid serves, in d. `untied` says where somebody without a list is, as it is
    /// stored, and its largest radius.
    pub(super) fn tie(
        &mut self,
        particle: u32,
        position: &Vector<D>,
        velocity: &Vector<D>,
        wait: f64,
        radius: f64,
        untied: impl Fn(u32) -> (Vector<D>, f64),
    ) {
        if !self.ties.has(particle) {
            self.forget_at_rest(particle, position);
        }
        let speed = velocity.norm_squared().sqrt();
        let short = SHORT_LEASH * self.largest;
        let image = self.cells.turns(particle);
        let mut list = std::mem::take(&mut self.fresh);
        loop {
            let tie = self.ties.make(particle);
            tie.leash = if tie.lonely { self.longest } else { short };
            let leash = tie.leash;
            // Where something happens to it, but no more than half a unit of time ahead and
            // well within the leash.
            let ahead = if speed > 0.0 {
                f64::min(wait.min(0.5), 0.75 * leash / speed)
            } else {
                0.0
            };
            let anchor = position + velocity * ahead;
            tie.reach = radius + leash;
            tie.home = self.cells.refile(particle, &anchor, tie.reach);
            self.gather(particle, &untied, &mut list);
            let tie = self.ties.make(particle);
            if leash > short && list.len() > MANY {
                tie.lonely = false;
                continue;
            }
            tie.lonely |= list.len() <= FEW;
            break;
        }
        let mut old = std::mem::take(&mut self.ties.make(particle).list);
        self.changes.find(&old, &list);
        for link in &self.changes.gone {
            if let Some(tie) = self.ties.own(link.particle()) {
                tie.forget(link.seen_from(particle));
            }
        }
        for link in &self.changes.come {
            if let Some(tie) = self.ties.own(link.particle()) {
                tie.list.push(link.seen_from(particle));
                tie.mover_changed();
            }
        }
        old.clear();
        old.extend_from_slice(&list);
        if self.cells.turns(particle) != image {
            // Filed in another image, its links mean others than before.
            self.changes.come.clone_from(&list);
        }
        self.fresh = list;
        let tie = self.ties.make(particle);
        tie.list = old;
        tie.spoil();
    }

    /// Forgets the list of a grain that has come to rest; those that move keep
    /// it on theirs, unless it has stopped out of their reach, where it would
    /// not find them again.
    pub(super) fn release(&mut self, particle: u32, position: &Vector<D>, radius: f64) {
        let tied = self.ties.own(particle);
        let list = tied.map_or_else(Vec::new, |tie| std::mem::take(&mut tie.list));
        self.ties.clear(particle);
        let before = self.cells.turns(particle);
        let home = self.cells.refile(particle, position, radius);
        let after = self.cells.turns(particle);
        for other in list {
            let Some(theirs) = self.ties.own(other.particle()) else {
                continue;
            };
            theirs.spoil();
            let mut turns = Link::<D>::turns_of(other.image());
            for axis in 0..D {
                // It may be filed in another image now.
                turns[axis] += before[axis] - after[axis];
            }
            let link = Link::new(other.particle(), Link::<D>::image_of(&turns));
            let apart = theirs.home - home + self.cells.shift(turns);
            let reach = self.largest + theirs.leash;
            let within = apart.norm_squared() < reach * reach;
            if !within || link != other {
                theirs.forget(other.seen_from(particle));
            }
            if within && link != other {
                theirs.list.push(link.seen_from(particle));
            }
        }
    }

    /// Takes `turns` periods off a grain's position.
    pub(super) fn unwind(&mut self, particle: u32, axis: usize, turns: i32) {
        self.cells.unwind(particle, axis, turns);
    }

    /// Calls `visit` for every grain whose centre may be nearer to that of
    /// `particle`, which is at `position`, than `distance`, in d, and for some that are not;
    /// itself left out.
    pub(super) fn for_each_within(
        &self,
        particle: u32,
        position: &Vector<D>,
        distance: f64,
        mut visit: impl FnMut(Found<D>),
    ) {
        let home = self.home(particle, position);
        let reach = self.spread(particle, distance);
        let farthest = reach + self.longest;
        if reach <= 2.0 * (self.largest + self.longest) {
            self.cells
                .for_each_in_reach(particle, &home, farthest, reach, |link, _| {
                    visit(self.cells.found(particle, link));
                });
        } else {
            self.cells.for_each_found(particle, &home, farthest, visit);
        }
    }

    /// Whether looking farther than `distance`, in d, finds nobody new.
    pub(super) fn is_everything(&self, particle: u32, distance: f64) -> bool {
        self.spread(particle, distance) >= self.cells.farthest()
    }

    /// How far from its anchor somebody may be who is at a distance from a grain, without
    /// what that one may have moved, in d.
    fn spread(&self, particle: u32, distance: f64) -> f64 {
        distance + self.ties[particle].leash
    }

    /// Lists everybody whose anchor is near enough to that of `particle`.
    #[inline(never)]
    fn gather(
        &self,
        particle: u32,
        untied: &impl Fn(u32) -> (Vector<D>, f64),
        list: &mut Vec<Link<D>>,
    ) {
        list.clear();
        let Tie { home, reach, .. } = &self.ties[particle];
        let farthest = reach + 0.5 * self.largest + self.longest;
        self.cells
            .for_each_in_reach(particle, home, farthest, *reach, |link, certain| {
                if certain || self.is_within(home, *reach, link, untied) {
                    list.push(link);
                }
            });
    }

    /// Whether somebody is nearer to a place in the grid than `reach` and its own together.
    #[cold]
    #[inline(never)]
    fn is_within(
        &self,
        home: &Vector<D>,
        reach: f64,
        link: Link<D>,
        untied: &impl Fn(u32) -> (Vector<D>, f64),
    ) -> bool {
        let other = link.particle();
        let (there, theirs) = if self.ties.has(other) {
            (self.ties[other].home, self.ties[other].reach)
        } else {
            let (stored, radius) = untied(other);
            (self.home(other, &stored), radius)
        };
        let both = reach + theirs;
        (there - home + self.link_shift(link)).norm_squared() < both * both
    }

    /// Takes a grain that is at rest, at `position`, off the lists of all others: only they
    /// know who lists it.
    fn forget_at_rest(&mut self, particle: u32, position: &Vector<D>) {
        let mut partners = Vec::new();
        let home = self.home(particle, position);
        let farthest = self.largest + self.longest;
        let told = self.cells.told_error(farthest);
        self.cells.for_each_in_reach(
            particle,
            &home,
            farthest + told,
            farthest + told,
            |link, _| {
                let theirs = &self.ties[link.particle()];
                // Farther off than this it is on nobody's list, see `release`.
                let reach = self.largest + theirs.leash + told;
                let apart = theirs.home - home + self.link_shift(link);
                if theirs.leash > 0.0 && apart.norm_squared() * ROUND < reach * reach {
                    partners.push(link);
                }
            },
        );
        for link in partners {
            if let Some(tie) = self.ties.own(link.particle()) {
                tie.forget(link.seen_from(particle));
                tie.spoil();
            }
        }
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
    fn loose() -> Self {
        Tie {
            home: Vector::zeros(),
            reach: 0.0,
            leash: 0.0,
            lonely: true,
            list: Vec::new(),
            bed: None,
            divided: false,
        }
    }
}
