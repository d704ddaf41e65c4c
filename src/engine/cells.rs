//! The cell grid: which grains may be near which.
//!
//! A grain is filed under the cell of its *anchor*, the place its neighbour
//! list was made for, in the image that lies in the grid; how many periods away
//! from there it is stored is kept beside. So the image of a neighbour is known
//! exactly: it is the one whose cell lies next to the grain's own. Outermost
//! cells of axes that are not periodic reach to infinity.

mod axis;
mod check;
mod link;
mod rooms;
mod saved;
#[cfg(test)]
mod tests;

use axis::Axis;
use rooms::{Guest, Rooms};

pub(super) use link::Link;
pub(super) use saved::SavedCells;

use crate::engine::sparse::Sparse;
use crate::model::Boundary;
use crate::particle::Vector;

/// Where somebody is looked for is wider by this factor, for rounding.
const SLACK: f64 = 1.0 + 1.0e-9;

/// Marks the cell of a grain that is stored in another image than that in the grid.
const ELSEWHERE: u32 = 1 << 31;

/// So many cells along an axis are looked at without further ado.
const MOST_STEPS: usize = 3;

impl<const D: usize> Found<D> {
    /// How `particle`, next to which this was found, is found next to this.
    pub(super) fn seen_from(&self, particle: u32) -> Self {
        Found {
            particle,
            turns: self.turns.map(|turns| -turns),
        }
    }
}

/// The grid and who is where.
#[derive(Clone, Debug)]
pub(super) struct Cells<const D: usize> {
    axes: [Axis; D],
    rooms: Rooms<D>,
    /// Where the cell of each grain is in a list of all, and whether it is stored
    /// [elsewhere](ELSEWHERE).
    seats: Vec<u32>,
    /// From the image in the grid to the one that is stored, in periods, of those.
    turns: Sparse<[i32; D]>,
}

/// A grain found next to another, with the number of periods to add to its
/// position along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Found<const D: usize> {
    pub(super) particle: u32,
    pub(super) turns: [i32; D],
}

impl<const D: usize> Cells<D> {
    /// A grid for grains at these positions, of cells that are no shorter than `edge` where
    /// a box is not.
    pub(super) fn new<B: Boundary<D>>(boundary: &B, positions: &[Vector<D>], edge: f64) -> Self {
        let (low, span) = extents(boundary, positions, edge);
        // Not many more cells than grains, however thin the gas.
        let most_cells = most_cells(positions.len()) as f64;
        let mut edge = edge;
        let cells_of = |edge: f64, axis: usize| (span[axis] / edge).floor().clamp(1.0, 1.0e9);
        while (0..D).map(|axis| cells_of(edge, axis)).product::<f64>() > most_cells {
            edge *= 1.1;
        }
        let mut stride = 1;
        let axes = std::array::from_fn(|axis| {
            let count = cells_of(edge, axis) as i32;
            let period = boundary.period(axis);
            let fitting = span[axis] / f64::from(count);
            // The cells of a period must fit exactly.
            let edge = if period.is_some() {
                fitting
            } else {
                fitting.max(edge)
            };
            let this = Axis::new(low[axis], edge, count, stride, period);
            stride *= count as usize;
            this
        });
        let mut cells = Cells {
            axes,
            rooms: Rooms::new(stride, longest(&axes)),
            seats: Vec::with_capacity(positions.len()),
            turns: Sparse::new(0, [0; D]),
        };
        for position in positions {
            cells.add(position);
        }
        cells
    }

    /// Lets nobody find some of the grains, up to when they are filed anew; their room
    /// is given back.
    pub(super) fn leave_out(&mut self, left_out: impl Fn(u32) -> bool) {
        self.rooms = self.rooms.without(left_out);
    }

    /// From the image of a grain in the grid to the one that is stored, in d.
    #[inline]
    pub(super) fn home_shift(&self, particle: u32) -> Vector<D> {
        self.shift(self.turns(particle))
    }

    /// So many periods, in d.
    #[inline]
    pub(super) fn shift(&self, turns: [i32; D]) -> Vector<D> {
        let mut shift = Vector::zeros();
        if turns != [0; D] {
            for axis in 0..D {
                shift[axis] = f64::from(turns[axis]) * self.axes[axis].length();
            }
        }
        shift
    }

    /// From the image of a grain in the grid to the one that is stored.
    #[inline]
    pub(super) fn turns(&self, particle: u32) -> [i32; D] {
        if self.seats[particle as usize] & ELSEWHERE == 0 {
            return [0; D];
        }
        self.turns[particle]
    }

    /// Seats a grain in a cell; returns where it has been before.
    #[inline]
    fn seat(&mut self, particle: u32, cell: u32, turns: [i32; D]) -> usize {
        let elsewhere = turns != [0; D];
        let seat = cell | if elsewhere { ELSEWHERE } else { 0 };
        let old = std::mem::replace(&mut self.seats[particle as usize], seat);
        if elsewhere {
            *self.turns.make(particle) = turns;
        } else if old & ELSEWHERE != 0 {
            self.turns.clear(particle);
        }
        (old & !ELSEWHERE) as usize
    }

    /// How many of the grains at these positions there are, on average, in a
    /// cube of this edge.
    pub(super) fn crowding<B: Boundary<D>>(
        boundary: &B,
        positions: &[Vector<D>],
        edge: f64,
    ) -> f64 {
        let (_, span) = extents(boundary, positions, edge);
        let cubes: f64 = span.iter().map(|span| span / edge).product();
        positions.len() as f64 / cubes
    }

    /// Seats one more grain, which is a point up to when it is filed anew.
    pub(super) fn add(&mut self, position: &Vector<D>) {
        let (cell, turns, home) = self.seat_for(position);
        let particle = self.seats.len() as u32;
        self.seats.push(0);
        self.turns.push();
        self.seat(particle, cell, turns);
        self.link(particle, &home, 0.0);
    }

    /// The cell for a position, how many periods away from there it is, and its image in
    /// the cell.
    #[inline]
    fn seat_for(&self, position: &Vector<D>) -> (u32, [i32; D], Vector<D>) {
        let mut home = *position;
        let (mut place, mut turns) = (0, [0; D]);
        for k in 0..D {
            let axis = &self.axes[k];
            let cell = axis.cell_at(position[k]);
            if axis.period.is_none() {
                place += axis.step(cell);
                continue;
            }
            let (cell, turned) = axis.wrapped(cell);
            place += axis.step(cell);
            turns[k] = turned;
            if turned != 0 {
                home[k] -= f64::from(turned) * axis.length();
            }
        }
        (place, turns, home)
    }

    /// How far a position lies outside the grid, in d, along axes that are not
    /// periodic.
    pub(super) fn outside(&self, position: &Vector<D>) -> f64 {
        let mut farthest: f64 = 0.0;
        for (axis, x) in self.axes.iter().zip(position.iter()) {
            if axis.period.is_none() {
                let high = axis.origin + f64::from(axis.count) * axis.edge;
                farthest = farthest.max(axis.origin - x).max(x - high);
            }
        }
        farthest
    }

    /// Unseats the grain that was seated last.
    pub(super) fn forget_last(&mut self) {
        if let Some(last) = self.seats.len().checked_sub(1) {
            self.rooms.leave(self.place_of(last as u32), last as u32);
            self.seats.pop();
            self.turns.pop();
        }
    }

    /// Beyond this, in d, it is not worth to look along any axis.
    pub(super) fn farthest(&self) -> f64 {
        self.axes.iter().map(Axis::farthest).fold(0.0, f64::max)
    }

    /// Files a grain under the cell of another position, from which its surface may be as far
    /// as `reach`, in d; returns the image of that position in the grid.
    pub(super) fn refile(&mut self, particle: u32, position: &Vector<D>, reach: f64) -> Vector<D> {
        let (cell, turns, home) = self.seat_for(position);
        let before = self.seat(particle, cell, turns);
        let (cell, guest) = (cell as usize, self.guest(particle, &home, reach));
        if cell != before {
            self.rooms.leave(before, particle);
            self.rooms.enter(cell, particle, &guest);
        } else if !self.rooms.shift(cell, particle, &guest) {
            self.rooms.enter(cell, particle, &guest);
        }
        home
    }

    /// Tells the grid that `turns` periods have been taken off a grain's
    /// position.
    #[inline(never)]
    pub(super) fn unwind(&mut self, particle: u32, axis: usize, turns: i32) {
        let mut all = self.turns(particle);
        all[axis] -= turns;
        self.seat(particle, self.place_of(particle) as u32, all);
    }

    /// A grain in a cell next to that of another, in terms of where they are
    /// stored.
    #[inline]
    pub(super) fn found(&self, particle: u32, link: Link<D>) -> Found<D> {
        let other = link.particle();
        let mut turns = Link::<D>::turns_of(link.image());
        let (own, theirs) = (self.turns(particle), self.turns(other));
        for axis in 0..D {
            turns[axis] += own[axis] - theirs[axis];
        }
        Found {
            particle: other,
            turns,
        }
    }

    /// How much farther away than `reach`, in d, somebody may be who is told to be within it.
    pub(super) fn told_error(&self, reach: f64) -> f64 {
        self.rooms.told_error(reach)
    }

    /// Calls `visit` for every grain filed not `farthest` away from `particle`, whose home is
    /// `own`, that is nearer than `reach` and its own together, and for some that are farther
    /// away: certainly not by more than the [error](Self::told_error) for both, or perhaps.
    /// Itself is left out.
    #[inline]
    pub(super) fn for_each_in_reach(
        &self,
        particle: u32,
        own: &Vector<D>,
        farthest: f64,
        reach: f64,
        mut visit: impl FnMut(Link<D>, bool),
    ) {
        let farthest = farthest * SLACK;
        let around: [(i32, i32); D] =
            std::array::from_fn(|k| self.axes[k].cells_around(own[k], farthest));
        if around
            .iter()
            .any(|(low, high)| high - low >= MOST_STEPS as i32)
        {
            return self.for_each_around(particle, around, |turns, other| {
                visit(Link::new(other, Link::<D>::image_of(&turns)), false);
            });
        }
        // The cells within which everybody is found, along each axis.
        let mut steps = [[Step::default(); MOST_STEPS]; D];
        let mut ends = [0; D];
        for (k, axis) in self.axes.iter().enumerate() {
            for cell in around[k].0..=around[k].1 {
                let (within, beyond) = axis.wrapped(cell);
                let place = own[k] - f64::from(beyond) * axis.length();
                steps[k][ends[k]] = Step {
                    row: within as usize * axis.stride,
                    image: Link::<D>::part(beyond) << Link::<D>::place(k),
                    told: self.rooms.told(place - axis.corner(within)),
                };
                ends[k] += 1;
            }
        }
        let told_reach = self.rooms.told_reach(reach);
        let mut told = [0.0; D];
        let mut at = [0; D];
        loop {
            let (mut row, mut image) = (0, 0);
            for axis in 1..D {
                let step = &steps[axis][at[axis]];
                row += step.row;
                image += step.image;
                told[axis] = step.told;
            }
            for step in &steps[0][..ends[0]] {
                told[0] = step.told;
                let image = image + step.image;
                self.rooms
                    .near(row + step.row, &told, told_reach, |other, certain| {
                        if other != particle {
                            visit(Link::new(other, image), certain);
                        }
                    });
            }
            // The next row, the second axis running fastest.
            let mut axis = 1;
            while axis < D && at[axis] + 1 == ends[axis] {
                at[axis] = 0;
                axis += 1;
            }
            if axis >= D {
                return;
            }
            at[axis] += 1;
        }
    }

    /// Calls `visit` for every other grain filed not `farthest` away from `particle`, whose
    /// home is `own`, and for some that are farther away.
    pub(super) fn for_each_found(
        &self,
        particle: u32,
        own: &Vector<D>,
        farthest: f64,
        mut visit: impl FnMut(Found<D>),
    ) {
        let around: [(i32, i32); D] = std::array::from_fn(|k| {
            let axis = &self.axes[k];
            axis.cells_around(own[k], f64::min(farthest * SLACK, axis.farthest()))
        });
        let before = self.turns(particle);
        self.for_each_around(particle, around, |turns, other| {
            let theirs = self.turns(other);
            visit(Found {
                particle: other,
                turns: std::array::from_fn(|axis| turns[axis] + before[axis] - theirs[axis]),
            });
        });
    }

    /// Calls `visit` for every other grain in the cells from the first to the last along each
    /// axis: how many periods away its cell is, and who it is.
    #[inline(never)]
    fn for_each_around(
        &self,
        particle: u32,
        around: [(i32, i32); D],
        mut visit: impl FnMut([i32; D], u32),
    ) {
        let (low, high) = (around.map(|(low, _)| low), around.map(|(_, high)| high));
        let mut at = low;
        loop {
            let mut turns = [0; D];
            let mut index = 0;
            for axis in 0..D {
                let (cell, turned) = self.axes[axis].wrapped(at[axis]);
                index += cell as usize * self.axes[axis].stride;
                turns[axis] = turned;
            }
            self.rooms.each(index, |other| {
                if other != particle {
                    visit(turns, other);
                }
            });
            let mut axis = 0;
            while axis < D && at[axis] == high[axis] {
                at[axis] = low[axis];
                axis += 1;
            }
            if axis == D {
                return;
            }
            at[axis] += 1;
        }
    }

    /// Where its cell is in a list of all.
    #[inline]
    fn place_of(&self, particle: u32) -> usize {
        (self.seats[particle as usize] & !ELSEWHERE) as usize
    }

    /// Its cell along each axis.
    #[inline]
    fn cell_of(&self, particle: u32) -> [i32; D] {
        let mut place = self.place_of(particle) as u32;
        std::array::from_fn(|k| {
            let count = self.axes[k].count as u32;
            let cell = place % count;
            place /= count;
            cell as i32
        })
    }

    /// A grain as the others in its cell know it.
    fn guest(&self, particle: u32, home: &Vector<D>, reach: f64) -> Guest<D> {
        let cell = self.cell_of(particle);
        let corner = Vector::from_fn(|k, _| self.axes[k].corner(cell[k]));
        self.rooms.guest(&(home - corner), reach)
    }

    fn link(&mut self, particle: u32, home: &Vector<D>, reach: f64) {
        let guest = self.guest(particle, home, reach);
        self.rooms.enter(self.place_of(particle), particle, &guest);
    }
}

/// A cell next to another along an axis.
#[derive(Clone, Copy, Default)]
struct Step {
    row: usize,
    image: u32,
    /// Where the grain is, seen from the corner of that cell.
    told: f32,
}

/// How many cells there may be for so many grains: few enough to be numbered.
fn most_cells(grains: usize) -> usize {
    (4 * grains + 4096).min(1 << 31)
}

/// The longest edge.
fn longest(axes: &[Axis]) -> f64 {
    axes.iter().map(|axis| axis.edge).fold(0.0, f64::max)
}

/// Lower corner and lengths of a box that holds all positions, with periods for
/// lengths where there are any.
fn extents<B: Boundary<D>, const D: usize>(
    boundary: &B,
    positions: &[Vector<D>],
    margin: f64,
) -> ([f64; D], [f64; D]) {
    let mut low = [0.0; D];
    let mut span = [margin; D];
    for axis in 0..D {
        if let Some(period) = boundary.period(axis) {
            low[axis] = period.origin;
            span[axis] = period.length;
            continue;
        }
        let along = positions.iter().map(|position| position[axis]);
        let least = along.clone().fold(f64::INFINITY, f64::min);
        let most = along.fold(f64::NEG_INFINITY, f64::max);
        if least.is_finite() {
            low[axis] = least - 0.5 * margin;
            span[axis] = most - least + margin;
        }
    }
    (low, span)
}
