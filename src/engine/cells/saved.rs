//! A grid that is saved and made again, with everybody in the same order: who
//! comes first in a cell is predicted first.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::engine::cells::{Axis, Cells, Rooms, longest, most_cells};
use crate::engine::sparse::Sparse;
use crate::model::Boundary;
use crate::particle::Vector;

/// No grain is stored farther away from the grid than this, in periods.
const FARTHEST: u32 = 1 << 30;

/// What a grid is made again from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub(in crate::engine) struct SavedCells<const D: usize> {
    /// Origin, edge and number of cells along each axis.
    axes: Vec<(f64, f64, i32)>,
    /// The cell of each grain, and the periods from there to where it is stored.
    cells: Vec<(u32, SVector<i32, D>)>,
    /// In which order the grains that are found in it have to be seated: cell by cell.
    order: Vec<u32>,
}

impl<const D: usize> Cells<D> {
    pub(in crate::engine) fn save(&self) -> SavedCells<D> {
        SavedCells {
            axes: self
                .axes
                .iter()
                .map(|axis| (axis.origin, axis.edge, axis.count))
                .collect(),
            cells: (0..)
                .zip(&self.seats)
                .map(|(id, _)| (self.place_of(id) as u32, SVector::from(self.turns(id))))
                .collect(),
            order: self.rooms.all(),
        }
    }

    /// The grid of `count` grains that was saved. `spot` says where a grain is filed, in
    /// the image that lies in the grid, and how far it reaches from there, in d.
    ///
    /// # Errors
    ///
    /// Says what does not fit.
    pub(in crate::engine) fn restore<B: Boundary<D>>(
        boundary: &B,
        saved: &SavedCells<D>,
        count: usize,
        spot: impl Fn(&Self, u32) -> (Vector<D>, f64),
    ) -> Result<Self, &'static str> {
        if saved.axes.len() != D || saved.cells.len() != count || saved.order.len() > count {
            return Err("the grid is not for these grains");
        }
        let mut stride: usize = 1;
        let mut axes = Vec::with_capacity(D);
        for (axis, &(origin, edge, along)) in saved.axes.iter().enumerate() {
            let period = boundary.period(axis);
            let fits = period.is_none_or(|period| {
                origin == period.origin && edge == period.length / f64::from(along)
            });
            if along < 1 || !(edge > 0.0 && edge.is_finite() && origin.is_finite()) || !fits {
                return Err("the grid is not one for this box");
            }
            axes.push(Axis::new(origin, edge, along, stride, period));
            stride = stride
                .checked_mul(along as usize)
                // As many as a grid is ever given.
                .filter(|cells| *cells <= most_cells(count))
                .ok_or("the grid has too many cells")?;
        }
        let axes = <[Axis; D]>::try_from(axes).map_err(|_| "the grid has too few axes")?;
        let mut cells = Cells {
            axes,
            rooms: Rooms::new(stride, longest(&axes)),
            seats: vec![0; count],
            turns: Sparse::new(count, [0; D]),
        };
        for (particle, (cell, turns)) in (0..).zip(&saved.cells) {
            if *cell as usize >= stride || turns.iter().any(|turns| turns.abs_diff(0) > FARTHEST) {
                return Err("a grain lies in no cell");
            }
            cells.seat(particle, *cell, (*turns).into());
        }
        let mut seated = vec![false; count];
        for &particle in &saved.order {
            match seated.get_mut(particle as usize) {
                Some(seated) if !*seated => *seated = true,
                _ => return Err("a grain is seated twice"),
            }
            let (home, reach) = spot(&cells, particle);
            cells.link(particle, &home, reach);
        }
        Ok(cells)
    }
}
