use std::str::FromStr;

use toml::{Table, Value};

use crate::scenario::path::{Path, Segment};

/// `path=value`: one value of a scenario, given on the command line.
///
/// The value is read as TOML, so numbers, booleans, `[lists]` and
/// `{tables = 1}` are what they look like; anything else is a text, with or
/// without quotes.
///
/// ```
/// use grainfall::scenario::Assignment;
///
/// let set: Assignment = "gravity=[0, -1]".parse()?;
/// assert!(set.value.is_array());
/// let set: Assignment = "parameters.wake_speed=never".parse()?;
/// assert_eq!(set.value.as_str(), Some("never"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// Where.
    pub path: Path,
    /// What.
    pub value: Value,
    /// How messages call it, such as `--set seed=2`.
    pub text: String,
}

/// A text that assigns nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParseAssignmentError {
    /// No `=`.
    #[error("`{0}` has no `=`: write path=value, such as parameters.sleep_speed=0.05")]
    NoValue(String),
    /// What stands before it is no path.
    #[error(transparent)]
    Path(#[from] crate::scenario::path::ParsePathError),
}

impl Assignment {
    /// Gives `value` to the value at `path`; `text` is how messages call it.
    #[must_use]
    pub fn new(path: Path, value: Value, text: String) -> Self {
        Assignment { path, value, text }
    }

    /// Writes the value into `table`, making the tables on its way.
    ///
    /// # Errors
    ///
    /// Says so when the path leads through something that is no table and no
    /// list, or beyond the end of a list.
    pub(super) fn apply(&self, table: &mut Table) -> Result<(), String> {
        let Some((last, way)) = self.path.segments().split_last() else {
            return Err("there is nothing to set".to_owned());
        };
        let mut so_far = Path::root();
        let mut node = Place::Table(table);
        for segment in way {
            so_far = so_far.clone().join(segment);
            let value = match node {
                Place::Table(table) => table
                    .entry(segment.to_string())
                    .or_insert_with(|| Value::Table(Table::new())),
                Place::List(list) => entry(list, segment, &so_far)?,
            };
            let kind = value.type_str();
            node = match value {
                Value::Table(table) => Place::Table(table),
                Value::Array(list) => Place::List(list),
                _ => {
                    return Err(format!(
                        "{so_far} is no table ({kind}), so nothing can be set inside it; set {so_far} itself"
                    ));
                }
            };
        }
        match node {
            Place::Table(table) => {
                table.insert(last.to_string(), self.value.clone());
            }
            Place::List(list) => *entry(list, last, &self.path)? = self.value.clone(),
        }
        Ok(())
    }
}

enum Place<'a> {
    Table(&'a mut Table),
    List(&'a mut Vec<Value>),
}

fn entry<'a>(
    list: &'a mut [Value],
    segment: &Segment,
    path: &Path,
) -> Result<&'a mut Value, String> {
    let count = list.len();
    match segment {
        Segment::Index(index) if *index < count => Ok(&mut list[*index]),
        _ => Err(format!(
            "there is no {path}: {} has {count} entries, counted from 0",
            path.parent()
        )),
    }
}

impl FromStr for Assignment {
    type Err = ParseAssignmentError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (path, value) = text
            .split_once('=')
            .ok_or_else(|| ParseAssignmentError::NoValue(text.to_owned()))?;
        Ok(Assignment::new(
            path.trim().parse()?,
            read_value(value.trim()),
            format!("--set {text}"),
        ))
    }
}

/// The value of a TOML text, or the text itself if it is not one.
fn read_value(text: &str) -> Value {
    let parsed = toml::from_str::<Table>(&format!("value = {text}"));
    match parsed.ok().and_then(|mut table| {
        let alone = table.len() == 1;
        table.remove("value").filter(|_| alone)
    }) {
        // A date is nothing here, but it may be a title.
        Some(Value::Datetime(_)) | None => Value::String(text.to_owned()),
        Some(value) => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Value {
        text.parse::<Assignment>().unwrap().value
    }

    #[test]
    fn values_are_what_they_look_like() {
        assert_eq!(value("seed=7"), Value::Integer(7));
        assert_eq!(value("a.b=7.0"), Value::Float(7.0));
        assert_eq!(value("a.b = 1e-4"), Value::Float(1.0e-4));
        assert_eq!(value("output.events=true"), Value::Boolean(true));
        assert_eq!(
            value("title=2020-01-02"),
            Value::String("2020-01-02".into())
        );
        assert_eq!(value("title=my run"), Value::String("my run".into()));
        assert_eq!(value("title=\"7\""), Value::String("7".into()));
        assert_eq!(value("title=a=b"), Value::String("a=b".into()));
        assert_eq!(value("title=1\nseed=2"), Value::String("1\nseed=2".into()));
        assert!(value("boundaries.0={periodic={length=3}}").is_table());
        assert!("seed".parse::<Assignment>().is_err());
        assert!("=3".parse::<Assignment>().is_err());
    }

    #[test]
    fn values_land_where_they_belong() {
        let mut table: Table = toml::from_str("a = [{ b = 1 }]\nc = 2").unwrap();
        let set = |text: &str, table: &mut Table| text.parse::<Assignment>().unwrap().apply(table);
        set("a.0.b=5", &mut table).unwrap();
        set("d.e.f=6", &mut table).unwrap();
        assert_eq!(table["a"][0]["b"].as_integer(), Some(5));
        assert_eq!(table["d"]["e"]["f"].as_integer(), Some(6));
        assert!(
            set("a[1].b=5", &mut table)
                .unwrap_err()
                .contains("1 entries")
        );
        assert!(set("c.d=5", &mut table).unwrap_err().contains("integer"));
        assert!(set("a.b=5", &mut table).is_err());
    }
}
