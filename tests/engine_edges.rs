//! Corners of the engine: grains at rest, newcomers, narrow boxes, odd input.

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::ForceFree;
use grainfall::engine::{Limits, Settings, Simulation, StopReason};
use grainfall::model::{
    Dynamics, Flight, Model, Motion, Observer, Occurrence, Parts, Surroundings,
};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, Time, Vector};

fn elastic<Y, const D: usize>(
    dynamics: Y,
    boundary: Cuboid<D>,
) -> Parts<Y, Polynomial, Restitution, Never, Cuboid<D>> {
    Parts {
        dynamics,
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Never,
        boundary,
    }
}

fn contacts_up_to<M: Model<D>, const D: usize>(
    simulation: &mut Simulation<M, D>,
    time: f64,
) -> Vec<f64> {
    let mut times = Vec::new();
    simulation.run(
        &Limits::until(Time::from_units(time)),
        &mut |occurrence: &Occurrence<D>| times.push(occurrence.time.units()),
    );
    times
}

/// A normal grain at rest has to find a fixed one that comes along, whoever of
/// the two is predicted first.
#[test]
fn a_moving_fixed_grain_hits_one_at_rest() {
    let pusher = Particle::new(Vector::<3>::zeros(), Vector::<3>::new(1.0, 0.0, 0.0));
    let grains = vec![
        pusher.with_mode(Mode::Fixed),
        Particle::new(Vector::<3>::new(1.05, 0.0, 0.0), Vector::<3>::zeros()),
    ];
    let model = elastic(ForceFree, Cuboid::open());
    let mut simulation = Simulation::new(model, grains).unwrap();
    let times = contacts_up_to(&mut simulation, 0.5);
    assert_eq!(times.len(), 1);
    assert!((times[0] - 0.05).abs() < 1.0e-12);
    assert!(simulation.max_overlap() < 1.0e-12);
}

/// Those that fly already have to hear of a grain inserted at rest.
#[test]
fn a_static_newcomer_is_noticed() {
    for mode in [Mode::Fixed, Mode::Frozen, Mode::Normal] {
        let flyer = Particle::new(Vector::<3>::zeros(), Vector::<3>::new(1.0, 0.0, 0.0));
        let model = elastic(ForceFree, Cuboid::open());
        let mut simulation = Simulation::new(model, vec![flyer]).unwrap();
        simulation.run(&Limits::until(Time::from_units(0.1)), &mut ());
        let newcomer = Particle::new(Vector::<3>::new(1.2, 0.0, 0.0), Vector::<3>::zeros());
        simulation.insert(newcomer.with_mode(mode)).unwrap();
        let times = contacts_up_to(&mut simulation, 0.5);
        assert_eq!(times.len(), 1, "{mode:?}");
        assert!((times[0] - 0.2).abs() < 1.0e-12);
    }
}

/// A fixed grain with a prescribed path is not at rest because its stored
/// velocity is zero.
#[test]
fn a_prescribed_path_is_followed() {
    #[derive(Clone, Copy)]
    struct Lift;
    impl Dynamics<2> for Lift {
        type Flight = grainfall::dynamics::Straight<2>;

        fn flight(&self, motion: &Motion<2>, since: Time) -> Self::Flight {
            let mut velocity = motion.velocity;
            if motion.mode == Mode::Fixed {
                velocity.y = 3.0;
            }
            ForceFree.flight(
                &Motion {
                    velocity,
                    ..*motion
                },
                since,
            )
        }

        fn gravity(&self, _time: Time) -> Vector<2> {
            Vector::<2>::zeros()
        }
    }
    // The second flies towards a third that is near; meanwhile the first, which
    // seems far and at rest, comes up from below.
    let at = |x: f64, y: f64, speed: f64| {
        Particle::new(Vector::<2>::new(x, y), Vector::<2>::new(speed, 0.0))
    };
    let grains = vec![
        at(0.0, -1.35, 0.0).with_mode(Mode::Fixed),
        at(0.0, 0.0, 0.1),
        at(1.02, 0.0, 0.0),
    ];
    let mut simulation = Simulation::new(elastic(Lift, Cuboid::open()), grains).unwrap();
    let times = contacts_up_to(&mut simulation, 0.15);
    assert_eq!(times.len(), 1);
    assert!((times[0] - 0.1167).abs() < 1.0e-3, "{times:?}");
    assert!(
        Lift.flight(
            &Motion {
                id: grainfall::ParticleId(0),
                position: Vector::<2>::zeros(),
                velocity: Vector::<2>::zeros(),
                mode: Mode::Normal,
            },
            Time::ZERO
        )
        .is_at_rest()
    );
}

/// In a narrow box every neighbour is shown once, in its nearest image.
#[test]
fn a_neighbour_is_shown_once() {
    struct Count(Vec<usize>);
    impl Observer<2> for Count {
        fn observe<S: Surroundings<2>>(&mut self, occurrence: &Occurrence<2>, after: &S) {
            let mut seen = 0;
            after.for_each_neighbour(occurrence.particle, 1.3, |neighbour| {
                seen += 1;
                assert!(neighbour.offset.norm() <= 1.3);
            });
            self.0.push(seen);
        }
    }
    let side = Side::periodic(2.2);
    let grains = vec![
        Particle::new(Vector::<2>::new(0.1, 0.1), Vector::<2>::new(1.0, 0.1)),
        Particle::new(Vector::<2>::new(1.2, 0.2), Vector::<2>::zeros()),
    ];
    let boundary = Cuboid::new([side, side]).unwrap();
    let mut simulation = Simulation::new(elastic(ForceFree, boundary), grains).unwrap();
    let mut count = Count(Vec::new());
    assert_eq!(
        simulation.run(&Limits::events(20), &mut count),
        StopReason::Events
    );
    assert_eq!(count.0, vec![1; 20]);
}

/// Grains that grow towards each other at rest meet although nothing happens
/// before, and the clock never goes back for a new grid.
#[test]
fn grains_at_rest_grow_until_they_touch() {
    let grains = vec![
        Particle::new(Vector::<2>::new(0.0, 0.0), Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(3.0, 0.0), Vector::<2>::zeros()),
    ];
    let dynamics = grainfall::dynamics::Growing::new(ForceFree, 1.0);
    let mut simulation = Simulation::new(elastic(dynamics, Cuboid::open()), grains).unwrap();
    simulation.run(&Limits::until(Time::from_units(1.0)), &mut ());
    let mut last = Time::from_units(1.0);
    for _ in 0..3 {
        simulation.run(&Limits::events(1), &mut |occurrence: &Occurrence<2>| {
            assert!(occurrence.time >= last);
            last = occurrence.time;
        });
        assert!(simulation.time() >= last);
    }
    assert!((last.units() - 2.0).abs() < 1.0e-12);
}

/// At t = −2 and with γ = 1/4 diameters are half of those at t = 0: they grow from then on as
/// those that start at t = 0 with γ = 1/2.
#[test]
fn grains_that_grow_meet_at_whatever_hour_they_start() {
    let seen = |start: f64, rate: f64| {
        let dynamics = grainfall::dynamics::Growing::new(ForceFree, rate);
        let boundary = Cuboid::new([Side::periodic(6.0); 2]).unwrap();
        let grains = (0..9)
            .map(|place| {
                let at = Vector::<2>::new(f64::from(place % 3), f64::from(place / 3)) * 2.0;
                let angle = f64::from(place) * 2.4;
                Particle::new(
                    at,
                    Vector::<2>::new(libm::cos(angle), libm::sin(angle)) * 0.1,
                )
            })
            .collect();
        let settings = Settings {
            start: Time::from_units(start),
            ..Settings::default()
        };
        let mut simulation =
            Simulation::with_settings(elastic(dynamics, boundary), grains, settings).unwrap();
        let mut meetings = Vec::new();
        simulation.run(&Limits::events(12), &mut |occurrence: &Occurrence<2>| {
            let after = occurrence.time.units() - start;
            meetings.push((after, occurrence.particle, occurrence.other));
        });
        meetings
    };
    let (early, late) = (seen(-2.0, 0.25), seen(0.0, 0.5));
    assert!(early.len() > 5);
    for (one, two) in early.iter().zip(&late) {
        assert_eq!((one.1, one.2), (two.1, two.2));
        assert!((one.0 - two.0).abs() < 1.0e-9, "{} and {}", one.0, two.0);
    }
}

type Grains = Vec<Particle<3>>;

fn is_refused<M: Model<3>>(model: M, grains: Grains) -> bool {
    Simulation::new(model, grains).is_err()
}

/// Numbers with which nothing sensible, or nothing at all, would come of a run.
#[test]
fn odd_numbers_are_refused() {
    use grainfall::dynamics::{Growing, UniformGravity};
    use grainfall::policy::{SelfCheck, SlowDescent};
    let open = Cuboid::<3>::open;
    let grain = || Particle::new(Vector::<3>::zeros(), Vector::<3>::zeros());
    for odd in [f64::NAN, f64::INFINITY, -1.0, 1.0e300, 1.0e-300] {
        assert!(is_refused(
            elastic(ForceFree, open()),
            vec![grain().with_diameter(odd)]
        ));
        assert!(is_refused(
            elastic(ForceFree, open()),
            vec![grain().with_mass(odd)]
        ));
    }
    for odd in [f64::NAN, f64::INFINITY, 1.0e30] {
        let mut fast = grain();
        fast.velocity.x = odd;
        assert!(is_refused(elastic(ForceFree, open()), vec![fast]));
        let gravity = UniformGravity::new(Vector::<3>::new(odd, 0.0, 0.0));
        assert!(is_refused(elastic(gravity, open()), vec![grain()]));
    }
    for odd in [f64::NAN, -1.0] {
        assert!(is_refused(
            elastic(Growing::new(ForceFree, odd), open()),
            vec![grain()]
        ));
        for policy in [
            SlowDescent {
                sleep_speed: odd,
                ..SlowDescent::default()
            },
            SlowDescent {
                wake_speed: odd,
                ..SlowDescent::default()
            },
            SlowDescent {
                frozen_restitution: odd,
                ..SlowDescent::default()
            },
            SlowDescent {
                store_time: Some(odd),
                ..SlowDescent::default()
            },
        ] {
            assert!(is_refused(
                elastic(ForceFree, open()).with_policy(policy),
                vec![grain()]
            ));
        }
        let rule = Restitution {
            restitution: odd,
            ..Restitution::default()
        };
        assert!(is_refused(
            elastic(ForceFree, open()).with_collision_rule(rule),
            vec![grain()]
        ));
    }
    for interval in [0.0, -1.0, f64::NAN, 1.0e-30, f64::INFINITY] {
        let check = SelfCheck {
            interval,
            ..SelfCheck::default()
        };
        let policy = SlowDescent {
            self_check: Some(check),
            ..SlowDescent::default()
        };
        assert!(is_refused(
            elastic(ForceFree, open()).with_policy(policy),
            vec![grain()]
        ));
    }
}

#[test]
fn a_box_may_be_empty() {
    let boundary = Cuboid::new([Side::periodic(4.0); 3]).unwrap();
    let mut simulation = Simulation::new(elastic(ForceFree, boundary), Vec::new()).unwrap();
    assert_eq!(
        simulation.run(&Limits::default(), &mut ()),
        StopReason::NothingLeft
    );
}

/// A grain that has met nobody for a very long time grazes a fixed one: how far
/// its place now has been rounded must not hide that.
#[test]
fn a_graze_after_a_long_flight_is_noticed() {
    let edge = 16.0;
    let slope = 1.0 + libm::exp2(-20.0);
    let depth = 1.0e-12;
    for mode in [Mode::Fixed, Mode::Normal] {
        for passes in 8_192..8_196 {
            // There, exactly, the flight goes by.
            let along = edge * f64::from(passes);
            let normal = Vector::<2>::new(-slope, 1.0).normalize();
            let place =
                Vector::<2>::new(8.0, 8.0 + (along * slope) % edge) + normal * (1.0 - depth);
            let speed = libm::exp2(-10.0);
            let grains = vec![
                Particle::new(
                    Vector::<2>::new(8.0, 8.0),
                    speed * Vector::<2>::new(1.0, slope),
                ),
                Particle::new(place, Vector::zeros()).with_mode(mode),
            ];
            let side = Side::Periodic {
                origin: 0.0,
                length: edge,
            };
            let model = elastic(ForceFree, Cuboid::new([side; 2]).unwrap());
            let mut simulation = Simulation::new(model, grains).unwrap();
            let times = contacts_up_to(&mut simulation, (along + 4.0) / speed);
            assert_eq!(times.len(), 1, "after {passes}, {mode:?}");
        }
    }
}
