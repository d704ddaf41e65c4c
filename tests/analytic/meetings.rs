//! When two grains, or a grain and a wall, meet, and how fast they part.

use crate::common::{close, heavy, rule, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, Growing, UniformGravity};
use grainfall::engine::Simulation;
use grainfall::model::{Dynamics, Model, OccurrenceKind, Parts};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, ParticleId, Time, Vector};

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
