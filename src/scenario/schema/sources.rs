use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::particle::Mode;
use crate::setup::{self, Sizes};

/// Where grains come from: one written out here, a file, or a generator.
///
/// Exactly one of `position`, `file`, `base`, `rain`, `gas`, `drum` and `one_by_one`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["position"] },
    { "required": ["file"] },
    { "required": ["base"] },
    { "required": ["rain"] },
    { "required": ["gas"] },
    { "required": ["drum"] },
    { "required": ["one_by_one"] },
]))]
pub struct Source {
    /// One grain: its centre, in d.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "d"))]
    pub position: Option<Vec<f64>>,
    /// With `position`: its velocity, in √(gd); 0 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "√(gd)"))]
    pub velocity: Option<Vec<f64>>,
    /// With `position`: its diameter, in d; 1 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "d"))]
    pub diameter: Option<f64>,
    /// With `position`: its mass, in m; its diameter to the power of the
    /// dimension if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "m"))]
    pub mass: Option<f64>,
    /// With `position`: `"normal"` (the default), `"falling"`, `"frozen"` or
    /// `"fixed"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// The grains of the last frame of an extended XYZ file, whose path counts
    /// from this file's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A rough bottom of fixed grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Base>,
    /// Grains falling at constant velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rain: Option<Rain>,
    /// A disordered gas in a periodic box of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gas: Option<Gas>,
    /// A drum of fixed grains and its sleeping filling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drum: Option<Drum>,
    /// Grains dropped during the run, each when everything is at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub one_by_one: Option<OneByOne>,
}

/// A rough bottom: a slab of fixed grains cut from a random packing, which is
/// made from the seed. The lateral axes have to be periodic or walled on both
/// sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Base {
    /// How thick, in d.
    #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "d"))]
    pub thickness: f64,
    /// Height of its bottom along the last axis, in d.
    #[schemars(range(min = -1.0e9, max = 1.0e9), extend("x-unit" = "d"))]
    pub bottom: f64,
    /// Diameters of its grains.
    pub sizes: Sizes,
}

impl Default for Base {
    fn default() -> Self {
        Base {
            thickness: 2.0,
            bottom: 0.0,
            sizes: Sizes::default(),
        }
    }
}

/// A rain: grains at random places of a column, falling at constant velocity
/// until their first collision (the paper's section 3). The lateral axes have
/// to be periodic or walled on both sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rain {
    /// How many grains.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub count: usize,
    /// Volume of the grains over the volume of the column.
    #[serde(default = "default_rain_fraction")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub packing_fraction: f64,
    /// How fast they fall, in √(gd).
    #[serde(default = "default_fall_speed")]
    #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "√(gd)"))]
    pub fall_speed: f64,
    /// Height of the lowest grain's lowest point at the start, in d. Left out:
    /// the highest point of the grains listed before, or the floor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1.0e9, max = 1.0e9), extend("x-unit" = "d"))]
    pub bottom: Option<f64>,
    /// Their diameters.
    #[serde(default)]
    pub sizes: Sizes,
}

fn default_rain_fraction() -> f64 {
    0.0503
}

fn default_fall_speed() -> f64 {
    2.5
}

/// A disordered gas: grown from points (Lubachevsky & Stillinger 1990,
/// doi:10.1007/BF01025983) in a periodic box whose size follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gas {
    /// How many grains.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub count: usize,
    /// Volume of the grains over the volume of the box.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub packing_fraction: f64,
    /// T = ⟨m v²⟩/D. Without gravity the unit of time is yours, and so that of v.
    #[serde(default = "default_temperature")]
    #[schemars(range(min = 0.0), extend("x-unit" = "m v²"))]
    pub temperature: f64,
    /// Proportions of the box, one number per axis. Left out: all equal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aspect: Vec<f64>,
    /// Diameters of the grains.
    #[serde(default)]
    pub sizes: Sizes,
}

fn default_temperature() -> f64 {
    1.0
}

/// A drum and its filling (the paper's section 4): a cylinder of fixed grains in
/// regular rings round the origin, its axis horizontal, and equal grains that have
/// fallen in and are asleep. In three dimensions the axis is y, which has to be
/// periodic with the length `rings` times `ring_spacing`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Drum {
    /// From the axis to the centres of the wall's grains, in d.
    #[schemars(range(min = 2.5, max = 1.0e4), extend("x-unit" = "d"))]
    pub radius: f64,
    /// How many rings of grains make the wall; 1 in two dimensions.
    #[schemars(range(min = 1, max = 10_000))]
    pub rings: usize,
    /// Distance of the rings, in d.
    #[schemars(range(min = 1.0, max = 1.3), extend("x-unit" = "d"))]
    pub ring_spacing: f64,
    /// Distance of the grains along a ring, in d, at least.
    #[schemars(range(min = 1.0, max = 1.3), extend("x-unit" = "d"))]
    pub arc_spacing: f64,
    /// Up to which height above the axis it is filled, in d.
    #[schemars(range(min = -1.0e4, max = 1.0e4), extend("x-unit" = "d"))]
    pub level: f64,
}

impl Default for Drum {
    /// The paper's.
    fn default() -> Self {
        Drum::from(setup::Drum::default())
    }
}

impl Drum {
    /// About how many grains it is made of, rather too many than too few.
    fn count(&self) -> usize {
        let turn = 2.0 * core::f64::consts::PI;
        let wall = turn * self.radius / self.arc_spacing * self.rings as f64;
        let length = if self.rings == 1 {
            1.0
        } else {
            self.rings as f64 * self.ring_spacing
        };
        // As many as are let fall: not a number counts as none.
        (wall + 0.5 * turn * self.radius * self.radius * length) as usize
    }
}

impl From<setup::Drum> for Drum {
    fn from(drum: setup::Drum) -> Self {
        Drum {
            radius: drum.radius,
            rings: drum.rings,
            ring_spacing: drum.ring_spacing,
            arc_spacing: drum.arc_spacing,
            level: drum.level,
        }
    }
}

impl From<Drum> for setup::Drum {
    fn from(drum: Drum) -> Self {
        setup::Drum {
            radius: drum.radius,
            rings: drum.rings,
            ring_spacing: drum.ring_spacing,
            arc_spacing: drum.arc_spacing,
            level: drum.level,
        }
    }
}

/// Grains dropped at random places during the run, each when everything is at
/// rest (the end of the paper's section 3). The lateral axes have to be
/// periodic or walled on both sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OneByOne {
    /// How many grains.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub count: usize,
    /// How far above the highest surface the lowest point of the new grain
    /// starts, in d.
    #[serde(default = "default_clearance")]
    #[schemars(range(min = 0.0, max = 1.0e9), extend("x-unit" = "d"))]
    pub clearance: f64,
    /// How fast they fall, in √(gd), at constant velocity until the first
    /// collision.
    #[serde(default = "default_fall_speed")]
    #[schemars(range(max = 1.0e9), extend("exclusiveMinimum" = 0.0, "x-unit" = "√(gd)"))]
    pub fall_speed: f64,
    /// Their diameters.
    #[serde(default)]
    pub sizes: Sizes,
}

fn default_clearance() -> f64 {
    2.0
}

/// What a [`Source`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SourceKind<'a> {
    /// One grain, with this centre.
    Grain(&'a [f64]),
    /// A file.
    File(&'a str),
    /// A rough bottom.
    Base(&'a Base),
    /// A rain.
    Rain(&'a Rain),
    /// A gas.
    Gas(&'a Gas),
    /// A drum.
    Drum(&'a Drum),
    /// Grains dropped during the run.
    OneByOne(&'a OneByOne),
}

impl Source {
    /// What this source says, or the names of everything it says if that is
    /// not exactly one thing.
    ///
    /// # Errors
    ///
    /// When none or several of them are given.
    pub fn kind(&self) -> Result<SourceKind<'_>, Vec<&'static str>> {
        let given = [
            ("position", self.position.as_deref().map(SourceKind::Grain)),
            ("file", self.file.as_deref().map(SourceKind::File)),
            ("base", self.base.as_ref().map(SourceKind::Base)),
            ("rain", self.rain.as_ref().map(SourceKind::Rain)),
            ("gas", self.gas.as_ref().map(SourceKind::Gas)),
            ("drum", self.drum.as_ref().map(SourceKind::Drum)),
            (
                "one_by_one",
                self.one_by_one.as_ref().map(SourceKind::OneByOne),
            ),
        ];
        let mut names = Vec::new();
        let mut found = None;
        for (name, kind) in given {
            if let Some(kind) = kind {
                names.push(name);
                found = Some(kind);
            }
        }
        match found {
            Some(kind) if names.len() == 1 => Ok(kind),
            _ => Err(names),
        }
    }

    /// How many grains it promises, as far as that is known before it is asked.
    #[must_use]
    pub fn count(&self) -> usize {
        match self.kind() {
            Ok(SourceKind::Grain(_)) => 1,
            Ok(SourceKind::Rain(rain)) => rain.count,
            Ok(SourceKind::Gas(gas)) => gas.count,
            Ok(SourceKind::OneByOne(drops)) => drops.count,
            Ok(SourceKind::Drum(drum)) => drum.count(),
            Ok(SourceKind::File(_) | SourceKind::Base(_)) | Err(_) => 0,
        }
    }
}
