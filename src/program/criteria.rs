//! Which sleep criteria, and which parts of one's own, the program knows.

use std::fmt;
use std::process::ExitCode;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::model::StatePolicy;
use crate::program::parts::AsTheyAre;
use crate::program::runner::{Added, BuiltIn, Runner};
use crate::scenario::{Gravity, KnownCriterion, KnownParts, Origin, Scenario, built_in_criteria};

/// The command-line program, with the sleep criteria that it knows: the built-in
/// ones, and those that are added.
///
/// A crate of one's own becomes the whole program, `run`, `resume`, `sweep`,
/// `compare` and `why` included, by a `main` of one line. The fields of the policy
/// are its parameters in scenarios, under `[criteria.NAME]`.
///
/// ```no_run
/// use std::process::ExitCode;
///
/// use grainfall::model::{Impact, NoEvent, Place, Reason, SleepDecision, StatePolicy};
/// use grainfall::model::{Surroundings, WakeDecision, Waking};
/// use grainfall::{Vector, program::Program};
/// use serde::{Deserialize, Serialize};
///
/// /// Asleep at any slow collision with a static grain; any hit wakes.
/// #[derive(Serialize, Deserialize)]
/// struct Slow {
///     speed: f64,
/// }
///
/// impl<const D: usize> StatePolicy<D> for Slow {
///     type Memory = ();
///     type Event = NoEvent;
///
///     fn should_sleep<S: Surroundings<D>>(
///         &self,
///         hit: &Impact<D>,
///         _after: Vector<D>,
///         _near: &S,
///         _memory: &mut (),
///     ) -> SleepDecision {
///         let reason = Reason::new("slow", hit.arriving_speed(), self.speed);
///         if hit.is_on_static() && reason.value < reason.limit {
///             return SleepDecision::Sleep(Place::HalfWay, reason);
///         }
///         SleepDecision::Stay(reason)
///     }
///
///     fn should_wake<S: Surroundings<D>>(
///         &self,
///         hit: &Impact<D>,
///         _near: &S,
///         _struck: &(),
///     ) -> WakeDecision<D> {
///         WakeDecision::Wake(Waking::at_rest(), Reason::new("hit", hit.closing_speed(), 0.0))
///     }
/// }
///
/// fn main() -> ExitCode {
///     Program::new().with_criterion::<Slow>("slow", "arrives slowly").main()
/// }
/// ```
pub struct Program {
    own: Vec<Own>,
    built_in: Box<dyn Runner>,
    parts: Option<KnownParts>,
}

/// A criterion that was added.
pub(super) struct Own {
    pub(super) known: KnownCriterion,
    pub(super) runner: Box<dyn Runner>,
}

impl Default for Program {
    fn default() -> Self {
        Program::new()
    }
}

impl fmt::Debug for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list()
            .entries(self.criteria().iter().map(|known| known.name))
            .finish()
    }
}

impl Program {
    /// With the built-in criteria.
    #[must_use]
    pub fn new() -> Self {
        Program::of(Box::new(BuiltIn::<AsTheyAre>::default()), None)
    }

    /// With what runs the built-in criteria, and parts of one's own.
    pub(super) fn of(built_in: Box<dyn Runner>, parts: Option<KnownParts>) -> Self {
        Program {
            own: Vec::new(),
            built_in,
            parts,
        }
    }

    pub(super) fn add(&mut self, own: Own) {
        self.own.push(own);
    }

    /// Adds a policy that scenarios may name, with what it is in a line. Its
    /// fields are read from `[criteria.NAME]`; one with a default may be left
    /// out. A built-in criterion of the same name is hidden.
    #[must_use]
    pub fn with_criterion<P>(mut self, name: &'static str, summary: &'static str) -> Self
    where
        P: StatePolicy<2> + StatePolicy<3> + Serialize + DeserializeOwned + 'static,
    {
        self.add(Own {
            known: KnownCriterion::of_policy::<P>(name, summary),
            runner: Box::new(Added::<P, AsTheyAre>::default()),
        });
        self
    }

    /// Runs the program with the arguments of this process, and says how it went.
    #[must_use]
    pub fn main(&self) -> ExitCode {
        super::run_command(self)
    }

    /// All criteria, those that were added first.
    #[must_use]
    pub fn criteria(&self) -> Vec<KnownCriterion> {
        let own = self.own.iter().map(|own| own.known);
        own.chain(built_in_criteria().iter().copied()).collect()
    }

    /// What runs a scenario.
    pub(super) fn runner(&self, scenario: &Scenario) -> &dyn Runner {
        let name = &scenario.sleep.criterion;
        let named = |own: &&Own| own.known.name == name;
        match self.own.iter().find(named) {
            // Without gravity nobody sleeps, whoever is named.
            Some(own) if scenario.gravity != Gravity::None => own.runner.as_ref(),
            _ => self.built_in.as_ref(),
        }
    }

    /// Has a scenario that is going to be read name what this program knows.
    pub(super) fn acquaint(&self, origin: &mut Origin) {
        origin.criteria = self.criteria();
        origin.parts = self.parts;
    }

    /// The same for the scenario of a run that has begun.
    pub(super) fn acquaint_run(&self, origin: &mut Origin) {
        self.acquaint(origin);
        origin.parts = self.parts.map(KnownParts::required);
    }
}
