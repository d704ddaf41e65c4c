use std::io::Write;

use serde::Serialize;

use crate::engine::{Counts, ModeCounts};
use crate::time::Time;

/// One row of `series.csv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesRow {
    /// When.
    pub time: Time,
    /// Grains by mode.
    pub modes: ModeCounts,
    /// Events so far.
    pub counts: Counts,
    /// Kinetic energy of all grains that are not fixed, in mgd.
    pub kinetic_energy: f64,
    /// Potential energy of all grains that are not fixed, in mgd.
    pub potential_energy: f64,
}

/// The columns of `series.csv`.
#[derive(Serialize)]
struct Record {
    time: f64,
    normal: usize,
    falling: usize,
    frozen: usize,
    fixed: usize,
    events: u64,
    pair_events: u64,
    frozen_events: u64,
    wake_events: u64,
    sleep_events: u64,
    wall_events: u64,
    kinetic_energy: f64,
    potential_energy: f64,
}

/// Writes `series.csv`: counts by mode, events and energies over time.
#[derive(Debug)]
pub struct Series<W: Write> {
    table: csv::Writer<W>,
}

impl<W: Write> Series<W> {
    /// A series that goes to `out`.
    pub fn new(out: W) -> Self {
        Series {
            table: csv::Writer::from_writer(out),
        }
    }

    /// A series that goes on in `out`, where the names of the columns stand
    /// already.
    pub fn continued(out: W) -> Self {
        Series {
            table: csv::WriterBuilder::new()
                .has_headers(false)
                .from_writer(out),
        }
    }

    /// Where it goes to; what has not been flushed is not there yet.
    pub fn get_ref(&self) -> &W {
        self.table.get_ref()
    }

    /// Writes a row, and before the first one the names of the columns.
    ///
    /// # Errors
    ///
    /// When the output cannot be written to.
    pub fn write(&mut self, row: &SeriesRow) -> csv::Result<()> {
        self.table.serialize(Record {
            time: row.time.units(),
            normal: row.modes.normal,
            falling: row.modes.falling,
            frozen: row.modes.frozen,
            fixed: row.modes.fixed,
            events: row.counts.total(),
            pair_events: row.counts.pair,
            frozen_events: row.counts.frozen,
            wake_events: row.counts.wake + row.counts.check_wake,
            sleep_events: row.counts.sleep,
            wall_events: row.counts.wall,
            kinetic_energy: row.kinetic_energy,
            potential_energy: row.potential_energy,
        })
    }

    /// Hands everything on to the output.
    ///
    /// # Errors
    ///
    /// When the output cannot be written to.
    pub fn flush(&mut self) -> std::io::Result<()> {
        self.table.flush()
    }
}
