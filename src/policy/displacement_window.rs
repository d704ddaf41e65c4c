use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{Impact, Reason, Surroundings};
use crate::particle::Vector;
use crate::policy::at_rest::RestCondition;
use crate::policy::parameters::positive;
use crate::time::Time;

/// At rest is who has stayed within ε of one place for a time τ.
///
/// The place is that of the collision with which the window began; a collision
/// farther than ε from it begins a new one. Physics engines for games have come
/// to this from a bound on the speed (the engine Rapier with its version 0.35).
/// It fails where motion is slow but steady: whatever is slower than ε/τ counts
/// as rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DisplacementWindow {
    /// ε, in d.
    pub distance: f64,
    /// τ, in √(d/g).
    pub window: f64,
}

impl Default for DisplacementWindow {
    /// 0.005 d, the height of a throw with 0.1 √(gd), within 0.1 √(d/g).
    fn default() -> Self {
        DisplacementWindow {
            distance: 0.005,
            window: 0.1,
        }
    }
}

/// Where a grain was when its window began, and when that was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Anchor<const D: usize> {
    place: Vector<D>,
    since: Time,
}

impl<const D: usize> RestCondition<D> for DisplacementWindow {
    type History = Option<Anchor<D>>;

    fn validate(&self) -> Result<(), SetupError> {
        positive("distance", self.distance)?;
        positive("window", self.window)
    }

    fn at_rest<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        _after: Vector<D>,
        _near: &S,
        history: &mut Option<Anchor<D>>,
    ) -> Result<Reason, Reason> {
        let place = impact.particle.position;
        let anchor = *history.get_or_insert(Anchor {
            place,
            since: impact.time,
        });
        let moved = (place - anchor.place).norm_squared().sqrt();
        if moved >= self.distance {
            *history = Some(Anchor {
                place,
                since: impact.time,
            });
            return Err(Reason::new("moved less than ε", moved, self.distance));
        }
        let stayed = impact.time - anchor.since;
        let reason = Reason::new("within ε for longer than τ", stayed, self.window);
        if stayed > self.window {
            Ok(reason)
        } else {
            Err(reason)
        }
    }
}
