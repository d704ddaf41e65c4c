//! Fig. 2: two grains fall between two fixed ones, wedge each other and form an
//! arch, in two dimensions. They fall asleep one after the other, and either
//! may be the first.
//!
//! That the first may sleep while nothing below but one fixed grain supports it
//! is what makes arches possible: it rests on a neighbour that still moves.
//!
//! cargo run --release --example arch

use grainfall::boundary::Cuboid;
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Occurrence, OccurrenceKind, Parts};
use grainfall::policy::SlowDescent;
use grainfall::predict::Polynomial;
use grainfall::{Particle, ParticleId, SetupError, Time, Vector};

/// Half the distance of the two fixed grains, in d: the gap between them is
/// 1.8 d wide, so two more fit in side by side only if they sit higher up.
const HALF_SPAN: f64 = 1.4;

/// Grains 2 and 3 of the figure start at rest this high above their places in
/// the arch; tells what becomes of them.
fn build(drops: [f64; 2]) -> Result<(), SetupError> {
    println!("grain 2 falls {} d, grain 3 {} d", drops[0], drops[1]);
    // In the arch 2 and 3 touch each other at x = 0, and each touches the fixed
    // grain beside it, at a height that Pythagoras gives.
    let reach = HALF_SPAN - 0.5;
    let height = (1.0 - reach * reach).sqrt();
    let at_rest = Vector::<2>::zeros();
    let grains = vec![
        Particle::fixed(Vector::<2>::new(-HALF_SPAN, 0.0)),
        Particle::new(Vector::<2>::new(-0.5, height + drops[0]), at_rest),
        Particle::new(Vector::<2>::new(0.5, height + drops[1]), at_rest),
        Particle::fixed(Vector::<2>::new(HALF_SPAN, 0.0)),
    ];
    let model = Parts {
        dynamics: UniformGravity::<2>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: SlowDescent::default(),
        boundary: Cuboid::open(),
    };
    let mut simulation = Simulation::new(model, grains)?;

    // A closure that takes an occurrence is an observer.
    let limits = Limits {
        time: Time::from_units(2.0),
        all_frozen: true,
        ..Limits::default()
    };
    simulation.run(&limits, &mut |event: &Occurrence<2>| {
        // The figure counts from 1.
        let (time, name) = (event.time.units(), event.particle.0 + 1);
        if event.kind == OccurrenceKind::Sleep {
            println!("  t = {time:.6}: grain {name} falls asleep");
        }
    });

    let modes = simulation.mode_counts();
    println!(
        "  {} asleep at t = {:.2} after {} collisions of 2 with 3 and {} with the sleeping and \
         fixed ones",
        modes.frozen,
        simulation.time().units(),
        simulation.counts().pair,
        simulation.counts().frozen
    );
    for name in [2, 3] {
        let grain = simulation.particle(ParticleId(name - 1));
        let [x, y] = [grain.position[0], grain.position[1]];
        println!(
            "  grain {name} is {} at ({x:.4}, {y:.4})",
            grain.mode.name()
        );
    }
    Ok(())
}

fn main() -> Result<(), SetupError> {
    // The figure: 2 sleeps in (b), 3 in (c). Then the mirror image.
    build([0.01, 0.02])?;
    build([0.02, 0.01])?;
    // Without friction an arch is not stable: from higher up grain 3 pushes 2
    // through before either has slowed down.
    build([0.05, 0.3])
}
