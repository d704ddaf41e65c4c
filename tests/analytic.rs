//! Systems of one or two grains whose whole course can be written down.

mod common;

use common::{close, free, heavy, periodic_laterally, rain_on_base, rule, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, Growing, Parabola, UniformGravity};
use grainfall::engine::{Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Dynamics, Model, Motion, OccurrenceKind, Parts, StatePolicy};
use grainfall::observe::{CollisionalTransfer, Displacements};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::setup::Sizes;
use grainfall::{Mode, Particle, ParticleId, Time, Vector, WallId};

/// Restitution of the floor, and impact speed at the first bounce, at t = 1.
const FLOOR: f64 = 0.4;

/// A ball at rest half a diameter above a floor.
fn ball<P: StatePolicy<2>>(
    elastic_speed: f64,
    policy: P,
    guards: Guards,
) -> Simulation<impl Model<2>, 2> {
    let model = heavy(
        rule(elastic_speed),
        policy,
        [Side::Open, Side::floor(0.0, FLOOR)],
    );
    let grain = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::zeros());
    let settings = Settings {
        guards,
        ..Settings::default()
    };
    Simulation::with_settings(model, vec![grain], settings).unwrap()
}

/// t* − 1 = 2 α V₀ / ((1 − α) g), here with V₀ = 1.
fn stopping_time() -> f64 {
    2.0 * FLOOR / (1.0 - FLOOR)
}

#[test]
fn bounces_come_when_they_should() {
    let mut simulation = ball(0.0, Never, Guards::none());
    let (why, events) = watch(&mut simulation, &Limits::events(30));
    assert_eq!(why, StopReason::Events);
    let mut speed = 1.0;
    for event in &events {
        assert_eq!(event.kind, OccurrenceKind::Wall);
        assert_eq!(event.wall, Some(WallId(0)));
        let wanted = 1.0 + stopping_time() * (1.0 - speed);
        close(event.time.units() / wanted, 1.0, 1.0e-13, "time of bounce");
        // Counted from the end, so that late bounces are held to it as well.
        let left = Time::from_units(1.0) + stopping_time() - event.time;
        close(left, stopping_time() * speed, 2.0e-15, "time left");
        close(event.impact_speed / speed, 1.0, 1.0e-12, "impact speed");
        speed *= FLOOR;
    }
}

#[test]
fn without_a_cut_off_bounces_collapse_at_the_stopping_time() {
    let mut simulation = ball(0.0, Never, Guards::none());
    let StopReason::Collapse(collapse) = simulation.run(&until(4.0), &mut ()) else {
        panic!("no collapse")
    };
    close(
        collapse.time.units(),
        1.0 + stopping_time(),
        1.0e-11,
        "time of collapse",
    );
    assert_eq!(collapse.particles, [ParticleId(0)]);
    assert_eq!(collapse.collisions, 100_000);
    // And it stays collapsed.
    let again = simulation.run(&until(5.0), &mut ());
    assert_eq!(again, StopReason::Collapse(collapse));
}

#[test]
fn with_a_cut_off_it_bounces_for_ever() {
    let mut simulation = ball(0.005, Never, Guards::default());
    let (why, events) = watch(&mut simulation, &until(4.0));
    assert_eq!(why, StopReason::Time);
    // Impact speeds 1, 0.4, …, 0.01024 lose energy; 0.4⁶ = 0.004096 does not.
    let last_speed = 0.004096;
    let regular = 2.327872;
    for (n, event) in events.iter().enumerate() {
        assert_eq!(event.elastic, n >= 6, "bounce {n}");
        if n >= 6 {
            let wanted = regular + 2.0 * last_speed * (n - 6) as f64;
            close(
                event.time.units(),
                wanted,
                1.0e-12,
                "time of elastic bounce",
            );
            close(event.impact_speed, last_speed, 1.0e-13, "impact speed");
        }
    }
    let elastic = ((4.0 - regular) / (2.0 * last_speed)) as u64 + 1;
    assert_eq!(simulation.counts().elastic, elastic);
    assert_eq!(simulation.counts().wall, elastic + 6);
    assert_eq!(simulation.counts().guard, 0);
}

#[test]
fn below_the_threshold_it_sleeps_half_way() {
    let policy = SlowDescent {
        sleep_speed: 0.01,
        wall_supports: true,
        ..SlowDescent::default()
    };
    let mut simulation = ball(0.0, policy, Guards::default());
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    let wanted = [1.0, 1.8, 2.12, 2.248, 2.2992, 2.31968, 2.327872, 2.3295104];
    assert_eq!(events.len(), wanted.len());
    for (event, time) in events.iter().zip(wanted) {
        close(event.time.units() / time, 1.0, 1.0e-13, "time");
    }
    assert_eq!(events[7].kind, OccurrenceKind::Sleep);
    let height = simulation.particle(ParticleId(0)).position[1] - 0.5;
    // The top of a flight that starts with 0.4 · 0.004096.
    close(height, 0.5 * 0.0016384 * 0.0016384, 1.0e-15, "height");
    close(height, 1.342177e-6, 1.0e-12, "height as the table has it");
    assert_eq!(simulation.particle(ParticleId(0)).mode, Mode::Frozen);
}

/// Two grains on the x axis towards each other: gap, masses, diameters,
/// velocities and restitution.
struct HeadOn {
    gap: f64,
    masses: [f64; 2],
    diameters: [f64; 2],
    speeds: [f64; 2],
    restitution: f64,
}

impl HeadOn {
    /// Lets them meet in a box periodic with 20 d; the left one starts at
    /// `x`. Gravity is across or absent.
    fn check<Y: Dynamics<3, Flight: grainfall::model::PolynomialFlight<3>> + Clone>(
        &self,
        x: f64,
        dynamics: &Y,
    ) {
        let contact = 0.5 * (self.diameters[0] + self.diameters[1]);
        let places = [x, x + contact + self.gap];
        let grains = (0..2)
            .map(|i| {
                Particle::new(
                    Vector::<3>::new(places[i], 7.0, 3.0),
                    Vector::<3>::new(self.speeds[i], 0.25, 0.0),
                )
                .with_diameter(self.diameters[i])
                .with_mass(self.masses[i])
            })
            .collect();
        let model = Parts {
            dynamics: dynamics.clone(),
            predictor: Polynomial,
            collision_rule: Restitution::constant(self.restitution),
            state_policy: Never,
            boundary: Cuboid::new([Side::periodic(20.0), Side::periodic(20.0), Side::Open])
                .unwrap(),
        };
        let mut simulation = Simulation::new(model, grains).unwrap();
        let closing = self.speeds[0] - self.speeds[1];
        let time = self.gap / closing;
        let (_, events) = watch(&mut simulation, &until(1.5 * time));
        // A plastic collision leaves them touching, and rounding may have them
        // meet once more.
        let again = usize::from(self.restitution == 0.0);
        assert!(!events.is_empty() && events.len() <= 1 + again);
        for event in &events[1..] {
            assert!(event.impact_speed < 1.0e-15 * closing);
        }
        let event = &events[0];
        assert_eq!(event.kind, OccurrenceKind::Pair);
        assert_eq!((event.particle.0, event.other.unwrap().0), (0, 1));
        close(event.time.units() / time, 1.0, 1.0e-14, "time");
        close(event.impact_speed / closing, 1.0, 1.0e-14, "closing speed");

        let [m0, m1] = self.masses;
        let impulse = -(1.0 + self.restitution) * closing * m0 * m1 / (m0 + m1);
        let after = [self.speeds[0] + impulse / m0, self.speeds[1] - impulse / m1];
        let fallen = simulation.model().dynamics().gravity(Time::ZERO)[2] * time;
        let scale = (m0 * closing).abs();
        close(event.impulse[0], impulse, 1.0e-14 * scale, "impulse");
        for (found, wanted) in [event.velocity, event.other_velocity].iter().zip(after) {
            let wanted = Vector::<3>::new(wanted, 0.25, fallen);
            let off = (found - wanted).norm();
            assert!(off < 1.0e-14 * closing.abs(), "velocity off by {off:e}");
        }
    }
}

#[test]
fn head_on_pairs() {
    for restitution in [0.0, 0.3, 0.7, 1.0] {
        for (masses, diameters) in [
            ([1.0, 1.0], [1.0, 1.0]),
            ([1.0, 8.0], [1.0, 2.0]),
            ([3.0, 0.02], [0.5, 1.75]),
        ] {
            for speeds in [[1.0, -1.0], [2.5, 0.0], [-0.25, -1.5]] {
                let pair = HeadOn {
                    gap: 1.5,
                    masses,
                    diameters,
                    speeds,
                    restitution,
                };
                // In the middle of the box; the face between their surfaces; it
                // cuts the first, the second; and the second just short of it.
                for x in [5.0, 18.5, 19.9, 17.5, 0.0] {
                    pair.check(x, &ForceFree);
                    pair.check(x, &UniformGravity::<3>::down());
                }
            }
        }
    }
}

#[test]
fn a_falling_grain_turns_normal_at_its_first_collision() {
    let bed = Particle::fixed(Vector::<2>::zeros());
    let drop = Particle::new(Vector::<2>::new(0.0, 3.0), Vector::<2>::new(0.0, -2.5))
        .with_mode(Mode::Falling);
    let model = heavy(rule(0.0), Never, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, vec![bed, drop]).unwrap();

    // No gravity on the way down: 2 d at 2.5.
    simulation.run(&until(0.5), &mut ());
    let grain = simulation.particle(ParticleId(1));
    close(grain.position[1], 3.0 - 1.25, 1.0e-15, "height");
    assert_eq!(grain.mode, Mode::Falling);
    let (_, events) = watch(&mut simulation, &until(3.0));
    close(events[0].time.units(), 0.8, 1.0e-15, "first contact");
    assert_eq!(simulation.particle(ParticleId(1)).mode, Mode::Normal);
    // Up with 0.4 · 2.5 = 1 and down again under gravity.
    close(events[1].time.units(), 2.8, 1.0e-14, "second contact");
    close(events[1].impact_speed, 1.0, 1.0e-14, "speed");
    assert_eq!(simulation.mode_counts().falling, 0);
}

#[test]
fn a_falling_grain_turns_normal_when_hit_by_another_or_by_a_wall() {
    let fall = |x: f64, y: f64| {
        Particle::new(Vector::<2>::new(x, y), Vector::<2>::new(0.0, -1.0)).with_mode(Mode::Falling)
    };
    let rise = Particle::new(Vector::<2>::new(0.0, 2.0), Vector::<2>::new(0.0, 3.0));
    let model = heavy(rule(0.0), Never, [Side::Open, Side::floor(0.0, 0.5)]);
    let grains = vec![fall(0.0, 5.0), rise, fall(3.0, 1.5), fall(3.0, 4.0)];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(1.2));
    // 5 − t − (2 + 3 t − t²/2) = 1: two roots of t²/2 − 4 t + 2, the first.
    close(
        events[0].time.units(),
        4.0 - f64::sqrt(12.0),
        1.0e-14,
        "in flight",
    );
    close(events[1].time.units(), 1.0, 1.0e-14, "at the wall");
    let modes: Vec<Mode> = simulation
        .snapshot()
        .iter()
        .map(|grain| grain.mode)
        .collect();
    let wanted = [Mode::Normal, Mode::Normal, Mode::Normal, Mode::Falling];
    assert_eq!(modes, wanted);
    // Exchanged: equal masses, α = 0.7.
    let meeting = events[0].time.units();
    let (down, up) = (-1.0, 3.0 - meeting);
    close(
        events[0].velocity[1],
        down + 0.85 * (up - down),
        1.0e-14,
        "the upper one",
    );
}

#[test]
fn a_fixed_grain_carried_along_pushes_at_the_right_time() {
    // Without gravity: w = 2, gap 1.5, so at t = 0.75; it leaves with (1 + α) w.
    let carried = Particle {
        velocity: Vector::<2>::new(2.0, 0.0),
        ..Particle::fixed(Vector::<2>::new(1.0, 5.0))
    };
    let rest = Particle::new(Vector::<2>::new(3.5, 5.0), Vector::zeros());
    let model = free(Restitution::constant(0.4), [Side::periodic(10.0); 2]);
    let mut simulation = Simulation::new(model, vec![rest, carried]).unwrap();
    let (_, events) = watch(&mut simulation, &until(20.0));
    close(events[0].time.units(), 0.75, 1.0e-15, "time");
    assert_eq!(events[0].kind, OccurrenceKind::Frozen);
    close(events[0].velocity[0], 2.8, 1.0e-15, "speed");
    close(
        simulation.particle(ParticleId(1)).velocity[0],
        2.0,
        0.0,
        "the fixed one's",
    );
    // It gains 0.8 a unit of time and so meets it again across the face, after
    // 8 d; then it is pushed back: 2 + 0.4 · (−0.8).
    close(events[1].time.units(), 0.75 + 8.0 / 0.8, 1.0e-13, "again");
    close(events[1].velocity[0], 1.68, 1.0e-14, "speed");
}

/// Gravity for all but fixed grains, which are lifted with an acceleration of
/// their own from rest.
#[derive(Clone)]
struct Lift {
    acceleration: f64,
}

impl Dynamics<2> for Lift {
    type Flight = Parabola<2>;

    fn flight(&self, motion: &Motion<2>, since: Time) -> Parabola<2> {
        let upward = match motion.mode {
            Mode::Fixed => self.acceleration,
            _ => -1.0,
        };
        let mut flight = Parabola {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: Vector::<2>::new(0.0, upward),
        };
        if motion.mode == Mode::Fixed {
            flight.velocity[1] = self.acceleration * since.units();
        }
        flight
    }

    fn gravity(&self, _time: Time) -> Vector<2> {
        Vector::<2>::new(0.0, -1.0)
    }
}

#[test]
fn a_fixed_grain_on_a_prescribed_path_pushes_at_the_right_time() {
    let model = Parts {
        dynamics: Lift { acceleration: 3.0 },
        predictor: Polynomial,
        collision_rule: Restitution::constant(0.5),
        state_policy: Never,
        boundary: Cuboid::open(),
    };
    // From 9 to 1 above: the gap of 8 closes as (3 + 1) t²/2, so at t = 2,
    // where the one goes up at 6 and the other down at 2.
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 9.0), Vector::zeros()),
    ];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(2.5));
    assert_eq!(events.len(), 1);
    close(events[0].time.units(), 2.0, 1.0e-15, "time");
    close(events[0].impact_speed, 8.0, 1.0e-14, "closing speed");
    close(events[0].velocity[1], 6.0 + 4.0, 1.0e-14, "speed");
    let piston = simulation.particle(ParticleId(0));
    close(piston.position[1], 1.5 * 6.25, 1.0e-14, "the path");
    // Next: the gap opens at 4 and closes as 4 t²/2, so 2 later.
    let (_, events) = watch(&mut simulation, &until(4.5));
    close(events[0].time.units(), 4.0, 1.0e-14, "time");
}

#[test]
fn growing_grains_touch_and_part_at_the_right_speed() {
    // σ = 1 and 2 at t = 0 grow by a quarter of that a unit of time.
    let model = Parts {
        dynamics: Growing::new(ForceFree, 0.25),
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Never,
        boundary: Cuboid::new([Side::floor(0.0, 1.0), Side::Open, Side::Open]).unwrap(),
    };
    let grains = vec![
        Particle::new(Vector::<3>::new(10.0, 0.0, 0.0), Vector::<3>::x() * 0.5),
        Particle::new(Vector::<3>::new(14.0, 0.0, 0.0), Vector::zeros())
            .with_diameter(2.0)
            .with_mass(8.0),
        Particle::new(Vector::<3>::new(1.5, 9.0, 0.0), Vector::zeros()),
    ];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(9.0));
    // 4 − t/2 = 1.5 (1 + t/4): t = 20/7, closing at 1/2 + 3/8.
    let closing = 0.875;
    close(events[0].time.units(), 20.0 / 7.0, 1.0e-14, "time");
    close(events[0].impact_speed, closing, 1.0e-14, "closing speed");
    let given = 2.0 * closing / 9.0;
    close(
        events[0].velocity[0],
        0.5 - 8.0 * given,
        1.0e-14,
        "the small",
    );
    close(events[0].other_velocity[0], given, 1.0e-14, "the large");
    let parting = events[0].other_velocity[0] - events[0].velocity[0];
    close(
        parting - 0.375,
        closing,
        1.0e-14,
        "the gap opens as it closed",
    );
    // A radius of 0.5 (1 + t/4) reaches the wall at 1.5 when t = 8, and the grain
    // leaves twice as fast as its surface came.
    assert_eq!(events.last().unwrap().kind, OccurrenceKind::Wall);
    let wall: Vec<_> = events.iter().filter(|e| e.particle.0 == 2).collect();
    close(wall[0].time.units(), 8.0, 1.0e-14, "at the wall");
    close(wall[0].velocity[0], 0.25, 1.0e-15, "off the wall");
    let grown = simulation.particle(ParticleId(1)).diameter;
    close(grown, 2.0 * (1.0 + 9.0 / 4.0), 1.0e-14, "diameter");
}

#[test]
fn transfer_is_distance_times_momentum() {
    // Diameters 1 and 2, masses 1 and 8, elastic: 1.5 times 2 · 8/9 · 2.5.
    let grains = vec![
        Particle::new(Vector::<3>::new(19.5, 7.0, 3.0), Vector::<3>::x() * 2.0),
        Particle::new(Vector::<3>::new(2.0, 7.0, 3.0), Vector::<3>::x() * -0.5)
            .with_diameter(2.0)
            .with_mass(8.0),
    ];
    let energy: f64 = grains.iter().map(Particle::kinetic_energy).sum();
    let model = free(Restitution::elastic(), [Side::periodic(20.0); 3]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let mut transfer = CollisionalTransfer::new(Time::ZERO);
    simulation.run(&until(2.0), &mut transfer);
    assert_eq!(transfer.collisions(), 1);
    let virial = 1.5 * 2.0 * 8.0 / 9.0 * 2.5;
    close(transfer.virial(), virial, 1.0e-14, "virial");
    let pressure = (2.0 * energy + 0.5 * virial) / (3.0 * 8000.0);
    let found = transfer.pressure::<3>(simulation.time(), energy, 8000.0);
    close(found / pressure, 1.0, 1.0e-14, "pressure");
}

#[test]
fn displacements_go_on_through_periodic_faces() {
    let grains = vec![
        Particle::new(Vector::<2>::new(1.0, 7.0), Vector::<2>::new(3.0, -1.0)),
        Particle::new(Vector::<2>::new(1.0, 3.0), Vector::<2>::new(-2.0, 0.0)),
    ];
    let model = heavy(
        rule(0.0),
        Never,
        [Side::periodic(5.0), Side::floor(0.0, 0.8)],
    );
    let mut simulation = Simulation::new(model, grains.clone()).unwrap();
    let mut displacements = Displacements::new(Time::ZERO, &grains);
    simulation.run(&until(1.0), &mut displacements);
    // Nothing but gravity so far.
    let found = displacements.at(simulation.time(), &simulation.snapshot());
    let wanted = [Vector::<2>::new(3.0, -1.5), Vector::<2>::new(-2.0, -0.5)];
    for (found, wanted) in found.iter().zip(&wanted) {
        close((found - wanted).norm(), 0.0, 1.0e-14, "free fall");
    }
}

#[test]
fn displacements_lead_from_start_to_end_whatever_happens() {
    // Falling grains, hits, sleep and wake.
    let width = 5.0;
    let grains = rain_on_base::<3>(3, 60, width, Sizes::default());
    let policy = SlowDescent::default();
    let model = heavy(rule(1.0e-3), policy, periodic_laterally(width));
    let settings = Settings {
        guards: Guards::none(),
        ..Settings::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, settings).unwrap();
    let start = simulation.snapshot();
    let mut displacements = Displacements::new(simulation.time(), &start);
    simulation.run(&until(12.0), &mut displacements);
    assert!(simulation.counts().sleep > 20 && simulation.counts().wake > 0);
    let end = simulation.snapshot();
    let found = displacements.at(simulation.time(), &end);
    let mut crossed = 0;
    for ((from, to), found) in start.iter().zip(&end).zip(&found) {
        let direct = to.position - from.position;
        close(found[2], direct[2], 1.0e-9, "height");
        for axis in 0..2 {
            let periods = (found[axis] - direct[axis]) / width;
            close(periods, periods.round(), 1.0e-9, "whole periods");
            crossed += usize::from(periods.round() != 0.0);
        }
    }
    assert!(crossed > 0, "nothing has crossed a face");
}
