//! Carries a run through: slice by slice, with samples, signals and a summary.

mod files;
mod pace;

use std::path::PathBuf;

use rand_chacha::ChaCha8Rng;

use crate::analysis;
use crate::engine::{Limits, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::{Model, Observer, Occurrence, Surroundings};
use crate::observe::TrajectoryHash;
use crate::output::{CollapseReport, EventLog, FractionReport, RunFolder, StoppedBy, Summary};
use crate::program::drive::files::{Files, Log, plain};
use crate::program::drive::pace::{Pace, Quiet, Samples};
use crate::program::error::ProgramError;
use crate::program::means::NormalMean;
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::scenario::{Origin, Scenario, Start};
use crate::setup::OneByOne;
use crate::time::Time;

/// No run goes on for longer, in √(d/g).
const LATEST: f64 = 8.0e9;

/// What is to be run, and where to.
pub(super) struct Job {
    pub(super) origin: Origin,
    pub(super) scenario: Scenario,
    pub(super) folder: PathBuf,
    pub(super) force: bool,
    pub(super) quiet: bool,
}

/// Who watches the run.
struct Watch {
    hash: TrajectoryHash,
    normal: NormalMean,
    log: Option<Log>,
}

impl<const D: usize> Observer<D> for Watch {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        self.hash.observe(occurrence, after);
        self.normal.observe(occurrence, after);
        if let Some(log) = &mut self.log {
            log.observe(occurrence, after);
        }
    }
}

/// Grains still to be dropped, one by one.
struct Dropper<const D: usize> {
    source: OneByOne<D>,
    random: ChaCha8Rng,
    dropped: usize,
    count: usize,
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
    dropper: Option<Dropper<D>>,
    /// Grains that fall at the start.
    rain: usize,
    end: Time,
}

/// Runs `model` from `start` and writes the run folder. Says the exit code.
pub(super) fn drive<M: Model<D>, const D: usize>(
    job: &Job,
    mut start: Start<D>,
    model: M,
) -> Result<u8, ProgramError> {
    let scenario = &job.scenario;
    let grains = std::mem::take(&mut start.grains);
    let clock = ProcessorClock::start();
    let simulation = Simulation::with_settings(model, grains, scenario.settings())
        .map_err(|error| start.refuse(&job.origin, scenario, error))?;
    let snapshot = simulation.snapshot();
    let folder = RunFolder::create(&job.folder, job.force)?;
    let files = Files::create(&folder, scenario, start.files())?;
    let log = match scenario.output.events {
        true => Some(EventLog::new(folder.create_file("events.csv")?)),
        false => None,
    };
    let dropper = scenario.dropper().map(|(source, random)| Dropper {
        source,
        random,
        dropped: 0,
        count: scenario.one_by_one().map_or(0, |drops| drops.count),
    });
    let mut run = Run {
        scenario,
        watch: Watch {
            hash: TrajectoryHash::new(),
            normal: NormalMean::new(&snapshot, simulation.time()),
            log,
        },
        rain: simulation.mode_counts().falling,
        simulation,
        files,
        dropper,
        end: Time::from_units(scenario.stop.time.unwrap_or(LATEST)),
    };
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    let mut progress = Progress::new(job.quiet);
    let ended = run.go(&signals, &mut progress);
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
    let summary = run.summary(end, clock.seconds());
    let text = serde_json::to_string_pretty(&summary)
        .map_err(|error| ProgramError::io("summary.json")(error.into()))?;
    folder.write("summary.json", format!("{text}\n").as_bytes())?;
    if let Some(error) = failure {
        return Err(error);
    }
    if !job.quiet {
        say(&format!("{}: {summary}", folder.path().display()))?;
    }
    Ok(exit_code)
}

impl<M: Model<D>, const D: usize> Run<'_, M, D> {
    /// From the start to the end.
    fn go(&mut self, signals: &Signals, progress: &mut Progress) -> Result<End, ProgramError> {
        let output = &self.scenario.output;
        let mut samples = Samples::new(output.series_every, output.frames_every);
        let mut pace = Pace::new();
        let mut quiet = Quiet::new(self.simulation.time());
        self.files.row(&self.simulation)?;
        self.files.frame(&self.simulation)?;
        loop {
            if let Some(code) = signals.exit_code() {
                return Ok(End::new(StoppedBy::Interrupted, code));
            }
            let now = self.simulation.time();
            let before = self.simulation.counts().total();
            let until = samples.next().min(pace.slice_after(now)).min(self.end);
            let event_limit = self.scenario.stop.events.unwrap_or(u64::MAX);
            let limits = Limits {
                time: until,
                events: event_limit.min(before.saturating_add(pace.events())),
                all_frozen: self.ends_frozen(),
            };
            pace.begin();
            let why = self.simulation.run(&limits, &mut self.watch);
            pace.end(why == StopReason::Time && until < samples.next());
            let events = self.simulation.counts().total();
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
                    let due = samples.due(until, events);
                    if until >= self.end {
                        return Ok(End::new(StoppedBy::Time, 0));
                    }
                    if self.scenario.stop.time.is_none() && quiet.lasts(until, events) {
                        return Ok(End::new(StoppedBy::Events, 0));
                    }
                    if due.row {
                        self.files.row(&self.simulation)?;
                    }
                    if due.frame {
                        self.files.frame(&self.simulation)?;
                    }
                }
            }
            progress.show(self.simulation.time().units(), events, self.share());
        }
    }

    /// Whether a slice is to end when everything is at rest.
    fn ends_frozen(&self) -> bool {
        let more = |dropper: &Dropper<D>| dropper.dropped < dropper.count;
        self.scenario.stop.all_frozen.unwrap_or(true) || self.dropper.as_ref().is_some_and(more)
    }

    /// Everything is at rest: drops the next grain, or ends the run.
    fn all_at_rest(&mut self) -> Option<End> {
        let Some(dropper) = &mut self.dropper else {
            return Some(End::new(StoppedBy::AllFrozen, 0));
        };
        if dropper.dropped == dropper.count {
            return Some(End::new(StoppedBy::AllFrozen, 0));
        }
        dropper.dropped += 1;
        let heap = self.simulation.snapshot();
        let top = analysis::highest_surface(&heap).unwrap_or(0.0);
        let inserted = dropper
            .source
            .grain(top, &mut dropper.random)
            .and_then(|grain| self.simulation.insert(grain).map(|_| grain));
        match inserted {
            Ok(grain) => {
                self.watch.normal.add(&grain, self.simulation.time());
                None
            }
            Err(error) => Some(failed_to_drop(&error)),
        }
    }

    /// How much is done, as far as that can be known, 0 … 1.
    fn share(&self) -> f64 {
        let stop = &self.scenario.stop;
        let time = stop
            .time
            .map_or(0.0, |end| self.simulation.time().units() / end);
        let events = stop.events.map_or(0.0, |end| {
            self.simulation.counts().total() as f64 / end as f64
        });
        let of = |done: usize, all: usize| {
            if all > 0 {
                done as f64 / all as f64
            } else {
                0.0
            }
        };
        let landed = of(self.watch.normal.landed(), self.rain);
        let dropped = self
            .dropper
            .as_ref()
            .map_or(0.0, |dropper| of(dropper.dropped, dropper.count));
        let deposited = if stop.all_frozen.unwrap_or(true) {
            if self.dropper.is_some() {
                dropped
            } else {
                landed
            }
        } else {
            0.0
        };
        time.max(events).max(deposited).clamp(0.0, 1.0)
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

    fn summary(&self, end: End, cpu_seconds: f64) -> Summary {
        let simulation = &self.simulation;
        let counts = simulation.counts();
        let grains = simulation.snapshot();
        let area = self.scenario.deposit_area();
        let fraction = area.and_then(|area| analysis::packing_fraction(&grains, area));
        let from = self.scenario.output.mean_normal_from;
        Summary {
            title: self.scenario.title.clone(),
            time: simulation.time().units(),
            stop_reason: end.reason,
            error: end.error,
            collapse: end.collapse,
            seed: self.scenario.seed,
            events: counts.into(),
            particles: simulation.mode_counts().into(),
            kinetic_energy: simulation.kinetic_energy(),
            potential_energy: plain(simulation.potential_energy()),
            energy_ledger: simulation.energy_ledger().into(),
            packing_fraction: fraction.map(|slab| FractionReport {
                value: slab.value,
                from: slab.from,
                to: slab.to,
            }),
            mean_normal: area.and_then(|_| self.watch.normal.mean(from)),
            max_overlap: simulation.max_overlap(),
            cpu_seconds,
            events_per_second: if cpu_seconds > 0.0 {
                counts.total() as f64 / cpu_seconds
            } else {
                0.0
            },
            trajectory_hash: format!("{:016x}", self.watch.hash.value()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}

fn failed_to_drop(error: &SetupError) -> End {
    let mut end = End::new(StoppedBy::Error, 3);
    end.error = Some(format!("the next grain could not be dropped: {error}"));
    end
}
