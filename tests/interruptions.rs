//! Stopping, looking and inserting leave no trace in a trajectory.

mod common;

use common::{deposition, hash, heavy, rain_on_base, rule, until, watch, what};
use grainfall::boundary::Side;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Observer, Occurrence, OccurrenceKind, Surroundings};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::SlowDescent;
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
