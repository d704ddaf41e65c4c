//! The same bits in every build: trajectories pinned by their hashes.
//!
//! `cargo test` checks them in the test profile, with assertions;
//! `cargo test --release --test determinism` as users run them, and
//! `CARGO_PROFILE_TEST_OPT_LEVEL=0 cargo test --test determinism pinned` without
//! any optimisation. A hash moves only when the physics does, or the last bit of
//! its arithmetic: never with the neighbour scheme, the queue, the clock, or the
//! build.

mod common;

use common::{Heavy, free, gas_grains, hash, heavy, periodic_laterally, rain_on_base, rule, watch};
use grainfall::collide::Restitution;
use grainfall::engine::{Limits, Settings, Simulation};
use grainfall::model::{Approach, Encounter, Flight, Forecast, Parts, PolynomialFlight};
use grainfall::model::{Predictor, Wall};
use grainfall::policy::{SelfCheck, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::setup::Sizes;
use grainfall::{Particle, Time, Vector};

const EQUAL: Sizes = Sizes::Equal { diameter: 1.0 };
const DEPOSITION: &str = "1b112030546aab83";
const HEAP: &str = "03114e4d03674a62";
const GAS: &str = "823e546f9e0a7433";

/// A deposition in space.
fn deposition() -> (Heavy<SlowDescent, 3>, Vec<Particle<3>>) {
    let sides = periodic_laterally::<3>(5.0);
    let model = heavy(rule(1.0e-3), SlowDescent::default(), sides);
    (model, rain_on_base::<3>(1, 120, 5.0, EQUAL))
}

/// A checked heap of all sizes in the plane; it is followed for so many events.
fn heap() -> (Heavy<SlowDescent, 2>, Vec<Particle<2>>) {
    let sizes = Sizes::Uniform {
        least: 0.6,
        most: 1.0,
    };
    let policy = SlowDescent {
        self_check: Some(SelfCheck::default()),
        ..SlowDescent::with_threshold(0.05)
    };
    let sides = periodic_laterally::<2>(12.0);
    let model = heavy(rule(1.0e-3), policy, sides);
    (model, rain_on_base::<2>(2, 60, 12.0, sizes))
}
const HEAP_EVENTS: u64 = 60_000;

fn text(hash: u64) -> String {
    format!("{hash:016x}")
}

#[test]
fn pinned_deposition_in_space() {
    let (model, grains) = deposition();
    let mut simulation = Simulation::new(model, grains).unwrap();
    let found = hash(&mut simulation, &Limits::all_frozen());
    assert_eq!(simulation.mode_counts().frozen, 120);
    assert_eq!(text(found), DEPOSITION);
}

#[test]
fn pinned_heap_of_all_sizes_in_the_plane() {
    let (model, grains) = heap();
    let mut simulation = Simulation::new(model, grains).unwrap();
    let found = hash(&mut simulation, &Limits::events(HEAP_EVENTS));
    assert!(simulation.counts().check > 100);
    assert_eq!(text(found), HEAP);
}

#[test]
fn pinned_gas_that_cools() {
    let (grains, sides) = gas_grains::<3>(3, 200, 0.2, EQUAL);
    let model = free(Restitution::constant(0.9), sides);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let found = hash(&mut simulation, &Limits::events(20_000));
    assert_eq!(text(found), GAS);
}

/// A bystander far below that nobody ever meets, but large: the cells and the
/// leashes of all lists are made for it.
fn bystander<const D: usize>(diameter: f64) -> Particle<D> {
    let mut place = Vector::zeros();
    place[D - 1] = -300.0;
    Particle::fixed(place).with_diameter(diameter)
}

#[test]
fn other_cells_and_lists_change_nothing() {
    for diameter in [1.3, 2.4] {
        let (model, mut grains) = deposition();
        grains.push(bystander(diameter));
        let mut simulation = Simulation::new(model, grains).unwrap();
        let found = hash(&mut simulation, &Limits::all_frozen());
        assert_eq!(text(found), DEPOSITION, "with one of {diameter} d");
    }
    let plain = {
        let (model, grains) = heap();
        let mut simulation = Simulation::new(model, grains).unwrap();
        simulation.run(&Limits::events(HEAP_EVENTS), &mut ());
        simulation.counts().transfer
    };
    for diameter in [1.7, 5.5] {
        let (model, mut grains) = heap();
        grains.push(bystander(diameter));
        let mut simulation = Simulation::new(model, grains).unwrap();
        let found = hash(&mut simulation, &Limits::events(HEAP_EVENTS));
        assert_eq!(text(found), HEAP, "with one of {diameter} d");
        // The lists are indeed others.
        assert_ne!(simulation.counts().transfer, plain);
    }
}

/// Looks ahead as far as there is to see, whatever is asked.
#[derive(Clone, Copy)]
struct Farsighted;

impl<const D: usize, F: Flight<D> + PolynomialFlight<D>> Predictor<D, F> for Farsighted {
    fn pair(&self, approach: &Approach<D, F>) -> Forecast {
        Polynomial.pair(&Approach {
            horizon: f64::INFINITY,
            ..*approach
        })
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast {
        Polynomial.wall(&Encounter {
            horizon: f64::INFINITY,
            ..*encounter
        })
    }
}

#[test]
fn how_far_a_prediction_looks_changes_nothing() {
    let (model, grains) = deposition();
    let farsighted = Parts {
        dynamics: model.dynamics,
        predictor: Farsighted,
        collision_rule: model.collision_rule,
        state_policy: model.state_policy,
        boundary: model.boundary,
    };
    let mut simulation = Simulation::new(farsighted, grains).unwrap();
    let found = hash(&mut simulation, &Limits::all_frozen());
    assert_eq!(text(found), DEPOSITION);
}

#[test]
fn the_hour_of_the_start_changes_nothing() {
    let (model, grains) = heap();
    let limits = Limits::events(HEAP_EVENTS / 2);
    let mut simulation = Simulation::new(model.clone(), grains.clone()).unwrap();
    let (_, events) = watch(&mut simulation, &limits);
    for start in [1.0e9 + 0.3, -12345.678] {
        let settings = Settings {
            start: Time::from_units(start),
            ..Settings::default()
        };
        let mut late = Simulation::with_settings(model.clone(), grains.clone(), settings).unwrap();
        let (_, seen) = watch(&mut late, &limits);
        for (one, two) in events.iter().zip(&seen) {
            assert_eq!((one.kind, one.particle), (two.kind, two.particle));
            assert_eq!((one.velocity, one.impulse), (two.velocity, two.impulse));
            assert_eq!(one.time - Time::ZERO, two.time - settings.start);
        }
        assert_eq!(events.len(), seen.len());
    }
}
