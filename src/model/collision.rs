//! What a collision does to velocities.

use std::fmt::Debug;

use serde::{Serialize, de::DeserializeOwned};

use crate::error::SetupError;
use crate::model::Impact;
use crate::particle::Vector;

/// Velocities just after a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebound<const D: usize> {
    /// Of the grain the impact is told from, in √(gd).
    pub velocity: Vector<D>,
    /// Of the other grain, in √(gd); ignored if the obstacle is a wall or a
    /// static grain.
    pub other_velocity: Vector<D>,
    /// The collision was made elastic by a cut-off (V_c), for the statistics.
    pub elastic: bool,
    /// The kinetic energy, in mgd, that the collision would have cost without
    /// that cut-off; 0 if it did not act.
    pub spared_energy: f64,
}

/// The inner states of the grains in a collision.
#[derive(Debug)]
pub struct Spins<'a, S> {
    /// Of the grain the impact is told from.
    pub own: &'a mut S,
    /// Of the other grain, unless the obstacle is a wall.
    pub other: Option<&'a mut S>,
}

/// What a collision does.
///
/// `examples/own_collision_rule.rs` shows how to write one.
///
/// The generic type names are: `D` the dimension.
pub trait CollisionRule<const D: usize> {
    /// What else a grain carries besides its velocity, such as the angular
    /// velocity of a rough sphere. Smooth grains use `()`, which costs nothing.
    type Spin: Copy + Default + Debug + Serialize + DeserializeOwned;

    /// Velocities after the collision. The obstacle has infinite mass if it is
    /// a wall or a static grain ([`Impact::is_on_static`]); otherwise it answers
    /// with its own mass.
    fn collide(&self, impact: &Impact<D>, spins: Spins<'_, Self::Spin>) -> Rebound<D>;

    /// Refuses parameters that are out of range; asked once, before a
    /// simulation starts.
    ///
    /// # Errors
    ///
    /// [`SetupError`] with the parameter, its value and what is allowed.
    fn validate(&self) -> Result<(), SetupError> {
        Ok(())
    }
}
