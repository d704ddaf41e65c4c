use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64_with_seed;

use crate::model::{Observer, Occurrence, Surroundings};

/// A hash of every physical event: its time, kind, ids, and velocities after,
/// to the last bit. Two runs with the same hash went the same way.
///
/// A chain: the 64-bit XXH3 of each event is seeded with the hash of all before
/// it, so that its whole state is the one number that it shows and can be saved.
#[derive(Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrajectoryHash {
    value: u64,
}

impl TrajectoryHash {
    /// The hash of no event.
    #[must_use]
    pub fn new() -> Self {
        TrajectoryHash::default()
    }

    /// The hash so far.
    #[must_use]
    pub fn value(&self) -> u64 {
        self.value
    }
}

impl std::fmt::Debug for TrajectoryHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "TrajectoryHash({:016x})", self.value())
    }
}

impl<const D: usize> Observer<D> for TrajectoryHash {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, _after: &S) {
        // Time 16 bytes, kind and ids 16, velocities 8 D each: room for D = 6.
        let mut record = [0u8; 128];
        let mut length = 0;
        let mut put = |bytes: &[u8]| {
            record[length..length + bytes.len()].copy_from_slice(bytes);
            length += bytes.len();
        };
        for word in occurrence.time.to_bits() {
            put(&word.to_le_bytes());
        }
        put(&(occurrence.kind as u32).to_le_bytes());
        put(&occurrence.particle.0.to_le_bytes());
        put(&occurrence.other.map_or(u32::MAX, |id| id.0).to_le_bytes());
        let wall = occurrence.wall.map_or(u32::MAX, |id| u32::from(id.0));
        put(&wall.to_le_bytes());
        for velocity in [&occurrence.velocity, &occurrence.other_velocity] {
            for component in velocity.iter().take(6) {
                put(&component.to_le_bytes());
            }
        }
        self.value = xxh3_64_with_seed(&record[..length], self.value);
    }
}
