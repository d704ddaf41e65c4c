use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use toml::Table;

use crate::policy::{DisplacementWindow, DynamoSleep, GranularTemperature, VelocityVariance};
use crate::scenario::criteria::Isostatic;

/// Parameters of sleep criteria, by the criterion's name. Those of the one that
/// `sleep.criterion` names count; what is left out has its default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Criteria(pub BTreeMap<String, Table>);

impl Criteria {
    /// Nothing is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What is given for a criterion.
    #[must_use]
    pub fn of(&self, name: &str) -> Table {
        self.0.get(name).cloned().unwrap_or_default()
    }
}

impl JsonSchema for Criteria {
    fn schema_name() -> Cow<'static, str> {
        "Criteria".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "object",
            "description": "Parameters of sleep criteria, by the criterion's name. Those of the \
                            one that `sleep.criterion` names count.",
            "properties": {
                "isostatic_support": generator.subschema_for::<Isostatic>(),
                "displacement_window": generator.subschema_for::<DisplacementWindow>(),
                "velocity_variance": generator.subschema_for::<VelocityVariance>(),
                "granular_temperature": generator.subschema_for::<GranularTemperature>(),
                "dynamo_sleep": generator.subschema_for::<DynamoSleep>(),
            },
            "additionalProperties": { "type": "object" },
        })
    }
}

/// Parameters of parts of one's own (a collision rule, say), by name: only for programs
/// that have such.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct OwnParts(pub BTreeMap<String, Table>);

impl OwnParts {
    /// Nothing is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What is given for the parts of this name.
    #[must_use]
    pub fn of(&self, name: &str) -> Table {
        self.0.get(name).cloned().unwrap_or_default()
    }
}

impl JsonSchema for OwnParts {
    fn schema_name() -> Cow<'static, str> {
        "OwnParts".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "object",
            "description": "Parameters of parts of one's own, by name: only for programs that \
                            have such.",
            "additionalProperties": { "type": "object" },
        })
    }
}
