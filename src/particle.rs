//! Grains: what is known of one at an instant, its identity and its mode.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A vector in `D` dimensions.
pub type Vector<const D: usize> = nalgebra::SVector<f64, D>;

/// A vector along one axis, from 0, of this length; nothing along the others. The
/// last axis, `D - 1`, points up.
///
/// ```
/// use grainfall::{Vector, along};
///
/// assert_eq!(along::<3>(2, -1.0), Vector::<3>::new(0.0, 0.0, -1.0));
/// ```
#[must_use]
pub fn along<const D: usize>(axis: usize, length: f64) -> Vector<D> {
    Vector::from_fn(|row, _| if row == axis { length } else { 0.0 })
}

/// The name of a grain: its place in the list the simulation was given,
/// counted from 0, then in the order of insertion. It never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ParticleId(pub u32);

impl ParticleId {
    /// The place in a list that is ordered by identity.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for ParticleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// The name of a wall: its place in [`Boundary::walls`](crate::model::Boundary::walls).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct WallId(pub u16);

impl WallId {
    /// The place in the boundary's list of walls.
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl fmt::Display for WallId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// The dynamics a grain follows (the paper's section 2; *falling* is the
/// constant-velocity rain of section 3, *fixed* its base "that never wakes up").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Flies under gravity and collides.
    Normal,
    /// Flies at constant velocity, without gravity, until its first collision
    /// of any kind; then normal.
    Falling,
    /// Asleep: at rest until it is hit hard enough or loses its support.
    Frozen,
    /// Never wakes: at rest, or on the path that the dynamics prescribes. Static
    /// grains do not collide with each other: one that moves passes through
    /// frozen ones, unless these are carried along with it.
    Fixed,
}

impl Mode {
    /// Frozen or fixed: such grains do not answer to collisions.
    #[must_use]
    pub fn is_static(self) -> bool {
        matches!(self, Mode::Frozen | Mode::Fixed)
    }

    /// Normal or falling.
    #[must_use]
    pub fn is_mobile(self) -> bool {
        !self.is_static()
    }

    /// The lower-case name used in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Mode::Normal => "normal",
            Mode::Falling => "falling",
            Mode::Frozen => "frozen",
            Mode::Fixed => "fixed",
        }
    }
}

/// A grain at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Particle<const D: usize> {
    /// Centre, in d.
    pub position: Vector<D>,
    /// Velocity, in √(gd).
    pub velocity: Vector<D>,
    /// Diameter σ, in d.
    pub diameter: f64,
    /// Mass, in m.
    pub mass: f64,
    /// The dynamics it follows.
    pub mode: Mode,
}

impl<const D: usize> Particle<D> {
    /// A normal grain of unit diameter and mass.
    #[must_use]
    pub fn new(position: Vector<D>, velocity: Vector<D>) -> Self {
        Particle {
            position,
            velocity,
            diameter: 1.0,
            mass: 1.0,
            mode: Mode::Normal,
        }
    }

    /// A grain of unit diameter and mass at rest that never wakes.
    #[must_use]
    pub fn fixed(position: Vector<D>) -> Self {
        Particle::new(position, Vector::zeros()).with_mode(Mode::Fixed)
    }

    /// A grain of unit diameter and mass that starts asleep.
    #[must_use]
    pub fn frozen(position: Vector<D>) -> Self {
        Particle::new(position, Vector::zeros()).with_mode(Mode::Frozen)
    }

    /// The same grain in another mode.
    #[must_use]
    pub fn with_mode(mut self, mode: Mode) -> Self {
        self.mode = mode;
        self
    }

    /// The same grain with another diameter, in d.
    #[must_use]
    pub fn with_diameter(mut self, diameter: f64) -> Self {
        self.diameter = diameter;
        self
    }

    /// The same grain with another mass, in m.
    #[must_use]
    pub fn with_mass(mut self, mass: f64) -> Self {
        self.mass = mass;
        self
    }

    /// Half the diameter, in d.
    #[must_use]
    pub fn radius(&self) -> f64 {
        0.5 * self.diameter
    }

    /// ½ m v², in mgd.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass * self.velocity.norm_squared()
    }
}
