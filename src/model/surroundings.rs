//! What a policy may see of the world at an event.

use crate::model::GravityCourse;
use crate::particle::{Mode, Particle, ParticleId, Vector, WallId};
use crate::time::Time;

/// A grain near another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour<const D: usize> {
    /// Which.
    pub id: ParticleId,
    /// From the grain in question to this one, the nearest image, in d.
    pub offset: Vector<D>,
    /// Distance of the centres over the distance at contact: 1 is touching.
    pub relative_distance: f64,
    /// The dynamics it follows now.
    pub mode: Mode,
}

/// A wall near a grain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearWall<const D: usize> {
    /// Which.
    pub id: WallId,
    /// Unit normal at the nearest point, from the wall to the grain.
    pub normal: Vector<D>,
    /// Gap between the wall and the grain's surface, in d.
    pub gap: f64,
    /// A bound on how fast the wall moves, in √(gd); 0 if it is at rest.
    pub speed: f64,
}

/// The world around an event, all at the event's time. Reading it changes
/// nothing.
///
/// The generic type names are: `D` the dimension.
pub trait Surroundings<const D: usize> {
    /// Now.
    fn time(&self) -> Time;

    /// Gravity now, in g.
    fn gravity(&self) -> Vector<D>;

    /// How gravity changes from now on, as seen from the ground.
    fn gravity_course(&self) -> GravityCourse;

    /// Velocity of what counts as at rest where a grain is, in √(gd).
    fn ground_velocity(&self, id: ParticleId) -> Vector<D>;

    /// A grain, now.
    fn particle(&self, id: ParticleId) -> Particle<D>;

    /// How many grains there are; their names run from 0.
    fn particle_count(&self) -> usize;

    /// Calls `visit` for every grain whose centre is nearer to the one of `of`
    /// than `range` times their distance at contact, in no stated order.
    fn for_each_neighbour(&self, of: ParticleId, range: f64, visit: impl FnMut(Neighbour<D>));

    /// Calls `visit` for every wall nearer than `gap` to the surface of `of`.
    fn for_each_wall(&self, of: ParticleId, gap: f64, visit: impl FnMut(NearWall<D>));
}
