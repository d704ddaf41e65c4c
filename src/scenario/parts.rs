//! Parameters of parts of one's own, for programs that have such.

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Table;

use crate::scenario::criteria::{Flaw, parameters, refuse_flaw, whole};
use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::Scenario;

/// Parts of one's own whose parameters scenarios may have.
#[derive(Clone, Copy, Debug)]
pub struct KnownParts {
    /// Their name in scenarios.
    pub name: &'static str,
    /// Whether they have to be named, with or without parameters: a run of another
    /// program does not.
    required: bool,
    read: fn(&Table) -> Result<Table, Flaw>,
}

impl KnownParts {
    /// Parts whose parameters are the fields of `Q`. A field with a default may be left
    /// out.
    #[must_use]
    pub fn of<Q: Serialize + DeserializeOwned>(name: &'static str) -> Self {
        KnownParts {
            name,
            required: false,
            read: |table| whole(&parameters::<Q>(table)?),
        }
    }

    /// The same, for the scenario of a run that has begun, where they have to be named.
    #[must_use]
    pub fn required(self) -> Self {
        KnownParts {
            required: true,
            ..self
        }
    }
}

/// Refuses parts that the program has not, and parameters that do not fit; writes out
/// those of its own.
pub(super) fn resolve_parts(origin: &Origin, scenario: &mut Scenario) -> Result<(), Refusal> {
    let path = |name: &str| Path::root().key("parts").key(name);
    let known = origin.parts.map(|known| known.name);
    let strange = scenario
        .parts
        .0
        .keys()
        .find(|name| Some(name.as_str()) != known);
    if let Some(name) = strange {
        let message = match known {
            Some(known) => {
                format!("this program has no parts `{name}`: its parts of its own are `{known}`")
            }
            None => format!(
                "no parts `{name}` are known here: only the program that has them knows them, to \
                 run, resume, sweep, compare, explain and check"
            ),
        };
        return Err(origin.refuse(path(name), Problem::Schema { message }));
    }
    if let Some(known) = origin.parts {
        if known.required && !scenario.parts.0.contains_key(known.name) {
            let message = format!(
                "a run without the parts `{}`, which this program has: it belongs to another",
                known.name
            );
            return Err(origin.refuse(Path::root(), Problem::Schema { message }));
        }
        let read = (known.read)(&scenario.parts.of(known.name));
        let all = read.map_err(|flaw| refuse_flaw(origin, &path(known.name), flaw))?;
        scenario.parts.0.insert(known.name.to_owned(), all);
    }
    Ok(())
}

impl Scenario {
    /// The parameters of the parts of one's own.
    ///
    /// # Errors
    ///
    /// When they do not fit `Q`, which [`read_text`](crate::scenario::read_text) with the
    /// same [`KnownParts`] refuses before.
    pub fn own_parts<Q: DeserializeOwned>(&self, origin: &Origin) -> Result<Q, Refusal> {
        let name = origin.parts.map_or("", |known| known.name);
        let path = Path::root().key("parts").key(name);
        parameters(&self.parts.of(name)).map_err(|flaw| refuse_flaw(origin, &path, flaw))
    }
}
