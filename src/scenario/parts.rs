//! Parameters of parts of one's own, for programs that have such.

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Table;

use crate::scenario::criteria::{Flaw, parameters, refuse_flaws, whole};
use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::read::Origin;
use crate::scenario::schema::Scenario;

/// Parts of one's own whose parameters scenarios may have.
#[derive(Clone, Copy, Debug)]
pub struct KnownParts {
    /// Their name in scenarios.
    pub name: &'static str,
    read: fn(&Table) -> Result<Table, Flaw>,
}

impl KnownParts {
    /// Parts whose parameters are the fields of `Q`. A field with a default may be left
    /// out.
    #[must_use]
    pub fn of<Q: Serialize + DeserializeOwned>(name: &'static str) -> Self {
        KnownParts {
            name,
            read: |table| parameters::<Q>(table).map(|parts| whole(&parts)),
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
                "this program has no parts of its own: a run with `{name}` belongs to one that has"
            ),
        };
        return Err(origin.refuse(path(name), Problem::Schema { message }));
    }
    if let Some(known) = origin.parts {
        let read = (known.read)(&scenario.parts.of(known.name));
        let all = refuse_flaws(origin, &path(known.name), read)?;
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
        match parameters(&self.parts.of(name)) {
            Ok(parts) => Ok(parts),
            Err(flaw) => Err(refuse_flaws(origin, &path, Err(flaw))
                .err()
                .unwrap_or_else(|| {
                    let message = "parameters that do not fit".to_owned();
                    origin.refuse(path, Problem::Schema { message })
                })),
        }
    }
}
