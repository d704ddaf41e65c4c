//! A policy that puts grains to sleep and wakes them at random.

use serde::{Deserialize, Serialize};

use crate::model::{
    Commands, Impact, Place, Reason, Response, SleepDecision, StatePolicy, Surroundings, WakeCause,
    WakeDecision, Waking,
};
use crate::particle::{Mode, ParticleId, Vector};
use crate::time::Time;

/// Decides by a hash of the time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Restless {
    pub(super) seed: u64,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Nudge;

impl Restless {
    fn dice(&self, time: Time, id: ParticleId) -> u64 {
        let [ticks, rest] = time.to_bits();
        let mut x = self.seed ^ ticks.rotate_left(17) ^ rest ^ (u64::from(id.0) << 40);
        // The finisher of splitmix64.
        x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    fn velocity<const D: usize>(&self, time: Time, id: ParticleId) -> Vector<D> {
        let dice = self.dice(time, id);
        if dice.is_multiple_of(3) {
            return Vector::zeros();
        }
        Vector::from_fn(|axis, _| ((dice >> (8 * axis)) & 255) as f64 / 128.0 - 1.0)
    }
}

impl<const D: usize> StatePolicy<D> for Restless {
    type Memory = ();
    type Event = Nudge;

    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _after: Vector<D>,
        _near: &S,
        _memory: &mut (),
    ) -> SleepDecision {
        let reason = Reason::new("at random", 0.0, 0.0);
        match self.dice(impact.time, impact.id) % 8 {
            0 => SleepDecision::Sleep(Place::Here, reason),
            1 | 2 => SleepDecision::Sleep(Place::HalfWay, reason),
            _ => SleepDecision::Stay(reason),
        }
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _near: &S,
        _struck: &(),
    ) -> WakeDecision<D> {
        let reason = Reason::new("at random", 0.0, 0.0);
        if self.dice(impact.time, impact.id).is_multiple_of(3) {
            WakeDecision::Wake(
                Waking::with_velocity(self.velocity(impact.time, impact.id)),
                reason,
            )
        } else {
            WakeDecision::Stay(reason)
        }
    }

    fn on_start<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        _memory: &mut (),
        commands: &mut Commands<Nudge>,
    ) {
        if near.particle(id).mode == Mode::Frozen {
            commands.schedule(id, 0.7, Nudge);
        }
    }

    fn on_sleep<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        _near: &S,
        _memory: &mut (),
        commands: &mut Commands<Nudge>,
    ) {
        commands.schedule(id, 0.4, Nudge);
    }

    fn on_wake<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        _cause: &WakeCause<D>,
        _near: &S,
        _memory: &mut (),
        commands: &mut Commands<Nudge>,
    ) {
        commands.schedule(id, 0.3, Nudge);
    }

    fn on_event<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        _event: Nudge,
        near: &S,
        _memory: &mut (),
        commands: &mut Commands<Nudge>,
    ) -> Response<D> {
        let reason = Reason::new("at random", 0.0, 0.0);
        match near.particle(id).mode {
            Mode::Frozen => Response::Wake(
                Waking::with_velocity(self.velocity(near.time(), id)),
                reason,
            ),
            Mode::Normal | Mode::Falling if self.dice(near.time(), id).is_multiple_of(2) => {
                Response::Sleep(reason)
            }
            _ => {
                commands.schedule(id, 0.5, Nudge);
                Response::Keep
            }
        }
    }
}
