//! Carries a run through: slice by slice, with samples, signals and a summary.

mod audits;
mod dropper;
mod files;
mod pace;
mod replay;
mod report;
mod state;

use std::sync::Arc;
use std::time::Instant;

use crate::boundary::Cuboid;
use crate::engine::{Limits, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::{Model, Observer, Occurrence, Surroundings};
use crate::observe::TrajectoryHash;
use crate::output::{Checkpoint, CollapseReport, RunFolder, StoppedBy};
use crate::program::drive::audits::Audits;
use crate::program::drive::dropper::Dropper;
use crate::program::drive::files::{Files, Log};
use crate::program::drive::pace::{Cadence, Pace, Samples};
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

/// A run without an end in time ends when nothing has happened for so long, in
/// √(d/g).
const QUIET: f64 = 1.0e6;

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

impl<M: Model<D>, const D: usize> Run<'_, M, D> {
    /// To the end; what has not come to its end by itself is saved.
    fn go(
        &mut self,
        job: &Job,
        signals: &Signals,
        progress: &mut Progress,
    ) -> Result<End, ProgramError> {
        let mut audits = Audits::new(job.options.audit, self.simulation.counts().total());
        let end = self.advance(job, signals, progress, &mut audits);
        progress.finish();
        audits.write(&job.folder, job.options.quiet)?;
        let end = end?;
        if !end.reason.is_finished() {
            self.write_checkpoint(job)?;
        }
        Ok(end)
    }

    fn write_checkpoint(&mut self, job: &Job) -> Result<(), ProgramError> {
        let checkpoint = Checkpoint::new(&job.text, self.save()?);
        files::write_checkpoint(&job.folder, &checkpoint)
    }

    fn advance(
        &mut self,
        job: &Job,
        signals: &Signals,
        progress: &mut Progress,
        audits: &mut Audits,
    ) -> Result<End, ProgramError> {
        let mut pace = Pace::new();
        let mut cadence = Cadence::new(job.options.checkpoint_every, self.simulation.time());
        if !self.resumed {
            self.files.row(&self.simulation)?;
            self.files.frame(&self.simulation)?;
        }
        loop {
            if let Some(code) = signals.exit_code() {
                return Ok(End::new(StoppedBy::Interrupted, code));
            }
            let now = self.simulation.time();
            if cadence.is_due(now) {
                let begun = Instant::now();
                self.write_checkpoint(job)?;
                cadence.written(begun);
            }
            let before = self.simulation.counts().total();
            let until = self
                .samples
                .next()
                .min(pace.slice_after(now))
                .min(cadence.next())
                .min(self.quiet_until())
                .min(self.end);
            let event_limit = self.scenario.stop.events.unwrap_or(u64::MAX);
            // When nothing has happened for long, the next event is waited for.
            let events = if self.samples.is_idle() {
                1
            } else {
                pace.events()
            };
            let limits = Limits {
                time: until,
                events: event_limit
                    .min(before.saturating_add(events))
                    .min(audits.next()),
                all_frozen: self.ends_frozen(),
            };
            pace.begin();
            let why = self.simulation.run(&limits, &mut self.watch);
            pace.end(why == StopReason::Time && until < self.samples.next());
            let events = self.simulation.counts().total();
            if self.samples.is_idle() && events > before {
                self.samples.wake(self.simulation.time(), events);
            }
            if let Some(missed) = audits.audit(&mut self.simulation) {
                let mut end = End::new(StoppedBy::Error, 3);
                end.error = Some(format!("a contact would have been missed: {missed}"));
                return Ok(end);
            }
            match why {
                StopReason::Collapse(collapse) => {
                    let mut end = End::new(StoppedBy::Collapse, 3);
                    end.collapse = Some(CollapseReport::from(&collapse));
                    return Ok(end);
                }
                StopReason::Escaped(particle) => {
                    let mut end = End::new(StoppedBy::Error, 3);
                    end.error = Some(format!(
                        "grain {particle} has left the system: it is more than 2e6 diameters \
                         away; is there a hole in the floor, or no floor at all?"
                    ));
                    return Ok(end);
                }
                StopReason::Events if events >= event_limit => {
                    return Ok(End::new(StoppedBy::Events, 0));
                }
                StopReason::Events => {}
                StopReason::AllFrozen => {
                    if let Some(end) = self.all_at_rest() {
                        return Ok(end);
                    }
                }
                StopReason::NothingLeft => return Ok(End::new(StoppedBy::Events, 0)),
                StopReason::Time => {
                    if until >= self.end {
                        return Ok(End::new(StoppedBy::Time, 0));
                    }
                    if until >= self.quiet_until() {
                        return Ok(End::new(StoppedBy::Events, 0));
                    }
                    if until >= self.samples.next() {
                        self.sample(until, events)?;
                    }
                }
            }
            progress.show(self.simulation.time().units(), events, self.share());
        }
    }

    /// Writes the row and the frame that are due.
    fn sample(&mut self, now: Time, events: u64) -> Result<(), ProgramError> {
        let due = self.samples.due(now, events);
        if due.row {
            self.files.row(&self.simulation)?;
        }
        if due.frame {
            self.files.frame(&self.simulation)?;
        }
        Ok(())
    }

    /// When a run without an end in time ends if nothing more happens.
    fn quiet_until(&self) -> Time {
        match self.scenario.stop.time {
            Some(_) => Time::NEVER,
            None => self.watch.latest + QUIET,
        }
    }

    /// Processor time of the run so far, in seconds.
    fn cpu_seconds(&self) -> f64 {
        self.cpu_before + self.clock.seconds()
    }

    /// Whether a slice is to end when everything is at rest.
    fn ends_frozen(&self) -> bool {
        self.scenario.stop.all_frozen.unwrap_or(true)
            || self.dropper.as_ref().is_some_and(Dropper::has_more)
    }

    /// Everything is at rest: drops the next grain, or ends the run.
    fn all_at_rest(&mut self) -> Option<End> {
        let dropper = self.dropper.as_mut().filter(|dropper| dropper.has_more());
        let Some(dropper) = dropper else {
            return Some(End::new(StoppedBy::AllFrozen, 0));
        };
        match dropper.drop_into(&mut self.simulation) {
            Ok(grain) => {
                self.watch.normal.add(&grain, self.simulation.time());
                None
            }
            Err(error) => Some(failed_to_drop(&error)),
        }
    }

    /// Writes the last row and frame and whatever is left in buffers.
    fn close(&mut self) -> Result<(), ProgramError> {
        self.files.row(&self.simulation)?;
        self.files.frame(&self.simulation)?;
        self.files.flush()?;
        if let Some(log) = &mut self.watch.log {
            log.flush()
                .map_err(|error| ProgramError::io("events.csv")(error.into()))?;
        }
        Ok(())
    }
}

fn failed_to_drop(error: &SetupError) -> End {
    let mut end = End::new(StoppedBy::Error, 3);
    end.error = Some(format!("the next grain could not be dropped: {error}"));
    end
}
