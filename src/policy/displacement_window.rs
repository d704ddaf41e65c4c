use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{Impact, Reason, Surroundings};
use crate::particle::Vector;
use crate::policy::at_rest::RestCondition;
use crate::policy::parameters::positive;
use crate::time::Time;

/// At rest is who has stayed within ε of one place for a time τ.
///
/// The place is that of the collision with which the window began. Looked at are
/// the places of the grain's collisions and those half-way in time between two of
/// them, where a bounce is at its top; one farther than ε away begins a new
/// window. Physics engines for games have come to this from a bound on the speed.
/// It fails where motion is slow but steady: whatever is slower than ε/τ counts
/// as rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DisplacementWindow {
    /// ε, in d.
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "d")))]
    pub distance: f64,
    /// τ, in √(d/g).
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(d/g)")))]
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

/// Where a grain was when its window began, and at its last collision.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Anchor<const D: usize> {
    place: Vector<D>,
    since: Time,
    last_place: Vector<D>,
    last: Time,
}

impl<const D: usize> Anchor<D> {
    fn new(place: Vector<D>, since: Time) -> Self {
        Anchor {
            place,
            since,
            last_place: place,
            last: since,
        }
    }

    /// How far from where the window began a grain has been since its last
    /// collision, at the end and half-way of a parabola that ends at `place` now.
    fn farthest(&self, place: &Vector<D>, now: Time, gravity: &Vector<D>) -> f64 {
        let flown = now - self.last;
        let middle = (place + self.last_place) * 0.5 - gravity * (0.125 * flown * flown);
        let end = (place - self.place).norm_squared();
        end.max((middle - self.place).norm_squared()).sqrt()
    }
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
        let (place, now) = (impact.particle.position, impact.time);
        let anchor = history.get_or_insert(Anchor::new(place, now));
        let moved = anchor.farthest(&place, now, &impact.gravity);
        if moved >= self.distance {
            *anchor = Anchor::new(place, now);
            return Err(Reason::new("moved less than ε", moved, self.distance));
        }
        (anchor.last_place, anchor.last) = (place, now);
        let stayed = now - anchor.since;
        let reason = Reason::new("within ε for longer than τ", stayed, self.window);
        if stayed > self.window {
            Ok(reason)
        } else {
            Err(reason)
        }
    }
}
