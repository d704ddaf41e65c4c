use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Gravity, in g.
#[derive(Clone, Debug, PartialEq)]
pub enum Gravity {
    /// None: written `"none"`. Nobody falls asleep then, for there is no "down".
    None,
    /// Down the last axis: written as its size.
    Down(f64),
    /// In any direction: written as a vector with one component per axis.
    Along(Vec<f64>),
}

impl Default for Gravity {
    /// The paper's: 1, down the last axis.
    fn default() -> Self {
        Gravity::Down(1.0)
    }
}

impl Gravity {
    /// The component along `axis` of `axes`, in g.
    #[must_use]
    pub fn component(&self, axis: usize, axes: usize) -> f64 {
        match self {
            Gravity::None => 0.0,
            Gravity::Down(size) if axis + 1 == axes => -size,
            Gravity::Down(_) => 0.0,
            Gravity::Along(vector) => vector.get(axis).copied().unwrap_or(0.0),
        }
    }

    /// True if it points down the last of `axes` and nowhere else, which is
    /// what a deposit and its height presuppose.
    #[must_use]
    pub fn is_down(&self, axes: usize) -> bool {
        (0..axes).all(|axis| {
            let component = self.component(axis, axes);
            if axis + 1 == axes {
                component < 0.0
            } else {
                component == 0.0
            }
        })
    }
}

impl Serialize for Gravity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Gravity::None => serializer.serialize_str("none"),
            Gravity::Down(size) => serializer.serialize_f64(*size),
            Gravity::Along(vector) => vector.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Gravity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(GravityVisitor)
    }
}

struct GravityVisitor;

impl<'de> Visitor<'de> for GravityVisitor {
    type Value = Gravity;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"none\", a number (down the last axis), or a vector")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Gravity, E> {
        if text == "none" {
            Ok(Gravity::None)
        } else {
            Err(E::invalid_value(serde::de::Unexpected::Str(text), &self))
        }
    }

    fn visit_f64<E: Error>(self, size: f64) -> Result<Gravity, E> {
        Ok(Gravity::Down(size))
    }

    fn visit_i64<E: Error>(self, size: i64) -> Result<Gravity, E> {
        Ok(Gravity::Down(size as f64))
    }

    fn visit_u64<E: Error>(self, size: u64) -> Result<Gravity, E> {
        Ok(Gravity::Down(size as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Gravity, A::Error> {
        let mut vector = Vec::new();
        while let Some(component) = items.next_element()? {
            vector.push(component);
        }
        Ok(Gravity::Along(vector))
    }
}

impl JsonSchema for Gravity {
    fn schema_name() -> Cow<'static, str> {
        "Gravity".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Gravity, in g: \"none\", a size (down the last axis), or a vector.",
            "oneOf": [
                { "const": "none" },
                { "type": "number", "exclusiveMinimum": 0 },
                {
                    "type": "array",
                    "items": { "type": "number" },
                    "minItems": 2,
                    "maxItems": 3,
                },
            ],
        })
    }
}
