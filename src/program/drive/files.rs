//! The files of a run while it goes on.

use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::engine::Simulation;
use crate::model::Model;
use crate::output::{Checkpoint, EventLog, Frame, RunFolder, Series, SeriesRow};
use crate::program::drive::state::{Unusable, nothing_yet};
use crate::program::error::ProgramError;
use crate::scenario::Scenario;
use crate::time::Time;

/// `events.csv`; the table has a buffer of its own.
pub(super) type Log = EventLog<File>;

/// How often what is in buffers goes to the disk, so that a run can be followed.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// `series.csv` and `frames.xyz`.
pub(super) struct Files {
    /// The table has a buffer of its own.
    series: Series<File>,
    frames: BufWriter<File>,
    flushed: Instant,
    last_row: Option<(Time, u64)>,
    last_frame: Option<(Time, u64)>,
}

/// How far the files have got.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SavedFiles {
    /// Lengths in bytes.
    series: u64,
    frames: u64,
    events: Option<u64>,
    last_row: Option<(Time, u64)>,
    last_frame: Option<(Time, u64)>,
}

/// Writes what says what is run: the files that the scenario names, a
/// checkpoint that says that nothing has been set up, and `scenario.toml`. The
/// last comes last: where it is, a run can be resumed. Returns its text, and the
/// scenario with those files in the place of the ones that were named.
pub(in crate::program) fn begin(
    folder: &RunFolder,
    scenario: &Scenario,
    inputs: &[(usize, Frame)],
) -> Result<(Vec<u8>, Scenario), ProgramError> {
    let resolved = with_inputs(scenario);
    for (index, frame) in inputs {
        let name = input(*index);
        let mut text = Vec::new();
        frame
            .write(&mut text)
            .map_err(ProgramError::io(name.clone()))?;
        folder.write(&name, &text)?;
    }
    let text = text_of(&resolved)?;
    write_checkpoint(folder, &Checkpoint::new(&text, nothing_yet()))?;
    folder.write("scenario.toml", &text)?;
    Ok((text, resolved))
}

/// What stands in the `scenario.toml` of a run of a scenario.
pub(in crate::program) fn scenario_text(scenario: &Scenario) -> Result<Vec<u8>, ProgramError> {
    text_of(&with_inputs(scenario))
}

/// The copy of a file of grains, named after the place of its source in the
/// list.
fn input(index: usize) -> String {
    format!("input-{index}.xyz")
}

/// The scenario with these copies in the place of the files that it names.
fn with_inputs(scenario: &Scenario) -> Scenario {
    let mut resolved = scenario.clone();
    for (index, source) in resolved.grains.iter_mut().enumerate() {
        if let Some(file) = &mut source.file {
            *file = input(index);
        }
    }
    resolved
}

fn text_of(resolved: &Scenario) -> Result<Vec<u8>, ProgramError> {
    let text = toml::to_string(resolved)
        .map_err(|error| ProgramError::io("scenario.toml")(std::io::Error::other(error)))?;
    let head = format!(
        "# As run by grainfall {}, with every default written out.\n\n",
        env!("CARGO_PKG_VERSION")
    );
    Ok((head + &text).into_bytes())
}

pub(super) fn write_checkpoint(
    folder: &RunFolder,
    checkpoint: &Checkpoint,
) -> Result<(), ProgramError> {
    let name = folder.file("checkpoint").display().to_string();
    checkpoint.write(folder).map_err(ProgramError::io(name))
}

impl Files {
    /// Begins the files.
    pub(super) fn create(
        folder: &RunFolder,
        scenario: &Scenario,
    ) -> Result<(Self, Option<Log>), ProgramError> {
        let files = Files {
            series: Series::new(folder.create_file("series.csv")?),
            frames: BufWriter::new(folder.create_file("frames.xyz")?),
            flushed: Instant::now(),
            last_row: None,
            last_frame: None,
        };
        let log = match scenario.output.events {
            true => Some(EventLog::new(folder.create_file("events.csv")?)),
            false => None,
        };
        Ok((files, log))
    }

    /// Goes on with the files of an earlier run, cut back to where it was.
    pub(super) fn continued(
        folder: &RunFolder,
        scenario: &Scenario,
        saved: &SavedFiles,
    ) -> Result<(Self, Option<Log>), Unusable> {
        if saved.events.is_some() != scenario.output.events {
            return Err(Unusable::State(
                "its files are not the scenario's".to_owned(),
            ));
        }
        let mut lengths = vec![("series.csv", saved.series), ("frames.xyz", saved.frames)];
        lengths.extend(saved.events.map(|length| ("events.csv", length)));
        // All of them, before anything is cut.
        for (name, length) in lengths {
            folder
                .check_length(name, length)
                .map_err(|error| Unusable::State(error.to_string()))?;
        }
        let cut = |name, at| folder.cut_file(name, at).map_err(ProgramError::from);
        let series = cut("series.csv", saved.series)?;
        let files = Files {
            series: match saved.series {
                0 => Series::new(series),
                _ => Series::continued(series),
            },
            frames: BufWriter::new(cut("frames.xyz", saved.frames)?),
            flushed: Instant::now(),
            last_row: saved.last_row,
            last_frame: saved.last_frame,
        };
        let log = match saved.events {
            Some(at) => Some(EventLog::continued(cut("events.csv", at)?, at > 0)),
            None => None,
        };
        Ok((files, log))
    }

    /// How far they have got, all of it on the disk.
    pub(super) fn save(&mut self, log: Option<&mut Log>) -> Result<SavedFiles, ProgramError> {
        self.flush()?;
        let events = match log {
            Some(log) => {
                let failed = |error: csv::Error| ProgramError::io("events.csv")(error.into());
                log.flush().map_err(failed)?;
                Some(length("events.csv", log.get_ref())?)
            }
            None => None,
        };
        Ok(SavedFiles {
            series: length("series.csv", self.series.get_ref())?,
            frames: length("frames.xyz", self.frames.get_ref())?,
            events,
            last_row: self.last_row,
            last_frame: self.last_frame,
        })
    }

    /// Writes a row, unless the last one says the same.
    pub(super) fn row<M: Model<D>, const D: usize>(
        &mut self,
        simulation: &Simulation<M, D>,
    ) -> Result<(), ProgramError> {
        let now = stamp(simulation);
        if self.last_row.replace(now) == Some(now) {
            return Ok(());
        }
        self.series
            .write(&SeriesRow {
                time: simulation.time(),
                modes: simulation.mode_counts(),
                counts: *simulation.counts(),
                kinetic_energy: simulation.kinetic_energy(),
                potential_energy: plain(simulation.potential_energy()),
            })
            .map_err(|error| ProgramError::io("series.csv")(error.into()))?;
        if self.flushed.elapsed() >= FLUSH_EVERY {
            self.flushed = Instant::now();
            self.flush()?;
        }
        Ok(())
    }

    /// Writes a frame, unless the last one says the same.
    pub(super) fn frame<M: Model<D>, const D: usize>(
        &mut self,
        simulation: &Simulation<M, D>,
    ) -> Result<(), ProgramError> {
        let now = stamp(simulation);
        if self.last_frame.replace(now) == Some(now) {
            return Ok(());
        }
        let boundary = simulation.model().boundary();
        Frame::new(&simulation.snapshot(), simulation.time(), boundary)
            .write(&mut self.frames)
            .map_err(ProgramError::io("frames.xyz"))
    }

    pub(super) fn flush(&mut self) -> Result<(), ProgramError> {
        self.series
            .flush()
            .map_err(ProgramError::io("series.csv"))?;
        self.frames.flush().map_err(ProgramError::io("frames.xyz"))
    }
}

/// The length of a file that has been written up to its end, once it is on the
/// disk.
fn length(name: &str, mut file: &File) -> Result<u64, ProgramError> {
    file.sync_data()
        .and_then(|()| file.stream_position())
        .map_err(ProgramError::io(name))
}

/// The same number, but 0 for −0, which sums of nothing are.
pub(super) fn plain(number: f64) -> f64 {
    number + 0.0
}

/// Tells two states of a run apart: when, and after how many events and grains.
fn stamp<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> (Time, u64) {
    let grains = simulation.mode_counts().total() as u64;
    (simulation.time(), simulation.counts().total() + grains)
}
