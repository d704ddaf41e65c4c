//! Stopping, looking, saving and inserting leave no trace in a trajectory.

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "program")]
#[path = "../common/mutate.rs"]
mod mutate;

mod damage;
mod insertions;
mod restarts;
mod stops;
