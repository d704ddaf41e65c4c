//! What the paper leaves open about its criteria: the readings of a sentence.

use serde::{Deserialize, Serialize};

/// What becomes of the energy that a grain loses when it falls asleep, if it
/// is woken soon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum EnergyStore {
    /// It is lost.
    Off,
    /// The grain gets its velocity back before the collision is resolved.
    #[default]
    VelocityBefore,
    /// The grain gets the energy added after the collision.
    EnergyAfter,
}

/// Which velocity is stored when a grain falls asleep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StoreAt {
    /// The one at the instant it freezes.
    #[default]
    Freezing,
    /// The one just after the collision that decided it.
    Deciding,
}

/// Which speed the sleep test reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SpeedRead {
    /// The one with which the grain arrives.
    #[default]
    Arriving,
    /// The one with which it leaves.
    Leaving,
}

/// Which velocity has to point down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DescentRead {
    /// The one with which the grain arrives. Read on the leaving one, a ball on
    /// a floor never sleeps.
    #[default]
    Arriving,
    /// The one with which it leaves.
    Leaving,
    /// Both.
    Both,
}

/// With which earlier collision the speed is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// The grain's previous one, with anything.
    #[default]
    AnyCollision,
    /// Its previous one with a frozen or fixed grain or a supporting wall.
    StaticCollisions,
    /// None: being slow is enough.
    None,
}

/// Which speed of a hit has to exceed V_wakeup.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum WakeRead {
    /// The closing speed along the normal.
    #[default]
    Normal,
    /// The whole relative speed.
    Relative,
}
