//! The cell grid: which grains may be near which.
//!
//! A grain is filed under the cell of its *anchor*, the place its neighbour
//! list was made for. Cell coordinates are not wrapped while a grain flies on
//! through a periodic face, so that the image of a neighbour is known exactly:
//! it is the one whose cell lies next to the grain's own. Outermost cells of
//! axes that are not periodic reach to infinity.

mod check;
mod saved;

pub(super) use saved::SavedCells;

use crate::model::{Boundary, Period};
use crate::particle::Vector;

/// Edges are longer than what they must cover by this factor, for rounding.
const SLACK: f64 = 1.0 + 1.0e-9;

/// Cells of an axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    origin: f64,
    edge: f64,
    count: i32,
    stride: usize,
    period: Option<Period>,
}

/// A grain's place in the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat<const D: usize> {
    /// The place it is filed under, in d.
    pub(super) anchor: Vector<D>,
    /// How far from there its surface may be, in d.
    pub(super) reach: f64,
    cell: [i32; D],
    /// Whether that cell is an image of one of the grid.
    astray: bool,
}

/// The grid and who is where.
#[derive(Clone, Debug)]
pub(super) struct Cells<const D: usize> {
    axes: [Axis; D],
    /// Who is in each cell of the grid.
    rooms: Vec<Vec<u32>>,
    seats: Vec<Seat<D>>,
}

/// A grain found next to another, with the number of periods to add to its
/// position along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Found<const D: usize> {
    pub(super) particle: u32,
    pub(super) turns: [i32; D],
}

impl<const D: usize> Found<D> {
    /// How `particle`, next to which this was found, is found next to this.
    pub(super) fn seen_from(&self, particle: u32) -> Self {
        Found {
            particle,
            turns: self.turns.map(|turns| -turns),
        }
    }
}

impl<const D: usize> Cells<D> {
    /// A grid for grains at these positions; grains in cells that are not
    /// neighbours are farther apart than `reach`.
    pub(super) fn new<B: Boundary<D>>(boundary: &B, positions: &[Vector<D>], reach: f64) -> Self {
        let (low, span) = extents(boundary, positions, reach);
        // Not many more cells than grains, however thin the gas.
        let most_cells = 4.0 * positions.len() as f64 + 4096.0;
        let mut edge = reach * SLACK;
        let cells_of = |edge: f64, axis: usize| (span[axis] / edge).floor().clamp(1.0, 1.0e9);
        while (0..D).map(|axis| cells_of(edge, axis)).product::<f64>() > most_cells {
            edge *= 1.1;
        }
        let mut stride = 1;
        let axes = std::array::from_fn(|axis| {
            let count = cells_of(edge, axis) as i32;
            let period = boundary.period(axis);
            let fitting = span[axis] / f64::from(count);
            let this = Axis {
                origin: low[axis],
                // The cells of a period must fit exactly.
                edge: if period.is_some() {
                    fitting
                } else {
                    fitting.max(edge)
                },
                count,
                stride,
                period,
            };
            stride *= count as usize;
            this
        });
        let mut cells = Cells {
            axes,
            rooms: vec![Vec::new(); stride],
            seats: Vec::with_capacity(positions.len()),
        };
        for position in positions {
            cells.add(position);
        }
        cells
    }

    /// Where a grain is filed.
    #[inline]
    pub(super) fn seat(&self, particle: u32) -> &Seat<D> {
        &self.seats[particle as usize]
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

    /// Says where a grain is filed that has been seated.
    pub(super) fn seat_at(&mut self, particle: u32, anchor: &Vector<D>, reach: f64) {
        let seat = &mut self.seats[particle as usize];
        seat.anchor = *anchor;
        seat.reach = reach;
    }

    /// Seats one more grain.
    pub(super) fn add(&mut self, position: &Vector<D>) {
        let cell = self.cell_of(position);
        let particle = self.seats.len() as u32;
        self.seats.push(Seat {
            anchor: *position,
            reach: 0.0,
            cell,
            astray: self.is_astray(&cell),
        });
        self.link(particle);
    }

    fn cell_of(&self, position: &Vector<D>) -> [i32; D] {
        std::array::from_fn(|k| {
            let axis = &self.axes[k];
            let place = libm::floor((position[k] - axis.origin) / axis.edge);
            match axis.period {
                Some(_) => place as i32,
                None => place.clamp(0.0, f64::from(axis.count - 1)) as i32,
            }
        })
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
            self.unlink(last as u32);
            self.seats.pop();
        }
    }

    /// The shortest edge, in d.
    pub(super) fn least_edge(&self) -> f64 {
        self.axes
            .iter()
            .map(|axis| axis.edge)
            .fold(f64::INFINITY, f64::min)
    }

    /// The most rings of cells that are worth a look: beyond, everybody has
    /// been seen, and in all images within a period and the edge of a cell.
    /// (Twice as many rings as cells, for the edges of a periodic axis may be
    /// almost twice as long as the shortest.)
    pub(super) fn rings(&self) -> i32 {
        2 * self.axes.iter().map(|axis| axis.count).max().unwrap_or(1) + 1
    }

    /// Files a grain under the cell of another position.
    pub(super) fn refile(&mut self, particle: u32, position: &Vector<D>, reach: f64) {
        let cell = self.cell_of(position);
        let seat = &mut self.seats[particle as usize];
        seat.anchor = *position;
        seat.reach = reach;
        if cell != self.seats[particle as usize].cell {
            self.unlink(particle);
            let astray = self.is_astray(&cell);
            let seat = &mut self.seats[particle as usize];
            seat.cell = cell;
            seat.astray = astray;
            self.link(particle);
        }
    }

    fn is_astray(&self, cell: &[i32; D]) -> bool {
        (0..D).any(|axis| !(0..self.axes[axis].count).contains(&cell[axis]))
    }

    /// Tells the grid that `turns` periods have been taken off a grain's
    /// position.
    pub(super) fn unwind(&mut self, particle: u32, axis: usize, turns: i32) {
        let Axis { count, period, .. } = self.axes[axis];
        let seat = &mut self.seats[particle as usize];
        seat.cell[axis] -= turns * count;
        seat.anchor[axis] -= f64::from(turns) * period.map_or(0.0, |period| period.length);
        let cell = seat.cell;
        self.seats[particle as usize].astray = self.is_astray(&cell);
    }

    /// Calls `visit` for every grain within `rings` cells of `particle`'s own,
    /// itself left out.
    pub(super) fn for_each_near(&self, particle: u32, rings: i32, mut visit: impl FnMut(Found<D>)) {
        self.for_each_seat(particle, rings, |found, _| visit(found));
    }

    /// The same, with where they are filed.
    #[inline]
    pub(super) fn for_each_seat(
        &self,
        particle: u32,
        rings: i32,
        mut visit: impl FnMut(Found<D>, &Seat<D>),
    ) {
        let centre = self.seats[particle as usize].cell;
        let mut low = centre.map(|c| c - rings);
        let mut high = centre.map(|c| c + rings);
        for axis in 0..D {
            if self.axes[axis].period.is_none() {
                low[axis] = low[axis].max(0);
                high[axis] = high[axis].min(self.axes[axis].count - 1);
            }
            if low[axis] > high[axis] {
                return;
            }
        }
        let mut at = low;
        loop {
            let mut turns = [0; D];
            let mut row = 0;
            for axis in 1..D {
                let (cell, turned) = self.wrapped(at[axis], axis);
                row += cell * self.axes[axis].stride;
                turns[axis] = turned;
            }
            for along in low[0]..=high[0] {
                at[0] = along;
                let (cell, turned) = self.wrapped(along, 0);
                turns[0] = turned;
                for &other in &self.rooms[row + cell] {
                    if other != particle {
                        let seat = &self.seats[other as usize];
                        let turns = if seat.astray {
                            std::array::from_fn(|axis| {
                                (at[axis] - seat.cell[axis]) / self.axes[axis].count
                            })
                        } else {
                            turns
                        };
                        let found = Found {
                            particle: other,
                            turns,
                        };
                        visit(found, seat);
                    }
                }
            }
            // The next row, the second axis running fastest.
            let mut axis = 1;
            while axis < D && at[axis] == high[axis] {
                at[axis] = low[axis];
                axis += 1;
            }
            if axis >= D {
                return;
            }
            at[axis] += 1;
        }
    }

    /// The cell of the grid that a cell is an image of, and how many periods
    /// away it is.
    #[inline]
    fn wrapped(&self, cell: i32, axis: usize) -> (usize, i32) {
        let count = self.axes[axis].count;
        let (once, turns) = if cell < 0 {
            (cell + count, -1)
        } else if cell >= count {
            (cell - count, 1)
        } else {
            (cell, 0)
        };
        if (0..count).contains(&once) {
            (once as usize, turns)
        } else {
            (cell.rem_euclid(count) as usize, cell.div_euclid(count))
        }
    }

    #[inline]
    fn index(&self, cell: &[i32; D]) -> usize {
        (0..D)
            .map(|axis| self.wrapped(cell[axis], axis).0 * self.axes[axis].stride)
            .sum()
    }

    fn index_of(&self, particle: u32) -> usize {
        self.index(&self.seats[particle as usize].cell)
    }

    fn link(&mut self, particle: u32) {
        let index = self.index_of(particle);
        self.rooms[index].push(particle);
    }

    fn unlink(&mut self, particle: u32) {
        let index = self.index_of(particle);
        let room = &mut self.rooms[index];
        if let Some(place) = room.iter().position(|other| *other == particle) {
            room.swap_remove(place);
        }
    }
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
