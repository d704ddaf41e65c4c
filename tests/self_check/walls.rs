//! A heap behind a wall that is taken away.

use grainfall::boundary::Side;
use grainfall::engine::Simulation;
use grainfall::model::{Model, Occurrence, OccurrenceKind as Kind};
use grainfall::policy::{SelfCheck, Timing};
use grainfall::{Mode, Particle, ParticleId, Time};

use crate::common::{heavy, rule, until, watch, what};
use crate::{at, at_once, in_the_open, own_clock, with_check};

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
        assert_eq!(what(event), what(other));
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
