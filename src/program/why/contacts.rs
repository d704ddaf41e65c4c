//! Who holds whom, by the definition of the self-check.

use std::fmt;

use serde::Serialize;

use crate::engine::Simulation;
use crate::model::{Boundary, Dynamics, Model, Wall};
use crate::particle::{Particle, ParticleId, Vector};

/// Neighbours nearer than this times the distance at contact may be supports.
const SUPPORT_RANGE: f64 = 1.05;
/// A wall within this gap below a grain supports it, in d.
const WALL_RANGE: f64 = 0.05;

/// A grain or a wall that holds another.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Contact {
    /// The grain.
    particle: Option<u32>,
    /// The wall.
    wall: Option<usize>,
    mode: &'static str,
    /// Where it is, as seen from the one it touches.
    place: &'static str,
    /// Between the surfaces, in d.
    gap: f64,
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.particle, self.wall) {
            (Some(particle), _) => write!(f, "grain {particle} ({}, {})", self.mode, self.place)?,
            (None, wall) => write!(f, "wall {} ({})", wall.unwrap_or(0), self.place)?,
        }
        write!(f, ", gap {:.6e}", self.gap)
    }
}

/// Those that hold a grain, and those that it holds: a static grain holds those
/// above it; a normal one braces static ones below it, as in an arch.
pub(super) fn contacts<M: Model<D>, const D: usize>(
    simulation: &Simulation<M, D>,
    particle: ParticleId,
) -> (Vec<Contact>, Vec<Contact>) {
    let boundary = simulation.model().boundary();
    let gravity = simulation.model().dynamics().gravity(simulation.time());
    let one = simulation.particle(particle);
    let mut holding = Vec::new();
    let mut held = Vec::new();
    for (id, other) in simulation.snapshot().into_iter().enumerate() {
        let offset = boundary.displacement(&one.position, &other.position);
        let contact = 0.5 * (one.diameter + other.diameter);
        let distance = offset.norm_squared().sqrt();
        if id == particle.index() || distance >= SUPPORT_RANGE * contact {
            continue;
        }
        let lower = offset.dot(&gravity);
        let of = |place| Contact {
            particle: Some(id as u32),
            wall: None,
            mode: other.mode.name(),
            place,
            gap: distance - contact,
        };
        if holds(&other, lower) {
            holding.push(of(if lower > 0.0 {
                "below"
            } else {
                "above, leaning"
            }));
        }
        if holds(&one, -lower) {
            held.push(of(if lower > 0.0 {
                "below, braced"
            } else {
                "above"
            }));
        }
    }
    for (id, wall) in boundary.walls().iter().enumerate() {
        let now = simulation.time();
        let gap = wall.distance(&one.position, now) - one.radius();
        let normal: Vector<D> = wall.normal(&one.position, now);
        if gap < WALL_RANGE && normal.dot(&gravity) < 0.0 {
            holding.push(Contact {
                particle: None,
                wall: Some(id),
                mode: "fixed",
                place: "below",
                gap,
            });
        }
    }
    (holding, held)
}

/// Whether a grain that is so much lower (along gravity) than another holds it.
fn holds<const D: usize>(grain: &Particle<D>, lower: f64) -> bool {
    if grain.mode.is_static() {
        lower > 0.0
    } else {
        grain.mode == crate::particle::Mode::Normal && lower < 0.0
    }
}
