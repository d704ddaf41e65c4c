//! A run, slice by slice, to its end.

use std::time::Instant;

use crate::engine::{Limits, StopReason};
use crate::error::SetupError;
use crate::model::Model;
use crate::output::{Checkpoint, CollapseReport, StoppedBy};
use crate::program::drive::audits::Audits;
use crate::program::drive::dropper::Dropper;
use crate::program::drive::pace::{Cadence, Pace};
use crate::program::drive::{End, Job, Run, files};
use crate::program::error::ProgramError;
use crate::program::progress::Progress;
use crate::program::signals::Signals;
use crate::time::Time;

/// A run without an end in time ends when nothing has happened for so long, in
/// √(d/g).
const QUIET: f64 = 1.0e6;

impl<M: Model<D>, const D: usize> Run<'_, M, D> {
    /// To the end; what has not come to its end by itself is saved.
    pub(super) fn go(
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
    pub(super) fn cpu_seconds(&self) -> f64 {
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
    pub(super) fn close(&mut self) -> Result<(), ProgramError> {
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
