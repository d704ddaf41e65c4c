//! The files of a run while it goes on.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::time::{Duration, Instant};

use crate::engine::Simulation;
use crate::model::Model;
use crate::output::{EventLog, Frame, RunFolder, Series, SeriesRow};
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

impl Files {
    /// Writes `scenario.toml`, with the files it names beside it, and begins
    /// the others.
    pub(super) fn create(
        folder: &RunFolder,
        scenario: &Scenario,
        inputs: &[(usize, Frame)],
    ) -> Result<Self, ProgramError> {
        let mut resolved = scenario.clone();
        for (index, frame) in inputs {
            let name = format!("input-{index}.xyz");
            let mut text = Vec::new();
            frame
                .write(&mut text)
                .map_err(ProgramError::io(name.clone()))?;
            folder.write(&name, &text)?;
            resolved.grains[*index].file = Some(name);
        }
        let text = toml::to_string(&resolved)
            .map_err(|error| ProgramError::io("scenario.toml")(std::io::Error::other(error)))?;
        let head = format!(
            "# As run by grainfall {}, with every default written out.\n\n",
            env!("CARGO_PKG_VERSION")
        );
        folder.write("scenario.toml", (head + &text).as_bytes())?;
        Ok(Files {
            series: Series::new(folder.create_file("series.csv")?),
            frames: BufWriter::new(folder.create_file("frames.xyz")?),
            flushed: Instant::now(),
            last_row: None,
            last_frame: None,
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

/// The same number, but 0 for −0, which sums of nothing are.
pub(super) fn plain(number: f64) -> f64 {
    number + 0.0
}

/// Tells two states of a run apart: when, and after how many events and grains.
fn stamp<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> (Time, u64) {
    let grains = simulation.mode_counts().total() as u64;
    (simulation.time(), simulation.counts().total() + grains)
}
