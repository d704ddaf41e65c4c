//! grainfall

pub mod dynamics;
pub mod model;
pub mod particle;
pub mod time;

pub use particle::{Mode, Particle, ParticleId, Vector, WallId};
pub use time::Time;
