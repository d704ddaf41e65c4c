//! What the criteria of the gallery share: when they are asked, where a grain
//! falls asleep, and how it wakes. They differ in one condition.

use std::fmt::Debug;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{
    Commands, Impact, Place, Reason, Response, SleepDecision, StatePolicy, Surroundings, WakeCause,
    WakeDecision, Waking,
};
use crate::particle::{Mode, ParticleId, Vector};
use crate::policy::asleep::Asleep;
use crate::policy::parameters::not_negative;
use crate::policy::supports::{Check, CheckDue, Kept, SelfCheck};
use crate::time::Time;

/// When a grain may be called at rest.
///
/// The generic type names are: `D` the dimension, `S` the surroundings.
pub trait RestCondition<const D: usize> {
    /// What it keeps of each grain while that is awake; cleared when it falls
    /// asleep.
    type History: Clone + Default + Debug + Serialize + DeserializeOwned;

    /// Refuses parameters that are out of range.
    ///
    /// # Errors
    ///
    /// [`SetupError`] with the parameter, its value and what is allowed.
    fn validate(&self) -> Result<(), SetupError>;

    /// Whether the grain of `impact`, which leaves with velocity `after`, is at
    /// rest. Asked at each of its collisions with anything, so that a history
    /// can be kept; only at those with a static grain (or a wall, if walls
    /// support) does the answer count.
    ///
    /// # Errors
    ///
    /// The condition that failed, with its numbers.
    fn at_rest<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        history: &mut Self::History,
    ) -> Result<Reason, Reason>;
}

/// A grain falls asleep at a collision with a static grain if `condition` calls
/// it at rest. Waking is the paper's: by a hit with a normal speed above
/// V_wakeup, with the velocity given back if that is soon, or by the self-check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest<C> {
    /// When a grain is at rest.
    pub condition: C,
    /// V_wakeup, in √(gd); infinite if no hit ever wakes.
    pub wake_speed: f64,
    /// How long a sleeper can get its velocity back, in √(d/g); 0 for never.
    pub store_time: f64,
    /// Where a grain falls asleep.
    pub place: Place,
    /// Whether walls support grains as frozen ones do.
    pub wall_supports: bool,
    /// The self-check of supports; none if frozen grains never check.
    pub self_check: Option<SelfCheck>,
}

impl<C> AtRest<C> {
    /// With the paper's waking for V_sleep = V_wakeup = 0.1 √(gd) and
    /// α_frozen = 0.4, and no self-check.
    #[must_use]
    pub fn new(condition: C) -> Self {
        AtRest {
            condition,
            wake_speed: 0.1,
            store_time: 0.2 / 0.6,
            place: Place::HalfWay,
            wall_supports: false,
            self_check: None,
        }
    }

    fn check(&self) -> Option<Check<'_>> {
        Check::of(self.self_check.as_ref(), self.wall_supports)
    }

    /// What a sleeper starts with if it wakes now.
    fn given_back<H, const D: usize>(
        &self,
        memory: &RestMemory<H, D>,
        now: Time,
        ground: Vector<D>,
    ) -> Waking<D> {
        match memory.asleep {
            Some(asleep) if now - asleep.since < self.store_time => {
                Waking::with_velocity(ground + asleep.velocity)
            }
            _ => Waking::with_velocity(ground),
        }
    }
}

/// What [`AtRest`] remembers of a grain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "H: Serialize + DeserializeOwned")]
pub struct RestMemory<H, const D: usize> {
    history: H,
    asleep: Option<Asleep<D>>,
    supports: Kept,
}

impl<const D: usize, C: RestCondition<D>> StatePolicy<D> for AtRest<C> {
    type Memory = RestMemory<C::History, D>;
    type Event = CheckDue;

    fn validate(&self) -> Result<(), SetupError> {
        not_negative("wake_speed", self.wake_speed)?;
        not_negative("store_time", self.store_time)?;
        self.condition.validate()?;
        self.self_check.as_ref().map_or(Ok(()), SelfCheck::validate)
    }

    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        memory: &mut Self::Memory,
    ) -> SleepDecision {
        let answer = self
            .condition
            .at_rest(impact, after, near, &mut memory.history);
        if !(impact.is_on_static() || self.wall_supports && impact.is_on_wall()) {
            return SleepDecision::Stay(Reason::new("on a static grain", 0.0, 1.0));
        }
        match answer {
            Ok(reason) => SleepDecision::Sleep(self.place, reason),
            Err(reason) => SleepDecision::Stay(reason),
        }
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _near: &S,
        struck: &Self::Memory,
    ) -> WakeDecision<D> {
        let speed = impact.closing_speed();
        let reason = Reason::new("hit faster than V_wakeup", speed, self.wake_speed);
        if speed <= self.wake_speed {
            return WakeDecision::Stay(reason);
        }
        let ground = impact.obstacle_velocity();
        WakeDecision::Wake(self.given_back(struck, impact.time, ground), reason)
    }

    fn check_memory<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &Self::Memory,
    ) -> Result<(), String> {
        match &memory.asleep {
            Some(asleep) => asleep.check(near.particle(id).mode, near.time()),
            None => Ok(()),
        }
    }

    fn may_forget<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &Self::Memory,
    ) -> bool {
        let is_over = match (near.particle(id).mode, memory.asleep) {
            // It may have a history.
            (Mode::Normal, _) => false,
            (_, Some(asleep)) => near.time() - asleep.since >= self.store_time,
            (_, None) => true,
        };
        is_over && memory.supports.is_empty()
    }

    fn on_start<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Self::Memory,
        commands: &mut Commands<CheckDue>,
    ) {
        memory.supports.start(self.check(), id, near, commands);
    }

    fn on_sleep<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Self::Memory,
        commands: &mut Commands<CheckDue>,
    ) {
        memory.history = C::History::default();
        memory.asleep = Some(Asleep {
            velocity: near.particle(id).velocity - near.ground_velocity(id),
            since: near.time(),
        });
        memory.supports.begin(self.check(), id, near, commands);
    }

    fn on_wake<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        _cause: &WakeCause<D>,
        _near: &S,
        memory: &mut Self::Memory,
        _commands: &mut Commands<CheckDue>,
    ) {
        memory.asleep = None;
        memory.supports.forget();
    }

    fn on_event<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        event: CheckDue,
        near: &S,
        memory: &mut Self::Memory,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        let kept = &memory.supports;
        kept.go_on(self.check(), event, id, near, commands, |grain| {
            self.given_back(memory, near.time(), grain.velocity)
        })
    }

    fn on_support_change<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        _supporter: ParticleId,
        near: &S,
        memory: &mut Self::Memory,
        _commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        let kept = &memory.supports;
        kept.answer(self.check(), id, near, |grain| {
            self.given_back(memory, near.time(), grain.velocity)
        })
    }
}
