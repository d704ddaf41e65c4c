//! Built-in observers.

mod hash;

pub use hash::TrajectoryHash;
