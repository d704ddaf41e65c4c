//! Cells along one axis: which is where, and which image of which.

use crate::model::Period;

/// Cells of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub(super) origin: f64,
    pub(super) edge: f64,
    /// Cells in a d.
    pub(super) per_edge: f64,
    pub(super) count: i32,
    pub(super) stride: usize,
    pub(super) period: Option<Period>,
}

impl Axis {
    pub(super) fn new(
        origin: f64,
        edge: f64,
        count: i32,
        stride: usize,
        period: Option<Period>,
    ) -> Self {
        Axis {
            origin,
            edge,
            per_edge: 1.0 / edge,
            count,
            stride,
            period,
        }
    }

    /// The period, in d; zero if there is none.
    #[inline]
    pub(super) fn length(&self) -> f64 {
        self.period.map_or(0.0, |period| period.length)
    }

    /// The cell of a place, counted on beyond the ends of a period.
    #[inline]
    pub(super) fn cell_at(&self, along: f64) -> i32 {
        let place = ((along - self.origin) * self.per_edge).floor();
        if self.period.is_none() {
            place.clamp(0.0, f64::from(self.count - 1)) as i32
        } else {
            place as i32
        }
    }

    /// The first and the last cell in which somebody no farther away than this may be filed,
    /// also if a place lies outside the grid.
    #[inline]
    pub(super) fn cells_around(&self, along: f64, farthest: f64) -> (i32, i32) {
        let mut along = along;
        if self.period.is_none() {
            let end = self.origin + f64::from(self.count) * self.edge;
            along = along.max(self.origin).min(end);
        }
        (
            self.cell_at(along - farthest),
            self.cell_at(along + farthest),
        )
    }

    /// How far it is worth to look, in d: within is everybody in the grid, and in all images
    /// within a period and the edge of a cell.
    pub(super) fn farthest(&self) -> f64 {
        (2.0 * f64::from(self.count) + 1.0) * self.edge
    }

    /// Where a cell begins.
    #[inline]
    pub(super) fn corner(&self, cell: i32) -> f64 {
        self.origin + f64::from(cell) * self.edge
    }

    /// What a cell adds to the place in a list of all.
    #[inline]
    pub(super) fn step(&self, cell: i32) -> u32 {
        (cell as usize * self.stride) as u32
    }

    /// The cell of the grid that a cell is an image of, and how many periods
    /// away it is.
    #[inline]
    pub(super) fn wrapped(&self, cell: i32) -> (i32, i32) {
        if (0..self.count).contains(&cell) {
            (cell, 0)
        } else {
            (cell.rem_euclid(self.count), cell.div_euclid(self.count))
        }
    }
}
