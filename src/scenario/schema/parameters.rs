use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The model's numbers (the paper's section 2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Parameters {
    /// α: restitution between mobile grains, 0 … 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
    /// α_frozen: restitution on frozen and fixed grains, 0 … 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub frozen_restitution: f64,
    /// V_c: collisions with a smaller normal closing speed are elastic, in
    /// √(gd); 0 switches that off.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(gd)"))]
    pub elastic_speed: f64,
    /// Whether V_c holds on frozen and fixed grains too.
    pub elastic_on_static: bool,
    /// V_sleep: slower grains may fall asleep, in √(gd); 0: nobody does.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(gd)"))]
    pub sleep_speed: f64,
    /// V_wakeup: a frozen grain wakes when hit with a greater normal closing
    /// speed, in √(gd); or `"never"`.
    #[schemars(extend("x-unit" = "√(gd)"))]
    pub wake_speed: Threshold,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            restitution: 0.7,
            frozen_restitution: 0.4,
            elastic_speed: 1.0e-4,
            elastic_on_static: true,
            sleep_speed: 0.1,
            wake_speed: Threshold(0.1),
        }
    }
}

/// A speed in √(gd), or never: `"never"` in files, infinite here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold(pub f64);

impl Serialize for Threshold {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_infinite() {
            serializer.serialize_str("never")
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

impl<'de> Deserialize<'de> for Threshold {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ThresholdVisitor)
    }
}

struct ThresholdVisitor;

impl Visitor<'_> for ThresholdVisitor {
    type Value = Threshold;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or \"never\"")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Threshold, E> {
        if text == "never" {
            Ok(Threshold(f64::INFINITY))
        } else {
            Err(E::invalid_value(Unexpected::Str(text), &self))
        }
    }

    fn visit_f64<E: Error>(self, speed: f64) -> Result<Threshold, E> {
        Ok(Threshold(speed))
    }

    fn visit_i64<E: Error>(self, speed: i64) -> Result<Threshold, E> {
        Ok(Threshold(speed as f64))
    }

    fn visit_u64<E: Error>(self, speed: u64) -> Result<Threshold, E> {
        Ok(Threshold(speed as f64))
    }
}

impl JsonSchema for Threshold {
    fn schema_name() -> Cow<'static, str> {
        "Threshold".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A speed in √(gd), or \"never\".",
            "oneOf": [{ "type": "number", "minimum": 0 }, { "const": "never" }],
        })
    }
}

/// What keeps the number of collisions finite. The model itself collapses:
/// grains that touch several static ones, or creep between them, collide
/// without end in a finite or even in no time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Guards {
    /// After this many collisions of one grain at one instant its velocity is
    /// projected on the directions that all static contacts it touches admit;
    /// 0 switches that off.
    pub cascade: u32,
    /// Normal speed with which a projected grain leaves its contacts, in
    /// √(gd). Left out: a tenth of V_c.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("x-unit" = "√(gd)"))]
    pub exit_speed: Option<f64>,
    /// Least normal speed after any contact with a static grain or a wall, in
    /// √(gd); 0 switches that off.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(gd)"))]
    pub floor_speed: f64,
    /// How long the same pair may not collide again after an elastic contact
    /// with a static grain, in √(d/g); 0 switches that off.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(d/g)"))]
    pub hold: f64,
    /// The run stops as collapsed when one grain has made this many collisions
    /// at one instant; 0: it goes on for ever. Where grains sleep and the cascade guard is
    /// on, one that has met nothing but static ones falls asleep after half as many instead.
    pub collapse: u32,
}

impl Default for Guards {
    fn default() -> Self {
        Guards {
            cascade: 16,
            exit_speed: None,
            floor_speed: 0.0,
            hold: 0.0,
            collapse: 100_000,
        }
    }
}
