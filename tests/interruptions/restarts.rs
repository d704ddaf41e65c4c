//! Saved, restored and gone on from: the same run, to the last bit of its state.

use crate::common::{free, gas_grains, heavy, periodic_laterally, rain_on_base, rule, until};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, Growing};
use grainfall::engine::{Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Model, Place};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{
    Comparison, DescentRead, EnergyStore, Phase, SelfCheck, SlowDescent, SpeedRead, StoreAt,
    Timing, WakeRead,
};
use grainfall::setup::{Sizes, seeded};
use rand::RngExt;

/// Everything there is to a simulation, as bytes.
pub(crate) fn bytes<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> Vec<u8> {
    postcard::to_stdvec(&simulation.save()).unwrap()
}

/// What has been under way when a simulation was saved.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    saves: u32,
    falling: u32,
    frozen: u32,
    /// Saved just before a grain fell asleep half-way.
    half_way: u32,
    /// How often a self-check woke a grain.
    check_wake: u64,
    largest: usize,
}

/// Runs through, and again with a new simulation in place of the old one at
/// random times and after random numbers of events: all the same, to the last
/// bit of what is saved.
fn restart<M: Model<D> + Clone, const D: usize>(
    start: &Simulation<M, D>,
    model: &M,
    end: f64,
    seed: u64,
) -> Met {
    let mut through = Simulation::restore(model.clone(), start.save()).unwrap();
    assert_eq!(bytes(&through), bytes(start));
    let mut straight = TrajectoryHash::new();
    through.run(&until(end), &mut straight);

    let mut rng = seeded(seed);
    let mut hash = TrajectoryHash::new();
    let mut met = Met::default();
    let mut simulation = Simulation::restore(model.clone(), start.save()).unwrap();
    let share = 0.04 * through.counts().total() as f64;
    loop {
        let part: f64 = rng.random();
        let time = simulation.time().units() + 0.08 * end * part * part;
        let events = simulation.counts().total() + 1 + (share * rng.random::<f64>()) as u64;
        let limits = Limits {
            events,
            ..until(time.min(end))
        };
        let why = simulation.run(&limits, &mut hash);
        let saved = bytes(&simulation);
        let state = postcard::from_bytes(&saved).unwrap();
        let mut again = Simulation::restore(model.clone(), state).unwrap();
        assert_eq!(bytes(&again), saved, "what is restored is what was saved");
        assert_eq!(again.snapshot(), simulation.snapshot());
        assert_eq!(again.mode_counts(), simulation.mode_counts());
        met.saves += 1;
        met.falling += u32::from(again.mode_counts().falling > 0);
        met.frozen += u32::from(again.mode_counts().frozen > 0);
        met.largest = met.largest.max(saved.len());
        if why == StopReason::Time && time >= end {
            break;
        }
        // The next event alone, to see what was about to happen.
        let sleeps = again.counts().sleep;
        let next = Limits {
            events: again.counts().total() + 1,
            ..until(end)
        };
        again.run(&next, &mut hash);
        met.half_way += u32::from(again.counts().sleep > sleeps);
        simulation = again;
    }
    assert_eq!(hash.value(), straight.value());
    assert_eq!(simulation.counts(), through.counts());
    assert_eq!(simulation.max_overlap(), through.max_overlap());
    assert!(
        bytes(&simulation) == bytes(&through),
        "the last states differ"
    );
    met.check_wake = through.counts().check_wake;
    met
}

/// The paper's policy with each group of its options.
pub(crate) fn policies() -> Vec<SlowDescent> {
    let base = SlowDescent::default();
    let check = |phase, support_normals| {
        Some(SelfCheck {
            phase,
            support_normals,
            ..SelfCheck::default()
        })
    };
    vec![
        base,
        SlowDescent {
            energy_store: EnergyStore::EnergyAfter,
            store_at: StoreAt::Deciding,
            self_check: check(Phase::Spread { seed: 3 }, true),
            ..base
        },
        SlowDescent {
            energy_store: EnergyStore::Off,
            store_time: Some(0.5),
            speed_read: SpeedRead::Leaving,
            descent_read: DescentRead::Both,
            keep_history: true,
            self_check: check(Phase::Own, false),
            ..base
        },
        SlowDescent {
            comparison: Comparison::StaticCollisions,
            wake_read: WakeRead::Relative,
            store_time: Some(5.0),
            self_check: check(Phase::Global, true),
            ..base
        },
        SlowDescent {
            place: Place::Here,
            comparison: Comparison::None,
            wall_supports: true,
            ..SlowDescent::with_threshold(0.05)
        },
        SlowDescent {
            self_check: Some(SelfCheck {
                timing: Timing::Events,
                ..SelfCheck::default()
            }),
            ..base
        },
    ]
}

fn restart_of_heaps<const D: usize>(count: usize, width: f64, end: f64) {
    let mut all = Met::default();
    for (number, policy) in policies().into_iter().enumerate() {
        let seed = number as u64;
        let sizes = if number % 2 == 0 {
            Sizes::default()
        } else {
            Sizes::Uniform {
                least: 0.7,
                most: 1.3,
            }
        };
        let grains = rain_on_base::<D>(seed, count, width, sizes);
        let model = heavy(rule(1.0e-3), policy, periodic_laterally(width));
        let guards = if number == 3 {
            Guards::floor_and_hold(1.0e-5, 1.0e-3)
        } else {
            Guards::default()
        };
        let settings = Settings {
            guards,
            ..Settings::default()
        };
        let start = Simulation::with_settings(model.clone(), grains, settings).unwrap();
        let met = restart(&start, &model, end, seed);
        assert!(met.falling > 0 && met.frozen > 0, "{policy:?}: {met:?}");
        all.saves += met.saves;
        all.half_way += met.half_way;
        all.check_wake += met.check_wake;
    }
    assert!(all.half_way > 0 && all.check_wake > 0, "{all:?}");
}

#[test]
fn a_heap_in_the_plane_goes_on_as_if_never_stopped() {
    restart_of_heaps::<2>(60, 10.0, 14.0);
}

#[test]
fn a_heap_in_space_goes_on_as_if_never_stopped() {
    restart_of_heaps::<3>(60, 4.0, 14.0);
}

fn restart_of_gases<const D: usize>(seed: u64) {
    for (restitution, growth) in [(1.0, None), (0.8, None), (1.0, Some(0.02))] {
        let (grains, sides) = gas_grains::<D>(
            seed,
            60,
            0.2,
            Sizes::Uniform {
                least: 0.5,
                most: 1.0,
            },
        );
        let rule = Restitution {
            restitution,
            frozen_restitution: restitution,
            ..Restitution::elastic()
        };
        let free = free(rule, sides);
        match growth {
            None => {
                let start = Simulation::new(free.clone(), grains).unwrap();
                restart(&start, &free, 5.0, seed);
            }
            Some(rate) => {
                let model = free.with_dynamics(Growing::new(ForceFree, rate));
                let start = Simulation::new(model.clone(), grains).unwrap();
                restart(&start, &model, 4.0, seed);
            }
        }
    }
}

#[test]
fn gases_go_on_as_if_never_stopped() {
    restart_of_gases::<2>(4);
    restart_of_gases::<3>(5);
}
