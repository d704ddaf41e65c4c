//! JSON and TOML as one kind of tree.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use toml::{Table, Value};

use crate::scenario::path::Path;

/// A JSON value as a tree of TOML: keys may stand only once, and `null` is the
/// same as leaving the key out.
pub(super) struct Tree(pub(super) Option<Value>);

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TreeVisitor)
    }
}

struct TreeVisitor;

impl<'de> Visitor<'de> for TreeVisitor {
    type Value = Tree;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Tree, E> {
        Ok(Tree(None))
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Tree, E> {
        Ok(Tree(Some(Value::Boolean(value))))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Tree, E> {
        Ok(Tree(Some(Value::Integer(value))))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Tree, E> {
        // Whole numbers beyond 2⁶³ are none that anything here takes.
        Ok(Tree(Some(
            i64::try_from(value).map_or(Value::Float(value as f64), Value::Integer),
        )))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Tree, E> {
        Ok(Tree(Some(Value::Float(value))))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Tree, E> {
        Ok(Tree(Some(Value::String(value.to_owned()))))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Tree, A::Error> {
        let mut list = Vec::new();
        while let Some(Tree(item)) = items.next_element()? {
            list.push(item.ok_or_else(|| A::Error::custom("a list may not hold null"))?);
        }
        Ok(Tree(Some(Value::Array(list))))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Tree, A::Error> {
        let mut table = Table::new();
        while let Some(key) = entries.next_key::<String>()? {
            if table.contains_key(&key) {
                return Err(A::Error::custom(format!("the key `{key}` stands twice")));
            }
            if let Tree(Some(value)) = entries.next_value()? {
                table.insert(key, value);
            }
        }
        Ok(Tree(Some(Value::Table(table))))
    }
}

/// The first number in `value` that is not finite, with its path below `path`.
pub(super) fn not_finite(value: &Value, path: &Path) -> Option<(Path, f64)> {
    match value {
        Value::Float(number) if !number.is_finite() => Some((path.clone(), *number)),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(index, item)| not_finite(item, &path.clone().index(index))),
        Value::Table(table) => table
            .iter()
            .find_map(|(key, item)| not_finite(item, &path.clone().key(key))),
        _ => None,
    }
}
