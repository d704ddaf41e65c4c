//! Built-in observers.

mod displacements;
mod forces;
mod hash;
mod transfer;

pub use displacements::Displacements;
pub use forces::ForceMeter;
pub use hash::TrajectoryHash;
pub use transfer::CollisionalTransfer;
