use crate::error::SetupError;
use crate::model::{
    Commands, Impact, Reason, Response, SleepDecision, StatePolicy, Surroundings, WakeCause,
    WakeDecision,
};
use crate::particle::{ParticleId, Vector};
use crate::policy::cone::{Normals, holds};
use crate::policy::parameters::neighbour_range;
use crate::policy::slow_descent::{Remembered, SlowDescent};
use crate::policy::supports::{CheckDue, WALL_RANGE};

/// At rest is who is slow in a pit that holds it: D static grains or walls,
/// near enough, between whose normals the weight can be shared, with no one
/// pulling. That is mechanical stability of a frictionless grain (Moukarzel 1998,
/// doi:10.1103/PhysRevLett.81.1634: D contacts hold one grain isostatically).
///
/// It is asked at each collision with anything, and the way the grain moves does
/// not matter: one that rattles below V_c without losing anything, for ever as
/// fast as before, falls asleep, too. Grains that lean on each other, as in an
/// arch, have no D static contacts as long as both move. So what the paper's
/// criteria put to sleep sleeps here as well, and waking is theirs.
///
/// It fails where the pit is wider than `range` sees, and on a flat floor, which
/// holds at one contact only: there it is no more than the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsostaticSupport {
    /// The paper's criteria, beside it; V_sleep is that of both.
    pub descent: SlowDescent,
    /// Grains nearer than this times their distance at contact are contacts.
    pub range: f64,
}

impl Default for IsostaticSupport {
    /// V_sleep = V_wakeup = 0.1 √(gd), and contacts nearer than 1.001: gaps
    /// below 0.001 d. The wider, the fewer events, and the looser the deposit.
    fn default() -> Self {
        IsostaticSupport {
            descent: SlowDescent::default(),
            range: 1.001,
        }
    }
}

impl IsostaticSupport {
    /// Whether the contacts of a grain hold it, in a place where gravity points
    /// that way; says how many there are.
    fn is_held<const D: usize, S: Surroundings<D>>(
        &self,
        id: ParticleId,
        gravity: &Vector<D>,
        near: &S,
    ) -> Result<Reason, Reason> {
        let mut normals = Normals::<D>::new();
        near.for_each_neighbour(id, self.range, |other| {
            if other.mode.is_static() {
                normals.add(-other.offset / other.offset.norm_squared().sqrt());
            }
        });
        if self.descent.wall_supports {
            near.for_each_wall(id, WALL_RANGE, |wall| normals.add(wall.normal));
        }
        let count = normals.as_slice().len() as f64;
        if normals.as_slice().len() < D {
            return Err(Reason::new("D static contacts", count, D as f64));
        }
        let reason = Reason::new("static contacts that hold the weight", count, D as f64);
        if holds(normals.as_slice(), &-gravity) {
            Ok(reason)
        } else {
            Err(reason)
        }
    }
}

impl<const D: usize> StatePolicy<D> for IsostaticSupport {
    type Memory = Remembered<D>;
    type Event = CheckDue;

    fn validate(&self) -> Result<(), SetupError> {
        neighbour_range("range", self.range)?;
        StatePolicy::<D>::validate(&self.descent)
    }

    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        memory: &mut Remembered<D>,
    ) -> SleepDecision {
        let descent = self.descent.should_sleep(impact, after, near, memory);
        if matches!(descent, SleepDecision::Sleep(..)) {
            return descent;
        }
        let speed = impact.arriving_speed();
        if speed >= self.descent.sleep_speed {
            let slow = Reason::new("speed below V_sleep", speed, self.descent.sleep_speed);
            return SleepDecision::Stay(slow);
        }
        match self.is_held(impact.id, &impact.gravity, near) {
            Ok(reason) => SleepDecision::Sleep(self.descent.place, reason),
            Err(reason) => SleepDecision::Stay(reason),
        }
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        near: &S,
        struck: &Remembered<D>,
    ) -> WakeDecision<D> {
        self.descent.should_wake(impact, near, struck)
    }

    fn check_memory<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &Remembered<D>,
    ) -> Result<(), String> {
        self.descent.check_memory(id, near, memory)
    }

    fn may_forget<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &Remembered<D>,
    ) -> bool {
        self.descent.may_forget(id, near, memory)
    }

    fn on_start<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        self.descent.on_start(id, near, memory, commands);
    }

    fn on_sleep<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        self.descent.on_sleep(id, near, memory, commands);
    }

    fn on_wake<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        cause: &WakeCause<D>,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        self.descent.on_wake(id, cause, near, memory, commands);
    }

    fn on_event<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        event: CheckDue,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        self.descent.on_event(id, event, near, memory, commands)
    }

    fn on_support_change<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        supporter: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        self.descent
            .on_support_change(id, supporter, near, memory, commands)
    }
}
