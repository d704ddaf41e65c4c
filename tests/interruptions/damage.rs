//! States that have been tampered with.

use crate::common::{heavy, periodic_laterally, rain_on_base, rule, until};
#[cfg(feature = "program")]
use crate::mutate;
use crate::restarts::{bytes, policies};
use grainfall::engine::Simulation;
use grainfall::setup::{Sizes, seeded};
use rand::RngExt;

/// What has been tampered with is refused or taken, and never a panic: so many
/// states behind the checksum, which `restore` has to judge, and as many files,
/// none of which may be taken for a checkpoint.
fn damage(seed: u64, count: u32) {
    let policy = policies().swap_remove(1);
    let model = heavy(rule(1.0e-3), policy, periodic_laterally::<2>(8.0));
    let grains = rain_on_base::<2>(1, 20, 8.0, Sizes::default());
    let mut simulation = Simulation::new(model.clone(), grains).unwrap();
    simulation.run(&until(8.0), &mut ());
    let good = bytes(&simulation);
    let mut rng = seeded(seed);
    let (mut unread, mut refused, mut taken) = (0, 0, 0);
    for _ in 0..count {
        let mut damaged = good.clone();
        for _ in 0..1 + rng.random_range(0..3) {
            let place = rng.random_range(0..damaged.len().max(1));
            if damaged.is_empty() {
                break;
            }
            match rng.random_range(0..4) {
                0 => damaged[place] ^= 1 << rng.random_range(0..8),
                1 => damaged[place] = rng.random(),
                2 => drop(damaged.remove(place)),
                _ => damaged.truncate(place.max(1)),
            }
        }
        match postcard::from_bytes(&damaged) {
            Err(_) => unread += 1,
            Ok(state) => match Simulation::restore(model.clone(), state) {
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
                Ok(_) => taken += 1,
            },
        }
    }
    assert!(
        [unread, refused, taken]
            .iter()
            .all(|&some| some > count / 40),
        "{unread} {refused} {taken}"
    );
    // A state of another model.
    let other = heavy(rule(1.0e-3), policy, periodic_laterally::<2>(9.0));
    let state = postcard::from_bytes(&good).unwrap();
    let error = Simulation::restore(other, state).err().unwrap();
    assert!(error.to_string().contains("box"), "{error}");

    #[cfg(feature = "program")]
    {
        use grainfall::output::Checkpoint;
        let whole = Checkpoint::new(b"seed = 1", good).to_bytes();
        for _ in 0..count {
            let mut damaged = whole.clone();
            mutate::mutate_bytes(&mut damaged, &mut rng);
            assert!(damaged == whole || Checkpoint::from_bytes(&damaged).is_err());
        }
    }
}

#[test]
fn damaged_states_are_refused() {
    damage(5, 6_000);
}

/// cargo test --test interruptions damaged -- --ignored
#[test]
#[ignore = "two million of them take half a minute"]
fn two_million_damaged_ones_are_refused() {
    damage(6, 1_000_000);
}
