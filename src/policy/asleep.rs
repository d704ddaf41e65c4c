//! What a sleeper may get back.

use serde::{Deserialize, Serialize};

use crate::particle::{Mode, Vector};
use crate::time::Time;

/// What a sleeper has lost, and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct Asleep<const D: usize> {
    /// Relative to the ground, in √(gd).
    pub(super) velocity: Vector<D>,
    pub(super) since: Time,
}

impl<const D: usize> Asleep<D> {
    /// Says what is wrong if a grain of this mode remembers, now, to have fallen
    /// asleep so.
    pub(super) fn check(&self, mode: Mode, now: Time) -> Result<(), String> {
        if mode != Mode::Frozen || self.since > now {
            return Err(format!("{} now, it remembers {self:?}", mode.name()));
        }
        Ok(())
    }
}
