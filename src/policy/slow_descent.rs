//! The paper's criteria.

mod readings;

pub use readings::{Comparison, DescentRead, EnergyStore, SpeedRead, StoreAt, WakeRead};

use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{
    Commands, GravityCourse, Impact, Obstacle, Place, Reason, Response, SleepDecision, StatePolicy,
    Surroundings, WakeCause, WakeDecision, Waking,
};
use crate::particle::{Particle, ParticleId, Vector};
use crate::policy::asleep::Asleep;
use crate::policy::parameters::{fraction, not_negative};
use crate::policy::supports::{Check, CheckDue, Kept, SelfCheck};
use crate::time::Time;

/// The paper's criteria (section 2), and its self-check (section 4).
///
/// A grain falls asleep, half-way to its next collision, if at a collision with
/// a frozen or fixed grain it is going down and its speed is below V_sleep and
/// below that at its previous collision. A frozen grain wakes if it is hit
/// with a normal speed above V_wakeup, or if its self-check finds that its
/// support is lost. If it wakes within 2 V_sleep/((1 − α_frozen) g) of falling
/// asleep it gets back the velocity it had.
///
/// The defaults are the paper's as far as it decides; every other reading has a
/// field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlowDescent {
    /// V_sleep, in √(gd).
    pub sleep_speed: f64,
    /// V_wakeup, in √(gd); infinite if no hit ever wakes.
    pub wake_speed: f64,
    /// α_frozen, which only sets how long energy is stored.
    pub frozen_restitution: f64,
    /// What becomes of the energy of a sleeper that is soon woken.
    pub energy_store: EnergyStore,
    /// Which velocity is stored.
    pub store_at: StoreAt,
    /// How long it is stored, in √(d/g), instead of
    /// 2 V_sleep/((1 − α_frozen) g).
    pub store_time: Option<f64>,
    /// Which speed the sleep test reads.
    pub speed_read: SpeedRead,
    /// Which velocity has to point down.
    pub descent_read: DescentRead,
    /// With which earlier collision the speed is compared.
    pub comparison: Comparison,
    /// Which speed of a hit counts.
    pub wake_read: WakeRead,
    /// Where a grain falls asleep.
    pub place: Place,
    /// Whether walls support grains as frozen ones do.
    pub wall_supports: bool,
    /// The self-check of supports; none if frozen grains never check.
    pub self_check: Option<SelfCheck>,
    /// Keep the speed at the last collision through sleep.
    pub keep_history: bool,
}

impl Default for SlowDescent {
    /// V_sleep = V_wakeup = 0.1 √(gd), α_frozen = 0.4, no self-check: the
    /// paper's deposition.
    fn default() -> Self {
        SlowDescent {
            sleep_speed: 0.1,
            wake_speed: 0.1,
            frozen_restitution: 0.4,
            energy_store: EnergyStore::default(),
            store_at: StoreAt::default(),
            store_time: None,
            speed_read: SpeedRead::default(),
            descent_read: DescentRead::default(),
            comparison: Comparison::default(),
            wake_read: WakeRead::default(),
            place: Place::HalfWay,
            wall_supports: false,
            self_check: None,
            keep_history: false,
        }
    }
}

impl SlowDescent {
    /// The paper's criteria with V_sleep = V_wakeup = `threshold`, in √(gd).
    #[must_use]
    pub fn with_threshold(threshold: f64) -> Self {
        SlowDescent {
            sleep_speed: threshold,
            wake_speed: threshold,
            ..SlowDescent::default()
        }
    }

    /// How long the energy of a sleeper is stored, in √(d/g).
    pub(crate) fn store_time(&self, gravity: f64) -> f64 {
        self.store_time
            .unwrap_or(2.0 * self.sleep_speed / ((1.0 - self.frozen_restitution) * gravity))
    }

    /// Whether what a sleeper has lost may still be given back so long after it fell
    /// asleep, or later.
    fn stores_after<const D: usize, S: Surroundings<D>>(&self, asleep: f64, near: &S) -> bool {
        let store_time = match (self.store_time, near.gravity_course()) {
            (Some(time), _) => time,
            // Weaker gravity would store it longer.
            (None, GravityCourse::Unknown) => f64::INFINITY,
            (None, _) => self.store_time(near.gravity().norm_squared().sqrt()),
        };
        self.energy_store != EnergyStore::Off && asleep <= STORE_MARGIN * store_time
    }

    fn check(&self) -> Option<Check<'_>> {
        Check::of(self.self_check.as_ref(), self.wall_supports)
    }

    /// What a sleeper gets back if it wakes now.
    fn given_back<const D: usize>(
        &self,
        memory: &Remembered<D>,
        now: Time,
        gravity: &Vector<D>,
        ground: Vector<D>,
        mass: f64,
    ) -> Waking<D> {
        let still_stored = memory
            .rest
            .asleep()
            .filter(|asleep| now - asleep.since < self.store_time(gravity.norm_squared().sqrt()));
        match (still_stored, self.energy_store) {
            (Some(asleep), EnergyStore::VelocityBefore) => {
                Waking::with_velocity(ground + asleep.velocity)
            }
            (Some(asleep), EnergyStore::EnergyAfter) => Waking {
                velocity: ground,
                extra_energy: 0.5 * mass * asleep.velocity.norm_squared(),
            },
            _ => Waking::with_velocity(ground),
        }
    }

    /// The same for one that has lost a support.
    fn woken_by_check<const D: usize, S: Surroundings<D>>(
        &self,
        memory: &Remembered<D>,
        near: &S,
        grain: &Particle<D>,
    ) -> Waking<D> {
        let (now, gravity) = (near.time(), near.gravity());
        self.given_back(memory, now, &gravity, grain.velocity, grain.mass)
    }

    fn is_on_support<const D: usize>(&self, impact: &Impact<D>) -> bool {
        impact.is_on_static() || (self.wall_supports && impact.is_on_wall())
    }
}

/// A bound on the length of gravity that turns, over the least of it: its rounding.
const STORE_MARGIN: f64 = 1.0 + 1.0e-9;

/// Difference of two kinetic energies, over the mass, up to which they are
/// equal, in gd: well above what the rounding of a place makes of it, 10⁻¹⁵ or
/// so, and well below the energy of a bounce at the slowest V_c in use.
const EQUAL_ENERGY: f64 = 1.0e-12;

/// Whether a speed is lower than an earlier one by more than rounding: bounces
/// that are elastic, below V_c, are all equally fast, and wear nobody out.
fn is_slower(speed: f64, before: f64) -> bool {
    0.5 * (before - speed) * (before + speed) > EQUAL_ENERGY
}

/// What [`SlowDescent`] remembers of a grain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Remembered<const D: usize> {
    /// Speed at the last collision that counts, relative to the ground, in
    /// √(gd).
    previous_speed: Option<f64>,
    rest: Rest<D>,
    supports: Kept,
}

/// How far a grain is from being asleep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
enum Rest<const D: usize> {
    #[default]
    Awake,
    /// A collision has decided it; its velocity after that, relative to the ground.
    Decided(Vector<D>),
    Asleep(Asleep<D>),
}

impl<const D: usize> Rest<D> {
    fn asleep(&self) -> Option<&Asleep<D>> {
        match self {
            Rest::Asleep(asleep) => Some(asleep),
            Rest::Awake | Rest::Decided(_) => None,
        }
    }
}

impl<const D: usize> StatePolicy<D> for SlowDescent {
    type Memory = Remembered<D>;
    type Event = CheckDue;

    fn validate(&self) -> Result<(), SetupError> {
        not_negative("sleep_speed", self.sleep_speed)?;
        not_negative("wake_speed", self.wake_speed)?;
        not_negative("store_time", self.store_time.unwrap_or(0.0))?;
        fraction("frozen_restitution", self.frozen_restitution)?;
        self.self_check.as_ref().map_or(Ok(()), SelfCheck::validate)
    }

    fn should_sleep<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        _near: &S,
        memory: &mut Remembered<D>,
    ) -> SleepDecision {
        let arriving = impact.particle.velocity - impact.ground_velocity;
        let leaving = after - impact.ground_velocity;
        let speed = match self.speed_read {
            SpeedRead::Arriving => arriving.norm_squared().sqrt(),
            SpeedRead::Leaving => leaving.norm_squared().sqrt(),
        };
        let on_support = self.is_on_support(impact);
        let previous = memory.previous_speed;
        // A decision that this collision has cancelled.
        memory.rest = Rest::Awake;
        if on_support || self.comparison == Comparison::AnyCollision {
            memory.previous_speed = Some(speed);
        }
        if !on_support {
            return SleepDecision::Stay(Reason::new("on a static grain", 0.0, 1.0));
        }
        let descent = match self.descent_read {
            DescentRead::Arriving => arriving.dot(&impact.gravity),
            DescentRead::Leaving => leaving.dot(&impact.gravity),
            DescentRead::Both => arriving
                .dot(&impact.gravity)
                .min(leaving.dot(&impact.gravity)),
        };
        if descent <= 0.0 {
            return SleepDecision::Stay(Reason::new("going down", descent, 0.0));
        }
        let slow = Reason::new("speed below V_sleep", speed, self.sleep_speed);
        if speed >= self.sleep_speed {
            return SleepDecision::Stay(slow);
        }
        if self.comparison != Comparison::None {
            let before = previous.unwrap_or(0.0);
            if !is_slower(speed, before) {
                let slower = Reason::new("slower than at the previous collision", speed, before);
                return SleepDecision::Stay(slower);
            }
        }
        memory.rest = Rest::Decided(leaving);
        SleepDecision::Sleep(self.place, slow)
    }

    fn should_wake<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _near: &S,
        struck: &Remembered<D>,
    ) -> WakeDecision<D> {
        let speed = match self.wake_read {
            WakeRead::Normal => impact.closing_speed(),
            WakeRead::Relative => impact.relative_velocity().norm_squared().sqrt(),
        };
        let reason = Reason::new("hit faster than V_wakeup", speed, self.wake_speed);
        if speed <= self.wake_speed {
            return WakeDecision::Stay(reason);
        }
        let mass = match &impact.obstacle {
            Obstacle::Particle { particle, .. } => particle.mass,
            Obstacle::Wall { .. } => f64::INFINITY,
        };
        let ground = impact.obstacle_velocity();
        let waking = self.given_back(struck, impact.time, &impact.gravity, ground, mass);
        WakeDecision::Wake(waking, reason)
    }

    fn check_memory<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &Remembered<D>,
    ) -> Result<(), String> {
        if memory
            .previous_speed
            .is_some_and(|speed| speed.is_nan() || speed < 0.0)
        {
            return Err(format!("it remembers no speed: {memory:?}"));
        }
        match memory.rest.asleep() {
            Some(asleep) => asleep.check(near.particle(id).mode, near.time()),
            None => Ok(()),
        }
    }

    fn may_forget<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        near: &S,
        memory: &Remembered<D>,
    ) -> bool {
        let is_stored = match memory.rest {
            Rest::Awake => false,
            Rest::Decided(_) => true,
            Rest::Asleep(asleep) => self.stores_after(near.time() - asleep.since, near),
        };
        !is_stored && memory.previous_speed.is_none() && memory.supports.is_empty()
    }

    fn on_start<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        memory.supports.start(self.check(), id, near, commands);
    }

    fn on_sleep<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) {
        let velocity = match (self.store_at, memory.rest) {
            (StoreAt::Deciding, Rest::Decided(velocity)) => velocity,
            _ => near.particle(id).velocity - near.ground_velocity(id),
        };
        memory.rest = Rest::Asleep(Asleep {
            velocity,
            since: near.time(),
        });
        if !self.keep_history {
            memory.previous_speed = None;
        }
        memory.supports.begin(self.check(), id, near, commands);
    }

    fn on_wake<S: Surroundings<D>>(
        &self,
        _id: ParticleId,
        cause: &WakeCause<D>,
        _near: &S,
        memory: &mut Remembered<D>,
        _commands: &mut Commands<CheckDue>,
    ) {
        memory.rest = Rest::Awake;
        memory.supports.forget();
        match cause {
            // Its first contact cannot put it back to sleep.
            WakeCause::Event => memory.previous_speed = Some(0.0),
            WakeCause::Hit { impact, after } => {
                if self.comparison == Comparison::AnyCollision {
                    memory.previous_speed = Some(match self.speed_read {
                        SpeedRead::Arriving => impact.arriving_speed(),
                        SpeedRead::Leaving => {
                            (after - impact.ground_velocity).norm_squared().sqrt()
                        }
                    });
                }
            }
        }
    }

    fn on_event<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        event: CheckDue,
        near: &S,
        memory: &mut Remembered<D>,
        commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        let kept = &memory.supports;
        kept.go_on(self.check(), event, id, near, commands, |grain| {
            self.woken_by_check(memory, near, grain)
        })
    }

    fn on_support_change<S: Surroundings<D>>(
        &self,
        id: ParticleId,
        _supporter: ParticleId,
        near: &S,
        memory: &mut Remembered<D>,
        _commands: &mut Commands<CheckDue>,
    ) -> Response<D> {
        let kept = &memory.supports;
        kept.answer(self.check(), id, near, |grain| {
            self.woken_by_check(memory, near, grain)
        })
    }
}
