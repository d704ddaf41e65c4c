//! How a run gets the model that its scenario names: by one virtual call at its
//! beginning. Everything after that is compiled for the policy and the other parts.

use std::marker::PhantomData;

use serde::de::DeserializeOwned;

use crate::boundary::Cuboid;
use crate::engine::Simulation;
use crate::model::{Model, StatePolicy};
use crate::output::Frame;
use crate::policy::Criterion;
use crate::program::compare::{Census, Had, TakeCensus};
use crate::program::drive::{self, Attempt, Job};
use crate::program::error::ProgramError;
use crate::program::parts::Refit;
use crate::program::signals::Signals;
use crate::program::why::{Ask, Question, Report};
use crate::scenario::{Dimension, Gravity, Origin, Problem, Scenario, Start};

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
            Dimension::Two => begin::<_, 2>(self, job, signals),
            Dimension::Three => begin::<_, 3>(self, job, signals),
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

fn begin<C, const D: usize>(choice: &C, job: &Job, signals: &Signals) -> Result<u8, ProgramError>
where
    C: Choice,
    C::Policy: StatePolicy<D>,
{
    let task = Begin {
        job,
        start: Start::<D>::new(&job.origin, &job.scenario)?,
        signals,
    };
    with_model(choice, &job.origin, &job.scenario, task)?
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
