//! Which sleep criteria the program knows, and how a run gets the one that its
//! scenario names: by one virtual call at its beginning. Everything after that
//! is compiled for the policy.

use std::fmt;
use std::marker::PhantomData;
use std::process::ExitCode;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::boundary::Cuboid;
use crate::engine::Simulation;
use crate::model::{Model, StatePolicy};
use crate::output::Frame;
use crate::policy::Criterion;
use crate::program::compare::{Census, Had, TakeCensus};
use crate::program::drive::{self, Attempt, Job};
use crate::program::error::ProgramError;
use crate::program::parts::{AsTheyAre, Refit};
use crate::program::signals::Signals;
use crate::program::why::{Ask, Question, Report};
use crate::scenario::{
    Dimension, Gravity, KnownCriterion, KnownParts, Origin, Problem, Scenario, Start,
    built_in_criteria,
};

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

/// The grains of a scenario that are written out or stand in files.
pub(super) struct Given {
    /// How many there are.
    pub(super) grains: usize,
    /// The files: for each the source's number and what was in it.
    pub(super) files: Vec<(usize, Frame)>,
}

/// Something that is done with a model which only a scenario knows.
pub(super) trait Task<const D: usize> {
    type Output;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output;
}

/// What can be done with the scenarios that name one criterion.
pub(super) trait Runner: Send + Sync {
    /// Makes the grains and runs from the start; says the exit code.
    fn start(&self, job: &Job, signals: &Signals) -> Result<u8, ProgramError>;

    /// Goes on from the state that a checkpoint holds.
    fn go_on(
        &self,
        job: &Job,
        state: &[u8],
        signals: &Signals,
        beforehand: &dyn Fn() -> Result<(), ProgramError>,
    ) -> Result<Attempt, ProgramError>;

    /// Goes through a run, from the state of a checkpoint or from the start, and
    /// reports on a grain; `None` if that is no place to begin.
    fn why(
        &self,
        job: &Job,
        state: Option<&[u8]>,
        question: Question,
    ) -> Result<Option<Report>, ProgramError>;

    /// Goes through a run again that had so many events, and counts what was false.
    fn census(&self, job: &Job, had: Had, signals: &Signals) -> Result<Census, ProgramError>;

    /// Checks the grains that are written out or stand in files against each other
    /// and the walls, and what the parts of the model say of themselves.
    fn check(&self, origin: &Origin, scenario: &Scenario) -> Result<Given, ProgramError>;
}

/// Where a policy, and the other parts, come from.
trait Choice: Send + Sync {
    type Policy: StatePolicy<2> + StatePolicy<3>;
    type Parts: Refit + DeserializeOwned;

    /// Whether scenarios without gravity come here, too.
    const FLOATS: bool;

    fn policy(&self, scenario: &Scenario) -> Option<Self::Policy>;
}

/// The built-in criteria, with parts `Q`.
pub(super) struct BuiltIn<Q>(PhantomData<fn() -> Q>);

impl<Q> Default for BuiltIn<Q> {
    fn default() -> Self {
        BuiltIn(PhantomData)
    }
}

impl<Q: Refit + DeserializeOwned> Choice for BuiltIn<Q> {
    type Policy = Criterion;
    type Parts = Q;

    const FLOATS: bool = true;

    fn policy(&self, scenario: &Scenario) -> Option<Criterion> {
        scenario.criterion()
    }
}

/// A policy `P` that was added, with parts `Q`.
pub(super) struct Added<P, Q>(PhantomData<fn() -> (P, Q)>);

impl<P, Q> Default for Added<P, Q> {
    fn default() -> Self {
        Added(PhantomData)
    }
}

impl<P, Q> Choice for Added<P, Q>
where
    P: StatePolicy<2> + StatePolicy<3> + DeserializeOwned,
    Q: Refit + DeserializeOwned,
{
    type Policy = P;
    type Parts = Q;

    const FLOATS: bool = false;

    fn policy(&self, scenario: &Scenario) -> Option<P> {
        scenario.own_criterion()
    }
}

impl<C: Choice> Runner for C {
    fn start(&self, job: &Job, signals: &Signals) -> Result<u8, ProgramError> {
        match job.scenario.dimension {
            Dimension::Two => {
                let start = Start::<2>::new(&job.origin, &job.scenario)?;
                with_model(
                    self,
                    &job.origin,
                    &job.scenario,
                    Begin {
                        job,
                        start,
                        signals,
                    },
                )?
            }
            Dimension::Three => {
                let start = Start::<3>::new(&job.origin, &job.scenario)?;
                with_model(
                    self,
                    &job.origin,
                    &job.scenario,
                    Begin {
                        job,
                        start,
                        signals,
                    },
                )?
            }
        }
    }

    fn go_on(
        &self,
        job: &Job,
        state: &[u8],
        signals: &Signals,
        beforehand: &dyn Fn() -> Result<(), ProgramError>,
    ) -> Result<Attempt, ProgramError> {
        let task = GoOn {
            job,
            state,
            signals,
            beforehand,
        };
        match job.scenario.dimension {
            Dimension::Two => with_model::<_, 2, _>(self, &job.origin, &job.scenario, task)?,
            Dimension::Three => with_model::<_, 3, _>(self, &job.origin, &job.scenario, task)?,
        }
    }

    fn why(
        &self,
        job: &Job,
        state: Option<&[u8]>,
        question: Question,
    ) -> Result<Option<Report>, ProgramError> {
        match job.scenario.dimension {
            Dimension::Two => ask::<_, 2>(self, job, state, question),
            Dimension::Three => ask::<_, 3>(self, job, state, question),
        }
    }

    fn census(&self, job: &Job, had: Had, signals: &Signals) -> Result<Census, ProgramError> {
        match job.scenario.dimension {
            Dimension::Two => count::<_, 2>(self, job, had, signals),
            Dimension::Three => count::<_, 3>(self, job, had, signals),
        }
    }

    fn check(&self, origin: &Origin, scenario: &Scenario) -> Result<Given, ProgramError> {
        match scenario.dimension {
            Dimension::Two => check::<_, 2>(self, origin, scenario),
            Dimension::Three => check::<_, 3>(self, origin, scenario),
        }
    }
}

fn count<C, const D: usize>(
    choice: &C,
    job: &Job,
    had: Had,
    signals: &Signals,
) -> Result<Census, ProgramError>
where
    C: Choice,
    C::Policy: StatePolicy<D>,
{
    let task = TakeCensus {
        job,
        start: Start::<D>::new(&job.origin, &job.scenario)?,
        had,
        parts: parts::<C>(&job.origin, &job.scenario)?,
        signals,
    };
    with_model(choice, &job.origin, &job.scenario, task)?
}

fn check<C, const D: usize>(
    choice: &C,
    origin: &Origin,
    scenario: &Scenario,
) -> Result<Given, ProgramError>
where
    C: Choice,
    C::Policy: StatePolicy<D>,
{
    let start = Start::<D>::given(origin, scenario)?;
    let task = Check {
        origin,
        scenario,
        start,
    };
    with_model(choice, origin, scenario, task)?
}

fn ask<C, const D: usize>(
    choice: &C,
    job: &Job,
    state: Option<&[u8]>,
    question: Question,
) -> Result<Option<Report>, ProgramError>
where
    C: Choice,
    C::Policy: StatePolicy<D>,
{
    let start = match state {
        Some(_) => None,
        None => Some(Start::<D>::new(&job.origin, &job.scenario)?),
    };
    let task = Ask {
        job,
        state,
        start,
        question,
    };
    with_model(choice, &job.origin, &job.scenario, task)?
}

/// Does a task with the model of a scenario.
fn with_model<C, const D: usize, T>(
    choice: &C,
    origin: &Origin,
    scenario: &Scenario,
    task: T,
) -> Result<T::Output, ProgramError>
where
    C: Choice,
    C::Policy: StatePolicy<D>,
    T: Task<D>,
{
    let parts = parts::<C>(origin, scenario)?;
    if C::FLOATS && scenario.gravity == Gravity::None {
        return Ok(task.run(|boundary| parts.refit(scenario.floating_model(boundary))));
    }
    let policy = choice
        .policy(scenario)
        .ok_or_else(|| misfit(origin, scenario))?;
    Ok(with_gravity(&parts, scenario, policy, task))
}

/// The same for one with gravity, and with a policy at hand.
fn with_gravity<Q, S, const D: usize, T>(
    parts: &Q,
    scenario: &Scenario,
    policy: S,
    task: T,
) -> T::Output
where
    Q: Refit,
    S: StatePolicy<D>,
    T: Task<D>,
{
    match &scenario.rotation {
        Some(rotation) => {
            task.run(|boundary| parts.refit(scenario.turning_model(rotation, policy, boundary)))
        }
        None => task.run(|boundary| parts.refit(scenario.gravity_model(policy, boundary))),
    }
}

/// Does a task with the model of a scenario in which nobody sleeps. (It is one of
/// those that are compiled anyway.)
pub(super) fn continued_without_sleep<Q: Refit, const D: usize, T: Task<D>>(
    parts: &Q,
    scenario: &Scenario,
    task: T,
) -> T::Output {
    with_gravity(parts, scenario, Criterion::Never, task)
}

/// The parts of one's own, with the parameters that the scenario has.
fn parts<C: Choice>(origin: &Origin, scenario: &Scenario) -> Result<C::Parts, ProgramError> {
    scenario.own_parts(origin).map_err(ProgramError::from)
}

/// The scenario names a criterion that this program does not know. (It has been
/// read with others.)
fn misfit(origin: &Origin, scenario: &Scenario) -> ProgramError {
    let problem = Problem::Value {
        found: format!("`{}`", scenario.sleep.criterion),
        allowed: "it is not among the criteria of this program".to_owned(),
    };
    let path = crate::scenario::Path::root().key("sleep").key("criterion");
    ProgramError::from(origin.refuse(path, problem))
}

struct Check<'a, const D: usize> {
    origin: &'a Origin,
    scenario: &'a Scenario,
    start: Start<D>,
}

impl<const D: usize> Task<D> for Check<'_, D> {
    type Output = Result<Given, ProgramError>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output {
        let (start, grains) = (&self.start, self.start.grains.clone());
        let model = model(start.boundary.clone());
        Simulation::with_settings(model, grains, self.scenario.settings())
            .map_err(|error| start.refuse(self.origin, self.scenario, error))?;
        Ok(Given {
            grains: start.grains.len(),
            files: start.files().to_vec(),
        })
    }
}

struct Begin<'a, const D: usize> {
    job: &'a Job,
    start: Start<D>,
    signals: &'a Signals,
}

impl<const D: usize> Task<D> for Begin<'_, D> {
    type Output = Result<u8, ProgramError>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output {
        drive::drive(self.job, self.start, model, self.signals)
    }
}

struct GoOn<'a> {
    job: &'a Job,
    state: &'a [u8],
    signals: &'a Signals,
    beforehand: &'a dyn Fn() -> Result<(), ProgramError>,
}

impl<const D: usize> Task<D> for GoOn<'_> {
    type Output = Result<Attempt, ProgramError>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output {
        drive::go_on(self.job, self.state, model, self.signals, self.beforehand)
    }
}
