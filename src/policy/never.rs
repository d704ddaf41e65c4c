use crate::model::{
    Impact, NoEvent, Reason, SleepDecision, StatePolicy, Surroundings, WakeDecision,
};
use crate::particle::{ParticleId, Vector};

/// Nobody falls asleep and nobody wakes: the plain inelastic hard-sphere model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Never;

impl<const D: usize> StatePolicy<D> for Never {
    type Memory = ();
    type Event = NoEvent;

    const SLEEPS: bool = false;

    fn should_sleep<S: Surroundings<D>>(
        &self,
        _impact: &Impact<D>,
        _after: Vector<D>,
        _near: &S,
        _memory: &mut (),
    ) -> SleepDecision {
        SleepDecision::Stay(Reason::new("nobody sleeps", 0.0, 0.0))
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        _impact: &Impact<D>,
        _near: &S,
        _struck: &(),
    ) -> WakeDecision<D> {
        WakeDecision::Stay(Reason::new("nobody wakes", 0.0, 0.0))
    }

    fn may_forget<S: Surroundings<D>>(&self, _id: ParticleId, _near: &S, _memory: &()) -> bool {
        true
    }
}
