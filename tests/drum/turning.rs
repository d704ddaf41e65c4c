//! Gravity that turns, and ground that does: flights, contacts, and what must not matter.

use crate::common::{close, until, watch};
use crate::events::with_events;
use crate::{DOWN, filled, model, policy, ring};
use grainfall::dynamics::{Trochoid, TurningGravity, TurningGround};
use grainfall::engine::Simulation;
use grainfall::model::{Dynamics, OccurrenceKind};
use grainfall::policy::{Never, SlowDescent};
use grainfall::{Mode, Particle, Vector};

/// A grain that flies and bounces in a ring, while gravity turns.
fn thrown<Y: Dynamics<2, Flight = Trochoid<2>>>(dynamics: Y) -> (Vector<2>, usize) {
    let mut grains = ring();
    let start = Vector::<2>::new(0.3, 1.0);
    grains.push(Particle::new(start, Vector::<2>::new(0.4, 0.0)));
    let mut simulation = Simulation::new(model(dynamics, Never), grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(7.0));
    let last = simulation.snapshot().pop().unwrap();
    (last.position, events.len())
}

#[test]
fn steps_converge_at_first_order() {
    let gravity = TurningGravity::new(DOWN, 0.4, [0, 1]);
    let (exact, bounces) = thrown(gravity);
    assert!(bounces >= 2, "{bounces}");
    let off = |step: f64| (thrown(gravity.in_steps(step)).0 - exact).norm();
    let errors: Vec<f64> = [0.02, 0.01, 0.005, 0.0025, 0.00125].map(off).to_vec();
    println!("errors of steps from 0.02, halved four times: {errors:?}");
    for pair in errors.windows(2).skip(2) {
        let ratio = pair[0] / pair[1];
        assert!((1.9..2.1).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn what_is_carried_stays_on_its_circle() {
    let centre = Vector::<2>::new(1.0, 2.0);
    let ground = TurningGround::new(DOWN, 0.7, [0, 1], centre);
    let mut grain = Particle::fixed(Vector::<2>::new(4.0, -2.0));
    grain.mode = Mode::Frozen;
    let mut simulation = Simulation::new(model(ground, Never), vec![grain]).unwrap();
    let time = 1000.0;
    simulation.run(&until(time), &mut ());
    let grain = simulation.snapshot()[0];
    let (sin, cos) = libm::sincos(0.7 * time);
    let place = centre + Vector::<2>::new(3.0 * cos + 4.0 * sin, 3.0 * sin - 4.0 * cos);
    close((grain.position - place).norm(), 0.0, 1.0e-11, "place");
    let radius = grain.position - centre;
    let speed = Vector::<2>::new(-0.7 * radius.y, 0.7 * radius.x);
    close((grain.velocity - speed).norm(), 0.0, 1.0e-11, "velocity");
}

/// The first contact of a grain thrown across a drum that turns, against the
/// distances of its parabola from the circles of the wall's grains, step by step.
#[test]
fn a_wall_that_turns_is_met_where_it_is() {
    let rate = -0.9;
    let ground = TurningGround::new(DOWN, rate, [0, 1], Vector::<2>::zeros());
    let mut grains = ring();
    let wall = grains.clone();
    let (start, velocity) = (Vector::<2>::new(-1.0, 0.5), Vector::<2>::new(2.0, 1.5));
    grains.push(Particle::new(start, velocity));
    let mut simulation = Simulation::new(model(ground, Never), grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(5.0));
    let gap = |time: f64| {
        let place = start + velocity * time + DOWN * (0.5 * time * time);
        let (sin, cos) = libm::sincos(rate * time);
        let apart = wall.iter().map(|grain| {
            let (x, y) = (grain.position.x, grain.position.y);
            (place - Vector::<2>::new(x * cos - y * sin, x * sin + y * cos)).norm() - 1.0
        });
        apart.fold(f64::INFINITY, f64::min)
    };
    let first = events.first().unwrap();
    assert_eq!(first.kind, OccurrenceKind::Frozen);
    let time = first.time.units();
    close(gap(time), 0.0, 1.0e-13, "gap");
    for step in 0..10_000 {
        assert!(gap(time * f64::from(step) / 10_000.0) > 0.0);
    }
}

/// The other way round, left is right and right is left, to the last bit.
#[test]
fn mirrored_drums_turn_the_other_way() {
    let mirrored = |position: Vector<2>| Vector::<2>::new(-position.x, position.y);
    let grains = filled();
    let mut other = grains.clone();
    for grain in &mut other {
        grain.position = mirrored(grain.position);
    }
    let run = |policy: SlowDescent, rate: f64, grains: &[Particle<2>], end: f64| {
        let gravity = TurningGravity::new(DOWN, rate, [0, 1]);
        let model = model(gravity, policy);
        let mut simulation = Simulation::new(model, grains.to_vec()).unwrap();
        let (_, events) = watch(&mut simulation, &until(end));
        (simulation.snapshot(), events)
    };
    for (policy, end) in [(policy(), 12.0), (with_events(), 6.0)] {
        let (here, events) = run(policy, 0.25, &grains, end);
        let (there, mirrored_events) = run(policy, -0.25, &other, end);
        assert!(
            events
                .iter()
                .any(|event| event.kind == OccurrenceKind::CheckWake)
        );
        assert!(events.len() > 1000);
        assert_eq!(events.len(), mirrored_events.len());
        for (event, other) in events.iter().zip(&mirrored_events) {
            assert_eq!(
                (event.kind, event.particle, event.other),
                (other.kind, other.particle, other.other)
            );
            assert_eq!(event.time, other.time);
        }
        for (grain, other) in here.iter().zip(&there) {
            assert_eq!(grain.position, mirrored(other.position));
        }
    }
}

/// Who is called the first changes nothing: each grain's speeds count from the
/// ground where it is itself.
#[test]
fn names_do_not_matter_where_the_ground_turns() {
    let mut grains = filled();
    for (place, grain) in grains.iter_mut().enumerate() {
        if grain.mode == Mode::Frozen && place % 2 == 0 {
            grain.mode = Mode::Normal;
        }
    }
    let last = grains.len() as u32 - 1;
    let run = |grains: Vec<Particle<2>>| {
        let ground = TurningGround::new(DOWN, 0.4, [0, 1], Vector::<2>::zeros());
        let policy = SlowDescent::with_threshold(0.2);
        let mut simulation = Simulation::new(model(ground, policy), grains).unwrap();
        let (_, events) = watch(&mut simulation, &until(3.0));
        let sleeps = events.iter().filter(|e| e.kind == OccurrenceKind::Sleep);
        let sleeps: Vec<(u32, _)> = sleeps.map(|e| (e.particle.0, e.time)).collect();
        (simulation.snapshot(), sleeps)
    };
    let (here, sleeps) = run(grains.clone());
    grains.reverse();
    let (mut there, other_sleeps) = run(grains);
    there.reverse();
    assert!(sleeps.len() > 20, "{}", sleeps.len());
    for (sleep, other) in sleeps.iter().zip(&other_sleeps) {
        assert_eq!((sleep.0, sleep.1), (last - other.0, other.1));
    }
    for (grain, other) in here.iter().zip(&there) {
        assert_eq!(grain.position, other.position);
    }
}
