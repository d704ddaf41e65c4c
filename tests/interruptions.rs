//! Stopping, looking, saving and inserting leave no trace in a trajectory.

mod common;
#[cfg(feature = "program")]
#[path = "common/mutate.rs"]
mod mutate;

use common::{
    deposition, free, gas_grains, hash, heavy, periodic_laterally, rain_on_base, rule, until,
    watch, what,
};
use grainfall::boundary::Side;
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, Growing};
use grainfall::engine::{Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Model, Observer, Occurrence, OccurrenceKind, Place, Surroundings};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{
    Comparison, DescentRead, EnergyStore, Phase, SelfCheck, SlowDescent, SpeedRead, StoreAt,
    Timing, WakeRead,
};
use grainfall::setup::{Sizes, seeded};
use grainfall::{Mode, Particle, ParticleId, SetupError, Time, Vector};
use rand::RngExt;

/// A small heap in the making, and when to stop.
fn scene() -> (Simulation<impl Model<3>, 3>, f64) {
    (deposition(2, 60, 4.0, Sizes::default()), 25.0)
}

/// A hash of what is left at the end: positions, velocities and modes.
fn state<M: Model<3>>(simulation: &Simulation<M, 3>) -> Vec<Particle<3>> {
    simulation.snapshot()
}

#[test]
fn stops_at_times_leave_no_trace() {
    let (mut through, end) = scene();
    let straight = hash(&mut through, &until(end));
    let (mut stopped, _) = scene();
    let mut rng = seeded(8);
    let mut hash = TrajectoryHash::new();
    let mut time = 0.0;
    let mut stops = 0;
    while time < end {
        // Some stops close to each other, some far apart.
        let part: f64 = rng.random();
        time = f64::min(end, time + 0.2 * part * part);
        let why = stopped.run(&until(time), &mut hash);
        assert_eq!(why, StopReason::Time);
        assert_eq!(stopped.time(), Time::from_units(time));
        // Going back is not possible and does nothing.
        assert_eq!(stopped.run(&until(0.5 * time), &mut hash), StopReason::Time);
        assert_eq!(stopped.time(), Time::from_units(time));
        stops += 1;
    }
    assert!(stops > 200);
    assert_eq!(hash.value(), straight);
    assert_eq!(stopped.counts(), through.counts());
    assert_eq!(state(&stopped), state(&through));
}

#[test]
fn stops_after_events_leave_no_trace() {
    let (mut through, end) = scene();
    let straight = hash(&mut through, &until(end));
    let (mut stopped, _) = scene();
    let mut hash = TrajectoryHash::new();
    for total in 1.. {
        let limits = Limits {
            events: 7 * total,
            ..until(end)
        };
        match stopped.run(&limits, &mut hash) {
            StopReason::Events => assert_eq!(stopped.counts().total(), 7 * total),
            why => {
                assert_eq!(why, StopReason::Time);
                break;
            }
        }
    }
    assert_eq!(hash.value(), straight);
    assert_eq!(state(&stopped), state(&through));
}

/// Looks at everything it is shown.
#[derive(Default)]
struct Curious {
    seen: f64,
    events: u64,
}

impl Observer<3> for Curious {
    fn observe<S: Surroundings<3>>(&mut self, occurrence: &Occurrence<3>, after: &S) {
        // What the guards do is told, but is no physical event.
        self.events += u64::from(occurrence.kind != OccurrenceKind::Guard);
        assert_eq!(after.time(), occurrence.time);
        let of = occurrence.particle;
        self.seen += after.gravity().norm();
        after.for_each_neighbour(of, 1.5, |other| self.seen += other.relative_distance);
        after.for_each_wall(of, 1.0, |wall| self.seen += wall.gap);
        let shown = after.particle(of).velocity;
        assert_eq!(shown, occurrence.velocity, "as it is told");
    }
}

#[test]
fn being_watched_leaves_no_trace() {
    let (mut alone, end) = scene();
    alone.run(&until(end), &mut ());
    let (mut watched, _) = scene();
    let mut observers = (Curious::default(), TrajectoryHash::new());
    for step in 1..=100 {
        watched.run(&until(end * f64::from(step) / 100.0), &mut observers);
        let grains = watched.snapshot();
        assert_eq!(grains[3], watched.particle(ParticleId(3)));
        assert!(watched.kinetic_energy().is_finite() && watched.potential_energy().is_finite());
    }
    assert!(observers.0.seen > 0.0);
    assert_eq!(observers.0.events, alone.counts().total());
    assert_eq!(alone.counts(), watched.counts());
    assert_eq!(state(&alone), state(&watched));
    let (mut hashed, _) = scene();
    assert_eq!(hash(&mut hashed, &until(end)), observers.1.value());
}

/// A few grains on a base, in two dimensions, and one that comes last.
fn bed_and_late_one() -> (Vec<Particle<2>>, Particle<2>) {
    let grains = rain_on_base::<2>(6, 12, 8.0, Sizes::default());
    // Binary fractions: it is at exactly this place at any quarter of time.
    let late = Particle::new(Vector::<2>::new(3.25, 14.5), Vector::<2>::new(0.0, -2.5))
        .with_mode(Mode::Falling);
    (grains, late)
}

fn bed(grains: Vec<Particle<2>>) -> Simulation<impl Model<2>, 2> {
    let sides = [Side::periodic(8.0), Side::Open];
    Simulation::new(heavy(rule(1.0e-3), SlowDescent::default(), sides), grains).unwrap()
}

#[test]
fn a_grain_inserted_on_its_way_is_one_that_was_there_from_the_start() {
    let (mut grains, late) = bed_and_late_one();
    // A shower, so that one of them fell freely until then, for long.
    for grain in &mut grains {
        if grain.mode == Mode::Falling {
            grain.position[1] += 4.0;
        }
    }
    let mut whole = grains.clone();
    whole.push(late);
    let (_, wanted) = watch(&mut bed(whole), &until(30.0));

    let mut simulation = bed(grains);
    let (_, mut found) = watch(&mut simulation, &until(0.75));
    let mut now = late;
    now.position[1] -= 2.5 * 0.75;
    let id = simulation.insert(now).unwrap();
    assert_eq!(id.index(), simulation.snapshot().len() - 1);
    found.extend(watch(&mut simulation, &until(30.0)).1);

    let mut touched = 0;
    // A dense heap doubles an error at every collision: hold the first ones to
    // it, among which the late one has had its part.
    for (place, (one, two)) in wanted.iter().zip(&found).take(150).enumerate() {
        assert_eq!(what(one), what(two), "event {place}");
        let off = (one.time - two.time).abs();
        assert!(off < 1.0e-9, "event {place} off by {off:e}");
        touched += usize::from(one.particle == id || one.other == Some(id));
    }
    assert!(touched > 2, "the late one took part {touched} times");
}

#[test]
fn a_refused_grain_leaves_no_trace() {
    let (grains, late) = bed_and_late_one();
    let mut through = bed(grains.clone());
    let straight = hash(&mut through, &until(10.0));

    let mut refusing = bed(grains);
    let mut hash = TrajectoryHash::new();
    refusing.run(&until(3.0), &mut hash);
    let there = refusing.particle(ParticleId(0));
    let refused = [
        (late.with_mass(-1.0), "mass"),
        (late.with_diameter(f64::NAN), "diameter"),
        (late.with_diameter(1.5), "diameter"),
    ];
    for (grain, wanted) in refused {
        let error = refusing.insert(grain).unwrap_err();
        let SetupError::Particle { field, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(field, wanted);
    }
    let onto = Particle {
        position: there.position + Vector::<2>::new(0.25, 0.0),
        ..late
    };
    let error = refusing.insert(onto).unwrap_err();
    assert!(
        matches!(
            error,
            SetupError::Overlap {
                first: ParticleId(0),
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(refusing.snapshot().len(), refusing.mode_counts().total());
    refusing.run(&until(10.0), &mut hash);
    assert_eq!(hash.value(), straight);
}

/// Everything there is to a simulation, as bytes.
fn bytes<M: Model<D>, const D: usize>(simulation: &Simulation<M, D>) -> Vec<u8> {
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
fn policies() -> Vec<SlowDescent> {
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
