//! Carries a run through: slice by slice, with samples, signals and a summary.

mod advance;
mod audits;
mod dropper;
mod files;
mod pace;
mod replay;
mod report;
mod state;

use std::sync::Arc;

use crate::boundary::Cuboid;
use crate::engine::Simulation;
use crate::model::{Model, Observer, Occurrence, Surroundings};
use crate::observe::TrajectoryHash;
use crate::output::{Checkpoint, CollapseReport, RunFolder, StoppedBy};
use crate::program::drive::dropper::Dropper;
use crate::program::drive::files::{Files, Log};
use crate::program::drive::pace::Samples;
use crate::program::drive::replay::Diary;
use crate::program::drive::state::{SavedRun, Unusable};
use crate::program::error::ProgramError;
use crate::program::means::NormalMean;
use crate::program::processor::ProcessorClock;
use crate::program::progress::{Gauge, Progress};
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::scenario::{Origin, Scenario, Start};
use crate::time::Time;

pub(super) use files::{begin, scenario_text};
pub(super) use replay::Replay;

/// No run goes on for longer, in √(d/g).
const LATEST: f64 = 8.0e9;

/// What is to be run, and where to.
pub(super) struct Job {
    pub(super) origin: Origin,
    pub(super) scenario: Scenario,
    pub(super) folder: RunFolder,
    /// What stands in `scenario.toml`.
    pub(super) text: Vec<u8>,
    pub(super) options: Options,
}

/// How a run is watched and saved, which no trajectory depends on.
#[derive(Clone, Debug, Default)]
pub(super) struct Options {
    /// Checkpoints every so much simulated time; by the clock on the wall if
    /// not given.
    pub(super) checkpoint_every: Option<f64>,
    /// An audit every so many events.
    pub(super) audit: Option<u64>,
    pub(super) quiet: bool,
    /// Where one of many runs tells how it is getting on.
    pub(super) gauge: Option<Arc<Gauge>>,
}

impl Options {
    /// Tells people something beside the results.
    pub(super) fn note(&self, text: String) {
        match &self.gauge {
            Some(gauge) => gauge.note(text),
            None => eprintln!("note:{text}"),
        }
    }
}

/// Who watches the run.
struct Watch {
    hash: TrajectoryHash,
    normal: NormalMean,
    /// When the latest event was.
    latest: Time,
    log: Option<Log>,
    /// Of a run that is gone through again.
    diary: Option<Diary>,
}

impl<const D: usize> Observer<D> for Watch {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        self.hash.observe(occurrence, after);
        self.normal.observe(occurrence, after);
        self.latest = occurrence.time;
        if let Some(log) = &mut self.log {
            log.observe(occurrence, after);
        }
        if let Some(diary) = &mut self.diary {
            diary.observe(occurrence, after);
        }
    }
}

/// How a run came to its end.
struct End {
    reason: StoppedBy,
    exit_code: u8,
    collapse: Option<CollapseReport>,
    error: Option<String>,
}

impl End {
    fn new(reason: StoppedBy, exit_code: u8) -> Self {
        End {
            reason,
            exit_code,
            collapse: None,
            error: None,
        }
    }
}

/// A run on its way.
struct Run<'a, M: Model<D>, const D: usize> {
    scenario: &'a Scenario,
    simulation: Simulation<M, D>,
    watch: Watch,
    files: Files,
    samples: Samples,
    dropper: Option<Dropper<D>>,
    /// Grains that fall at the start.
    rain: usize,
    end: Time,
    /// Whether it goes on from a checkpoint.
    resumed: bool,
    /// Processor time before that, in seconds.
    cpu_before: f64,
    clock: ProcessorClock,
}

/// When a run ends at the latest.
fn end_of(scenario: &Scenario) -> Time {
    Time::from_units(scenario.stop.time.unwrap_or(LATEST))
}

/// Runs `model` from `start` and writes the run folder. Says the exit code.
pub(super) fn drive<M: Model<D>, const D: usize>(
    job: &Job,
    mut start: Start<D>,
    model: impl FnOnce(Cuboid<D>) -> M,
    signals: &Signals,
) -> Result<u8, ProgramError> {
    let scenario = &job.scenario;
    let grains = std::mem::take(&mut start.grains);
    let clock = ProcessorClock::start();
    let model = model(start.boundary.clone());
    let simulation = Simulation::with_settings(model, grains, scenario.settings())
        .map_err(|error| start.refuse(&job.origin, scenario, error))?;
    let snapshot = simulation.snapshot();
    let (files, log) = Files::create(&job.folder, scenario)?;
    let output = &scenario.output;
    let run = Run {
        scenario,
        watch: Watch {
            hash: TrajectoryHash::new(),
            normal: NormalMean::new(&snapshot, simulation.time()),
            latest: simulation.time(),
            log,
            diary: None,
        },
        rain: simulation.mode_counts().falling,
        simulation,
        files,
        samples: Samples::new(output.series_every, output.frames_every),
        dropper: Dropper::new(scenario),
        end: end_of(scenario),
        resumed: false,
        cpu_before: 0.0,
        clock,
    };
    see_through(job, run, signals)
}

/// What has become of an attempt to go on.
pub(super) enum Attempt {
    /// The run has gone on to an end, with this exit code.
    Done(u8),
    /// Nothing had been set up when this was written.
    NothingYet,
    /// This is no state to go on from, and why.
    Unusable(String),
}

/// Goes on from the state that a checkpoint holds.
pub(super) fn go_on<M: Model<D>, const D: usize>(
    job: &Job,
    state: &[u8],
    model: impl FnOnce(Cuboid<D>) -> M,
    signals: &Signals,
    beforehand: impl FnOnce() -> Result<(), ProgramError>,
) -> Result<Attempt, ProgramError> {
    let restored = match SavedRun::<M, D>::read(state) {
        Ok(None) => return Ok(Attempt::NothingYet),
        Ok(Some(saved)) => saved.restore(&job.scenario, &job.folder, model),
        Err(unusable) => Err(unusable),
    };
    match restored {
        Ok(run) => {
            beforehand()?;
            see_through(job, run, signals).map(Attempt::Done)
        }
        Err(Unusable::State(reason)) => Ok(Attempt::Unusable(reason)),
        Err(Unusable::Program(error)) => Err(error),
    }
}

/// Carries a run to its end and tells how it went.
fn see_through<M: Model<D>, const D: usize>(
    job: &Job,
    mut run: Run<'_, M, D>,
    signals: &Signals,
) -> Result<u8, ProgramError> {
    let mut progress = Progress::new(job.options.quiet, job.options.gauge.clone());
    signals.begin();
    let ended = run.go(job, signals, &mut progress);
    progress.finish();
    let (end, failure) = match ended.and_then(|end| run.close().map(|()| end)) {
        Ok(end) => (end, None),
        Err(error) => {
            let mut end = End::new(StoppedBy::Error, error.exit_code());
            end.error = Some(error.to_string());
            (end, Some(error))
        }
    };
    let exit_code = end.exit_code;
    let summary = run.summary(end);
    let written = serde_json::to_string_pretty(&summary)
        .map_err(|error| ProgramError::io("summary.json")(error.into()))
        .and_then(|text| {
            let text = format!("{text}\n");
            Ok(job.folder.write("summary.json", text.as_bytes())?)
        });
    let folder = job.folder.path().display().to_string();
    // The first error is the one to tell.
    if let Some(source) = failure.or(written.err()) {
        return Err(ProgramError::Stopped {
            source: Box::new(source),
            folder,
        });
    }
    if summary.stop_reason.is_finished() {
        Checkpoint::clear(&job.folder).map_err(ProgramError::io(folder.clone()))?;
    }
    if !job.options.quiet {
        say(&format!("{folder}: {summary}"))?;
    }
    Ok(exit_code)
}
