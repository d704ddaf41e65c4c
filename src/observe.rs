//! Built-in observers.

mod displacements;
mod hash;
mod transfer;

pub use displacements::Displacements;
pub use hash::TrajectoryHash;
pub use transfer::CollisionalTransfer;
