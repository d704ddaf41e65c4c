use crate::scenario::read::{Format, Origin};

/// A scenario that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
    /// The scenario, in TOML, with comments.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal: $summary:literal,)*) => {
        &[$(Preset {
            name: $name,
            summary: $summary,
            text: include_str!(concat!("presets/", $name, ".toml")),
        }),*]
    };
}

/// All presets, in the order in which they are listed.
const PRESETS: &[Preset] = presets! {
    "deposition": "the paper's deposition: 4800 grains rain on a rough base",
    "one-by-one": "grains dropped one after the other: a looser deposit",
    "bounce": "Fig. 1: a ball bounces, slows down and falls asleep",
    "bounce-full": "Fig. 1: the same without cut-off and sleep; it collapses",
    "bounce-regularised": "Fig. 1: the same, elastic below V_c; it bounces for ever",
    "arch": "Fig. 2: two wedged grains fall asleep on each other, in the plane",
    "drum": "Figs. 6 and 7: the paper's rotating drum; gravity turns",
    "drum-turning": "the same drum, truly turning under constant gravity",
    "drum2d": "a small drum of disks, quick to run",
    "gas": "an elastic gas of spheres in a periodic box",
    "gas2d": "an elastic gas of disks in a periodic box",
    "gas-inelastic": "an inelastic gas of spheres, which cools",
};

/// All presets, in the order in which they are listed.
#[must_use]
pub fn presets() -> &'static [Preset] {
    PRESETS
}

impl Preset {
    /// The preset of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Preset> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// Its text, to be read.
    #[must_use]
    pub fn origin(&self) -> Origin {
        Origin {
            format: Format::Toml,
            ..Origin::toml(&format!("preset {}", self.name), self.text)
        }
    }
}
