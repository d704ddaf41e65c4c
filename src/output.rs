//! What a run leaves behind: a folder of plain files.

mod audit;
mod checkpoint;
mod events;
mod folder;
mod series;
mod summary;
mod xyz;

pub use audit::{AuditReport, MissedContact};
pub use checkpoint::{Checkpoint, CheckpointError};
pub use events::EventLog;
pub use folder::{FolderError, RunFolder, write_atomically};
pub(crate) use folder::{lock, names_in};
pub use series::{Series, SeriesRow};
pub use summary::{
    CollapseReport, Ending, EnergyReport, EventCounts, FractionReport, ParticleCounts, StoppedBy,
    Summary,
};
pub use xyz::{Frame, XyzError, XyzReader};
