//! Built-in collision rules: constant restitution, elastic below a cut-off.

use crate::error::SetupError;
use crate::model::{CollisionRule, Impact, Obstacle, Rebound, Spins};

/// Smooth grains of constant normal restitution, elastic below a cut-off speed
/// (the paper's section 2; the cut-off after McNamara & Young 1994,
/// doi:10.1103/PhysRevE.50.R28).
///
/// With normal closing speed u, the grains leave with normal speed ε u, where
/// ε = α between mobile grains, α_frozen on a frozen or fixed one, the wall's
/// own on a wall, and 1 in all three cases if u < V_c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restitution {
    /// α, between mobile grains; 0.7 in the paper.
    pub restitution: f64,
    /// α_frozen, on frozen and fixed grains; 0.4 in the paper.
    pub frozen_restitution: f64,
    /// V_c, in √(gd): collisions slower than this are elastic; 1e-4 in the paper.
    pub elastic_speed: f64,
    /// Whether the cut-off holds on frozen and fixed grains too. True in this
    /// model; false costs about a quarter more events.
    pub elastic_on_static: bool,
}

impl Default for Restitution {
    /// The paper's values.
    fn default() -> Self {
        Restitution {
            restitution: 0.7,
            frozen_restitution: 0.4,
            elastic_speed: 1.0e-4,
            elastic_on_static: true,
        }
    }
}

impl Restitution {
    /// Perfectly elastic everywhere but on walls.
    #[must_use]
    pub fn elastic() -> Self {
        Restitution::constant(1.0)
    }

    /// The same restitution against everything but walls, without a cut-off.
    #[must_use]
    pub fn constant(restitution: f64) -> Self {
        Restitution {
            restitution,
            frozen_restitution: restitution,
            elastic_speed: 0.0,
            elastic_on_static: true,
        }
    }

    /// The same rule, if its numbers are in range.
    ///
    /// # Errors
    ///
    /// When a restitution is outside 0 … 1 or the cut-off is negative.
    pub fn validated(self) -> Result<Self, SetupError> {
        for (field, value) in [
            ("restitution", self.restitution),
            ("frozen_restitution", self.frozen_restitution),
        ] {
            if !(0.0..=1.0).contains(&value) {
                return Err(SetupError::Parameter {
                    field,
                    value,
                    allowed: "0 … 1 is allowed",
                });
            }
        }
        if !(self.elastic_speed >= 0.0 && self.elastic_speed.is_finite()) {
            return Err(SetupError::Parameter {
                field: "elastic_speed",
                value: self.elastic_speed,
                allowed: "0 or more is allowed",
            });
        }
        Ok(self)
    }
}

impl<const D: usize> CollisionRule<D> for Restitution {
    type Spin = ();

    fn validate(&self) -> Result<(), SetupError> {
        self.validated().map(drop)
    }

    #[inline]
    fn collide(&self, impact: &Impact<D>, _spins: Spins<'_, ()>) -> Rebound<D> {
        let closing = impact.closing_speed();
        let (restitution, cut_off, other_mass) = match &impact.obstacle {
            Obstacle::Wall { restitution, .. } => (*restitution, true, f64::INFINITY),
            Obstacle::Particle { particle, .. } if particle.mode.is_static() => (
                self.frozen_restitution,
                self.elastic_on_static,
                f64::INFINITY,
            ),
            Obstacle::Particle { particle, .. } => (self.restitution, true, particle.mass),
        };
        let elastic = cut_off && closing < self.elastic_speed;
        let inelastic = restitution;
        let restitution = if elastic { 1.0 } else { inelastic };
        // The normal is of unit length to within rounding, which is a hair more
        // on average: left so, an elastic gas would heat up.
        let unit = impact.normal.norm_squared();
        let change = impact.normal * ((1.0 + restitution) * closing / unit);
        // The other grain's share of the change of relative velocity.
        let share = if other_mass.is_finite() {
            impact.particle.mass / (impact.particle.mass + other_mass)
        } else {
            0.0
        };
        let spared_energy = if elastic {
            let reduced_mass = impact.particle.mass * (1.0 - share);
            0.5 * reduced_mass * closing * closing * (1.0 - inelastic * inelastic)
        } else {
            0.0
        };
        Rebound {
            velocity: impact.particle.velocity + change * (1.0 - share),
            other_velocity: impact.obstacle_velocity() - change * share,
            elastic,
            spared_energy,
        }
    }
}
