use serde::{Deserialize, Serialize};

use crate::particle::Mode;

/// What has happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Collisions of two mobile grains.
    pub pair: u64,
    /// Collisions of a mobile grain with a static one that stayed.
    pub frozen: u64,
    /// Collisions that woke a frozen grain.
    pub wake: u64,
    /// Grains that fell asleep.
    pub sleep: u64,
    /// Events of the policy's own, such as self-checks, that were carried out.
    pub check: u64,
    /// Times the policy was asked about a sleeper since a grain that it leans on
    /// had changed.
    pub support: u64,
    /// Times that the answer to one of both woke a grain.
    pub check_wake: u64,
    /// Collisions with walls.
    pub wall: u64,
    /// Neighbour lists made anew for grains that moved on; not physical.
    pub transfer: u64,
    /// Collisions of any kind that a cut-off speed made elastic.
    pub elastic: u64,
    /// Times a guard against endless cascades acted.
    pub guard: u64,
}

impl Counts {
    /// Physical events: all kinds but transfers and checks that passed.
    /// (Elastic collisions and guards are no kinds of their own.)
    #[must_use]
    pub fn total(&self) -> u64 {
        self.pair + self.frozen + self.wake + self.sleep + self.check_wake + self.wall
    }
}

/// How many grains there are of each mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModeCounts {
    /// Normal.
    pub normal: usize,
    /// Falling.
    pub falling: usize,
    /// Frozen.
    pub frozen: usize,
    /// Fixed.
    pub fixed: usize,
}

impl ModeCounts {
    /// All grains.
    #[must_use]
    pub fn total(&self) -> usize {
        self.normal + self.falling + self.frozen + self.fixed
    }

    /// Normal and falling ones.
    #[must_use]
    pub fn mobile(&self) -> usize {
        self.normal + self.falling
    }

    /// The number of grains of a mode.
    pub(super) fn of(&mut self, mode: Mode) -> &mut usize {
        match mode {
            Mode::Normal => &mut self.normal,
            Mode::Falling => &mut self.falling,
            Mode::Frozen => &mut self.frozen,
            Mode::Fixed => &mut self.fixed,
        }
    }
}
