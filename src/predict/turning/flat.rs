//! Flat walls.

use crate::model::{Encounter, TurningFlight, Wall};
use crate::particle::Vector;

/// Covers the rounding of bounds.
const ROUND: f64 = 1.0e-9;

/// A time after which there certainly is no contact with a flat wall: what goes
/// round also drifts,
///
/// e + u t + s t²/2 + something between −w and w , u = n·(v + p⟂/Ω) ,
///
/// e being the gap now and s what is steady of the acceleration, along the
/// normal. Infinity if it drifts towards the wall.
pub(super) fn last_chance<const D: usize, F: TurningFlight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    normal: &Vector<D>,
    offset: f64,
) -> f64 {
    let flight = &encounter.flight;
    let (turning, rate) = (flight.turning(), flight.rate());
    let [from, to] = flight.plane();
    let across = normal[to] * turning[from] - normal[from] * turning[to];
    let size = turning.norm_squared().sqrt();
    let wave = 3.0 * size / (rate * rate);
    let gap = normal.dot(&flight.start()) - offset - encounter.radius;
    let velocity: Vector<D> = flight.start_velocity();
    let drift = normal.dot(&velocity) + across / rate - encounter.growth;
    let steady = normal.dot(&flight.steady());
    let blur =
        ROUND * (velocity.norm_squared().sqrt() + size / rate.abs() + encounter.growth.abs());
    if steady < 0.0 || drift < -blur {
        return f64::INFINITY;
    }
    if drift <= blur {
        // As good as none: what does not happen in a turn does not happen for very
        // many; the question is put again then.
        return if steady == 0.0 && drift == 0.0 {
            4.0 * core::f64::consts::PI / rate.abs()
        } else {
            f64::INFINITY
        };
    }
    ((wave - gap) / (drift - blur)).max(0.0) * (1.0 + ROUND) + f64::MIN_POSITIVE
}
