//! What a scenario file may say: one schema for TOML and JSON.

mod conditions;
mod gravity;
mod named_parameters;
mod numbering;
mod parameters;
mod rotation;
mod sleep;
mod sources;

pub use conditions::{Output, Stop};
pub use gravity::Gravity;
pub use named_parameters::NamedParameters;
pub use numbering::Numbering;
pub use parameters::{Guards, Parameters, Threshold};
pub use rotation::{Rotation, Turns};
pub use sleep::{Phase, SelfCheck, Sleep};
pub use sources::{Base, Drum, Gas, OneByOne, Rain, Source, SourceKind};

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// A whole scenario: everything a run depends on.
///
/// Units: the diameter d, the mass m and gravity g are 1, so times are in
/// √(d/g) and speeds in √(gd). Without gravity the unit of time is yours. The
/// last axis points up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Scenario of grainfall")]
pub struct Scenario {
    /// What this is, for people. Left out: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// 2 (disks) or 3 (spheres).
    pub dimension: Dimension,
    /// Everything random in a run follows from this number.
    #[serde(default = "default_seed")]
    #[schemars(range(min = 0, max = 9_223_372_036_854_775_807_i64))]
    pub seed: u64,
    /// How the grains of each generator are numbered: `"drawn"`, as they are drawn,
    /// or `"space"`, so that neighbours have numbers near each other, which makes
    /// events of more than 10⁴ grains cheaper. Left out: as drawn.
    #[serde(default, skip_serializing_if = "Numbering::is_drawn")]
    pub numbering: Numbering,
    /// `"none"`, a size (pointing down the last axis), or a vector; in g.
    #[serde(default)]
    #[schemars(extend("x-unit" = "g"))]
    pub gravity: Gravity,
    /// A drum turns: gravity, as seen from it, or the ground with all that is
    /// fixed or asleep. Left out: nothing turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Rotation>,
    /// What bounds each axis, in the order x, y(, z). Left out: open on all
    /// sides; a `gas` brings its own periodic box.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub boundaries: Vec<Side>,
    /// The model's numbers, with the paper's symbols.
    #[serde(default)]
    pub parameters: Parameters,
    /// How exactly grains fall asleep and wake; the defaults are the model.
    #[serde(default)]
    pub sleep: Sleep,
    /// Parameters of sleep criteria other than the paper's, by name. Those of the one
    /// that `sleep.criterion` names count.
    #[serde(default, skip_serializing_if = "NamedParameters::is_empty")]
    #[schemars(schema_with = "named_parameters::of_criteria")]
    pub criteria: NamedParameters,
    /// Parameters of parts of one's own, by name: only for programs that have such.
    #[serde(default, skip_serializing_if = "NamedParameters::is_empty")]
    pub parts: NamedParameters,
    /// Sleeping grains check at intervals whether they are still supported.
    /// Left out: they don't.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_check: Option<SelfCheck>,
    /// What keeps the number of collisions finite.
    #[serde(default)]
    pub guards: Guards,
    /// When the run ends: at whichever comes first.
    #[serde(default)]
    pub stop: Stop,
    /// What is written, and how often.
    #[serde(default)]
    pub output: Output,
    /// Where the grains come from, in the order of their ids.
    pub grains: Vec<Source>,
}

fn default_seed() -> u64 {
    1
}

/// The number of dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "i64", into = "i64")]
pub enum Dimension {
    /// Disks in a plane.
    Two,
    /// Spheres in space.
    Three,
}

impl Dimension {
    /// 2 or 3.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }
}

impl From<Dimension> for i64 {
    fn from(dimension: Dimension) -> i64 {
        match dimension {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }
}

/// A number of dimensions that is neither 2 nor 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} dimensions; 2 or 3 is allowed")]
pub struct DimensionError(pub i64);

impl TryFrom<i64> for Dimension {
    type Error = DimensionError;

    fn try_from(count: i64) -> Result<Self, DimensionError> {
        match count {
            2 => Ok(Dimension::Two),
            3 => Ok(Dimension::Three),
            _ => Err(DimensionError(count)),
        }
    }
}

impl JsonSchema for Dimension {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Dimension".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": [2, 3] })
    }
}

/// What bounds one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Side {
    /// Nothing: grains may go as far as they like.
    Open,
    /// The axis closes on itself.
    Periodic {
        /// Where the primary cell begins, in d.
        #[serde(default)]
        #[schemars(range(min = -1.0e9, max = 1.0e9), extend("x-unit" = "d"))]
        origin: f64,
        /// Length of the period, in d; at least two diameters.
        #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "d"))]
        length: f64,
    },
    /// A wall below, above, or both.
    Walls {
        /// Where the lower wall stands, in d. Left out: there is none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = -1.0e9, max = 1.0e9), extend("x-unit" = "d"))]
        low: Option<f64>,
        /// Where the upper wall stands, in d. Left out: there is none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = -1.0e9, max = 1.0e9), extend("x-unit" = "d"))]
        high: Option<f64>,
        /// Coefficient of restitution of these walls, 0 … 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        restitution: f64,
    },
}

impl Scenario {
    /// The number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.dimension.count()
    }

    /// What bounds `axis`, counted from 0.
    #[must_use]
    pub fn side(&self, axis: usize) -> Side {
        self.boundaries.get(axis).copied().unwrap_or(Side::Open)
    }

    /// The gas that makes its own box, if there is one.
    #[must_use]
    pub fn gas(&self) -> Option<&Gas> {
        self.grains.iter().find_map(|source| source.gas.as_ref())
    }

    /// The grains that are dropped one after the other, if there are any.
    #[must_use]
    pub fn one_by_one(&self) -> Option<&OneByOne> {
        self.grains
            .iter()
            .find_map(|source| source.one_by_one.as_ref())
    }

    /// Whether a run ends when no grain is normal or falling: if nothing else is said,
    /// where gravity brings all to rest and does not turn.
    pub(super) fn ends_all_frozen(&self) -> bool {
        let comes_to_rest = !matches!(self.gravity, Gravity::None) && self.rotation.is_none();
        self.stop.all_frozen.unwrap_or(comes_to_rest)
    }

    /// Writes every default that depends on other values where it can be read,
    /// so that the scenario says all that a run depends on.
    pub fn resolve(&mut self) {
        self.guards
            .exit_speed
            .get_or_insert(0.1 * self.parameters.elastic_speed);
        self.stop.all_frozen = Some(self.ends_all_frozen());
    }
}
