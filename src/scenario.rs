//! Scenarios: everything a run depends on, in one file.
//!
//! A scenario is written in TOML or JSON, with one schema for both
//! ([`Scenario`], [`json_schema`]). [`read()`] finds everything that is wrong with
//! one before anything runs, and says where it stands in the file, what was
//! found and what is allowed.
//!
//! ```
//! use grainfall::scenario::{Origin, read_text};
//!
//! let text = "
//!     dimension = 2
//!     boundaries = [{ periodic = { length = 10 } }, { walls = { low = 0, restitution = 0.4 } }]
//!     grains = [{ position = [5, 3] }]
//!     stop.time = 10
//! ";
//! let scenario = read_text(&Origin::toml("example", text))?;
//! assert_eq!(scenario.grains.len(), 1);
//!
//! let wrong = text.replace("[5, 3]", "[5, 3], diametre = 2");
//! let error = read_text(&Origin::toml("example", &wrong)).unwrap_err();
//! assert!(error.to_string().contains("did you mean `diameter`?"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod criteria;
mod error;
mod parts;
mod path;
mod place;
mod presets;
mod read;
mod schema;
mod set;
mod suggest;
mod tree;
mod validate;

pub use build::{Drumming, FloatingModel, GravityModel, Start, TurningModel};
pub use criteria::{KnownCriterion, built_in_criteria};
pub use error::{Problem, Refusal, ScenarioError};
pub use parts::KnownParts;
pub use path::{Path, Segment};
pub use place::{Line, Place};
pub use presets::{Preset, presets};
pub use read::{Format, Origin, read, read_text};
pub use schema::{
    Base, Dimension, DimensionError, Drum, Gas, Gravity, Guards, NamedParameters, Numbering,
    OneByOne, Output, Parameters, Phase, Rain, Rotation, Scenario, SelfCheck, Side, Sleep, Source,
    SourceKind, Stop, Threshold, Turns,
};
pub use set::Assignment;
pub use suggest::nearest;

/// The JSON Schema of a scenario (draft 2020-12), for editors and other programs.
#[must_use]
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(Scenario).into()
}
