use std::io::Write;

use crate::model::{Observer, Occurrence, Surroundings};

/// Writes every physical event to `events.csv`: the exact time, what happened,
/// to whom, the normal closing speed and the momentum that `particle` received.
#[derive(Debug)]
pub struct EventLog<W: Write> {
    table: csv::Writer<W>,
    error: Option<csv::Error>,
    headed: bool,
}

impl<W: Write> EventLog<W> {
    /// A log that goes to `out`.
    pub fn new(out: W) -> Self {
        EventLog {
            table: csv::Writer::from_writer(out),
            error: None,
            headed: false,
        }
    }

    /// A log that goes on in `out`, where the names of the columns stand
    /// already if `headed`.
    pub fn continued(out: W, headed: bool) -> Self {
        EventLog {
            headed,
            ..EventLog::new(out)
        }
    }

    /// Where it goes to; what has not been flushed is not there yet.
    pub fn get_ref(&self) -> &W {
        self.table.get_ref()
    }

    /// Hands everything on to the output.
    ///
    /// # Errors
    ///
    /// When an event could not be written, now or before.
    pub fn flush(&mut self) -> csv::Result<()> {
        match self.error.take() {
            Some(error) => Err(error),
            None => Ok(self.table.flush()?),
        }
    }

    fn write<const D: usize>(&mut self, event: &Occurrence<D>) -> csv::Result<()> {
        let axes = ["impulse_x", "impulse_y", "impulse_z"];
        let known = ["time", "kind", "particle", "other", "wall", "impact_speed"];
        if !self.headed {
            self.headed = true;
            self.table
                .write_record(known.iter().chain(axes.iter().take(D)))?;
        }
        let optional = |id: Option<String>| id.unwrap_or_default();
        for field in [
            event.time.to_string(),
            event.kind.name().to_owned(),
            event.particle.to_string(),
            optional(event.other.map(|id| id.to_string())),
            optional(event.wall.map(|id| id.to_string())),
            format!("{:?}", event.impact_speed),
        ] {
            self.table.write_field(field)?;
        }
        for component in event.impulse.iter() {
            self.table.write_field(format!("{component:?}"))?;
        }
        self.table.write_record(None::<&[u8]>)
    }
}

impl<W: Write, const D: usize> Observer<D> for EventLog<W> {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, _: &S) {
        if self.error.is_none() {
            self.error = self.write(occurrence).err();
        }
    }
}
