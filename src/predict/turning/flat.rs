//! Flat walls.

use crate::model::{Encounter, TurningFlight, Wall};
use crate::particle::Vector;
use crate::predict::descent::{Descent, quadratic_descent};

/// Covers the rounding of bounds.
const ROUND: f64 = 1.0e-9;

/// True if there certainly is no contact with a flat wall, ever: what goes round
/// also drifts, and that comes nowhere near.
pub(super) fn drifts_away<const D: usize, F: TurningFlight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    normal: &Vector<D>,
    offset: f64,
) -> bool {
    let drift = encounter.flight.drift();
    if !drift.radius.is_finite() {
        return false;
    }
    let start: Vector<D> = encounter.flight.start();
    let size = start.norm_squared().sqrt() + offset.abs() + encounter.radius;
    let gap = normal.dot(&start) - offset - encounter.radius - drift.radius - ROUND * size;
    let speed = drift.velocity.norm_squared().sqrt() + encounter.growth.abs();
    let velocity = normal.dot(&drift.velocity) - encounter.growth - ROUND * speed;
    let bend = 0.5 * normal.dot(&drift.acceleration);
    let next = quadratic_descent([gap, velocity, bend], false, f64::INFINITY);
    gap > 0.0 && next == Descent::Never
}
