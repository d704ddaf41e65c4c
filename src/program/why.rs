//! The command `why`: what a grain does, and what the policy said about it last.

mod arguments;
mod contacts;

pub(super) use arguments::WhyArguments;

use std::fmt;

use serde::Serialize;

use crate::boundary::Cuboid;
use crate::engine::Answer;
use crate::model::Model;
use crate::output::{Checkpoint, Ending, RunFolder};
use crate::particle::{Mode, ParticleId};
use crate::program::criteria::Program;
use crate::program::drive::{Job, Options, Replay};
use crate::program::error::ProgramError;
use crate::program::runner::Task;
use crate::program::show::say_result;
use crate::program::why::contacts::{Contact, contacts};
use crate::scenario::Start;
use crate::time::Time;

/// The program's answer about a grain.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Report {
    particle: u32,
    /// When, in √(d/g).
    time: f64,
    mode: &'static str,
    /// Since when it has been in this mode; not given if that was so when the
    /// replay began.
    since: Option<f64>,
    /// When the replay began.
    replayed_from: f64,
    /// Whether it had a speed, in √(gd).
    speed: f64,
    /// The last answers of the policy.
    fell_asleep: Option<Condition>,
    stayed_awake: Option<Condition>,
    woke: Option<Condition>,
    slept_on: Option<Condition>,
    supported_by: Vec<Contact>,
    supports: Vec<Contact>,
}

/// A condition that settled something.
#[derive(Clone, Debug, Serialize)]
struct Condition {
    time: f64,
    condition: &'static str,
    value: f64,
    limit: f64,
}

impl From<Answer> for Condition {
    fn from(answer: Answer) -> Self {
        Condition {
            time: answer.time.units(),
            condition: answer.reason.condition,
            value: answer.reason.value,
            limit: answer.reason.limit,
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "t = {:.6}: {} ({:.6e} against {:.6e})",
            self.time, self.condition, self.value, self.limit
        )
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let state = match self.mode {
            "frozen" => "asleep",
            "normal" => "awake",
            other => other,
        };
        write!(
            f,
            "grain {} at t = {:.6}: {state}",
            self.particle, self.time
        )?;
        match self.since {
            Some(since) => write!(f, " since t = {since:.6}")?,
            None => write!(f, " since t = {:.6} or before", self.replayed_from)?,
        }
        if self.speed > 0.0 {
            write!(f, ", speed {:.6e}", self.speed)?;
        }
        let answers = [
            ("last to fall asleep", &self.fell_asleep),
            ("last not to fall asleep", &self.stayed_awake),
            ("last woken", &self.woke),
            ("last hit in vain", &self.slept_on),
        ];
        for (name, answer) in answers {
            if let Some(answer) = answer {
                write!(f, "\n{name} at {answer}")?;
            }
        }
        for (name, list) in [
            ("supported by", &self.supported_by),
            ("supports", &self.supports),
        ] {
            if list.is_empty() {
                write!(f, "\n{name} nobody")?;
                continue;
            }
            write!(f, "\n{name}")?;
            for contact in list {
                write!(f, "\n  {contact}")?;
            }
        }
        Ok(())
    }
}

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question {
    particle: ParticleId,
    time: Time,
}

pub(super) fn why(arguments: &WhyArguments, program: &Program) -> Result<u8, ProgramError> {
    let folder = RunFolder::open(&arguments.folder)?;
    let job = Job::begun(folder, Options::default(), program)?;
    let time = arguments
        .time
        .or_else(|| Some(Ending::of(job.folder.path())?.time));
    let question = Question {
        particle: ParticleId(arguments.particle),
        time: time.map_or(Time::NEVER, Time::from_units),
    };
    let report = answer(&job, program, question)?;
    say_result(&report, arguments.json).map(|()| 0)
}

/// From the newest checkpoint that is not later than the question, else from the
/// start.
fn answer(job: &Job, program: &Program, question: Question) -> Result<Report, ProgramError> {
    let runner = program.runner(&job.scenario);
    for (_, found) in Checkpoint::all(&job.folder) {
        if let Ok(checkpoint) = found
            && checkpoint.is_of(&job.text)
            && let Some(report) = runner.why(job, Some(&checkpoint.state), question)?
        {
            return Ok(report);
        }
    }
    let report = runner.why(job, None, question)?;
    report.ok_or_else(|| ProgramError::NoGrain {
        particle: question.particle.0,
        folder: job.folder.path().display().to_string(),
    })
}

/// Goes through a run up to the question.
pub(super) struct Ask<'a, const D: usize> {
    pub(super) job: &'a Job,
    /// From a checkpoint.
    pub(super) state: Option<&'a [u8]>,
    /// Else from here.
    pub(super) start: Option<Start<D>>,
    pub(super) question: Question,
}

impl<const D: usize> Task<D> for Ask<'_, D> {
    /// `None` if the checkpoint is no place to begin, or there is no such grain.
    type Output = Result<Option<Report>, ProgramError>;

    fn run<M: Model<D>>(self, model: impl FnOnce(Cuboid<D>) -> M) -> Self::Output {
        let Question { particle, time } = self.question;
        let replay = match (self.state, self.start) {
            (Some(state), _) => Replay::from_state(&self.job.scenario, state, model)?,
            (None, Some(start)) => Some(Replay::new(self.job, start, model)?),
            (None, None) => None,
        };
        let begun = |replay: &Replay<M, D>| {
            // A run that goes on is asked about where it was saved last.
            time == Time::NEVER || replay.simulation.time() <= time
        };
        let Some(mut replay) = replay.filter(begun) else {
            return Ok(None);
        };
        if particle.index() >= replay.simulation.mode_counts().total() {
            return Ok(None);
        }
        let from = replay.simulation.time();
        replay.follow(particle);
        if time != Time::NEVER || self.state.is_none() {
            replay.advance(time, u64::MAX);
        }
        Ok(Some(report(&replay, particle, from)))
    }
}

fn report<M: Model<D>, const D: usize>(
    replay: &Replay<M, D>,
    particle: ParticleId,
    from: Time,
) -> Report {
    let simulation = &replay.simulation;
    let grain = simulation.particle(particle);
    let answers = simulation.answers();
    let since = replay.diary().change.map(|(_, since)| since);
    let (supported_by, supports) = contacts(simulation, particle);
    let speed = grain.velocity.norm_squared().sqrt();
    Report {
        particle: particle.0,
        time: simulation.time().units(),
        mode: grain.mode.name(),
        since: since.filter(|since| *since > from).map(Time::units),
        replayed_from: from.units(),
        speed: if grain.mode == Mode::Normal || grain.mode == Mode::Falling {
            speed
        } else {
            0.0
        },
        fell_asleep: answers.slept.map(Condition::from),
        stayed_awake: answers.stayed_awake.map(Condition::from),
        woke: answers.woke.map(Condition::from),
        slept_on: answers.slept_on.map(Condition::from),
        supported_by,
        supports,
    }
}
