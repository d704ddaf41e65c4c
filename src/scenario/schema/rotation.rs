use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What turns as a drum does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Turns {
    /// Gravity, as seen from the drum, which is at rest then (the paper's
    /// section 4). Centrifugal and Coriolis forces are left out, as in the paper.
    #[default]
    Gravity,
    /// The ground: fixed and frozen grains are carried along on circles round the
    /// origin, and thresholds are for velocities relative to it.
    Ground,
}

/// A drum turns about an axis through the origin, in the plane of the first and
/// the last axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Ω of the drum, in radians per √(d/g); positive from the first axis towards
    /// the last. 0.075 in the paper. Its size is 1e-6 or more.
    #[schemars(range(min = -1000.0, max = 1000.0), extend("x-unit" = "1/√(d/g)"))]
    pub angular_velocity: f64,
    /// `"gravity"`, as seen from the drum, or `"ground"`, as seen from outside.
    #[serde(default)]
    pub of: Turns,
    /// Gravity turns in steps of so long, in √(d/g). Left out: continuously.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0e-6, max = 1.0e6), extend("x-unit" = "√(d/g)"))]
    pub step: Option<f64>,
}
