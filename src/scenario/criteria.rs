//! Sleep criteria by name, with their parameters.

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::error::SetupError;
use crate::model::StatePolicy;
use crate::policy::{
    AtRest, Criterion, DisplacementWindow, DynamoSleep, EnergyStore, GranularTemperature,
    IsostaticSupport, RestCondition, VelocityVariance,
};
use crate::scenario::error::{Problem, Refusal};
use crate::scenario::path::Path;
use crate::scenario::read::{Origin, misfit};
use crate::scenario::schema::Scenario;
use crate::scenario::suggest::nearest;

/// A sleep criterion that scenarios may name.
#[derive(Clone, Copy, Debug)]
pub struct KnownCriterion {
    /// Its name in scenarios.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
    read: fn(&Table) -> Result<Table, Flaw>,
}

/// What is wrong with parameters.
#[derive(Debug)]
pub(super) enum Flaw {
    /// They do not fit: where, and what serde says.
    Misfit(Path, String),
    /// One is out of its range.
    Range(SetupError),
}

impl KnownCriterion {
    /// A policy that scenarios may name: its fields are its parameters. A field
    /// with a default may be left out.
    #[must_use]
    pub fn of_policy<P>(name: &'static str, summary: &'static str) -> Self
    where
        P: StatePolicy<2> + StatePolicy<3> + Serialize + DeserializeOwned,
    {
        KnownCriterion {
            name,
            summary,
            read: |table| {
                let policy: P = parameters(table)?;
                StatePolicy::<2>::validate(&policy).map_err(Flaw::Range)?;
                StatePolicy::<3>::validate(&policy).map_err(Flaw::Range)?;
                whole(&policy)
            },
        }
    }

    const fn built_in<C>(name: &'static str, summary: &'static str) -> Self
    where
        C: Checked + Serialize + DeserializeOwned,
    {
        KnownCriterion {
            name,
            summary,
            read: |table| {
                let read: C = parameters(table)?;
                read.check().map_err(Flaw::Range)?;
                whole(&read)
            },
        }
    }
}

/// The built-in criteria, in the order in which they are listed.
const BUILT_IN: &[KnownCriterion] = &[
    KnownCriterion::built_in::<Nothing>(
        "slow_descent",
        "comes down slowly, and slower than before (the paper's)",
    ),
    KnownCriterion::built_in::<Isostatic>(
        "isostatic_support",
        "slow in a pit whose contacts hold its weight, or the paper's",
    ),
    KnownCriterion::built_in::<DisplacementWindow>(
        "displacement_window",
        "has hardly moved for a while",
    ),
    KnownCriterion::built_in::<VelocityVariance>(
        "velocity_variance",
        "its velocity has hardly varied for a while",
    ),
    KnownCriterion::built_in::<GranularTemperature>(
        "granular_temperature",
        "it and its neighbours move alike",
    ),
    KnownCriterion::built_in::<DynamoSleep>(
        "dynamo_sleep",
        "leaves a support slowly, twice in one place (the code DynamO's)",
    ),
    KnownCriterion::built_in::<Nothing>("never", "nobody sleeps"),
];

/// The built-in criteria, in the order in which they are listed.
#[must_use]
pub fn built_in_criteria() -> &'static [KnownCriterion] {
    BUILT_IN
}

/// Parameters of built-in criteria, as they stand in scenarios.
trait Checked {
    fn check(&self) -> Result<(), SetupError>;
}

/// No parameters of its own: `parameters` and `sleep` say it all.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Nothing {}

impl Checked for Nothing {
    fn check(&self) -> Result<(), SetupError> {
        Ok(())
    }
}

/// Slow in a pit whose contacts hold the grain's weight, or at rest by the
/// paper's criterion, whose parameters stand elsewhere.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Isostatic {
    /// Static grains nearer than this are contacts, in units of the distance at
    /// contact.
    #[schemars(range(min = 1.0, max = 2.0), extend("x-unit" = "σ₁₂"))]
    range: f64,
}

impl Default for Isostatic {
    fn default() -> Self {
        Isostatic {
            range: IsostaticSupport::default().range,
        }
    }
}

impl Checked for Isostatic {
    fn check(&self) -> Result<(), SetupError> {
        let support = IsostaticSupport {
            range: self.range,
            ..IsostaticSupport::default()
        };
        StatePolicy::<2>::validate(&support)
    }
}

macro_rules! checked {
    ($($condition:ty),*) => {
        $(impl Checked for $condition {
            fn check(&self) -> Result<(), SetupError> {
                RestCondition::<2>::validate(self)
            }
        })*
    };
}

checked!(
    DisplacementWindow,
    VelocityVariance,
    GranularTemperature,
    DynamoSleep
);

pub(super) fn parameters<P: DeserializeOwned>(table: &Table) -> Result<P, Flaw> {
    serde_path_to_error::deserialize(Value::Table(table.clone())).map_err(|error| {
        let path = Path::from(error.path());
        Flaw::Misfit(path, error.into_inner().message().to_owned())
    })
}

/// All parameters, with the defaults of those that were left out.
pub(super) fn whole<P: Serialize>(policy: &P) -> Result<Table, Flaw> {
    Table::try_from(policy).map_err(|error| {
        let message = format!("its parameters cannot be written as a table: {error}");
        Flaw::Misfit(Path::root(), message)
    })
}

/// Refuses criteria that nobody knows and parameters that do not fit; writes out
/// those of the chosen one.
pub(super) fn resolve(origin: &Origin, scenario: &mut Scenario) -> Result<(), Refusal> {
    let chosen = scenario.sleep.criterion.clone();
    known(origin, &chosen, Path::root().key("sleep").key("criterion"))?;
    for (name, table) in &scenario.criteria.0 {
        let path = Path::root().key("criteria").key(name);
        let criterion = known(origin, name, path.clone())?;
        (criterion.read)(table).map_err(|flaw| refuse_flaw(origin, &path, flaw))?;
    }
    let path = Path::root().key("criteria").key(&chosen);
    let criterion = known(origin, &chosen, path.clone())?;
    let given = (criterion.read)(&scenario.criteria.of(&chosen));
    let all = given.map_err(|flaw| refuse_flaw(origin, &path, flaw))?;
    if !all.is_empty() {
        scenario.criteria.0.insert(chosen, all);
    }
    Ok(())
}

fn known<'a>(origin: &'a Origin, name: &str, path: Path) -> Result<&'a KnownCriterion, Refusal> {
    let found = origin.criteria.iter().find(|known| known.name == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = origin.criteria.iter().map(|known| known.name).collect();
        let problem = Problem::Schema {
            message: format!(
                "there is no criterion `{name}`; there are {}",
                names.join(", ")
            ),
        };
        Refusal {
            hint: nearest(name, names.iter().copied())
                .map(|near| format!("did you mean `{near}`?")),
            ..origin.refuse(path, problem)
        }
    })
}

pub(super) fn refuse_flaw(origin: &Origin, path: &Path, flaw: Flaw) -> Refusal {
    match flaw {
        Flaw::Misfit(inside, message) => {
            let at = inside.segments().iter().fold(path.clone(), Path::join);
            misfit(origin, at, &message)
        }
        Flaw::Range(error) => origin.refuse_part(path.clone(), error),
    }
}

impl Scenario {
    /// The built-in criterion that the scenario names; `None` if it names none of
    /// them, or its parameters do not fit, which
    /// [`read_text`](crate::scenario::read_text) refuses.
    #[must_use]
    pub fn criterion(&self) -> Option<Criterion> {
        let table = self.criteria.of(&self.sleep.criterion);
        Some(match self.sleep.criterion.as_str() {
            "slow_descent" => Criterion::SlowDescent(self.slow_descent()),
            "isostatic_support" => Criterion::IsostaticSupport(IsostaticSupport {
                descent: self.slow_descent(),
                range: parameters::<Isostatic>(&table).ok()?.range,
            }),
            "displacement_window" => Criterion::DisplacementWindow(self.at_rest(&table)?),
            "velocity_variance" => Criterion::VelocityVariance(self.at_rest(&table)?),
            "granular_temperature" => Criterion::GranularTemperature(self.at_rest(&table)?),
            "dynamo_sleep" => {
                let at_rest: AtRest<DynamoSleep> = self.at_rest(&table)?;
                Criterion::DynamoSleep(AtRest {
                    wake_speed: at_rest.condition.wake_speed,
                    store_time: 0.0,
                    place: crate::model::Place::Here,
                    ..at_rest
                })
            }
            "never" => Criterion::Never,
            _ => return None,
        })
    }

    /// The parameters of the policy of one's own that the scenario names; `None`
    /// if they do not fit.
    #[must_use]
    pub fn own_criterion<P: DeserializeOwned>(&self) -> Option<P> {
        parameters(&self.criteria.of(&self.sleep.criterion)).ok()
    }

    /// With the paper's waking.
    fn at_rest<C: DeserializeOwned>(&self, table: &Table) -> Option<AtRest<C>> {
        let paper = self.slow_descent();
        let axes = self.axes();
        let gravity = (0..axes)
            .map(|axis| self.gravity.component(axis, axes))
            .map(|component| component * component)
            .sum::<f64>()
            .sqrt();
        Some(AtRest {
            condition: parameters(table).ok()?,
            wake_speed: paper.wake_speed,
            store_time: match paper.energy_store {
                EnergyStore::Off => 0.0,
                EnergyStore::VelocityBefore | EnergyStore::EnergyAfter => paper.store_time(gravity),
            },
            place: paper.place,
            wall_supports: paper.wall_supports,
            self_check: paper.self_check,
        })
    }
}
