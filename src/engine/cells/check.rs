//! Whether the grid's book-keeping holds.

use crate::engine::cells::Cells;
use crate::particle::Vector;

/// How far beyond the edge of its cell, over that edge, rounding may put a
/// grain: periods are taken off its place and off its cell separately.
const ROUND: f64 = 1.0e-9;

impl<const D: usize> Cells<D> {
    /// Whether those who look around find a grain.
    pub(in crate::engine) fn is_found(&self, particle: u32) -> bool {
        self.rooms.holds(self.place_of(particle), particle)
    }

    /// A grain has to sit in the cell of its home, and in that cell's room.
    pub(in crate::engine) fn check_seat(
        &self,
        particle: u32,
        home: &Vector<D>,
    ) -> Result<(), String> {
        let cell = self.cell_of(particle);
        for axis in 0..D {
            let this = &self.axes[axis];
            let cell = f64::from(cell[axis]);
            let mut place = (home[axis] - this.origin) / this.edge;
            if this.period.is_none() {
                place = place.clamp(0.0, f64::from(this.count) - ROUND);
            }
            if place < cell - ROUND || place > cell + 1.0 + ROUND {
                return Err(format!(
                    "grain {particle} sits in cell {cell} along axis {axis}, not in {place}"
                ));
            }
        }
        if !self.is_found(particle) {
            return Err(format!("grain {particle} is not linked in its cell"));
        }
        Ok(())
    }
}
