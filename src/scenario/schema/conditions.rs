use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When the run ends: at whichever comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Stop {
    /// At this time, in √(d/g). Left out: at no set time, but a run in which
    /// nothing happens for 10⁶ √(d/g) ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 8.0e9), extend("x-unit" = "√(d/g)"))]
    pub time: Option<f64>,
    /// After this many physical events. Left out: after no set number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<u64>,
    /// When no grain is normal or falling and none is left to drop. Left out:
    /// true with gravity that does not turn, else false.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub all_frozen: Option<bool>,
}

/// What is written to the run folder, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Time between the rows of `series.csv`, in √(d/g); 0: the first and the
    /// last only.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(d/g)"))]
    pub series_every: f64,
    /// Time between the frames of `frames.xyz`, in √(d/g); 0: the first and the
    /// last only.
    #[schemars(range(min = 0.0), extend("x-unit" = "√(d/g)"))]
    pub frames_every: f64,
    /// Whether every physical event is written to `events.csv`.
    pub events: bool,
    /// Where the mean number of normal grains of a deposition begins to be
    /// taken, in √(d/g); it ends at 0.8 of the last landing. Left out: a
    /// quarter of the last landing.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("x-unit" = "√(d/g)"))]
    pub mean_normal_from: Option<f64>,
}

impl Default for Output {
    fn default() -> Self {
        Output {
            series_every: 1.0,
            frames_every: 0.0,
            events: false,
            mean_normal_from: None,
        }
    }
}
