//! A run gone through again, to count false sleeps and false wakes.

use serde::{Deserialize, Serialize};

use crate::boundary::Cuboid;
use crate::model::{Boundary, Dynamics, Model};
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::policy::Never;
use crate::program::drive::{Job, Replay};
use crate::program::error::ProgramError;
use crate::program::parts::Refit;
use crate::program::runner::{Task, continued_without_sleep};
use crate::program::signals::Signals;
use crate::scenario::{Gravity, Scenario, Start};
use crate::time::Time;

/// So many sleeps of a run are questioned, evenly spread over all.
const QUESTIONS: u64 = 20;
/// One that moves farther than this, in d, was not at rest, …
const MOVED: f64 = 0.05;
/// … within this time, in √(d/g).
const PATIENCE: f64 = 2.0;
/// How often one looks where it is, in √(d/g): in between it moves no farther than
/// a hundredth of MOVED from rest.
const LOOK_EVERY: f64 = 0.02;
/// The most events of one continuation.
const MOST_EVENTS: u64 = 5_000_000;
/// After so many events it is seen whether a signal has come.
const SLICE: u64 = 100_000;

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::program) struct Census {
    /// Sleeps that were questioned.
    pub(in crate::program) sleeps: u64,
    /// Those that were false.
    pub(in crate::program) false_sleeps: u64,
    /// All wakes.
    pub(in crate::program) wakes: u64,
    /// Those that were false.
    pub(in crate::program) false_wakes: u64,
}

/// What a run had.
#[derive(Clone, Copy, Debug)]
pub(in crate::program) struct Had {
    pub(in crate::program) events: u64,
    pub(in crate::program) sleeps: u64,
}

/// Takes the census of a run that had so many events, and so many of them sleeps.
pub(in crate::program) struct TakeCensus<'a, Q, const D: usize> {
    pub(in crate::program) job: &'a Job,
    pub(in crate::program) start: Start<D>,
    pub(in crate::program) had: Had,
    pub(in crate::program) parts: Q,
    /// After one of these it is left unfinished.
    pub(in crate::program) signals: &'a Signals,
}

impl<Q: Refit, const D: usize> Task<D> for TakeCensus<'_, Q, D> {
    type Output = Result<Census, ProgramError>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output {
        let boundary = self.start.boundary.clone();
        let mut replay = Replay::new(self.job, self.start, model)?;
        let mut census = Census::default();
        let questions = QUESTIONS.min(self.had.sleeps);
        let mut last = 0;
        for question in 0..questions {
            // In the middle of each of so many equal parts.
            let which = (2 * question + 1) * self.had.sleeps / (2 * questions);
            if !on_to_sleep(&mut replay, which + 1, self.signals) {
                break;
            }
            // One collision can put two to sleep: only the last of them is asked.
            let here = replay.simulation.counts().total();
            if std::mem::replace(&mut last, here) == here {
                continue;
            }
            if let Some(was_false) = ask(&self.parts, &self.job.scenario, &boundary, &replay)? {
                census.sleeps += 1;
                census.false_sleeps += u64::from(was_false);
            }
        }
        while self.signals.exit_code().is_none() {
            let on = replay.simulation.counts().total() + SLICE;
            if on >= self.had.events || !replay.advance(Time::NEVER, on) {
                replay.advance(Time::NEVER, self.had.events);
                break;
            }
        }
        let diary = replay.diary();
        (census.wakes, census.false_wakes) = (diary.wakes, diary.false_wakes);
        Ok(census)
    }
}

/// On, event by event, until grains have fallen asleep so many times; false if they
/// never do.
fn on_to_sleep<M: Model<D>, const D: usize>(
    replay: &mut Replay<M, D>,
    sleeps: u64,
    signals: &Signals,
) -> bool {
    while replay.simulation.counts().sleep < sleeps {
        let next = replay.simulation.counts().total() + 1;
        if signals.exit_code().is_some() || !replay.advance(Time::NEVER, next) {
            return replay.simulation.counts().sleep >= sleeps;
        }
    }
    true
}

/// Whether the grain that has just fallen asleep would have gone away; `None` if
/// that can't be found out.
fn ask<Q: Refit, M: Model<D>, const D: usize>(
    parts: &Q,
    scenario: &Scenario,
    boundary: &Cuboid<D>,
    replay: &Replay<M, D>,
) -> Result<Option<bool>, ProgramError> {
    let Some((sleeper, lost)) = replay.diary().asleep else {
        return Ok(None);
    };
    let simulation = &replay.simulation;
    let mut grains = simulation.snapshot();
    let grain = &mut grains[sleeper.index()];
    grain.mode = Mode::Normal;
    grain.velocity = Vector::from_fn(|axis, _| lost[axis]);
    let scenario = from_now::<D>(scenario, boundary, simulation.time());
    let task = WatchIt {
        scenario: &scenario,
        grains,
        boundary: boundary.clone(),
        sleeper,
    };
    Ok(continued_without_sleep(parts, &scenario, task))
}

/// A scenario in which what turns goes on from where it is at a time. Parts of one's
/// own are put into it again, so they begin anew.
fn from_now<const D: usize>(scenario: &Scenario, boundary: &Cuboid<D>, now: Time) -> Scenario {
    let mut scenario = scenario.clone();
    if let Some(rotation) = &scenario.rotation {
        let model = scenario.turning_model(rotation, Never, boundary.clone());
        let gravity: Vector<D> = model.dynamics.gravity(now);
        scenario.gravity = Gravity::Along(gravity.iter().copied().collect());
    }
    scenario
}

/// Follows one grain while nobody falls asleep or wakes.
struct WatchIt<'a, const D: usize> {
    scenario: &'a Scenario,
    grains: Vec<Particle<D>>,
    boundary: Cuboid<D>,
    sleeper: ParticleId,
}

impl<const D: usize> Task<D> for WatchIt<'_, D> {
    type Output = Option<bool>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Option<bool> {
        let place = self.grains[self.sleeper.index()].position;
        let model = model(self.boundary.clone());
        let mut replay = Replay::without_end(model, self.grains, self.scenario).ok()?;
        for look in 1.. {
            let now = f64::from(look) * LOOK_EVERY;
            let more = replay.advance(Time::from_units(now), MOST_EVENTS);
            let there = replay.simulation.particle(self.sleeper).position;
            let moved = self.boundary.displacement(&place, &there);
            if moved.norm_squared() > MOVED * MOVED {
                return Some(true);
            }
            if replay.simulation.counts().total() >= MOST_EVENTS || replay.broke_off() {
                return None;
            }
            if now >= PATIENCE || !more {
                return Some(false);
            }
        }
        None
    }
}
