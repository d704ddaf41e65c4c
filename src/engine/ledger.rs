//! Where the energy goes.

use serde::{Deserialize, Serialize};

/// How the total energy of all grains but fixed ones has changed since the
/// start, by what changed it, in mgd; what is lost counts negative.
///
/// Total energy is kinetic, ½mv², and potential, −m g·x. Every entry is summed
/// event by event with compensation (Neumaier 1974,
/// doi:10.1002/zamm.19740540106) from the velocities and places that the grains
/// had before and after; no entry is what is left over. So the
/// [`sum`](EnergyLedger::sum) and the [`change`](EnergyLedger::change) differ by
/// rounding, and by what a user's own dynamics does to the energy in flight
/// without saying so ([`Dynamics::DRIVES`](crate::model::Dynamics::DRIVES)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// Collisions of two mobile grains.
    pub pair: f64,
    /// Collisions with static grains that stayed.
    pub frozen: f64,
    /// Collisions that woke a frozen grain, without what it was given.
    pub wake: f64,
    /// Collisions with walls.
    pub wall: f64,
    /// Kinetic energy taken from grains that fell asleep.
    pub sleep: f64,
    /// Kinetic energy given to grains that woke, by hits and by checks.
    pub given_back: f64,
    /// Potential energy that falling grains, which fall at constant velocity,
    /// have lost; up to now, also by those still in flight.
    pub fall: f64,
    /// Guards against endless cascades.
    pub guard: f64,
    /// Work of obstacles that move: fixed grains, walls, moving ground.
    pub moving: f64,
    /// Work of growing diameters in collisions.
    pub growth: f64,
    /// Potential energy gained by re-entering through periodic sides, if
    /// gravity has a component along their axis.
    pub crossing: f64,
    /// Work of gravity that changes in time: what the energy of grains changes by
    /// between events. A potential −m g·x changes with g even if nothing moves.
    pub field: f64,
    /// Energy of grains that were inserted.
    pub inserted: f64,
    /// Not in the sum: what the elastic cut-off V_c spared, that is, what its
    /// collisions would have cost without it (≥ 0).
    pub elastic_spared: f64,
    /// Total energy at the start.
    pub at_start: f64,
    /// Total energy now.
    pub now: f64,
}

impl EnergyLedger {
    /// The entries that make up the sum.
    fn entries(&self) -> [f64; 13] {
        [
            self.pair,
            self.frozen,
            self.wake,
            self.wall,
            self.sleep,
            self.given_back,
            self.fall,
            self.guard,
            self.moving,
            self.growth,
            self.crossing,
            self.field,
            self.inserted,
        ]
    }

    /// All entries together.
    #[must_use]
    pub fn sum(&self) -> f64 {
        let mut sum = Sum::default();
        for entry in self.entries() {
            sum.add(entry);
        }
        sum.value()
    }

    /// How the total energy has changed.
    #[must_use]
    pub fn change(&self) -> f64 {
        self.now - self.at_start
    }

    /// What the entries do not explain, over the sum of their sizes and of the
    /// energies at both ends: rounding leaves some 10⁻¹².
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        let parts = self.entries().into_iter().chain([self.at_start, self.now]);
        let size: f64 = parts.map(f64::abs).sum();
        if size == 0.0 {
            return 0.0;
        }
        (self.sum() - self.change()) / size
    }
}

/// A sum that keeps what rounding takes from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Sum {
    value: f64,
    lost: f64,
}

impl Sum {
    #[inline]
    pub(super) fn add(&mut self, term: f64) {
        let sum = self.value + term;
        self.lost += if self.value.abs() >= term.abs() {
            (self.value - sum) + term
        } else {
            (term - sum) + self.value
        };
        self.value = sum;
    }

    pub(super) fn value(&self) -> f64 {
        self.value + self.lost
    }
}

/// What changes the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entry {
    Pair,
    Frozen,
    Wake,
    Wall,
    Sleep,
    GivenBack,
    Fall,
    Guard,
    Moving,
    Growth,
    Crossing,
    Field,
    Inserted,
    ElasticSpared,
    AtStart,
}

/// The running sums.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ledger {
    sums: [Sum; Entry::AtStart as usize + 1],
}

impl Ledger {
    #[inline]
    pub(super) fn add(&mut self, entry: Entry, energy: f64) {
        self.sums[entry as usize].add(energy);
    }

    /// The entries with the total energy now; `since` has what grains in flight
    /// have changed since their last events.
    pub(super) fn read(&self, now: f64, since: &Ledger) -> EnergyLedger {
        let value =
            |entry: Entry| self.sums[entry as usize].value() + since.sums[entry as usize].value();
        EnergyLedger {
            pair: value(Entry::Pair),
            frozen: value(Entry::Frozen),
            wake: value(Entry::Wake),
            wall: value(Entry::Wall),
            sleep: value(Entry::Sleep),
            given_back: value(Entry::GivenBack),
            fall: value(Entry::Fall),
            guard: value(Entry::Guard),
            moving: value(Entry::Moving),
            growth: value(Entry::Growth),
            crossing: value(Entry::Crossing),
            field: value(Entry::Field),
            inserted: value(Entry::Inserted),
            elastic_spared: value(Entry::ElasticSpared),
            at_start: value(Entry::AtStart),
            now,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Sum;

    #[test]
    fn nothing_is_lost_beside_large_terms() {
        let mut sum = Sum::default();
        for term in [1.0, 1.0e100, 1.0, -1.0e100] {
            sum.add(term);
        }
        assert_eq!(sum.value(), 2.0);
    }
}
