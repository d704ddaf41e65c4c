//! The self-check: who has lost a support wakes.

#[path = "../common/mod.rs"]
mod common;

mod events;
mod leaning;
mod walls;

use common::{close, heavy, rule, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::Parabola;
use grainfall::engine::Simulation;
use grainfall::model::{Dynamics, Model, Motion, Occurrence, OccurrenceKind as Kind, Parts};
use grainfall::policy::{Phase, SelfCheck, SlowDescent, Timing};
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, ParticleId, Time, Vector};

fn at(x: f64, y: f64) -> Vector<2> {
    Vector::<2>::new(x, y)
}

/// Every 1/4 from the start or from falling asleep.
fn own_clock() -> SelfCheck {
    SelfCheck {
        interval: 0.25,
        phase: Phase::Own,
        ..SelfCheck::default()
    }
}

/// Whenever a support is lost.
fn at_once() -> SelfCheck {
    SelfCheck {
        timing: Timing::Events,
        ..own_clock()
    }
}

fn with_check(check: SelfCheck) -> SlowDescent {
    SlowDescent {
        self_check: Some(check),
        ..SlowDescent::default()
    }
}

fn in_the_open(check: SelfCheck, grains: Vec<Particle<2>>) -> Simulation<impl Model<2>, 2> {
    let model = heavy(rule(0.0), with_check(check), [Side::Open; 2]);
    Simulation::new(model, grains).unwrap()
}

/// What happened to one grain.
fn story(events: &[Occurrence<2>], id: u32) -> Vec<(Kind, f64)> {
    events
        .iter()
        .filter(|event| event.particle.0 == id)
        .map(|event| (event.kind, event.time.units()))
        .collect()
}

/// How far 1 sleeps above the fixed 0.
const GAP: f64 = 1.0e-3;
/// When 2 is struck.
const STRIKE: f64 = 0.6;

/// 0 and 3 are fixed. 1 sleeps a hair above 0 and leans on 2, which sleeps
/// between 0 and 3, on 3. 4 strikes 2 from above, which falls through between 0
/// and 3 and touches nobody.
fn leaning() -> Vec<Particle<2>> {
    let strike = at(1.008, 0.9 + 1.0 + 2.0 * STRIKE);
    vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::frozen(at(0.0, 1.0 + GAP)),
        Particle::frozen(at(1.008, 0.9)),
        Particle::fixed(at(2.03, 0.75)),
        Particle::new(strike, at(0.0, -2.0)).with_mode(Mode::Falling),
    ]
}

#[test]
fn a_grain_whose_support_has_been_woken_wakes_at_its_next_check() {
    let mut simulation = in_the_open(own_clock(), leaning());
    // Two checks each of 1 and 2 pass before.
    simulation.run(&until(0.55), &mut ());
    assert_eq!(simulation.counts().check, 4);
    let (_, events) = watch(&mut simulation, &until(0.76));
    assert_eq!(events.len(), 2);
    let (strike, woken) = (&events[0], &events[1]);
    assert_eq!(
        (strike.kind, strike.other),
        (Kind::Wake, Some(ParticleId(2)))
    );
    close(strike.time.units(), STRIKE, 1.0e-12, "the strike");

    // At 3/4 the supports of 1 are counted, and one of two is gone.
    assert_eq!((woken.kind, woken.particle.0), (Kind::CheckWake, 1));
    assert_eq!(woken.time, Time::from_units(0.75));
    let reason = woken.reason.unwrap();
    assert_eq!(reason.condition, "all supports are still there");
    assert_eq!((reason.value, reason.limit), (1.0, 2.0));
    assert_eq!(woken.velocity, Vector::<2>::zeros(), "at rest: no store");
    assert_eq!(simulation.counts().check, 5);
    assert_eq!(simulation.counts().check_wake, 1);
}

#[test]
fn a_support_that_is_awake_is_none_even_if_it_has_not_moved() {
    // Struck an instant before the check: 2 is where it was.
    let mut grains = leaning();
    let wait = 0.15 - 1.0e-9;
    grains[4].position[1] += 2.0 * wait;
    let mut simulation = in_the_open(own_clock(), grains);
    let (_, events) = watch(&mut simulation, &until(0.76));
    assert_eq!(events[0].kind, Kind::Wake);
    assert!(events[0].time < Time::from_units(0.75));
    assert_eq!(events[1].kind, Kind::CheckWake);
    assert_eq!(events[1].time, Time::from_units(0.75));
}

#[test]
fn one_woken_by_its_check_does_not_sleep_at_its_first_contact() {
    let mut simulation = in_the_open(own_clock(), leaning());
    let (_, events) = watch(&mut simulation, &until(1.25));
    let told = story(&events, 1);
    let kinds: Vec<_> = told.iter().map(|event| event.0).collect();
    // It lands slowly, on its way down; and sleeps only after the next landing.
    let wanted = [Kind::CheckWake, Kind::Frozen, Kind::Frozen, Kind::Sleep];
    assert_eq!(kinds, wanted);
    let fall = (2.0 * GAP).sqrt();
    close(told[1].1, 0.75 + fall, 1.0e-12, "first landing");
    close(told[2].1, 0.75 + 1.8 * fall, 1.0e-12, "second landing");
    let landed = |event: &&Occurrence<2>| event.particle.0 == 1 && event.kind == Kind::Frozen;
    let landings: Vec<_> = events.iter().filter(landed).collect();
    close(landings[0].impact_speed, fall, 1.0e-12, "speed");
    assert!(fall < 0.1 && landings[0].reason.is_none());
    assert!(landings[1].reason.is_some());
    // Asleep again it checks what it lies on now, and that stays.
    simulation.run(&until(5.0), &mut ());
    assert_eq!(simulation.counts().check_wake, 1);
    assert_eq!(simulation.particle(ParticleId(1)).mode, Mode::Frozen);
}

#[test]
fn without_any_support_it_wakes_unless_told_otherwise() {
    for (unsupported_wakes, woken) in [(true, 1), (false, 0)] {
        let check = SelfCheck {
            unsupported_wakes,
            ..own_clock()
        };
        let alone = Particle::frozen(at(0.0, 9.0));
        // One above and one too far below are no supports.
        let above = Particle::fixed(at(0.0, 10.0));
        let below = Particle::fixed(at(0.0, 9.0 - 1.051));
        let mut simulation = in_the_open(check, vec![alone, above, below]);
        let (_, events) = watch(&mut simulation, &until(0.26));
        assert_eq!(simulation.counts().check_wake, woken);
        assert_eq!(simulation.counts().check, 1);
        for event in events {
            assert_eq!(event.time.units(), 0.25);
            assert_eq!(event.reason.unwrap().condition, "has a support");
        }
    }
}

#[test]
fn supports_reach_to_five_percent_of_the_contact_distance() {
    // Of unlike grains: contact at 1.25, so out to 1.3125.
    for (distance, woken) in [(1.3124, 0), (1.3126, 1)] {
        let sleeper = Particle::frozen(at(0.0, distance));
        let support = Particle::fixed(at(0.0, 0.0)).with_diameter(1.5);
        let mut simulation = in_the_open(own_clock(), vec![sleeper, support]);
        simulation.run(&until(0.3), &mut ());
        assert_eq!(simulation.counts().check_wake, woken, "at {distance}");
    }
}

#[test]
fn a_normal_grain_above_braces_as_long_as_it_is_there() {
    // 1 sleeps on the fixed 0, and 2 is just being thrown up from it.
    let grains = || {
        vec![
            Particle::fixed(at(0.0, 0.0)),
            Particle::frozen(at(0.0, 1.0)),
            Particle::new(at(0.0, 2.0), at(0.0, 0.5)),
        ]
    };
    // After 1/4 it is 0.094 d above its contact, out of range.
    for (support_normals, woken) in [(true, 1), (false, 0)] {
        let check = SelfCheck {
            support_normals,
            ..own_clock()
        };
        let mut simulation = in_the_open(check, grains());
        let (_, events) = watch(&mut simulation, &until(0.3));
        assert_eq!(simulation.counts().check_wake, woken);
        if let Some(event) = events.first() {
            let reason = event.reason.unwrap();
            assert_eq!((reason.value, reason.limit), (1.0, 2.0));
        }
    }
}

#[test]
fn checks_are_spread_or_global_as_asked() {
    let column = |count: u32| -> Vec<Particle<2>> {
        (0..=count)
            .map(|i| {
                let place = at(2.0 * f64::from(i / 2), f64::from(i % 2));
                if i % 2 == 0 {
                    Particle::fixed(place)
                } else {
                    Particle::frozen(place)
                }
            })
            .collect()
    };
    let checks = |phase: Phase, start: f64, end: f64| {
        let check = SelfCheck {
            phase,
            ..own_clock()
        };
        let mut simulation = in_the_open(check, column(199));
        simulation.run(&until(start), &mut ());
        let before = simulation.counts().check;
        simulation.run(&until(end), &mut ());
        simulation.counts().check - before
    };
    // All at once, or about a fifth in a fifth of the interval.
    assert_eq!(checks(Phase::Own, 0.2499, 0.2501), 100);
    assert_eq!(checks(Phase::Global, 0.4999, 0.5001), 100);
    let spread = Phase::Spread { seed: 5 };
    for fifth in 0..5 {
        let start = 1.0 + 0.05 * f64::from(fifth);
        let found = checks(spread, start, start + 0.05);
        assert!((8..35).contains(&found), "{found} in fifth {fifth}");
    }
    // Every grain once in every interval, in other places with another seed.
    assert_eq!(checks(spread, 1.0, 1.25), 100);
    let other = Phase::Spread { seed: 6 };
    assert_ne!(checks(spread, 1.0, 1.05), checks(other, 1.0, 1.05));
}

/// Gravity that turns over at t = 1; nothing moves.
struct Overturned;

impl Dynamics<2> for Overturned {
    type Flight = Parabola<2>;

    fn flight(&self, motion: &Motion<2>, _since: Time) -> Parabola<2> {
        Parabola {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: Vector::zeros(),
        }
    }

    fn gravity(&self, time: Time) -> Vector<2> {
        let down = if time < Time::from_units(1.0) {
            -1.0
        } else {
            1.0
        };
        at(0.0, down)
    }
}

/// A sleeper on a fixed grain, while gravity turns over at t = 1, checks at 1.2, as with
/// every check 0.3 after the one before.
fn wakes_as_gravity_has_turned_over(check: SelfCheck) {
    let model = Parts {
        dynamics: Overturned,
        predictor: Polynomial,
        collision_rule: rule(0.0),
        state_policy: with_check(SelfCheck {
            interval: 0.3,
            ..check
        }),
        boundary: Cuboid::open(),
    };
    let grains = vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::frozen(at(0.0, 1.0)),
    ];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(2.0));
    assert_eq!(events.len(), 1);
    assert_eq!(events[0].kind, Kind::CheckWake);
    let when = events[0].time.units();
    close(when, 1.2, 1.0e-12, "the first check after");
}

#[test]
fn below_is_below_under_the_gravity_of_the_moment() {
    wakes_as_gravity_has_turned_over(own_clock());
}

#[test]
fn a_sleeper_whose_check_fails_soon_gets_its_velocity_back() {
    // It rolls off a fixed grain onto a floor and falls asleep in mid-air, on
    // its way to the next contact. With so short a range nobody supports it
    // there: at its check, within the time of the store, it goes on.
    let check = SelfCheck {
        interval: 0.05,
        support_range: 1.0 + 1.0e-9,
        ..own_clock()
    };
    let grains = vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::new(at(0.3, 1.3), at(0.0, 0.0)),
    ];
    let policy = SlowDescent {
        sleep_speed: 1.0,
        ..with_check(check)
    };
    let model = heavy(rule(0.0), policy, [Side::Open, Side::floor(-0.9, 0.4)]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(6.0));
    let asleep = events.iter().position(|event| event.kind == Kind::Sleep);
    let asleep = asleep.expect("it sleeps");
    let lost = -events[asleep].impulse;
    assert!(lost.norm() > 1.0e-3);
    let woken = &events[asleep + 1];
    assert_eq!(woken.kind, Kind::CheckWake);
    let wait = woken.time - events[asleep].time;
    close(wait, 0.05, 1.0e-12, "one interval later");
    assert_eq!(woken.velocity, lost, "and on it goes");
}
