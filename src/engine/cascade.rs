//! The cascade guard and the collapse detector.

use crate::engine::cells::Found;
use crate::engine::ledger::Entry;
use crate::engine::projection::{Member, Touch, project, project_within};
use crate::engine::settings::{Collapse, Guards};
use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::model::{Boundary, Dynamics, Model, Reason, StatePolicy, Wall};
use crate::particle::{Mode, Particle, ParticleId, Vector};

/// Difference of squared distances up to which two surfaces count as touching,
/// in d².
const TOUCHING: f64 = 1.0e-11;

/// After each this many collisions with nothing but static obstacles, a grain
/// is looked at: it may be caught in a cage.
const CONFINED: u32 = 4096;

/// Difference of squared distances, in d², up to which the bars of a cage may be
/// away: the grain in it cannot move farther than about that.
const CAGE: f64 = 1.0e-8;

/// Collisions that follow each other in less than this part of the exit speed
/// over gravity are too many: a free grain needs twice the whole to come back.
const HURRY: f64 = 0.1;

/// A grain is held if its contacts leave less than this part of its weight.
const HELD: f64 = 1.0e-3;

/// A cascade that goes on after the guard has acted so often is looked at more closely.
const STUBBORN: u32 = 256;

/// Contacts that all but contradict each other, as at a groove whose sides open by 10⁻⁵,
/// are solved for in two steps: after the first so much may remain of how fast surfaces
/// close, over the fastest grain's speed.
const NARROW: f64 = 1.0e-6;

/// The collisions that count as collapse over those, with nothing but static obstacles,
/// after which a grain falls asleep: whatever goes on there has no end that could be told.
const LAST_RESORT: u32 = 2;

/// A cluster of grains that touch is not followed beyond this many.
const MOST_MEMBERS: usize = 12;

/// Normal grains that touch each other, and all their contacts.
struct Cluster<const D: usize> {
    members: Vec<u32>,
    touches: Vec<Touch<D>>,
    /// The static grains among those touched.
    statics: Vec<u32>,
}

/// Velocities of a cluster.
struct Stopped<const D: usize> {
    /// Those before, or nearer ones: the others are found from these.
    nearly: Vec<Vector<D>>,
    /// The nearest with which nobody comes nearer.
    resting: Vec<Vector<D>>,
}

impl<const D: usize> Cluster<D> {
    /// Stops whoever comes nearer to somebody, where the ground moves like this.
    fn stopped(&self, before: &[Vector<D>], ground: &Vector<D>) -> Option<Stopped<D>> {
        if let Some(resting) = project(before, &self.touches, 0.0) {
            let nearly = before.to_vec();
            return Some(Stopped { nearly, resting });
        }
        let squares = before.iter().map(|v| (v - ground).norm_squared());
        let creep = NARROW * squares.fold(0.0, f64::max).sqrt();
        let nearly = project_within(before, &self.touches, 0.0, creep)?;
        let resting = project(&nearly, &self.touches, 0.0)?;
        Some(Stopped { nearly, resting })
    }

    /// The velocities nearest to `before` with which nobody comes nearer and the first
    /// member leaves such of its contacts at this speed, in √(gd); `None` if there are
    /// none.
    fn left_alone(
        &self,
        before: &[Vector<D>],
        exit: f64,
        such: impl Fn(&Touch<D>) -> bool,
    ) -> Option<Vec<Vector<D>>> {
        let mut touches = self.touches.clone();
        for touch in touches.iter_mut().filter(|touch| touch.is_of(0)) {
            if such(touch) {
                touch.speed += exit;
            }
        }
        project(before, &touches, 0.0)
    }
}

/// What the guard did.
#[derive(Debug)]
pub(super) struct Relief<const D: usize> {
    /// Why the grain has to sleep where it is, if it has to.
    pub(super) caught: Option<Reason>,
    /// Grains whose velocities were changed, and who have to be predicted anew,
    /// with the change, in √(gd).
    pub(super) disturbed: Vec<(u32, Vector<D>)>,
}

impl<const D: usize> Relief<D> {
    /// Nothing.
    pub(super) fn none() -> Self {
        Relief {
            caught: None,
            disturbed: Vec::new(),
        }
    }

    /// Whether the velocity of a grain was changed.
    pub(super) fn disturbs(&self, particle: u32) -> bool {
        self.disturbed.iter().any(|(other, _)| *other == particle)
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// Ends a cascade of a grain that has made `run` collisions at this instant,
    /// or finds that it has collapsed.
    pub(super) fn end_cascade(&mut self, particle: u32, run: u32) -> Relief<D> {
        let guards = self.settings.guards;
        if guards.collapse.is_some_and(|limit| run >= limit) && self.collapse.is_none() {
            self.collapse = Some(self.name_collapse(particle, run));
        }
        let sleeps = self.model.state_policy().sleeps();
        let between = Reason::new("caught between static grains", 0.0, 0.0);
        if sleeps && guards.cascade.is_some() {
            let caught = if self.is_caught(particle) {
                Some(between)
            } else {
                self.past_remedy(particle, run)
            };
            if caught.is_some() {
                self.counts.guard += 1;
                return Relief {
                    caught,
                    ..Relief::none()
                };
            }
        }
        let due = |limit: u32| run >= limit && run.is_multiple_of(limit);
        if !guards.cascade.is_some_and(due) {
            return Relief::none();
        }
        let cluster = self.cluster(particle);
        if cluster.touches.is_empty() {
            return Relief::none();
        }
        self.counts.guard += 1;
        let before: Vec<Vector<D>> = cluster
            .members
            .iter()
            .map(|&member| self.world.particle_now(&self.model, member).velocity)
            .collect();
        let place = self.world.particle_now(&self.model, particle).position;
        let now = self.world.clock;
        let ground = self.model.dynamics().ground_velocity(&place, now);
        let Some(Stopped { nearly, resting }) = cluster.stopped(&before, &ground) else {
            return Relief::none();
        };
        // In a narrow cone a small exit speed along the normals is a large one
        // along the axis.
        let most = 10.0 * guards.exit_speed;
        let leave = |way: &dyn Fn(f64) -> Option<Vec<Vector<D>>>| {
            let fast = way(guards.exit_speed)?;
            let gained = fast
                .iter()
                .zip(&resting)
                .map(|(fast, rest)| (fast - rest).norm_squared().sqrt())
                .fold(0.0, f64::max);
            if gained > most {
                way(guards.exit_speed * (most / gained))
            } else {
                Some(fast)
            }
        };
        let mut leaving = leave(&|exit| project(&nearly, &cluster.touches, exit));
        // Where contacts work against each other some grain cannot leave.
        let is_at_rest = (resting[0] - ground).norm_squared().sqrt() <= most;
        let caught = sleeps && leaving.is_none() && is_at_rest;
        if leaving.is_none() && !caught && run / STUBBORN >= guards.cascade.unwrap_or(run) {
            // Somebody else cannot leave. At rest within rounding, this one would go on
            // colliding with what it slides along, so it leaves alone: all its
            // contacts, or the static ones.
            leaving = leave(&|exit| cluster.left_alone(&nearly, exit, |_| true))
                .or_else(|| leave(&|exit| cluster.left_alone(&nearly, exit, Touch::is_on_static)));
        }
        let after = leaving.unwrap_or(resting);
        let mut disturbed = Vec::new();
        for ((&member, velocity), was) in cluster.members.iter().zip(after).zip(before) {
            let body = &mut self.world.bodies[member as usize];
            if body.since == self.world.clock {
                body.velocity = velocity;
                body.stamp = body.stamp.wrapping_add(1);
                self.world.keep_blur(&self.model, member);
                self.world.glance(&self.model, member);
                self.tell_dependants(member, false);
            } else {
                let position = self.world.particle_now(&self.model, member).position;
                self.settle(member, position, velocity);
            }
            self.traces.forget_partner(member);
            if let Some(slot) = self.slots.own(member) {
                slot.sleep = crate::time::Time::NEVER;
            }
            self.note_speed(member);
            self.world
                .note_change(Entry::Guard, member, &was, &velocity);
            disturbed.push((member, velocity - was));
        }
        Relief {
            caught: caught.then_some(between),
            disturbed,
        }
    }

    /// Whether a grain is caught between static obstacles that all but touch it:
    /// on so many sides that no velocity leads away from all of them, or so
    /// that they hold its weight while it rattles between them far faster than
    /// a grain that leaves at the exit speed.
    fn is_caught(&mut self, particle: u32) -> bool {
        let now = self.world.clock;
        let exit = self.settings.guards.exit_speed;
        let confined = self.traces[particle].confined;
        if confined == 0 || !confined.is_multiple_of(CONFINED) || exit == 0.0 {
            return false;
        }
        let Some(lasted) = self.traces.confine_from(particle, now) else {
            return false;
        };
        let velocity = self.world.particle_now(&self.model, particle).velocity;
        let mut bars = Vec::new();
        self.for_each_static(particle, CAGE, |touch, _| bars.push(touch));
        if project(&[velocity], &bars, exit).is_none() {
            return true;
        }
        let gravity = self.model.dynamics().gravity(now);
        let hurried = lasted * gravity.norm_squared().sqrt() < HURRY * exit * f64::from(CONFINED);
        // Where the ground moves the bars do so together: it falls relative to them. How
        // it falls depends neither on its mass nor on the size of gravity.
        for bar in &mut bars {
            bar.speed = 0.0;
            bar.one.mass = 1.0;
        }
        let strength = gravity.norm_squared().sqrt();
        // In a narrow wedge the sides press with thousands of times the weight, and what
        // is left of that is not exact: a tenth of what would hold it.
        let held = |fall: Vec<Vector<D>>| fall[0].norm_squared().sqrt() < HELD;
        let way = |fall: Vector<D>| project_within(&[fall], &bars, 0.0, 0.1 * HELD);
        hurried && strength > 0.0 && way(gravity / strength).is_some_and(held)
    }

    /// Why a grain has to sleep that has gone on colliding with nothing but static
    /// obstacles, at one instant, through all that the guard has done.
    fn past_remedy(&self, particle: u32, run: u32) -> Option<Reason> {
        let Guards {
            cascade,
            exit_speed,
            collapse,
            ..
        } = self.settings.guards;
        let last = collapse? / LAST_RESORT;
        if run < last {
            return None;
        }
        let tried = exit_speed > 0.0 && cascade.is_some_and(|due| run / STUBBORN >= due);
        let confined = self.traces[particle].confined >= run;
        if !tried || !confined || self.collapse.is_some() {
            return None;
        }
        let mut leans = false;
        self.for_each_static(particle, TOUCHING, |_, grain| leans |= grain.is_some());
        let what = "collided without end at one instant";
        leans.then(|| Reason::new(what, f64::from(run), f64::from(last)))
    }

    fn name_collapse(&self, particle: u32, run: u32) -> Collapse {
        let cluster = self.cluster(particle);
        let mut particles: Vec<ParticleId> = cluster
            .members
            .iter()
            .chain(&cluster.statics)
            .map(|id| ParticleId(*id))
            .collect();
        if let Partner::Particle(last) = self.traces[particle].partner
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
        let mut cluster = Cluster {
            members: vec![particle],
            touches: Vec::new(),
            statics: Vec::new(),
        };
        let mut place = 0;
        while place < cluster.members.len() {
            let member = cluster.members[place];
            let Cluster {
                members,
                touches,
                statics,
            } = &mut cluster;
            self.for_each_static(member, TOUCHING, |mut touch, id| {
                touch.one.place = place;
                touches.push(touch);
                if let Some(id) = id
                    && !statics.contains(&id)
                {
                    statics.push(id);
                }
            });
            self.for_each_touching(member, TOUCHING, |id, normal, one, other| {
                if other.mode != Mode::Normal {
                    return;
                }
                let there = match members.iter().position(|&known| known == id) {
                    // Its contacts have been noted already.
                    Some(there) if there < place => return,
                    Some(there) => there,
                    None if members.len() == MOST_MEMBERS => return,
                    None => {
                        members.push(id);
                        members.len() - 1
                    }
                };
                touches.push(Touch {
                    one: Member {
                        place,
                        mass: one.mass,
                    },
                    other: Some(Member {
                        place: there,
                        mass: other.mass,
                    }),
                    normal,
                    speed: self.growth_speed(),
                });
            });
            place += 1;
        }
        cluster
    }

    /// Calls `visit` for every static grain and wall that touches a grain now,
    /// with the grain's id.
    fn for_each_static(
        &self,
        particle: u32,
        tolerance: f64,
        mut visit: impl FnMut(Touch<D>, Option<u32>),
    ) {
        let now = self.world.clock;
        self.for_each_touching(particle, tolerance, |id, normal, one, other| {
            if other.mode.is_static() {
                let touch = Touch {
                    one: Member {
                        place: 0,
                        mass: one.mass,
                    },
                    other: None,
                    normal,
                    speed: other.velocity.dot(&normal) + self.growth_speed(),
                };
                visit(touch, Some(id));
            }
        });
        let one = self.world.particle_now(&self.model, particle);
        for wall in self.model.boundary().walls() {
            if wall.distance(&one.position, now) - one.radius() < 0.5 * tolerance {
                let normal = wall.normal(&one.position, now);
                let speed = wall.velocity(&one.position, now).dot(&normal);
                let touch = Touch {
                    one: Member {
                        place: 0,
                        mass: one.mass,
                    },
                    other: None,
                    normal,
                    speed: speed + self.growth_speed(),
                };
                visit(touch, None);
            }
        }
    }

    /// Calls `visit` for every grain that touches another now: its id, the
    /// normal towards the other, the other and it.
    fn for_each_touching(
        &self,
        particle: u32,
        tolerance: f64,
        mut visit: impl FnMut(u32, Vector<D>, &Particle<D>, &Particle<D>),
    ) {
        let one = self.world.particle_now(&self.model, particle);
        let largest = self.world.largest * self.scale_at(self.world.clock);
        // However small they are, their surfaces are no farther apart than this.
        let margin = tolerance.sqrt();
        let farthest = one.radius() + 0.5 * largest + margin;
        let mut touched = Vec::new();
        let mut look = |found: &Found<D>| {
            let Some((other, offset)) = self.world.nearest(&self.model, &one, found) else {
                return;
            };
            let apart = -offset;
            let contact = 0.5 * (one.diameter + other.diameter);
            if apart.norm_squared() - contact * contact < tolerance {
                touched.push((found.particle, apart.normalize(), other));
            }
        };
        let near = &self.world.near;
        if near.is_tied(particle) && near.slack(particle, &one.position) > margin {
            near.list(particle).for_each(|found| look(&found));
        } else {
            self.world
                .for_each_within(&self.model, particle, farthest, |found| look(&found));
        }
        // By id, so that the outcome does not depend on the grid.
        touched.sort_by_key(|touch| touch.0);
        for (id, normal, other) in &touched {
            visit(*id, *normal, &one, other);
        }
    }

    /// A bound on how fast growing grains come nearer by growth alone.
    fn growth_speed(&self) -> f64 {
        if M::Dynamics::GROWS {
            self.model.dynamics().growth_rate() * self.world.largest
        } else {
            0.0
        }
    }
}
