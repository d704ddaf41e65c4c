//! A collision, as the rule and the policy see it.

use crate::particle::{Particle, ParticleId, Vector, WallId};
use crate::time::Time;

/// What a grain collides with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle<const D: usize> {
    /// Another grain.
    Particle {
        /// Which.
        id: ParticleId,
        /// As it is just before the collision, in its periodic image next to
        /// the struck place.
        particle: Particle<D>,
    },
    /// A wall.
    Wall {
        /// Which.
        id: WallId,
        /// Velocity of its surface at the struck place, in √(gd).
        velocity: Vector<D>,
        /// Its coefficient of restitution.
        restitution: f64,
    },
}

/// A collision seen from one grain, just before velocities change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact<const D: usize> {
    /// When.
    pub time: Time,
    /// Which grain.
    pub id: ParticleId,
    /// The grain just before the collision.
    pub particle: Particle<D>,
    /// What it collides with.
    pub obstacle: Obstacle<D>,
    /// Unit vector from the obstacle to the grain.
    pub normal: Vector<D>,
    /// How fast the distance at contact grows, in √(gd); 0 for grains of
    /// constant size.
    pub growth: f64,
    /// Gravity at this time, in g.
    pub gravity: Vector<D>,
    /// Velocity of what counts as at rest here, in √(gd).
    pub ground_velocity: Vector<D>,
}

impl<const D: usize> Impact<D> {
    /// Velocity of the obstacle's surface, in √(gd).
    #[must_use]
    pub fn obstacle_velocity(&self) -> Vector<D> {
        match &self.obstacle {
            Obstacle::Particle { particle, .. } => particle.velocity,
            Obstacle::Wall { velocity, .. } => *velocity,
        }
    }

    /// Velocity of the grain relative to the obstacle, in √(gd).
    #[must_use]
    pub fn relative_velocity(&self) -> Vector<D> {
        self.particle.velocity - self.obstacle_velocity()
    }

    /// Rate at which the gap closes along the normal, growth included, in
    /// √(gd): positive in a collision.
    #[must_use]
    pub fn closing_speed(&self) -> f64 {
        self.growth - self.relative_velocity().dot(&self.normal)
    }

    /// Speed of the arriving grain relative to the ground, in √(gd).
    #[must_use]
    pub fn arriving_speed(&self) -> f64 {
        (self.particle.velocity - self.ground_velocity)
            .norm_squared()
            .sqrt()
    }

    /// The obstacle is a frozen or fixed grain.
    #[must_use]
    pub fn is_on_static(&self) -> bool {
        matches!(&self.obstacle, Obstacle::Particle { particle, .. } if particle.mode.is_static())
    }

    /// The obstacle is a wall.
    #[must_use]
    pub fn is_on_wall(&self) -> bool {
        matches!(self.obstacle, Obstacle::Wall { .. })
    }
}
