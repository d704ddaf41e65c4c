//! The engine: it carries grains from event to event.
//!
//! It knows a model by [`Model`](crate::model::Model) alone and no
//! implementation of its parts.

mod ahead;
mod aloft;
mod answers;
#[cfg(test)]
mod audit;
mod body;
mod candidates;
mod cascade;
mod cells;
mod collisions;
mod consistency;
mod counts;
mod energy;
mod events;
mod foresight;
mod glances;
mod guards;
mod images;
mod leaning;
mod ledger;
mod missed;
mod neighbours;
mod parting;
mod projection;
mod queue;
mod saved;
mod search;
mod settings;
mod setup;
mod simulation;
mod slot;
mod sparse;
mod speeds;
mod transitions;
mod view;
mod walls;

pub use answers::{Answer, Answers};
pub use counts::{Counts, ModeCounts};
pub use ledger::EnergyLedger;
pub use missed::{Audit, Missed};
pub use saved::{RestoreError, Saved, SavedOf};
pub use settings::{Collapse, Guards, Limits, Settings, StopReason};
pub use simulation::Simulation;
