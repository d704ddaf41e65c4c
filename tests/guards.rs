//! Guards against endless cascades, and how a run without them ends.

mod common;

use common::{deposition, gas, hash, heavy, rain_on_base, rule, until};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::TurningGround;
use grainfall::engine::{Counts, Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Dynamics, Model, Parts, StatePolicy};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Turning;
use grainfall::setup::Sizes;
use grainfall::{Particle, ParticleId, SetupError, Time, Vector};

fn with(guards: Guards) -> Settings {
    Settings {
        guards,
        ..Settings::default()
    }
}

/// A grain, 2, that drops 0.1 d into the notch between two fixed ones, 0 and 1,
/// at ± `half`, so far `off` the middle, with a constant restitution: bounces
/// without end in a finite time. 3 is fixed, near, and out of it.
fn notch(half: f64, off: f64, guards: Guards) -> Simulation<impl Model<2>, 2> {
    let bottom = f64::sqrt(1.0 - half * half);
    let grains = vec![
        Particle::fixed(Vector::<2>::new(-half, 0.0)),
        Particle::fixed(Vector::<2>::new(half, 0.0)),
        Particle::new(Vector::<2>::new(off, bottom + 0.1), Vector::zeros()),
        Particle::fixed(Vector::<2>::new(1.3, 1.1)),
    ];
    let model = heavy(rule(0.0), Never, [Side::Open; 2]);
    Simulation::with_settings(model, grains, with(guards)).unwrap()
}

#[test]
fn without_guards_a_grain_in_a_notch_collapses_and_is_named() {
    let limit = 5000;
    let guards = Guards {
        collapse: Some(limit),
        ..Guards::none()
    };
    // In a steep notch it is thrown from one to the other; in a flat one it comes
    // to an end on one of them, sliding.
    for (half, wanted) in [(0.97, vec![0, 1]), (0.6, vec![0])] {
        let mut simulation = notch(half, 0.01, guards);
        let StopReason::Collapse(collapse) = simulation.run(&until(20.0), &mut ()) else {
            panic!("no collapse")
        };
        assert_eq!(collapse.particles[0], ParticleId(2), "who collides");
        let mut touched: Vec<u32> = collapse.particles[1..].iter().map(|id| id.0).collect();
        touched.sort_unstable();
        assert_eq!(touched, wanted, "whom it touches");
        assert_eq!(collapse.collisions, u64::from(limit));
        assert_eq!(collapse.time, simulation.time());
        assert!(simulation.time() < Time::from_units(5.0));
        assert_eq!(simulation.counts().guard, 0);
        // There is no gap left, and next to no speed along the normal.
        let there = simulation.particle(ParticleId(2));
        for other in wanted {
            let apart = there.position - simulation.particle(ParticleId(other)).position;
            assert!((apart.norm() - 1.0).abs() < 1.0e-12);
            // Surfaces that part by less than 1e-12 d at unit gravity.
            assert!(apart.dot(&there.velocity).abs() < 1.0e-6);
        }

        // Not looked for, it goes on for as long as it is let.
        let blind = Guards {
            collapse: None,
            ..Guards::none()
        };
        let more = Limits::events(2 * simulation.counts().total());
        let why = notch(half, 0.01, blind).run(&more, &mut ());
        assert_eq!(why, StopReason::Events);
    }
}

#[test]
fn with_guards_it_goes_on() {
    for guards in [Guards::default(), Guards::floor_and_hold(1.0e-5, 1.0e-9)] {
        let mut simulation = notch(0.97, 0.01, guards);
        let collapsed = 2.5;
        let limits = Limits {
            events: 200_000,
            ..until(collapsed)
        };
        let why = simulation.run(&limits, &mut ());
        assert!(matches!(why, StopReason::Time | StopReason::Events));
        assert!(simulation.counts().guard > 10);
        let overlap = simulation.max_overlap();
        assert!(overlap < 1.0e-9, "overlap {overlap:e} with {guards:?}");
        let there = simulation.particle(ParticleId(2));
        assert!(
            (there.position - Vector::<2>::new(0.0, f64::sqrt(1.0 - 0.97 * 0.97))).norm() < 1.0e-6
        );
        assert!(there.velocity.norm() < 1.0e-3);
    }
}

/// The hash of a run with and without guards, none of which acts in it.
fn is_untouched<M: Model<D>, const D: usize>(
    name: &str,
    limits: Limits,
    make: impl Fn(Guards) -> Simulation<M, D>,
) {
    let mut guarded = make(Guards::default());
    let one = hash(&mut guarded, &limits);
    assert_eq!(guarded.counts().guard, 0, "{name} is to need no guard");
    assert!(guarded.counts().total() > 1000);
    let two = hash(&mut make(Guards::none()), &limits);
    assert_eq!(one, two, "{name}");
}

#[test]
fn guards_that_do_not_act_leave_no_trace() {
    is_untouched("a rain's first contacts", Limits::events(1200), |guards| {
        let grains = rain_on_base::<3>(1, 60, 4.0, Sizes::default());
        let sides = common::periodic_laterally(4.0);
        let model = heavy(rule(1.0e-3), SlowDescent::default(), sides);
        Simulation::with_settings(model, grains, with(guards)).unwrap()
    });
    is_untouched("a gas", Limits::events(5000), |guards| {
        let made = gas::<2>(3, 100, 0.5, Restitution::constant(0.95));
        let (model, grains) = (made.model().clone(), made.snapshot());
        Simulation::with_settings(model, grains, with(guards)).unwrap()
    });
}

#[test]
fn in_a_heap_overlaps_stay_at_rounding() {
    let mut simulation = deposition::<2>(5, 80, 12.0, Sizes::default());
    let why = simulation.run(&Limits::all_frozen(), &mut ());
    assert_eq!(why, StopReason::AllFrozen);
    assert!(simulation.counts().guard > 0);
    assert!(simulation.max_overlap() < 1.0e-9);
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = Guards::default();
    for (guards, wanted) in [
        (
            Guards {
                cascade: Some(0),
                ..good
            },
            "guards.cascade",
        ),
        (
            Guards {
                collapse: Some(0),
                ..good
            },
            "guards.collapse",
        ),
        (
            Guards {
                exit_speed: -1.0,
                ..good
            },
            "guards.exit_speed",
        ),
        (
            Guards {
                floor_speed: f64::NAN,
                ..good
            },
            "guards.floor_speed",
        ),
        (
            Guards {
                hold: f64::INFINITY,
                ..good
            },
            "guards.hold",
        ),
    ] {
        let model = heavy(rule(0.0), Never, [Side::Open; 2]);
        let refused = Simulation::with_settings(model, vec![], with(guards));
        let Err(SetupError::Parameter { field, .. }) = refused.map(|_| ()) else {
            panic!("{wanted} was let through")
        };
        assert_eq!(field, wanted);
    }
}

/// How many collisions a grain makes between three that all but touch it and are
/// carried along, before it is put to sleep.
fn collisions_in_a_cage(rate: f64) -> u64 {
    let middle = Vector::<2>::new(3.0, 0.0);
    let down = Vector::<2>::new(0.0, -1.0);
    let ground = TurningGround::new(down, rate, [0, 1], Vector::<2>::zeros());
    let carried = ground.ground_velocity(&middle, Time::ZERO);
    let mut grains = vec![Particle::new(
        middle,
        carried + Vector::<2>::new(3.0e-5, 2.0e-5),
    )];
    for bar in 0..3 {
        let (sin, cos) = libm::sincos(0.3 + f64::from(bar) * 2.0 * core::f64::consts::PI / 3.0);
        let place = middle + Vector::<2>::new(cos, sin) * (1.0 + 1.0e-13);
        grains.push(Particle::fixed(place));
    }
    let model = Parts {
        dynamics: ground,
        predictor: Turning,
        collision_rule: rule(1.0e-4),
        state_policy: SlowDescent::default(),
        boundary: Cuboid::new([Side::Open; 2]).unwrap(),
    };
    let mut simulation = Simulation::new(model, grains).unwrap();
    let limits = Limits {
        all_frozen: true,
        ..Limits::events(20_000)
    };
    assert_eq!(simulation.run(&limits, &mut ()), StopReason::AllFrozen);
    simulation.counts().frozen
}

#[test]
fn a_cage_that_is_carried_along_catches_as_one_at_rest_does() {
    let (at_rest, carried) = (collisions_in_a_cage(1.0e-9), collisions_in_a_cage(0.5));
    println!("{at_rest} collisions in a cage at rest, {carried} in one that turns");
    assert!(at_rest < 100);
    assert_eq!(at_rest, carried);
}

/// A grain that leans on 1 and 2, between which it could slide down if it did not
/// wedge itself against 3 by 10⁻³ of a degree; as found in a deposit of 10⁶. To hold it
/// these would have to press with 10⁴ times its weight.
#[test]
fn a_grain_in_a_narrow_wedge_is_caught() {
    let grains = vec![
        Particle::new(
            Vector::<3>::zeros(),
            Vector::<3>::new(
                -0.0005884462141699399,
                -6.15865897897847e-5,
                0.0008073344332827398,
            ),
        ),
        Particle::fixed(Vector::<3>::new(
            -0.31358747310817137,
            0.9364672365993485,
            -0.1571369195583152,
        )),
        Particle::fixed(Vector::<3>::new(
            -0.46612258807391527,
            -0.7891559764207017,
            -0.3999532194707509,
        )),
        Particle::fixed(Vector::<3>::new(
            0.6145638083374791,
            -0.6823413797729643,
            0.3958807483783211,
        )),
    ];
    let model = heavy(rule(1.0e-3), SlowDescent::default(), [Side::Open; 3]);
    let guards = Guards {
        exit_speed: 1.0e-4,
        ..Guards::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, with(guards)).unwrap();
    let limits = Limits {
        all_frozen: true,
        ..Limits::events(200_000)
    };
    assert_eq!(simulation.run(&limits, &mut ()), StopReason::AllFrozen);
    assert!(simulation.max_overlap() < 1.0e-11);
}

/// A grain that has slid into the end of a groove whose three sides are planes of one
/// line to 10⁻⁵, and would have to press with 10⁴ times its momentum to stop there; as
/// found in a deposit of 10⁶.
#[test]
fn a_grain_in_a_narrow_groove_slides_out_again() {
    let grains = vec![
        Particle::new(
            Vector::<3>::zeros(),
            Vector::<3>::new(
                -0.07310474661300562,
                0.13297454901063793,
                0.03423281841334729,
            ),
        ),
        Particle::fixed(Vector::<3>::new(
            -0.640361889291782,
            -0.1573289681812362,
            -0.7517873678864824,
        )),
        Particle::fixed(Vector::<3>::new(
            0.8819046544988964,
            0.4600206473080206,
            0.10307853522188637,
        )),
        Particle::fixed(Vector::<3>::new(
            -0.40101730546280123,
            -0.43222774401996844,
            0.8076907192847784,
        )),
    ];
    let model = heavy(rule(1.0e-3), Never, [Side::Open; 3]);
    let guards = Guards {
        exit_speed: 1.0e-4,
        ..Guards::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, with(guards)).unwrap();
    let until = Limits::until(Time::from_units(1.0));
    assert_eq!(simulation.run(&until, &mut ()), StopReason::Time);
    assert!(simulation.particle(ParticleId(0)).position.norm() > 0.1);
    assert!(simulation.max_overlap() < 1.0e-11);
}

/// Three static grains around a fourth that comes from above with this velocity: the
/// sides of the groove that they make open by 10⁻⁷, too little for any projection.
fn in_a_shut_groove<P: StatePolicy<3>>(policy: P, guards: Guards) -> (StopReason, Counts) {
    let mut grains = vec![Particle::new(
        Vector::<3>::zeros(),
        Vector::<3>::new(0.0, 0.0, -0.1),
    )];
    grains.extend((0..3).map(|third| {
        let angle = 2.0 * core::f64::consts::PI / 3.0 * f64::from(third);
        let (sine, cosine) = libm::sincos(angle);
        Particle::fixed(Vector::<3>::new(cosine, sine, -1.0e-7).normalize())
    }));
    let model = heavy(rule(1.0e-3), policy, [Side::Open; 3]);
    let mut simulation = Simulation::with_settings(model, grains, with(guards)).unwrap();
    let limits = Limits {
        all_frozen: true,
        ..Limits::events(5000)
    };
    let stop = simulation.run(&limits, &mut ());
    (stop, *simulation.counts())
}

#[test]
fn a_cascade_on_static_grains_without_remedy_ends_in_sleep() {
    let guards = Guards {
        cascade: Some(1),
        collapse: Some(1000),
        ..Guards::default()
    };
    let (stop, counts) = in_a_shut_groove(SlowDescent::default(), guards);
    assert_eq!((stop, counts.frozen), (StopReason::AllFrozen, 500));
    // It collapses all the same where nobody sleeps, or the guard has no way to help.
    let (stop, _) = in_a_shut_groove(Never, guards);
    assert!(matches!(stop, StopReason::Collapse(_)), "{stop:?}");
    for (cascade, exit_speed) in [(None, 1.0e-5), (Some(1), 0.0), (Some(5), 1.0e-5)] {
        let guards = Guards {
            cascade,
            exit_speed,
            ..guards
        };
        let (stop, _) = in_a_shut_groove(SlowDescent::default(), guards);
        assert!(matches!(stop, StopReason::Collapse(_)), "{stop:?}");
    }
}
