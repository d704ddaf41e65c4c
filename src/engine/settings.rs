use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::particle::ParticleId;
use crate::time::Time;

/// Remedies for endless cascades of collisions, which the model itself
/// produces: grains that touch several static ones at once, or that creep
/// between them, collide without end in a finite or even in no time.
///
/// Each can be switched off, and none acts on a grain that makes no such
/// cascade: a run in which [`Counts::guard`](crate::engine::Counts::guard)
/// stays 0 is the same run, bit for bit, with and without them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guards {
    /// After this many collisions of one grain at one instant (closer together
    /// than 10⁻¹² √(d/g), or than a hundredth of `exit_speed` over g, or 10⁻⁷ if
    /// that is 0, if the surfaces part by less than 10⁻¹² d in between), and each
    /// time as many more, the velocities of all normal grains that touch it,
    /// directly or through each other, are
    /// projected on the cone of those with which no contact closes: the limit
    /// of the cascade. A grain that no velocity would free falls asleep.
    /// `None` switches it off.
    pub cascade: Option<u32>,
    /// Normal speed with which a projected grain leaves its contacts, in
    /// √(gd); best well below V_c.
    pub exit_speed: f64,
    /// Least normal speed after any contact with a static grain or wall, in
    /// √(gd). 0 switches it off.
    pub floor_speed: f64,
    /// How long the same pair may not collide again after an elastic contact
    /// with a static grain, in √(d/g). 0 switches it off.
    pub hold: f64,
    /// A run stops as collapsed when one grain has made this many collisions at
    /// one instant. `None` lets it go on for ever. Where grains sleep, and `cascade` and
    /// `exit_speed` are on, one that has met nothing but static obstacles falls asleep
    /// after half as many instead.
    pub collapse: Option<u32>,
}

impl Default for Guards {
    fn default() -> Self {
        Guards {
            cascade: Some(16),
            exit_speed: 1.0e-5,
            floor_speed: 0.0,
            hold: 0.0,
            collapse: Some(100_000),
        }
    }
}

impl Guards {
    /// No guard; collapse is still found and named.
    #[must_use]
    pub fn none() -> Self {
        Guards {
            cascade: None,
            exit_speed: 0.0,
            floor_speed: 0.0,
            hold: 0.0,
            collapse: Some(100_000),
        }
    }

    /// The defaults with an exit speed that fits a rule's elastic cut-off V_c, in
    /// √(gd): a tenth of it.
    #[must_use]
    pub fn for_elastic_speed(elastic_speed: f64) -> Self {
        Guards {
            exit_speed: 0.1 * elastic_speed,
            ..Guards::default()
        }
    }

    /// The floor and the hold instead of the projection.
    #[must_use]
    pub fn floor_and_hold(floor_speed: f64, hold: f64) -> Self {
        Guards {
            floor_speed,
            hold,
            ..Guards::none()
        }
    }

    pub(super) fn validate(&self) -> Result<(), SetupError> {
        let speeds = [
            ("guards.exit_speed", self.exit_speed),
            ("guards.floor_speed", self.floor_speed),
            ("guards.hold", self.hold),
        ];
        for (field, value) in speeds {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(SetupError::Parameter {
                    field,
                    value,
                    allowed: "0 or more is allowed",
                });
            }
        }
        let numbers = [
            ("guards.cascade", self.cascade),
            ("guards.collapse", self.collapse),
        ];
        for (field, value) in numbers {
            if value == Some(0) {
                return Err(SetupError::Parameter {
                    field,
                    value: 0.0,
                    allowed: "1 or more is allowed, or none to switch it off",
                });
            }
        }
        Ok(())
    }
}

/// How the engine works, apart from the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// What the clock shows at the start.
    pub start: Time,
    /// Remedies for endless cascades.
    pub guards: Guards,
    /// How far ahead the next collision of a grain that falls asleep is looked
    /// for, in √(d/g).
    pub sleep_horizon: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            start: Time::ZERO,
            guards: Guards::default(),
            sleep_horizon: 1000.0,
        }
    }
}

/// When a run is to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Once nothing is left to do before this time, which the clock then shows.
    pub time: Time,
    /// Once [`Counts::total`](crate::engine::Counts::total) has reached this.
    pub events: u64,
    /// Once no grain is normal or falling.
    pub all_frozen: bool,
}

impl Default for Limits {
    /// No limit at all: until nothing is left to do.
    fn default() -> Self {
        Limits {
            time: Time::NEVER,
            events: u64::MAX,
            all_frozen: false,
        }
    }
}

impl Limits {
    /// Up to a time.
    #[must_use]
    pub fn until(time: Time) -> Self {
        Limits {
            time,
            ..Limits::default()
        }
    }

    /// Up to a total number of physical events.
    #[must_use]
    pub fn events(events: u64) -> Self {
        Limits {
            events,
            ..Limits::default()
        }
    }

    /// Until no grain is normal or falling.
    #[must_use]
    pub fn all_frozen() -> Self {
        Limits {
            all_frozen: true,
            ..Limits::default()
        }
    }
}

/// Why a run stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum StopReason {
    /// The time limit was reached.
    Time,
    /// The number of events was reached.
    Events,
    /// No grain is normal or falling.
    AllFrozen,
    /// No event lies ahead.
    NothingLeft,
    /// Collisions without end at one instant.
    Collapse(Collapse),
    /// A grain has left: along an axis that is not periodic it is more than two
    /// million diameters away from where the grains started. (Most often it
    /// fell through a hole in the floor.)
    Escaped(ParticleId),
}

/// A cascade of collisions that does not end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Collapse {
    /// The instant.
    pub time: Time,
    /// The grains involved, by id: the one that collides without end first,
    /// then those it touches.
    pub particles: Vec<ParticleId>,
    /// How many collisions the first of them has made at this instant.
    pub collisions: u64,
}
