use std::fmt;

use serde::{Deserialize, Serialize};

use crate::engine::{Audit, Missed};

/// `audit.json`: what comparing the queue with brute force has found.
///
/// A run that is audited writes it besides its other files, which are those of
/// one that is not. It begins anew when the run is resumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AuditReport {
    /// An audit after so many events.
    pub every: u64,
    /// How many there were.
    pub audits: u64,
    /// Pairs with a mobile grain that were looked at, in all audits together.
    pub pairs: u64,
    /// How many of them came near enough to each other, or to a wall, to be
    /// predicted.
    pub predicted: u64,
    /// Contacts that a guard had put off.
    pub deferred: u64,
    /// The deepest overlap of any mobile grain at any audit, in d.
    pub deepest_overlap: f64,
    /// Contacts that would have been missed: there should be none.
    pub missed: Vec<MissedContact>,
}

/// A contact that nobody would have noticed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissedContact {
    /// A grain.
    pub particle: u32,
    /// The grain it meets, or null.
    pub other: Option<u32>,
    /// The wall it meets, or null.
    pub wall: Option<u16>,
    /// When, in √(d/g), to the last digit.
    pub time: String,
    /// When it would have been looked after.
    pub entry: String,
}

impl From<&Missed> for MissedContact {
    fn from(missed: &Missed) -> Self {
        MissedContact {
            particle: missed.particle.0,
            other: missed.other.map(|id| id.0),
            wall: missed.wall.map(|id| id.0),
            time: missed.time.to_string(),
            entry: missed.entry.to_string(),
        }
    }
}

impl AuditReport {
    /// Of no audit yet.
    #[must_use]
    pub fn new(every: u64) -> Self {
        AuditReport {
            every,
            audits: 0,
            pairs: 0,
            predicted: 0,
            deferred: 0,
            deepest_overlap: 0.0,
            missed: Vec::new(),
        }
    }

    /// Adds what an audit has found.
    pub fn add(&mut self, audit: &Audit) {
        self.audits += 1;
        self.pairs += audit.pairs;
        self.predicted += audit.predicted;
        self.deferred += audit.deferred;
        self.deepest_overlap = self.deepest_overlap.max(audit.deepest);
        self.missed
            .extend(audit.missed.iter().map(MissedContact::from));
    }
}

impl fmt::Display for AuditReport {
    /// On one line, for people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} audits of {} pairs, {} predicted: {} missed, {} put off, deepest overlap {:.1e} d",
            self.audits,
            self.pairs,
            self.predicted,
            self.missed.len(),
            self.deferred,
            self.deepest_overlap
        )
    }
}
