//! The same bits in every build: trajectories pinned by their hashes.
//!
//! `cargo test` checks them in the test profile, with assertions;
//! `cargo test --release --test determinism` as users run them. A hash moves
//! only when the physics does, or the last bit of its arithmetic: never with
//! the neighbour scheme, the queue, or the build.

mod common;

use common::{free, gas_grains, hash, heavy, periodic_laterally, rain_on_base, rule};
use grainfall::collide::Restitution;
use grainfall::engine::{Limits, Simulation};
use grainfall::policy::{SelfCheck, SlowDescent};
use grainfall::setup::Sizes;

const EQUAL: Sizes = Sizes::Equal { diameter: 1.0 };

#[test]
fn a_deposition_in_space() {
    let sides = periodic_laterally::<3>(5.0);
    let model = heavy(rule(1.0e-3), SlowDescent::default(), sides);
    let mut simulation = Simulation::new(model, rain_on_base::<3>(1, 120, 5.0, EQUAL)).unwrap();
    let found = hash(&mut simulation, &Limits::all_frozen());
    assert_eq!(simulation.mode_counts().frozen, 120);
    assert_eq!(format!("{found:016x}"), "d1cd5b8fb1d57c04");
}

#[test]
fn a_checked_heap_of_all_sizes_in_the_plane() {
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
    let mut simulation = Simulation::new(model, rain_on_base::<2>(2, 60, 12.0, sizes)).unwrap();
    let found = hash(&mut simulation, &Limits::events(60_000));
    assert!(simulation.counts().check > 100);
    assert_eq!(format!("{found:016x}"), "8d9daead6e9a66db");
}

#[test]
fn a_gas_that_cools() {
    let (grains, sides) = gas_grains::<3>(3, 200, 0.2, EQUAL);
    let found = {
        let model = free(Restitution::constant(0.9), sides);
        hash(
            &mut Simulation::new(model, grains).unwrap(),
            &Limits::events(20_000),
        )
    };
    assert_eq!(format!("{found:016x}"), "e82c7a85c2abf60a");
}
