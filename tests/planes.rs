//! Disks are spheres whose centres stay in a plane: a run in two dimensions is
//! one in three, event for event and bit for bit.

mod common;

use common::{free, gas_grains, heavy, rain_on_base, rule, watch, what};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind, Parts};
use grainfall::policy::{Comparison, SelfCheck, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::setup::Sizes;
use grainfall::{Particle, Vector};

const MIXED: Sizes = Sizes::Uniform {
    least: 0.6,
    most: 1.2,
};

/// A vector of the plane with a third component.
fn lifted(flat: &Vector<2>, depth: f64) -> Vector<3> {
    Vector::<3>::new(flat[0], flat[1], depth)
}

/// The same grains as spheres that all lie at one depth.
fn spheres(disks: &[Particle<2>]) -> Vec<Particle<3>> {
    disks
        .iter()
        .map(|disk| Particle {
            position: lifted(&disk.position, 0.37),
            velocity: lifted(&disk.velocity, 0.0),
            diameter: disk.diameter,
            mass: disk.mass,
            mode: disk.mode,
        })
        .collect()
}

/// Runs both and compares all that happens; returns the events in the plane.
fn are_the_same(
    mut flat: Simulation<impl Model<2>, 2>,
    mut deep: Simulation<impl Model<3>, 3>,
    limits: &Limits,
) -> (StopReason, Vec<Occurrence<2>>) {
    let (why, events) = watch(&mut flat, limits);
    let (why_deep, events_deep) = watch(&mut deep, limits);
    for (place, (one, two)) in events.iter().zip(&events_deep).enumerate() {
        assert_eq!(what(one), what(two), "event {place}");
        assert_eq!(one.time, two.time, "event {place}");
        assert_eq!(lifted(&one.velocity, 0.0), two.velocity, "event {place}");
        let speeds = (one.impact_speed, two.impact_speed);
        assert_eq!(speeds.0, speeds.1, "event {place}");
    }
    assert_eq!(events.len(), events_deep.len());
    assert_eq!(why, why_deep);
    assert_eq!(flat.counts().total(), deep.counts().total());
    assert_eq!(flat.counts().check, deep.counts().check);
    let (disks, balls) = (flat.snapshot(), deep.snapshot());
    assert_eq!(spheres(&disks), balls);
    (why, events)
}

fn sides_in_space([x, y]: [Side; 2], depth: Side) -> [Side; 3] {
    [x, y, depth]
}

#[test]
fn a_gas_of_disks_is_one_of_spheres_in_a_plane() {
    let (disks, sides) = gas_grains::<2>(9, 150, 0.4, MIXED);
    let rule = Restitution::constant(0.9);
    for depth in [Side::Open, Side::periodic(4.0)] {
        let deep =
            Simulation::new(free(rule, sides_in_space(sides, depth)), spheres(&disks)).unwrap();
        let flat = Simulation::new(free(rule, sides), disks.clone()).unwrap();
        are_the_same(flat, deep, &Limits::events(20_000));
    }
}

#[test]
fn a_heap_of_disks_is_one_of_spheres_in_a_plane() {
    let disks = rain_on_base::<2>(4, 120, 14.0, MIXED);
    let sides = [Side::periodic(14.0), Side::Open];
    let policy = SlowDescent {
        self_check: Some(SelfCheck::default()),
        comparison: Comparison::AnyCollision,
        ..SlowDescent::default()
    };
    let flat = Simulation::new(heavy(rule(1.0e-3), policy, sides), disks.clone()).unwrap();
    let model = Parts {
        dynamics: UniformGravity::new(Vector::<3>::new(0.0, -1.0, 0.0)),
        predictor: Polynomial,
        collision_rule: rule(1.0e-3),
        state_policy: policy,
        boundary: Cuboid::new(sides_in_space(sides, Side::Open)).unwrap(),
    };
    let deep = Simulation::new(model, spheres(&disks)).unwrap();
    let (why, events) = are_the_same(flat, deep, &Limits::events(150_000));
    println!("{why:?} after {} events", events.len());
    // All that can happen has happened.
    for kind in [
        OccurrenceKind::Pair,
        OccurrenceKind::Frozen,
        OccurrenceKind::Wake,
        OccurrenceKind::Sleep,
        OccurrenceKind::CheckWake,
    ] {
        assert!(events.iter().any(|event| event.kind == kind), "{kind:?}");
    }
}
