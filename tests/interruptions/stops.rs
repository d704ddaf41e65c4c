//! Stopping and being watched.

use crate::common::{deposition, hash, until};
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Observer, Occurrence, OccurrenceKind, Surroundings};
use grainfall::observe::TrajectoryHash;
use grainfall::setup::{Sizes, seeded};
use grainfall::{ParticleId, Time};
use rand::RngExt;

/// A small heap in the making, and when to stop.
fn scene() -> (Simulation<impl Model<3>, 3>, f64) {
    (deposition(2, 60, 4.0, Sizes::default()), 25.0)
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
    assert_eq!(stopped.snapshot(), through.snapshot());
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
    assert_eq!(stopped.snapshot(), through.snapshot());
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
    assert_eq!(alone.snapshot(), watched.snapshot());
    let (mut hashed, _) = scene();
    assert_eq!(hash(&mut hashed, &until(end)), observers.1.value());
}
