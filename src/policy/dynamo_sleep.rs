use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{Impact, Reason, Surroundings};
use crate::particle::Vector;
use crate::policy::at_rest::RestCondition;
use crate::policy::parameters::{not_negative, positive};
use crate::time::Time;

/// The sleep rule of the code DynamO (Bannerman, Sargant and Lue 2011,
/// doi:10.1002/jcc.21915), as far as it can be told from outside, written afresh.
///
/// At a collision with a static grain the velocity with which a grain leaves is
/// taken along gravity, with its sign: it has to be below V_sleep, so a grain
/// that goes up passes at any speed. Since its last collision of this kind it
/// has to have moved less than `distance`, within no less than `time`. There the
/// grain falls asleep where it is, and any hit wakes it, from rest:
/// `wake_speed` is 0. Nothing is stored, and nobody checks supports; the random
/// kicks by which that code wakes grains now and then are left out.
///
/// It fails in heaps: a sleeper on which anything still bounces is woken by each
/// bounce.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DynamoSleep {
    /// V_sleep, in √(gd).
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(gd)")))]
    pub sleep_speed: f64,
    /// How far apart two collisions of a resting grain may be, in d.
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "d")))]
    pub distance: f64,
    /// How long they have to be apart, in √(d/g).
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(d/g)")))]
    pub time: f64,
    /// V_wakeup, in √(gd): 0, so that any hit wakes, in the original.
    #[cfg_attr(feature = "program", schemars(range(min = 0.0), extend("x-unit" = "√(gd)")))]
    pub wake_speed: f64,
}

impl Default for DynamoSleep {
    /// Windows of 0.01 d and 10⁻⁴ √(d/g); V_sleep = 0.1 √(gd).
    fn default() -> Self {
        DynamoSleep {
            sleep_speed: 0.1,
            distance: 0.01,
            time: 1.0e-4,
            wake_speed: 0.0,
        }
    }
}

/// Where and when a grain last met a static one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct LastSupport<const D: usize> {
    place: Vector<D>,
    time: Time,
}

impl<const D: usize> RestCondition<D> for DynamoSleep {
    type History = Option<LastSupport<D>>;

    fn validate(&self) -> Result<(), SetupError> {
        positive("sleep_speed", self.sleep_speed)?;
        positive("distance", self.distance)?;
        positive("time", self.time)?;
        not_negative("wake_speed", self.wake_speed)
    }

    fn at_rest<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        _near: &S,
        history: &mut Option<LastSupport<D>>,
    ) -> Result<Reason, Reason> {
        if !impact.is_on_static() && !impact.is_on_wall() {
            return Err(Reason::new("on a static grain", 0.0, 1.0));
        }
        let place = impact.particle.position;
        let last = history.replace(LastSupport {
            place,
            time: impact.time,
        });
        let Some(last) = last else {
            return Err(Reason::new("a second time on a static grain", 0.0, 1.0));
        };
        let gravity = impact.gravity.norm_squared().sqrt();
        let leaving = (after - impact.ground_velocity).dot(&impact.gravity) / gravity;
        let slow = Reason::new("velocity down below V_sleep", leaving, self.sleep_speed);
        // Without gravity there is no down: nobody sleeps.
        if leaving.is_nan() || leaving >= self.sleep_speed {
            return Err(slow);
        }
        let moved = (place - last.place).norm_squared().sqrt();
        if moved >= self.distance {
            return Err(Reason::new("hardly moved", moved, self.distance));
        }
        let waited = impact.time - last.time;
        if waited < self.time {
            return Err(Reason::new(
                "long enough since the last time",
                waited,
                self.time,
            ));
        }
        Ok(slow)
    }
}
