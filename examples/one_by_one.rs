//! The end of section 3: grains that are dropped one by one pack more loosely
//! than a rain, because no layer of moving grains shakes those below into place.
//!
//! cargo run --release --example one_by_one         (200 grains)
//! cargo run --release --example one_by_one 1500    (enough to compare with the paper)

use grainfall::analysis::{highest_surface, packing_fraction};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::Parts;
use grainfall::policy::SlowDescent;
use grainfall::predict::Polynomial;
use grainfall::setup::{Base, OneByOne, seeded};
use grainfall::{Particle, Vector};

/// Edge of the square base, in d.
const WIDTH: f64 = 6.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count: usize = std::env::args()
        .nth(1)
        .map_or(Ok(200), |text| text.parse())?;

    let mut rng = seeded(1);
    let base = Base::<3> {
        lengths: Vector::<3>::new(WIDTH, WIDTH, 2.0),
        ..Base::default()
    }
    .grains(&mut rng)?;
    let source = OneByOne::<3> {
        lengths: Vector::<3>::new(WIDTH, WIDTH, 0.0),
        ..OneByOne::default()
    };

    // V_wakeup = ∞: who sleeps, sleeps for ever, as in the bottom-to-top method
    // this imitates.
    let model = Parts {
        dynamics: UniformGravity::<3>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: SlowDescent {
            sleep_speed: 0.05,
            wake_speed: f64::INFINITY,
            ..SlowDescent::default()
        },
        boundary: Cuboid::new([Side::periodic(WIDTH), Side::periodic(WIDTH), Side::Open])?,
    };
    let mut simulation = Simulation::new(model, base)?;

    for dropped in 1..=count {
        // 2 d above the highest surface, at a random place. A grain takes the
        // next free name.
        let top = highest_surface(&simulation.snapshot()).unwrap_or(0.0);
        simulation.insert(source.grain(top, &mut rng)?)?;
        match simulation.run(&Limits::all_frozen(), &mut ()) {
            StopReason::AllFrozen => {}
            other => return Err(format!("grain {dropped} did not come to rest: {other:?}").into()),
        }
        if dropped % (count / 5).max(1) == 0 {
            println!(
                "{dropped:5} grains, {:4.0} collisions each, top at {:.2} d",
                simulation.counts().total() as f64 / dropped as f64,
                highest_surface(&simulation.snapshot()).unwrap_or(0.0)
            );
        }
    }

    let heap: Vec<Particle<3>> = simulation.snapshot();
    if let Some(slab) = packing_fraction(&heap, WIDTH * WIDTH) {
        println!(
            "φ = {:.4} between z = {:.2} and {:.2}; the paper has 0.586, and 0.63 for the rain",
            slab.value, slab.from, slab.to
        );
    }
    Ok(())
}
