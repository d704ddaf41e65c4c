//! What a sleeper may get back.

use serde::{Deserialize, Serialize};

use crate::particle::Vector;
use crate::time::Time;

/// What a sleeper has lost, and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct Asleep<const D: usize> {
    /// Relative to the ground, in √(gd).
    pub(super) velocity: Vector<D>,
    pub(super) since: Time,
}
