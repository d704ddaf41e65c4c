//! The cascade guard and the collapse detector.

use crate::engine::projection::{Member, Touch, project};
use crate::engine::search::Partner;
use crate::engine::settings::Collapse;
use crate::engine::simulation::Simulation;
use crate::model::{Boundary, Dynamics, Model, Wall};
use crate::particle::{Mode, ParticleId, Vector};

/// Difference of squared distances up to which two surfaces count as touching,
/// in d².
const TOUCHING: f64 = 1.0e-11;

/// A cluster of grains that touch is not followed beyond this many.
const MOST_MEMBERS: usize = 12;

/// Normal grains that touch each other, and all their contacts.
struct Cluster<const D: usize> {
    members: Vec<u32>,
    touches: Vec<Touch<D>>,
    /// The static grains among those touched.
    statics: Vec<u32>,
}

/// What the guard did.
#[derive(Debug, Default)]
pub(super) struct Relief {
    /// The grain is caught between static ones and has to sleep where it is.
    pub(super) caught: bool,
    /// Grains whose velocities were changed, and who have to be predicted anew.
    pub(super) disturbed: Vec<u32>,
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Ends a cascade of a grain that has made `run` collisions at this instant,
    /// or finds that it has collapsed.
    pub(super) fn end_cascade(&mut self, particle: u32, run: u32) -> Relief {
        let guards = self.settings.guards;
        if guards.collapse.is_some_and(|limit| run >= limit) && self.collapse.is_none() {
            self.collapse = Some(self.name_collapse(particle, run));
        }
        let due = |limit: u32| run >= limit && run.is_multiple_of(limit);
        if !guards.cascade.is_some_and(due) {
            return Relief::default();
        }
        let cluster = self.cluster(particle);
        if cluster.touches.is_empty() {
            return Relief::default();
        }
        self.counts.guard += 1;
        let before: Vec<Vector<D>> = cluster
            .members
            .iter()
            .map(|&member| self.world.particle_now(&self.model, member).velocity)
            .collect();
        let Some(resting) = project(&before, &cluster.touches, 0.0) else {
            return Relief::default();
        };
        // In a narrow cone a small exit speed along the normals is a large one
        // along the axis.
        let most = 10.0 * guards.exit_speed;
        let mut exit = guards.exit_speed;
        let mut leaving = project(&before, &cluster.touches, exit);
        if let Some(fast) = &leaving {
            let gained = fast
                .iter()
                .zip(&resting)
                .map(|(fast, rest)| (fast - rest).norm())
                .fold(0.0, f64::max);
            if gained > most {
                exit *= most / gained;
                leaving = project(&before, &cluster.touches, exit);
            }
        }
        // Where contacts work against each other some grain cannot leave.
        let caught = leaving.is_none() && resting[0].norm() <= most;
        let after = leaving.unwrap_or(resting);
        let mut disturbed = Vec::new();
        for (&member, velocity) in cluster.members.iter().zip(after) {
            let body = &mut self.world.bodies[member as usize];
            if body.since == self.world.clock {
                body.velocity = velocity;
                body.stamp = body.stamp.wrapping_add(1);
            } else {
                let position = self.world.particle_now(&self.model, member).position;
                self.settle(member, position, velocity);
            }
            self.traces[member as usize].partner = Partner::Nobody;
            self.slots[member as usize].sleep = crate::time::Time::NEVER;
            self.note_speed(member);
            disturbed.push(member);
        }
        Relief { caught, disturbed }
    }

    fn name_collapse(&self, particle: u32, run: u32) -> Collapse {
        let cluster = self.cluster(particle);
        let mut particles: Vec<ParticleId> = cluster
            .members
            .iter()
            .chain(&cluster.statics)
            .map(|id| ParticleId(*id))
            .collect();
        if let Partner::Particle(last) = self.traces[particle as usize].partner
            && !particles.contains(&ParticleId(last))
        {
            particles.push(ParticleId(last));
        }
        Collapse {
            time: self.world.clock,
            particles,
            collisions: u64::from(run),
        }
    }

    /// The normal grains that touch `particle` now, directly or through each
    /// other, it first, and whatever any of them touches.
    fn cluster(&self, particle: u32) -> Cluster<D> {
        let now = self.world.clock;
        let mut cluster = Cluster {
            members: vec![particle],
            touches: Vec::new(),
            statics: Vec::new(),
        };
        let mut place = 0;
        while place < cluster.members.len() {
            let member = cluster.members[place];
            let one = self.world.particle_now(&self.model, member);
            let here = Member {
                place,
                mass: one.mass,
            };
            let farthest = one.radius() + 0.5 * self.world.largest * self.scale_at(now) + TOUCHING;
            let mut touched = Vec::new();
            self.world.near.for_each_within(member, farthest, |found| {
                let other = self.world.particle_now(&self.model, found.particle);
                if other.mode == Mode::Falling {
                    return;
                }
                let towards = self.world.nearest(&self.model, &one, &other, found.turns);
                let Some(apart) = towards.map(|towards| -towards) else {
                    return;
                };
                let contact = 0.5 * (one.diameter + other.diameter);
                if apart.norm_squared() - contact * contact < TOUCHING {
                    touched.push((found.particle, apart.normalize(), other));
                }
            });
            // By id, so that the outcome does not depend on the grid.
            touched.sort_by_key(|touch| touch.0);
            for (id, normal, other) in touched {
                if other.mode.is_static() {
                    cluster.touches.push(Touch {
                        one: here,
                        other: None,
                        normal,
                        speed: other.velocity.dot(&normal),
                    });
                    if !cluster.statics.contains(&id) {
                        cluster.statics.push(id);
                    }
                    continue;
                }
                let known = cluster.members.iter().position(|&known| known == id);
                let there = match known {
                    // Its contacts have been noted already.
                    Some(there) if there < place => continue,
                    Some(there) => there,
                    None if cluster.members.len() == MOST_MEMBERS => continue,
                    None => {
                        cluster.members.push(id);
                        cluster.members.len() - 1
                    }
                };
                cluster.touches.push(Touch {
                    one: here,
                    other: Some(Member {
                        place: there,
                        mass: other.mass,
                    }),
                    normal,
                    speed: 0.0,
                });
            }
            for wall in self.model.boundary().walls() {
                if wall.distance(&one.position, now) - one.radius() < 0.5 * TOUCHING {
                    let normal = wall.normal(&one.position, now);
                    let speed = wall.velocity(&one.position, now).dot(&normal);
                    cluster.touches.push(Touch {
                        one: here,
                        other: None,
                        normal,
                        speed,
                    });
                }
            }
            place += 1;
        }
        let growth = if M::Dynamics::GROWS {
            self.model.dynamics().growth_rate() * self.world.largest
        } else {
            0.0
        };
        for touch in &mut cluster.touches {
            touch.speed += growth;
        }
        cluster
    }
}
