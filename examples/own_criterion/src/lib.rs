//! A sleep criterion of one's own: a grain is tired after a number of slow
//! collisions in a row. Nothing here says how many dimensions there are.

use grainfall::Vector;
use grainfall::model::{
    Impact, NoEvent, Place, Reason, SleepDecision, StatePolicy, Surroundings, WakeDecision, Waking,
};
use serde::{Deserialize, Serialize};

/// Asleep at the `slow_hits`th collision in a row that is slower than `speed`, if
/// that is with a static grain; woken by a hit twice as fast.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tired {
    /// What is slow, in √(gd).
    pub speed: f64,
    /// How many slow collisions make tired.
    pub slow_hits: u32,
}

impl Default for Tired {
    fn default() -> Self {
        Tired {
            speed: 0.1,
            slow_hits: 3,
        }
    }
}

// The criterion: from here to the end of the block.
impl<const D: usize> StatePolicy<D> for Tired {
    type Memory = u32; // how many collisions in a row were slow
    type Event = NoEvent;

    #[rustfmt::skip]
    fn should_sleep<S: Surroundings<D>>(
        &self, hit: &Impact<D>, _after: Vector<D>, _near: &S, slow: &mut u32,
    ) -> SleepDecision {
        let reason = Reason::new("slow hit", hit.arriving_speed(), self.speed);
        *slow = (*slow + 1) * u32::from(reason.value < reason.limit);
        if *slow < self.slow_hits || !hit.is_on_static() {
            return SleepDecision::Stay(reason);
        }
        SleepDecision::Sleep(Place::HalfWay, reason)
    }

    fn should_wake<S: Surroundings<D>>(&self, hit: &Impact<D>, _: &S, _: &u32) -> WakeDecision<D> {
        let reason = Reason::new("hard hit", hit.closing_speed(), 2.0 * self.speed);
        if reason.value <= reason.limit {
            return WakeDecision::Stay(reason);
        }
        WakeDecision::Wake(Waking::at_rest(), reason)
    }
}
