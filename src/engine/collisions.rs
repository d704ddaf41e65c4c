//! Carrying out collisions.

use crate::engine::body::gain;
use crate::engine::cascade::Relief;
use crate::engine::ledger::Entry;
use crate::engine::simulation::Simulation;
use crate::engine::slot::{Partner, Slot};
use crate::engine::view::View;
use crate::model::{
    Boundary, CollisionRule, Dynamics, Impact, Model, Observer, Obstacle, Occurrence,
    OccurrenceKind, Place, Reason, Rebound, SleepDecision, Spins, StatePolicy, WakeCause,
    WakeDecision, Wall,
};
use crate::particle::{Mode, Particle, ParticleId, Vector, WallId};

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// A mobile grain meets another grain now.
    pub(super) fn collide_pair<O: Observer<D>>(
        &mut self,
        particle: u32,
        other: u32,
        observer: &mut O,
    ) {
        let now = self.world.clock;
        let struck_static = self.world.bodies[other as usize].mode.is_static();
        let (a, b) = if struck_static || particle < other {
            (particle, other)
        } else {
            (other, particle)
        };
        let one = self.world.particle_now(&self.model, a);
        let mut two = self.world.particle_now(&self.model, b);
        // The image of this moment, not the one of the prediction.
        let apart = self.world.displacement(&self.model, &two, &one);
        let distance = apart.norm_squared().sqrt();
        let normal = apart / distance;
        let stored_position = two.position;
        two.position = one.position - apart;
        let contact = 0.5 * (one.diameter + two.diameter);
        self.deepest = self.deepest.max(contact - distance);
        self.counts.guard += u64::from(self.traces.held_at(a, b, now));
        let mut impact = self.impact(a, one, normal, two.diameter);
        impact.obstacle = Obstacle::Particle {
            id: ParticleId(b),
            particle: two,
        };
        let impact_speed = impact.closing_speed();

        let mut kind = OccurrenceKind::Pair;
        let mut reason = None;
        let mut extra_energy = 0.0;
        if struck_static {
            kind = OccurrenceKind::Frozen;
            if two.mode == Mode::Frozen {
                let near = View {
                    model: &self.model,
                    world: &self.world,
                };
                let struck = &self.memories[b];
                let policy = self.model.state_policy();
                let decision = policy.should_wake(&impact, &near, struck);
                match decision {
                    WakeDecision::Stay(why) => {
                        self.hear(b, |kept, it| kept.slept_on = Some(it), why)
                    }
                    WakeDecision::Wake(_, why) => {
                        self.hear(b, |kept, it| kept.woke = Some(it), why)
                    }
                }
                if let WakeDecision::Wake(waking, why) = decision {
                    kind = OccurrenceKind::Wake;
                    reason = Some(why);
                    extra_energy = waking.extra_energy;
                    self.world
                        .note_change(Entry::GivenBack, b, &two.velocity, &waking.velocity);
                    two.velocity = waking.velocity;
                    two.mode = Mode::Normal;
                    impact.obstacle = Obstacle::Particle {
                        id: ParticleId(b),
                        particle: two,
                    };
                }
            }
        }
        let two_mobile = two.mode.is_mobile();
        let mut rebound = self.rebound(&impact, a, Some(b));
        let entry = match kind {
            OccurrenceKind::Pair => Entry::Pair,
            OccurrenceKind::Wake => Entry::Wake,
            _ => Entry::Frozen,
        };
        self.note_collision(entry, &impact, &rebound);
        if extra_energy > 0.0 {
            let before = rebound.other_velocity;
            rebound.other_velocity = with_energy(before, two.mass, extra_energy);
            self.world
                .note_change(Entry::GivenBack, b, &before, &rebound.other_velocity);
        }
        if !two_mobile {
            self.lift(&impact, &mut rebound);
        }

        let sleep = self.ask_sleep(&impact, rebound.velocity, a);
        let dynamics = self.model.dynamics();
        let other_ground = dynamics.ground_velocity(&stored_position, now);
        let mirrored = || Impact {
            id: ParticleId(b),
            particle: two,
            obstacle: Obstacle::Particle {
                id: ParticleId(a),
                particle: one,
            },
            normal: -normal,
            ground_velocity: other_ground,
            ..impact
        };
        let mut sleep_other = None;
        if kind == OccurrenceKind::Pair {
            sleep_other = self.ask_sleep(&mirrored(), rebound.other_velocity, b);
        }

        let run = self
            .traces
            .collided(a, Partner::Particle(b), !two_mobile, impact_speed, now);
        let held = (struck_static && !two_mobile && rebound.elastic).then_some(b);
        self.traces.hold(a, held, now);
        self.settle(a, one.position, rebound.velocity);
        let mut run_other = 0;
        if two_mobile {
            run_other = self
                .traces
                .collided(b, Partner::Particle(a), false, impact_speed, now);
            self.traces.hold(b, None, now);
            self.settle(b, stored_position, rebound.other_velocity);
        }
        if kind == OccurrenceKind::Wake {
            let cause = WakeCause::Hit {
                impact: mirrored(),
                after: rebound.other_velocity,
            };
            self.tell_woken(b, &cause);
        }
        let relief = self.end_cascade(a, run);
        let mut relief_other = Relief::none();
        if two_mobile && !relief.disturbs(b) {
            relief_other = self.end_cascade(b, run_other);
        }

        match kind {
            OccurrenceKind::Pair => self.counts.pair += 1,
            OccurrenceKind::Wake => self.counts.wake += 1,
            _ => self.counts.frozen += 1,
        }
        self.counts.elastic += u64::from(rebound.elastic);
        let velocity = self.world.bodies[a as usize].velocity;
        self.report(
            &Occurrence {
                time: now,
                kind,
                particle: ParticleId(a),
                other: Some(ParticleId(b)),
                wall: None,
                impact_speed,
                impulse: (velocity - one.velocity) * one.mass,
                velocity,
                other_velocity: self.world.bodies[b as usize].velocity,
                elastic: rebound.elastic,
                reason: reason.or(sleep.map(|(_, why)| why)),
            },
            observer,
        );
        self.predict(a);
        if two_mobile {
            self.predict(b);
        }
        self.tell_disturbed(&relief, [a, b], observer);
        self.tell_disturbed(&relief_other, [a, b], observer);
        self.begin_sleep(a, sleep, relief.caught, observer);
        if two_mobile {
            self.begin_sleep(b, sleep_other, relief_other.caught, observer);
        }
    }

    /// A mobile grain meets a wall now.
    pub(super) fn collide_wall<O: Observer<D>>(
        &mut self,
        particle: u32,
        wall: WallId,
        observer: &mut O,
    ) {
        let now = self.world.clock;
        let one = self.world.particle_now(&self.model, particle);
        let this = &self.model.boundary().walls()[wall.index()];
        let normal = this.normal(&one.position, now);
        let obstacle = Obstacle::Wall {
            id: wall,
            velocity: this.velocity(&one.position, now),
            restitution: this.restitution(),
        };
        let mut impact = self.impact(particle, one, normal, 0.0);
        impact.obstacle = obstacle;
        let impact_speed = impact.closing_speed();
        let mut rebound = self.rebound(&impact, particle, None);
        self.note_collision(Entry::Wall, &impact, &rebound);
        self.lift(&impact, &mut rebound);
        let sleep = self.ask_sleep(&impact, rebound.velocity, particle);

        let run = self
            .traces
            .collided(particle, Partner::Wall(wall), true, impact_speed, now);
        self.traces.hold(particle, None, now);
        self.settle(particle, one.position, rebound.velocity);
        let relief = self.end_cascade(particle, run);
        self.counts.wall += 1;
        self.counts.elastic += u64::from(rebound.elastic);
        let velocity = self.world.bodies[particle as usize].velocity;
        self.report(
            &Occurrence {
                time: now,
                kind: OccurrenceKind::Wall,
                particle: ParticleId(particle),
                other: None,
                wall: Some(wall),
                impact_speed,
                impulse: (velocity - one.velocity) * one.mass,
                velocity,
                other_velocity: Vector::zeros(),
                elastic: rebound.elastic,
                reason: sleep.map(|(_, why)| why),
            },
            observer,
        );
        self.predict(particle);
        self.tell_disturbed(&relief, [particle; 2], observer);
        self.begin_sleep(particle, sleep, relief.caught, observer);
    }

    /// An impact whose obstacle has still to be filled in.
    fn impact(
        &self,
        particle: u32,
        one: Particle<D>,
        normal: Vector<D>,
        other_diameter: f64,
    ) -> Impact<D> {
        let now = self.world.clock;
        let dynamics = self.model.dynamics();
        let growth = if M::Dynamics::GROWS {
            // Diameters at t = 0 grow at the rate; these are those of now.
            let scale = 1.0 + dynamics.growth_rate() * now.units();
            0.5 * (one.diameter + other_diameter) / scale * dynamics.growth_rate()
        } else {
            0.0
        };
        Impact {
            time: now,
            id: ParticleId(particle),
            particle: one,
            obstacle: Obstacle::Wall {
                id: WallId(0),
                velocity: Vector::zeros(),
                restitution: 1.0,
            },
            normal,
            growth,
            gravity: dynamics.gravity(now),
            ground_velocity: dynamics.ground_velocity(&one.position, now),
        }
    }

    /// What the rule makes of an impact; nothing if rounding, or a velocity
    /// given back, has the two separate already.
    fn rebound(&mut self, impact: &Impact<D>, own: u32, other: Option<u32>) -> Rebound<D> {
        if impact.closing_speed() <= 0.0 {
            return Rebound {
                velocity: impact.particle.velocity,
                other_velocity: impact.obstacle_velocity(),
                elastic: false,
                spared_energy: 0.0,
            };
        }
        let mut own_spin = self.spins[own as usize];
        let mut other_spin = other.map(|id| self.spins[id as usize]);
        let rebound = self.model.collision_rule().collide(
            impact,
            Spins {
                own: &mut own_spin,
                other: other_spin.as_mut(),
            },
        );
        self.spins[own as usize] = own_spin;
        if let (Some(id), Some(spin)) = (other, other_spin) {
            self.spins[id as usize] = spin;
        }
        rebound
    }

    /// The floor guard: a least speed away from a static obstacle.
    fn lift(&mut self, impact: &Impact<D>, rebound: &mut Rebound<D>) {
        let least = self.settings.guards.floor_speed;
        if least == 0.0 {
            return;
        }
        let apart = rebound.velocity - impact.obstacle_velocity();
        let leaving = apart.dot(&impact.normal) - impact.growth;
        if leaving < least {
            let before = rebound.velocity;
            rebound.velocity += impact.normal * (least - leaving);
            let gained = gain(impact.particle.mass, &before, &rebound.velocity);
            self.world.ledger.add(Entry::Guard, gained);
            self.counts.guard += 1;
        }
    }

    fn ask_sleep(
        &mut self,
        impact: &Impact<D>,
        after: Vector<D>,
        particle: u32,
    ) -> Option<(Place, Reason)> {
        let near = View {
            model: &self.model,
            world: &self.world,
        };
        let memory = self.memories.make(particle);
        let policy = self.model.state_policy();
        match policy.should_sleep(impact, after, &near, memory) {
            SleepDecision::Stay(reason) => {
                self.hear(particle, |kept, it| kept.stayed_awake = Some(it), reason);
                None
            }
            SleepDecision::Sleep(place, reason) => {
                self.hear(particle, |kept, it| kept.slept = Some(it), reason);
                Some((place, reason))
            }
        }
    }

    /// Writes a grain's state after a collision; whatever it was about to do is
    /// void.
    pub(super) fn settle(&mut self, particle: u32, position: Vector<D>, velocity: Vector<D>) {
        let model = &self.model;
        let was_static = self.world.bodies[particle as usize].mode.is_static();
        self.world
            .write(model, particle, position, velocity, Mode::Normal);
        *self.slots.make(particle) = Slot::EMPTY;
        self.tie_if_moving(particle);
        self.note_speed(particle);
        self.tell_dependants(particle, was_static);
    }

    /// Reports, and predicts anew, the grains that the end of a cascade has
    /// disturbed, but for those that have just collided.
    fn tell_disturbed<O: Observer<D>>(
        &mut self,
        relief: &Relief<D>,
        collided: [u32; 2],
        observer: &mut O,
    ) {
        for &(particle, change) in &relief.disturbed {
            if collided.contains(&particle) {
                continue;
            }
            self.report(
                &Occurrence {
                    time: self.world.clock,
                    kind: OccurrenceKind::Guard,
                    particle: ParticleId(particle),
                    other: None,
                    wall: None,
                    impact_speed: 0.0,
                    impulse: change * self.world.bodies[particle as usize].mass,
                    velocity: self.world.bodies[particle as usize].velocity,
                    other_velocity: Vector::zeros(),
                    elastic: false,
                    reason: None,
                },
                observer,
            );
            self.predict(particle);
        }
    }

    pub(super) fn report<O: Observer<D>>(&self, occurrence: &Occurrence<D>, observer: &mut O) {
        observer.observe(
            occurrence,
            &View {
                model: &self.model,
                world: &self.world,
            },
        );
    }

    /// A grain that has just been predicted anew starts to fall asleep.
    fn begin_sleep<O: Observer<D>>(
        &mut self,
        particle: u32,
        decision: Option<(Place, Reason)>,
        caught: Option<Reason>,
        observer: &mut O,
    ) {
        if caught.is_some() {
            self.fall_asleep(particle, caught, observer);
            return;
        }
        match decision {
            None => {}
            Some((Place::Here, reason)) => self.fall_asleep(particle, Some(reason), observer),
            Some((Place::HalfWay, _)) => {
                if let Some(wait) = self.next_collision(particle) {
                    self.slots.make(particle).sleep = self.world.clock + 0.5 * wait;
                    self.enqueue(particle);
                }
            }
        }
    }
}

/// A velocity lengthened so that its kinetic energy grows by `energy`.
fn with_energy<const D: usize>(velocity: Vector<D>, mass: f64, energy: f64) -> Vector<D> {
    let squared = velocity.norm_squared();
    if squared == 0.0 {
        return velocity;
    }
    velocity * ((squared + 2.0 * energy / mass) / squared).sqrt()
}
