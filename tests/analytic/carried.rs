//! Fixed grains that are carried along.

use crate::common::{close, free, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::Parabola;
use grainfall::engine::Simulation;
use grainfall::model::{Dynamics, Motion, OccurrenceKind, Parts};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, ParticleId, Time, Vector};

#[test]
fn a_fixed_grain_carried_along_pushes_at_the_right_time() {
    // Without gravity: w = 2, gap 1.5, so at t = 0.75; it leaves with (1 + α) w.
    let carried = Particle {
        velocity: Vector::<2>::new(2.0, 0.0),
        ..Particle::fixed(Vector::<2>::new(1.0, 5.0))
    };
    let rest = Particle::new(Vector::<2>::new(3.5, 5.0), Vector::zeros());
    let model = free(Restitution::constant(0.4), [Side::periodic(10.0); 2]);
    let mut simulation = Simulation::new(model, vec![rest, carried]).unwrap();
    let (_, events) = watch(&mut simulation, &until(20.0));
    close(events[0].time.units(), 0.75, 1.0e-15, "time");
    assert_eq!(events[0].kind, OccurrenceKind::Frozen);
    close(events[0].velocity[0], 2.8, 1.0e-15, "speed");
    close(
        simulation.particle(ParticleId(1)).velocity[0],
        2.0,
        0.0,
        "the fixed one's",
    );
    // It gains 0.8 a unit of time and so meets it again across the face, after
    // 8 d; then it is pushed back: 2 + 0.4 · (−0.8).
    close(events[1].time.units(), 0.75 + 8.0 / 0.8, 1.0e-13, "again");
    close(events[1].velocity[0], 1.68, 1.0e-14, "speed");
}

/// Gravity for all but fixed grains, which are lifted with an acceleration of
/// their own from rest.
#[derive(Clone)]
struct Lift {
    acceleration: f64,
}

impl Dynamics<2> for Lift {
    type Flight = Parabola<2>;

    fn flight(&self, motion: &Motion<2>, since: Time) -> Parabola<2> {
        let upward = match motion.mode {
            Mode::Fixed => self.acceleration,
            _ => -1.0,
        };
        let mut flight = Parabola {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: Vector::<2>::new(0.0, upward),
        };
        if motion.mode == Mode::Fixed {
            flight.velocity[1] = self.acceleration * since.units();
        }
        flight
    }

    fn gravity(&self, _time: Time) -> Vector<2> {
        Vector::<2>::new(0.0, -1.0)
    }
}

#[test]
fn a_fixed_grain_on_a_prescribed_path_pushes_at_the_right_time() {
    let model = Parts {
        dynamics: Lift { acceleration: 3.0 },
        predictor: Polynomial,
        collision_rule: Restitution::constant(0.5),
        state_policy: Never,
        boundary: Cuboid::open(),
    };
    // From 9 to 1 above: the gap of 8 closes as (3 + 1) t²/2, so at t = 2,
    // where the one goes up at 6 and the other down at 2.
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 9.0), Vector::zeros()),
    ];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(2.5));
    assert_eq!(events.len(), 1);
    close(events[0].time.units(), 2.0, 1.0e-15, "time");
    close(events[0].impact_speed, 8.0, 1.0e-14, "closing speed");
    close(events[0].velocity[1], 6.0 + 4.0, 1.0e-14, "speed");
    let piston = simulation.particle(ParticleId(0));
    close(piston.position[1], 1.5 * 6.25, 1.0e-14, "the path");
    // Next: the gap opens at 4 and closes as 4 t²/2, so 2 later.
    let (_, events) = watch(&mut simulation, &until(4.5));
    close(events[0].time.units(), 4.0, 1.0e-14, "time");
}
