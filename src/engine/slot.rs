//! What lies ahead of a grain, and its entry in the queue.

use serde::{Deserialize, Serialize};

use crate::engine::queue::{Key, Rank};
use crate::particle::WallId;
use crate::time::Time;

/// Who a grain meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Partner {
    Nobody,
    Particle(u32),
    Wall(WallId),
}

/// What lies ahead of a grain: one cache line.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(align(64))]
pub(super) struct Slot {
    /// Its next contact, as far as it has to know.
    pub(super) contact: Time,
    pub(super) partner: Partner,
    /// The partner's stamp when this was foreseen.
    pub(super) partner_stamp: u32,
    /// Until when its neighbour list is certain to be complete.
    pub(super) renewal: Time,
    /// When it falls asleep, if it is about to.
    pub(super) sleep: Time,
}

impl Slot {
    pub(super) const EMPTY: Slot = Slot {
        contact: Time::NEVER,
        partner: Partner::Nobody,
        partner_stamp: 0,
        renewal: Time::NEVER,
        sleep: Time::NEVER,
    };

    /// When the grain will be predicted anew.
    #[inline]
    pub(super) fn bound(&self) -> Time {
        self.contact.min(self.sleep)
    }

    /// The order of this contact among those at the same time.
    #[inline]
    pub(super) fn contact_key(&self, particle: u32) -> Key {
        contact_key(particle, self.contact, self.partner)
    }

    /// The entry of a grain with this slot.
    #[inline]
    pub(super) fn key(&self, particle: u32) -> Key {
        // At equal times the first of these comes first.
        let mut time = self.contact;
        let mut own = None;
        if self.sleep < time {
            time = self.sleep;
            own = Some(Rank::Sleep);
        }
        if self.renewal < time {
            time = self.renewal;
            own = Some(Rank::Transfer);
        }
        match own {
            None => self.contact_key(particle),
            Some(rank) => Key {
                time,
                rank,
                low: particle,
                high: particle,
            },
        }
    }
}

/// The order of a contact of two grains, or of a grain and a wall.
#[inline]
pub(super) fn contact_key(particle: u32, time: Time, partner: Partner) -> Key {
    let (rank, other) = match partner {
        Partner::Particle(other) => (Rank::Contact, other),
        Partner::Wall(wall) => (Rank::Wall, u32::from(wall.0)),
        Partner::Nobody => (Rank::Transfer, particle),
    };
    let (low, high) = match rank {
        Rank::Contact => (particle.min(other), particle.max(other)),
        _ => (particle, other),
    };
    Key {
        time,
        rank,
        low,
        high,
    }
}
