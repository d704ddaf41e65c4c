use crate::engine::body::World;
use crate::engine::cells::Found;
use crate::model::{
    Boundary, Dynamics, GravityCourse, Model, NearWall, Neighbour, Shape, Surroundings, Wall,
};
use crate::particle::{Particle, ParticleId, Vector, WallId};
use crate::time::Time;

/// The world at the instant the clock shows.
pub(super) struct View<'a, M, const D: usize> {
    pub(super) model: &'a M,
    pub(super) world: &'a World<D>,
}

impl<M: Model<D>, const D: usize> Surroundings<D> for View<'_, M, D> {
    fn time(&self) -> Time {
        self.world.clock
    }

    fn gravity(&self) -> Vector<D> {
        self.model.dynamics().gravity(self.world.clock)
    }

    fn gravity_course(&self) -> GravityCourse {
        self.model.dynamics().gravity_course()
    }

    fn ground_velocity(&self, id: ParticleId) -> Vector<D> {
        let position = self.particle(id).position;
        let dynamics = self.model.dynamics();
        dynamics.ground_velocity(&position, self.world.clock)
    }

    fn particle(&self, id: ParticleId) -> Particle<D> {
        self.world.particle_now(self.model, id.0)
    }

    fn particle_count(&self) -> usize {
        self.world.bodies.len()
    }

    fn for_each_neighbour(&self, of: ParticleId, range: f64, mut visit: impl FnMut(Neighbour<D>)) {
        let centre = self.particle(of);
        let scale = crate::engine::body::scale_at::<M, D>(self.model, self.world.clock);
        let farthest = range * 0.5 * (centre.diameter + self.world.largest * scale);
        let visit = |found: Found<D>| {
            let Some((other, offset)) = self.world.nearest(self.model, &centre, &found) else {
                return;
            };
            let contact = 0.5 * (centre.diameter + other.diameter);
            let relative_distance = offset.norm_squared().sqrt() / contact;
            if relative_distance < range {
                visit(Neighbour {
                    id: ParticleId(found.particle),
                    offset,
                    relative_distance,
                    mode: other.mode,
                });
            }
        };
        self.world
            .for_each_within(self.model, of.0, farthest, visit);
    }

    fn for_each_wall(&self, of: ParticleId, gap: f64, mut visit: impl FnMut(NearWall<D>)) {
        let centre = self.particle(of);
        let now = self.world.clock;
        for (place, wall) in self.model.boundary().walls().iter().enumerate() {
            let this = wall.distance(&centre.position, now) - centre.radius();
            if this < gap {
                visit(NearWall {
                    id: WallId(place as u16),
                    normal: wall.normal(&centre.position, now),
                    gap: this,
                    speed: match wall.shape() {
                        Shape::Plane { .. } => 0.0,
                        Shape::General { speed, .. } => speed,
                    },
                });
            }
        }
    }
}
