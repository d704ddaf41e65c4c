//! What a wall may not say of itself, found before a simulation starts.

use crate::error::SetupError;
use crate::model::{Boundary, Shape, Wall};
use crate::particle::{Vector, WallId};
use crate::time::Time;

/// How far the length of a normal may be from 1.
const UNIT_TOLERANCE: f64 = 1.0e-9;

/// Refuses what walls say of themselves if it cannot be.
pub(super) fn check_walls<B: Boundary<D>, const D: usize>(boundary: &B) -> Result<(), SetupError> {
    let walls = boundary.walls();
    if walls.len() > usize::from(u16::MAX) {
        return Err(SetupError::Parameter {
            field: "the number of walls",
            value: walls.len() as f64,
            allowed: "65535 at most are allowed",
        });
    }
    for (place, wall) in walls.iter().enumerate() {
        let id = WallId(place as u16);
        let restitution = wall.restitution();
        if !(0.0..=1.0).contains(&restitution) {
            return refuse_wall(id, "restitution", restitution, "0 … 1 is allowed");
        }
        let bounds = match wall.shape() {
            Shape::Plane { normal, .. } => {
                check_unit(id, &normal)?;
                continue;
            }
            Shape::General {
                curvature,
                speed,
                acceleration,
            } => [
                ("curvature", curvature),
                ("speed", speed),
                ("acceleration", acceleration),
            ],
        };
        for (field, value) in bounds {
            if value.is_nan() || value < 0.0 {
                return refuse_wall(id, field, value, "a bound, 0 or more, is allowed");
            }
        }
    }
    Ok(())
}

/// Refuses a wall whose distance is no number, or whose normal is no unit vector,
/// where a grain is.
pub(super) fn check_distance<W: Wall<D>, const D: usize>(
    id: WallId,
    wall: &W,
    position: &Vector<D>,
    now: Time,
) -> Result<(), SetupError> {
    let distance = wall.distance(position, now);
    if distance.is_nan() {
        return refuse_wall(id, "distance", distance, "a number is wanted");
    }
    check_unit(id, &wall.normal(position, now))
}

fn check_unit<const D: usize>(id: WallId, normal: &Vector<D>) -> Result<(), SetupError> {
    let length = normal.norm_squared().sqrt();
    if (length - 1.0).abs() < UNIT_TOLERANCE {
        return Ok(());
    }
    refuse_wall(id, "length of the normal", length, "1 is allowed")
}

fn refuse_wall(
    wall: WallId,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), SetupError> {
    Err(SetupError::Wall {
        wall,
        field,
        value,
        allowed,
    })
}
