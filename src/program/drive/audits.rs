//! Audits on the way.

use crate::engine::Simulation;
use crate::model::Model;
use crate::output::{AuditReport, RunFolder};
use crate::program::error::ProgramError;
use crate::program::show::say;

/// When audits are due, and what they have found.
pub(super) struct Audits {
    report: Option<AuditReport>,
    /// The number of events at which the next is due.
    next: u64,
}

impl Audits {
    /// One every so many events from here on, or none.
    pub(super) fn new(every: Option<u64>, events: u64) -> Self {
        Audits {
            report: every.map(AuditReport::new),
            next: every.map_or(u64::MAX, |every| events.saturating_add(every)),
        }
    }

    /// The number of events at which the next is due.
    pub(super) fn next(&self) -> u64 {
        self.next
    }

    /// Audits a simulation if it is time. Says what was missed first, if
    /// anything.
    pub(super) fn audit<M: Model<D>, const D: usize>(
        &mut self,
        simulation: &mut Simulation<M, D>,
    ) -> Option<String> {
        let report = self.report.as_mut()?;
        let events = simulation.counts().total();
        if events < self.next {
            return None;
        }
        self.next = events.saturating_add(report.every);
        let audit = simulation.audit();
        report.add(&audit);
        audit.missed.first().map(ToString::to_string)
    }

    /// Writes `audit.json`, and a line for people unless `quiet`.
    pub(super) fn write(&self, folder: &RunFolder, quiet: bool) -> Result<(), ProgramError> {
        let Some(report) = &self.report else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(report)
            .map_err(|error| ProgramError::io("audit.json")(error.into()))?;
        folder.write("audit.json", format!("{text}\n").as_bytes())?;
        if !quiet {
            say(&report.to_string())?;
        }
        Ok(())
    }
}
