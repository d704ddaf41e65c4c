use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use toml::Table;

use crate::policy::{DisplacementWindow, DynamoSleep, GranularTemperature, VelocityVariance};
use crate::scenario::criteria::Isostatic;

/// Tables of parameters, by the name of what they are the parameters of: a sleep
/// criterion, or parts of one's own. What is left out has its default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct NamedParameters(pub BTreeMap<String, Table>);

impl NamedParameters {
    /// Nothing is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What is given under a name.
    #[must_use]
    pub fn of(&self, name: &str) -> Table {
        self.0.get(name).cloned().unwrap_or_default()
    }
}

impl JsonSchema for NamedParameters {
    fn schema_name() -> Cow<'static, str> {
        "NamedParameters".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "object",
            "additionalProperties": { "type": "object" },
        })
    }
}

/// The same for sleep criteria, with the parameters of those that are built in.
pub(super) fn of_criteria(generator: &mut SchemaGenerator) -> Schema {
    let mut schema = NamedParameters::json_schema(generator);
    let built_in = json_schema!({
        "isostatic_support": generator.subschema_for::<Isostatic>(),
        "displacement_window": generator.subschema_for::<DisplacementWindow>(),
        "velocity_variance": generator.subschema_for::<VelocityVariance>(),
        "granular_temperature": generator.subschema_for::<GranularTemperature>(),
        "dynamo_sleep": generator.subschema_for::<DynamoSleep>(),
    });
    schema.insert("properties".to_owned(), built_in.to_value());
    schema
}
