//! Support that is lost as an event, by scenes of a few grains.

use grainfall::boundary::Side;
use grainfall::engine::Simulation;
use grainfall::model::{Occurrence, OccurrenceKind as Kind, StatePolicy};
use grainfall::policy::{
    AtRest, Criterion, DisplacementWindow, DynamoSleep, GranularTemperature, IsostaticSupport,
    SelfCheck, SlowDescent, VelocityVariance,
};
use grainfall::{Particle, ParticleId, Time};

use crate::common::{close, heavy, rule, until, watch};
use crate::{GAP, at, at_once, in_the_open, leaning, wakes_as_gravity_has_turned_over, with_check};

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
    let counts = simulation.counts();
    assert_eq!((counts.check, counts.support), (0, 1));

    // One that lands again first braces on, and is a brace when it sleeps, too.
    let grains = vec![
        Particle::fixed(at(0.0, 0.0)),
        Particle::frozen(at(0.0, 1.0)),
        Particle::new(at(0.0, 2.0), at(0.0, 0.09)),
    ];
    let mut simulation = in_the_open(at_once(), grains);
    let (_, events) = watch(&mut simulation, &until(5.0));
    assert!(events.iter().all(|event| event.kind != Kind::CheckWake));
    let landings = events.iter().filter(|event| event.kind == Kind::Frozen);
    assert!(landings.count() > 1 && simulation.mode_counts().normal == 0);
    let counts = simulation.counts();
    assert_eq!(
        (counts.check, counts.support),
        (0, 1),
        "when it falls asleep"
    );
}

#[test]
fn where_nobody_says_how_gravity_goes_the_clock_stays() {
    wakes_as_gravity_has_turned_over(at_once());
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

/// When the leaning grain wakes.
fn leaning_wakes<S: StatePolicy<2>>(policy: S) -> Time {
    let model = heavy(rule(0.0), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, leaning()).unwrap();
    let (_, events) = watch(&mut simulation, &until(0.61));
    let mut woken = events.iter().filter(|event| event.kind == Kind::CheckWake);
    let first = woken.next().expect("it wakes");
    assert_eq!((first.particle, woken.count()), (ParticleId(1), 0));
    assert_eq!(first.time, events[0].time);
    first.time
}

#[test]
fn every_criterion_of_the_gallery_can_do_it() {
    let descent = with_check(at_once());
    let wanted = leaning_wakes(descent);
    fn resting<C>(condition: C) -> AtRest<C> {
        AtRest {
            self_check: Some(at_once()),
            ..AtRest::new(condition)
        }
    }
    let isostatic = IsostaticSupport {
        descent,
        ..IsostaticSupport::default()
    };
    for criterion in [
        Criterion::SlowDescent(descent),
        Criterion::IsostaticSupport(isostatic),
        Criterion::DisplacementWindow(resting(DisplacementWindow::default())),
        Criterion::VelocityVariance(resting(VelocityVariance::default())),
        Criterion::GranularTemperature(resting(GranularTemperature::default())),
        Criterion::DynamoSleep(resting(DynamoSleep::default())),
    ] {
        assert_eq!(leaning_wakes(criterion), wanted, "{criterion:?}");
    }
    assert_eq!(leaning_wakes(isostatic), wanted);
    assert_eq!(leaning_wakes(resting(DynamoSleep::default())), wanted);
}
