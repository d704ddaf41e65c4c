//! What can be wrong with a set-up. All of it is found before anything runs.

use crate::particle::{ParticleId, WallId};

/// A set-up that cannot be simulated: which part, the value, what is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// A parameter out of its range.
    #[error("{field} is {value}; {allowed}")]
    Parameter {
        /// Which parameter.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A quantity of one grain out of its range.
    #[error("grain {id}: {field} is {value}; {allowed}")]
    Particle {
        /// Which grain.
        id: ParticleId,
        /// Which of its quantities.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Two grains that overlap by more than rounding.
    #[error(
        "grains {first} and {second} overlap by {depth:e} d; they may touch, to within {tolerance:e} d"
    )]
    Overlap {
        /// The one.
        first: ParticleId,
        /// The other.
        second: ParticleId,
        /// How deep, in d.
        depth: f64,
        /// How deep is still taken for rounding, in d.
        tolerance: f64,
    },
    /// A grain that is not wholly on the free side of a wall.
    #[error(
        "grain {id} reaches {depth:e} d beyond wall {wall}; it may touch, to within {tolerance:e} d"
    )]
    OutsideWall {
        /// Which grain.
        id: ParticleId,
        /// Which wall.
        wall: WallId,
        /// How deep, in d.
        depth: f64,
        /// How deep is still taken for rounding, in d.
        tolerance: f64,
    },
    /// Something that a wall says of itself and that cannot be.
    #[error("wall {wall}: {field} is {value}; {allowed}")]
    Wall {
        /// Which wall.
        wall: WallId,
        /// Which of its quantities.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A periodic axis shorter than two diameters would let a grain meet itself
    /// or one neighbour twice.
    #[error(
        "axis {axis} has period {length} d; it must be at least {least} d, twice the largest diameter"
    )]
    PeriodTooShort {
        /// Which axis, from 0.
        axis: usize,
        /// Its period, in d.
        length: f64,
        /// The least that is allowed, in d.
        least: f64,
    },
    /// More grains than names.
    #[error("{count} grains; at most {most} can be named")]
    TooManyParticles {
        /// How many there are.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// A generator could not place what was asked for.
    #[error("placed {placed} of {wanted} grains: {reason}")]
    NoRoom {
        /// How many fitted.
        placed: usize,
        /// How many were wanted.
        wanted: usize,
        /// Why, and what would help.
        reason: &'static str,
    },
}

/// Refuses the value of a parameter, unless something holds of it.
pub(crate) fn require(
    holds: bool,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), SetupError> {
    if holds {
        return Ok(());
    }
    Err(SetupError::Parameter {
        field,
        value,
        allowed,
    })
}
