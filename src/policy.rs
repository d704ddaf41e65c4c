//! Built-in state policies: a gallery of sleep criteria.
//!
//! | criterion | a grain is at rest when |
//! |---|---|
//! | [`SlowDescent`] | it comes down slowly, and slower than before: the paper's |
//! | [`IsostaticSupport`] | it is slow in a pit whose contacts hold its weight, or by the paper's |
//! | [`DisplacementWindow`] | it has hardly moved for a while |
//! | [`VelocityVariance`] | its velocity has hardly varied for a while |
//! | [`GranularTemperature`] | it and its neighbours move alike |
//! | [`DynamoSleep`] | it leaves a support slowly, twice in one place: that of the code DynamO |
//! | [`Never`] | never |
//!
//! [`SlowDescent`] and [`IsostaticSupport`] are policies by themselves; the
//! others are conditions that [`AtRest`] makes policies of, with the paper's way
//! of waking. [`Criterion`] is any one of them.

mod asleep;
mod at_rest;
mod cone;
mod criterion;
mod displacement_window;
mod dynamo_sleep;
mod granular_temperature;
mod isostatic_support;
mod never;
mod parameters;
mod slow_descent;
mod supports;
mod velocity_variance;

pub use at_rest::{AtRest, RestCondition, RestMemory};
pub use criterion::{Criterion, CriterionMemory};
pub use displacement_window::{Anchor, DisplacementWindow};
pub use dynamo_sleep::{DynamoSleep, LastSupport};
pub use granular_temperature::GranularTemperature;
pub use isostatic_support::IsostaticSupport;
pub use never::Never;
pub use slow_descent::{
    Comparison, DescentRead, EnergyStore, Remembered, SlowDescent, SpeedRead, StoreAt, WakeRead,
};
pub use supports::{CheckDue, Phase, SelfCheck, Timing};
pub use velocity_variance::{Moments, VelocityVariance};
