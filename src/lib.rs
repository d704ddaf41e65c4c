//! grainfall

pub mod analysis;
pub mod boundary;
pub mod collide;
pub mod dynamics;
pub mod engine;
pub mod error;
pub mod model;
pub mod observe;
pub mod particle;
pub mod policy;
pub mod predict;
pub mod setup;
pub mod time;

#[cfg(feature = "program")]
pub mod draw;
#[cfg(feature = "program")]
pub mod output;
#[cfg(feature = "program")]
pub mod program;
#[cfg(feature = "program")]
pub mod scenario;

pub use error::SetupError;
pub use particle::{Mode, Particle, ParticleId, Vector, WallId};
pub use time::Time;
