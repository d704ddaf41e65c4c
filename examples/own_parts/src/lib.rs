//! A collision rule and a dynamics of one's own, in the place of the program's:
//! grains on a chute that is tilted, whose restitution falls with the speed of impact.

use grainfall::boundary::Cuboid;
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::model::{
    CollisionRule, Dynamics, Impact, Model, Parts, Predictor, Rebound, Spins, StatePolicy,
};
use grainfall::predict::Polynomial;
use grainfall::program::Refit;
use grainfall::{SetupError, Time, Vector};
use serde::{Deserialize, Serialize};

/// What scenarios say under `[parts.chute]`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Chute {
    /// How far gravity leans towards the first axis, in degrees.
    pub tilt: f64,
    /// What an impact at 1 √(gd) takes off the restitution.
    pub loss: f64,
}

impl Refit for Chute {
    fn refit<Y, P, S, const D: usize>(
        &self,
        parts: Parts<Y, P, Restitution, S, Cuboid<D>>,
    ) -> impl Model<D>
    where
        Y: Dynamics<D>,
        P: Predictor<D, Y::Flight>,
        S: StatePolicy<D>,
    {
        let rule = Softening {
            slow: parts.collision_rule,
            loss: self.loss,
        };
        let strength = parts.dynamics.gravity(Time::ZERO).norm_squared().sqrt();
        let angle = self.tilt * std::f64::consts::PI / 180.0;
        let mut gravity = Vector::<D>::zeros();
        gravity[0] = strength * libm::sin(angle);
        gravity[D - 1] = -strength * libm::cos(angle);
        parts
            .with_dynamics(UniformGravity::new(gravity))
            .with_predictor(Polynomial)
            .with_collision_rule(rule)
    }
}

/// Restitution that falls with the fifth root of the speed of impact, as that of
/// viscoelastic spheres begins to.
#[derive(Clone, Copy, Debug)]
struct Softening {
    slow: Restitution,
    loss: f64,
}

impl<const D: usize> CollisionRule<D> for Softening {
    type Spin = ();

    fn collide(&self, impact: &Impact<D>, spins: Spins<'_, ()>) -> Rebound<D> {
        let lost = self.loss * libm::pow(impact.closing_speed(), 0.2);
        let now = Restitution {
            restitution: (self.slow.restitution - lost).max(0.0),
            frozen_restitution: (self.slow.frozen_restitution - lost).max(0.0),
            ..self.slow
        };
        now.collide(impact, spins)
    }

    fn validate(&self) -> Result<(), SetupError> {
        if (0.0..=1.0).contains(&self.loss) {
            return CollisionRule::<D>::validate(&self.slow);
        }
        Err(SetupError::Parameter {
            field: "loss",
            value: self.loss,
            allowed: "0 … 1 is allowed",
        })
    }
}
