//! The self-check: who has lost a support wakes.

mod common;

use common::{close, heavy, rule, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::Parabola;
use grainfall::engine::Simulation;
use grainfall::model::{
    Commands, Dynamics, Impact, Model, Motion, NoEvent, Occurrence, OccurrenceKind as Kind, Parts,
    Reason, Response, SleepDecision, StatePolicy, Surroundings, WakeDecision, Waking,
};
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

#[test]
fn below_is_below_under_the_gravity_of_the_moment() {
    let model = Parts {
        dynamics: Overturned,
        predictor: Polynomial,
        collision_rule: rule(0.0),
        state_policy: with_check(SelfCheck {
            interval: 0.3,
            ..own_clock()
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
    close(
        events[0].time.units(),
        1.2,
        1.0e-12,
        "the first check after",
    );
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

/// Whenever a support is lost.
fn at_once() -> SelfCheck {
    SelfCheck {
        timing: Timing::Events,
        ..own_clock()
    }
}

#[test]
fn with_events_whose_support_is_woken_wakes_at_the_same_instant() {
    let mut simulation = in_the_open(at_once(), leaning());
    let whom: Vec<_> = simulation.supporters(ParticleId(1)).collect();
    assert_eq!(whom, [ParticleId(0), ParticleId(2)]);
    assert!(simulation.dependants(ParticleId(2)).eq([ParticleId(1)]));
    let (_, events) = watch(&mut simulation, &until(0.61));
    let (strike, woken) = (&events[0], &events[1]);
    assert_eq!(
        (strike.kind, strike.other),
        (Kind::Wake, Some(ParticleId(2)))
    );
    assert_eq!((woken.kind, woken.particle.0), (Kind::CheckWake, 1));
    assert_eq!(woken.time, strike.time);
    let reason = woken.reason.unwrap();
    assert_eq!(reason.condition, "all supports are still there");
    assert_eq!((reason.value, reason.limit), (1.0, 2.0));
    // That was the only question, and nobody leans any more.
    let counts = simulation.counts();
    assert_eq!((counts.check, counts.support, counts.check_wake), (0, 1, 1));
    assert_eq!(simulation.supporters(ParticleId(1)).count(), 0);
    assert_eq!(simulation.dependants(ParticleId(0)).count(), 0);
}

/// Sleepers in the order of their names, each above the one that `below` names;
/// the first is fixed.
fn tower(below: &[usize]) -> Vec<Particle<2>> {
    let mut grains = vec![Particle::fixed(at(0.0, 0.0))];
    let mut heights = vec![0.0; below.len() + 1];
    let mut left = below.len();
    while left > 0 {
        for (place, &on) in below.iter().enumerate() {
            if heights[place + 1] == 0.0 && (on == 0 || heights[on] > 0.0) {
                heights[place + 1] = heights[on] + 1.0 + GAP;
                left -= 1;
            }
        }
    }
    grains.extend(heights[1..].iter().map(|&y| Particle::frozen(at(0.0, y))));
    grains
}

#[test]
fn a_tower_whose_foot_is_taken_away_wakes_upwards_at_one_instant() {
    // 3 on 0, 1 on 3, 4 on 1, 2 on 4.
    let mut simulation = in_the_open(at_once(), tower(&[3, 4, 0, 1]));
    simulation.run(&until(0.5), &mut ());
    assert_eq!(simulation.counts().total(), 0);
    let energy = simulation.energy_ledger();
    simulation
        .set_free(ParticleId(0), at(0.0, -1.0))
        .expect("it is fixed");
    let change = simulation.energy_ledger();
    close(change.inserted - energy.inserted, 0.5, 1.0e-14, "energy");
    close(change.sum(), change.change(), 1.0e-13, "ledger");
    let (_, events) = watch(&mut simulation, &until(0.5));
    let order: Vec<_> = events.iter().map(|event| event.particle.0).collect();
    assert_eq!(order, [3, 1, 4, 2]);
    assert!(events.iter().all(|event| event.kind == Kind::CheckWake));
    assert!(events.iter().all(|event| event.time == simulation.time()));
    // All fall alike, and so never meet.
    assert!(watch(&mut simulation, &until(3.0)).1.is_empty());
}

#[test]
fn of_several_that_lose_a_support_at_once_the_smallest_name_wakes_first() {
    // Two on each side of the fixed one that is taken away, and one on both.
    let step = 1.0 + GAP;
    let side = |x: f64| at(x, (step * step - x * x).sqrt());
    let top = at(0.0, 2.0 * side(0.51).y);
    let grains = vec![
        Particle::frozen(top),
        Particle::frozen(side(0.51)),
        Particle::frozen(side(-0.51)),
        Particle::fixed(at(0.0, 0.0)),
    ];
    let mut simulation = in_the_open(at_once(), grains);
    let away = at(0.0, -9.0);
    simulation.set_free(ParticleId(3), away).expect("fixed");
    let (_, events) = watch(&mut simulation, &until(0.0));
    // The top one is called when the first of its supports wakes, and comes
    // before the second.
    let order: Vec<_> = events.iter().map(|event| event.particle.0).collect();
    assert_eq!(order, [1, 0, 2]);
}

#[test]
fn who_is_free_or_not_there_is_not_set_free() {
    let free = Particle::new(at(5.0, 0.0), at(0.0, 0.0));
    let overlapping = Particle::fixed(at(0.5, 0.0));
    let mut grains = tower(&[0]);
    grains.extend([free, overlapping]);
    grains.swap(1, 3);
    grains[3].position.x -= 9.0;
    let mut simulation = in_the_open(at_once(), grains);
    let before = simulation.snapshot();
    for (id, velocity, said) in [
        (9, 0.0, "grain 9: id"),
        (2, 0.0, "grain 2: mode"),
        (0, f64::NAN, "grain 0: velocity"),
        (0, 0.0, "overlap"),
    ] {
        let refused = simulation.set_free(ParticleId(id), at(velocity, 0.0));
        let error = refused.expect_err(said).to_string();
        assert!(error.contains(said), "{error}, not {said}");
    }
    assert_eq!(simulation.snapshot(), before);
    simulation.assert_consistent();
}

#[test]
fn with_events_nobody_stays_in_the_air_but_once_in_a_while() {
    for (unsupported_wakes, woken) in [(true, 1), (false, 0)] {
        let check = SelfCheck {
            unsupported_wakes,
            ..at_once()
        };
        let alone = Particle::frozen(at(0.0, 9.0));
        let above = Particle::fixed(at(0.0, 10.0));
        let mut simulation = in_the_open(check, vec![alone, above]);
        let (_, events) = watch(&mut simulation, &until(0.0));
        assert_eq!(events.len(), woken, "at the start");
    }
}

#[test]
fn with_events_nobody_sleeps_at_the_apex_of_a_flight() {
    // With so high a threshold it falls asleep at each second landing, half-way
    // to the next, out of reach of the support: it flies on as if nothing had
    // been.
    let grains = || {
        vec![
            Particle::fixed(at(0.0, 0.0)),
            Particle::new(at(0.0, 3.0), at(0.0, 0.0)),
        ]
    };
    let policy = |check| SlowDescent {
        sleep_speed: 3.0,
        ..with_check(check)
    };
    let run = |policy| {
        let model = heavy(rule(0.0), policy, [Side::Open; 2]);
        let mut simulation = Simulation::new(model, grains()).unwrap();
        watch(&mut simulation, &until(5.5)).1
    };
    let events = run(policy(at_once()));
    let mut high = 0;
    for (sleep, next) in events.iter().zip(&events[1..]) {
        if sleep.kind != Kind::Sleep {
            continue;
        }
        let lost = -sleep.impulse;
        if next.kind == Kind::CheckWake {
            high += 1;
            assert_eq!(next.time, sleep.time);
            assert_eq!(next.velocity, lost);
        }
    }
    assert!(high > 0, "it never fell asleep too high");
    let asleep = events.iter().rfind(|event| event.kind == Kind::Sleep);
    assert!(asleep.is_some_and(|last| last.time > Time::from_units(2.0)));
    // It lands when one lands that never sleeps.
    let landings = |events: &[Occurrence<2>]| -> Vec<f64> {
        let landed = events.iter().filter(|event| event.kind == Kind::Frozen);
        landed.map(|event| event.time.units()).collect()
    };
    let awake = landings(&run(SlowDescent {
        sleep_speed: 0.0,
        ..SlowDescent::default()
    }));
    let found = landings(&events);
    assert!(found.len() > 2);
    for (landing, wanted) in found.iter().zip(&awake) {
        close(*landing, *wanted, 1.0e-12, "landing");
    }
}

#[test]
fn with_events_it_wakes_when_the_one_above_leaves() {
    // y − 1 = 1 + t/2 − t²/2 reaches 1.05 on the way up.
    let grains = vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::frozen(at(0.0, 1.0)),
        Particle::new(at(0.0, 2.0), at(0.0, 0.5)),
    ];
    let mut simulation = in_the_open(at_once(), grains);
    let (_, events) = watch(&mut simulation, &until(0.3));
    assert_eq!(events[0].kind, Kind::CheckWake);
    let leaves = 0.5 - 0.15_f64.sqrt();
    close(events[0].time.units(), leaves, 1.0e-11, "it leaves");
    // Asked a few times only on the way there.
    assert!(simulation.counts().check < 20, "{:?}", simulation.counts());

    // One that lands again first braces on, and is asked about at its landings.
    let grains = vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::frozen(at(0.0, 1.0)),
        Particle::new(at(0.0, 2.0), at(0.0, 0.09)),
    ];
    let mut simulation = in_the_open(at_once(), grains);
    let (_, events) = watch(&mut simulation, &until(5.0));
    assert!(events.iter().all(|event| event.kind != Kind::CheckWake));
    let landings = events.iter().filter(|event| event.kind == Kind::Frozen);
    let sleeps = events.iter().filter(|event| event.kind == Kind::Sleep);
    let changes = landings.count() + sleeps.count();
    assert_eq!(simulation.counts().support, changes as u64);
}

/// A wall of fixed grains at the edge of a base, and a heap behind it, which leans
/// on it; or the same the other way round.
fn heap_behind_a_wall(mirrored: bool) -> Vec<Particle<2>> {
    let mut grains = Vec::new();
    for row in 0..5 {
        grains.push(Particle::fixed(at(-1.01, 0.6 + 1.01 * f64::from(row))));
    }
    for place in 0..8 {
        grains.push(Particle::fixed(at(1.01 * f64::from(place), 0.0)));
    }
    for row in 1..=5 {
        for place in 0..8 - row {
            let x = 1.01 * (f64::from(place) + 0.5 * f64::from(row % 2));
            grains.push(Particle::frozen(at(x, 0.88 * f64::from(row))));
        }
    }
    for grain in &mut grains {
        if mirrored {
            grain.position.x = -grain.position.x;
        }
    }
    grains
}

/// The wakes of the heap when its wall is taken away at 1/2.
fn dam_break(
    check: SelfCheck,
    mirrored: bool,
) -> (Simulation<impl Model<2>, 2>, Vec<Occurrence<2>>) {
    let grains = heap_behind_a_wall(mirrored);
    let model = heavy(rule(3.0e-2), with_check(check), [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    simulation.run(&until(0.5), &mut ());
    assert_eq!(simulation.counts().total(), 0, "the heap rests");
    for row in 0..5 {
        simulation
            .set_free(ParticleId(row), at(0.0, -3.0))
            .expect("the wall is fixed");
    }
    let (_, events) = watch(&mut simulation, &until(4.0));
    (simulation, events)
}

#[test]
fn taking_away_a_wall_brings_down_the_heap_behind_it() {
    let polled = SelfCheck {
        interval: 0.01,
        ..own_clock()
    };
    for check in [at_once(), polled] {
        let (simulation, events) = dam_break(check, false);
        let first = &events[0];
        assert_eq!(first.kind, Kind::CheckWake);
        let wait = first.time - Time::from_units(0.5);
        match check.timing {
            Timing::Events => assert_eq!(wait, 0.0),
            Timing::Polled => assert!(wait <= 0.01),
        }

        // Its face comes down over the edge, and what lies farther behind stays.
        let start = heap_behind_a_wall(false);
        for (id, (grain, start)) in simulation.snapshot().iter().zip(&start).enumerate() {
            let down = start.position.y - grain.position.y;
            let behind = start.mode == Mode::Frozen && start.position.x > 2.0;
            if [20, 26, 31, 35].contains(&id) {
                assert!(down > 1.0 && grain.position.x < 0.0, "{id} is {grain:?}");
            } else if behind {
                assert!(down < 0.2, "{id} is {grain:?}");
            }
        }
    }
}

#[test]
fn a_mirrored_heap_comes_down_the_other_way() {
    let (here, events) = dam_break(at_once(), false);
    let (there, mirrored) = dam_break(at_once(), true);
    assert_eq!(events.len(), mirrored.len());
    for (event, other) in events.iter().zip(&mirrored) {
        assert_eq!(common::what(event), common::what(other));
        assert_eq!(event.time, other.time);
    }
    for (grain, other) in here.snapshot().iter().zip(&there.snapshot()) {
        assert_eq!(grain.position, at(-other.position.x, other.position.y));
    }
}

#[test]
fn with_events_a_quiet_heap_costs_nothing() {
    let mut simulation = in_the_open(at_once(), heap_behind_a_wall(false));
    simulation.run(&until(1000.0), &mut ());
    let counts = simulation.counts();
    assert_eq!((counts.check, counts.support, counts.total()), (0, 0, 0));
    let mut simulation = in_the_open(own_clock(), heap_behind_a_wall(false));
    simulation.run(&until(1000.0), &mut ());
    assert_eq!(simulation.counts().check, 25 * 4000);
}

#[test]
fn where_nobody_says_how_gravity_goes_the_clock_stays() {
    let model = Parts {
        dynamics: Overturned,
        predictor: Polynomial,
        collision_rule: rule(0.0),
        state_policy: with_check(SelfCheck {
            interval: 0.3,
            ..at_once()
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
    close(
        events[0].time.units(),
        1.2,
        1.0e-12,
        "the first check after",
    );
}

#[test]
fn a_fixed_support_that_moves_away_is_looked_for_by_the_clock() {
    // 0.05 d away after 1/2, so lost at the check after that.
    let mut support = Particle::fixed(at(0.0, 0.0));
    support.velocity = at(0.0, -0.09);
    let grains = vec![support, Particle::frozen(at(0.0, 1.0))];
    let mut simulation = in_the_open(at_once(), grains);
    let (_, events) = watch(&mut simulation, &until(1.0));
    assert_eq!(events[0].kind, Kind::CheckWake);
    close(events[0].time.units(), 0.75, 1.0e-12, "the check");
}

/// A criterion of one's own: a sleeper leans on whoever is nearer than 1.5, and
/// wakes when the second of them changes.
#[derive(Clone, Copy)]
struct Second;

impl StatePolicy<2> for Second {
    type Memory = u32;
    type Event = NoEvent;

    fn should_sleep<S: Surroundings<2>>(
        &self,
        _impact: &Impact<2>,
        _after: Vector<2>,
        _near: &S,
        _memory: &mut u32,
    ) -> SleepDecision {
        SleepDecision::Stay(Reason::new("never", 0.0, 0.0))
    }

    fn should_wake<S: Surroundings<2>>(
        &self,
        _impact: &Impact<2>,
        _near: &S,
        _struck: &u32,
    ) -> WakeDecision<2> {
        WakeDecision::Wake(Waking::at_rest(), Reason::new("always", 0.0, 0.0))
    }

    fn on_start<S: Surroundings<2>>(
        &self,
        id: ParticleId,
        near: &S,
        _memory: &mut u32,
        commands: &mut Commands<NoEvent>,
    ) {
        near.for_each_neighbour(id, 1.5, |other| commands.lean_on(id, other.id));
        // Neither on itself nor on nobody.
        commands.lean_on(id, id);
        commands.lean_on(id, ParticleId(999));
    }

    fn on_support_change<S: Surroundings<2>>(
        &self,
        _id: ParticleId,
        supporter: ParticleId,
        near: &S,
        memory: &mut u32,
        _commands: &mut Commands<NoEvent>,
    ) -> Response<2> {
        assert_eq!(near.particle(supporter).mode, Mode::Normal);
        *memory += 1;
        let reason = Reason::new("the second change", f64::from(*memory), 2.0);
        if *memory < 2 {
            Response::Keep
        } else {
            Response::Wake(Waking::with_velocity(at(0.0, 0.125)), reason)
        }
    }
}

#[test]
fn a_criterion_of_ones_own_lets_sleepers_lean() {
    // 0 sleeps between 1 and 2, which are struck from the sides and at rest else.
    let strike = |x: f64, u: f64| Particle::new(at(x, 0.0), at(u, 0.0)).with_mode(Mode::Falling);
    let grains = vec![
        Particle::frozen(at(0.0, 0.0)),
        Particle::frozen(at(-1.2, 0.0)),
        Particle::frozen(at(1.2, 0.0)),
        strike(-2.6, 1.0),
        strike(2.75, -1.0),
    ];
    let model = heavy(rule(0.0), Second, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    assert!(
        simulation
            .supporters(ParticleId(0))
            .eq([ParticleId(1), ParticleId(2)])
    );
    // Free grains lean on nobody, whatever is asked for.
    assert_eq!(simulation.supporters(ParticleId(3)).count(), 0);
    simulation.run(&until(0.5), &mut ());
    assert_eq!(*simulation.memory(ParticleId(0)), 1);
    assert_eq!(simulation.mode_counts().frozen, 2);
    let (_, events) = watch(&mut simulation, &until(0.6));
    let told = story(&events, 0);
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].0, Kind::CheckWake);
    close(told[0].1, 0.55, 1.0e-12, "the second change");
    let counts = simulation.counts();
    assert_eq!((counts.check, counts.support, counts.check_wake), (0, 2, 1));
}
