//! How grains are numbered.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the grains of each generator are numbered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Numbering {
    /// As they are drawn.
    #[default]
    Drawn,
    /// Along a curve that fills space (`setup::sort_in_space` in the library).
    Space,
}

impl Numbering {
    pub(super) fn is_drawn(&self) -> bool {
        *self == Numbering::Drawn
    }
}
