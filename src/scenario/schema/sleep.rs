use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::Place;
use crate::policy::{
    Comparison, DescentRead, EnergyStore, SlowDescent, SpeedRead, StoreAt, Timing, WakeRead,
};

/// How exactly grains fall asleep and wake. What the paper leaves open is
/// decided by the defaults; the alternatives are here to be compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sleep {
    /// The criterion: `"slow_descent"` (the paper's, the default),
    /// `"isostatic_support"`, `"displacement_window"`, `"velocity_variance"`,
    /// `"granular_temperature"`, `"dynamo_sleep"` or `"never"`. Its parameters
    /// stand in `criteria`.
    pub criterion: String,
    /// Which speed is compared with V_sleep and with the previous one.
    pub speed_read: SpeedRead,
    /// Which velocity has to point down.
    pub descent_read: DescentRead,
    /// At which previous collisions the speed has to have been greater.
    pub comparison: Comparison,
    /// Which speed of the hit is compared with V_wakeup.
    pub wake_read: WakeRead,
    /// Where a grain falls asleep.
    pub place: Place,
    /// How the energy of a grain that wakes soon is given back.
    pub energy_store: EnergyStore,
    /// Which velocity is stored.
    pub store_at: StoreAt,
    /// How long it is stored, in √(d/g). Left out: the paper's
    /// 2 V_sleep/((1 − α_frozen) g).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("x-unit" = "√(d/g)"))]
    pub store_time: Option<f64>,
    /// Whether grains may fall asleep on walls.
    pub wall_supports: bool,
    /// Whether a grain remembers while it sleeps how fast it last was.
    pub keep_history: bool,
    /// How far ahead the next collision of a grain that falls asleep is
    /// looked for, in √(d/g).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "√(d/g)"))]
    pub horizon: f64,
}

impl Default for Sleep {
    fn default() -> Self {
        let model = SlowDescent::default();
        Sleep {
            criterion: "slow_descent".to_owned(),
            speed_read: model.speed_read,
            descent_read: model.descent_read,
            comparison: model.comparison,
            wake_read: model.wake_read,
            place: model.place,
            energy_store: model.energy_store,
            store_at: model.store_at,
            store_time: model.store_time,
            wall_supports: model.wall_supports,
            keep_history: model.keep_history,
            horizon: 1000.0,
        }
    }
}

/// Sleeping grains check whether they are still supported (the paper's section 4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SelfCheck {
    /// What has sleepers check: the clock (`"polled"`), or the loss of a support
    /// (`"events"`), at its very instant. Then `interval` counts only where nothing
    /// can be foreseen, and `phase` for nothing.
    #[serde(default)]
    pub timing: Timing,
    /// τ_check: how often, in √(d/g).
    #[schemars(range(min = 1.0e-6), extend("x-unit" = "√(d/g)"))]
    pub interval: f64,
    /// How near a support has to be, in units of the distance at contact.
    #[serde(default = "default_support_range")]
    #[schemars(range(min = 1.0, max = 2.0), extend("x-unit" = "σ₁₂"))]
    pub support_range: f64,
    /// Whether normal grains above count as supports.
    #[serde(default = "default_true")]
    pub support_normals: bool,
    /// When the checks of a grain begin.
    #[serde(default)]
    pub phase: Phase,
    /// Whether a grain that has no support at all wakes at its check.
    #[serde(default = "default_true")]
    pub unsupported_wakes: bool,
}

fn default_support_range() -> f64 {
    1.05
}

fn default_true() -> bool {
    true
}

/// When the checks of a grain begin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// When it falls asleep; those of grains that start asleep are spread at
    /// random, from the seed: the model.
    #[default]
    Spread,
    /// When it falls asleep, or at the start.
    Own,
    /// Never: all check together, at multiples of the interval.
    Global,
}
