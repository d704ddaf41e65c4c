//! Drums: how they are made, gravity that turns, and ground that does.

#[path = "../common/mod.rs"]
mod common;

mod events;
mod made;
mod turning;

use common::{hash, rule, until};
use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::{Trochoid, TurningGravity, TurningGround};
use grainfall::engine::Simulation;
use grainfall::model::{Dynamics, Parts, StatePolicy};
use grainfall::policy::{SelfCheck, SlowDescent};
use grainfall::predict::Turning;
use grainfall::setup::{Drum, seeded};
use grainfall::{Particle, Vector};

type Turned<Y, S> = Parts<Y, Turning, grainfall::collide::Restitution, S, Cuboid<2>>;

fn model<Y: Dynamics<2, Flight = Trochoid<2>>, S: StatePolicy<2>>(
    dynamics: Y,
    policy: S,
) -> Turned<Y, S> {
    Parts {
        dynamics,
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: policy,
        boundary: Cuboid::new([Side::Open, Side::Open]).unwrap(),
    }
}

fn policy() -> SlowDescent {
    SlowDescent {
        self_check: Some(SelfCheck::default()),
        ..SlowDescent::with_threshold(0.2)
    }
}

fn drum() -> Drum {
    Drum {
        radius: 5.0,
        rings: 1,
        ..Drum::default()
    }
}

fn ring() -> Vec<Particle<2>> {
    drum().wall::<2>().unwrap()
}

fn filled() -> Vec<Particle<2>> {
    drum().grains::<2>(&mut seeded(3)).unwrap()
}

const DOWN: Vector<2> = Vector::<2>::new(0.0, -1.0);

/// Pinned: a change of these is a change of the physics, or of a last digit.
#[test]
fn pinned_drums() {
    let mut gravity = {
        let gravity = TurningGravity::new(DOWN, 0.25, [0, 1]);
        Simulation::new(model(gravity, policy()), filled()).unwrap()
    };
    let mut ground = {
        let ground = TurningGround::new(DOWN, -0.25, [0, 1], Vector::<2>::zeros());
        Simulation::new(model(ground, policy()), filled()).unwrap()
    };
    let found = [
        hash(&mut gravity, &until(10.0)),
        hash(&mut ground, &until(10.0)),
    ];
    let text = found.map(|hash| format!("{hash:016x}"));
    assert_eq!(text, ["ca369dada54737c7", "8f7f2d837d880a22"]);
}
