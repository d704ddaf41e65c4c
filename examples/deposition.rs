//! Figs 3 to 5: a rain of grains on a rough base, until all of them sleep.
//!
//! cargo run --release --example deposition            (400 grains, V_t = 0.1)
//! cargo run --release --example deposition 4800 0.1   (the paper's)
//!
//! Few grains and a coarse elastic cut-off keep this quick. The paper's own
//! cut-off, V_c = 1e-4, gives the same packing from about four times as many
//! collisions.

use grainfall::analysis::{highest_surface, packing_fraction};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::Parts;
use grainfall::policy::SlowDescent;
use grainfall::predict::Polynomial;
use grainfall::setup::{Base, Rain, seeded};
use grainfall::{Mode, Time, Vector};

/// Edge of the square base, in d.
const WIDTH: f64 = 10.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(Ok(400), |text| text.parse())?;
    let threshold: f64 = arguments.next().map_or(Ok(0.1), |text| text.parse())?;

    // A rough base, so that no crystal grows from below, and the rain above it,
    // both from one seed. The lowest grain of the rain starts where the base
    // ends.
    let mut rng = seeded(1);
    let base = Base::<3> {
        lengths: Vector::<3>::new(WIDTH, WIDTH, 2.0),
        ..Base::default()
    }
    .grains(&mut rng)?;
    let top = highest_surface(&base).unwrap_or(0.0);
    let rain = Rain::<3> {
        count,
        lengths: Vector::<3>::new(WIDTH, WIDTH, 0.0),
        origin: Vector::<3>::new(0.0, 0.0, top),
        ..Rain::default()
    };
    let mut grains = base;
    grains.extend(rain.grains(&mut rng)?);

    // The paper's model, with V_sleep = V_wakeup = V_t.
    let model = Parts {
        dynamics: UniformGravity::<3>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::default()
        },
        state_policy: SlowDescent {
            sleep_speed: threshold,
            wake_speed: threshold,
            ..SlowDescent::default()
        },
        boundary: Cuboid::new([Side::periodic(WIDTH), Side::periodic(WIDTH), Side::Open])?,
    };
    let mut simulation = Simulation::new(model, grains)?;

    // Fig. 3: while the heap grows, the number of normal grains stays about
    // constant. Fig. 4: they lie in a layer on top. Fig. 5: so the cost, here in
    // events, grows no faster than the time.
    println!("   t   falling  normal  frozen   layer of normal grains    events");
    let mut time = 0.0;
    loop {
        time += 5.0;
        let limits = Limits {
            time: Time::from_units(time),
            all_frozen: true,
            ..Limits::default()
        };
        let reason = simulation.run(&limits, &mut ());
        let modes = simulation.mode_counts();
        let mut heights: Vec<f64> = simulation
            .snapshot()
            .iter()
            .filter(|grain| grain.mode == Mode::Normal)
            .map(|grain| grain.position[2])
            .collect();
        heights.sort_by(f64::total_cmp);
        let layer = match (heights.first(), heights.last()) {
            (Some(low), Some(high)) => format!("z = {low:5.2} … {high:5.2}"),
            _ => "none".to_owned(),
        };
        println!(
            "{:6.1} {:7} {:7} {:7}   {layer:22} {:10}",
            simulation.time().units(),
            modes.falling,
            modes.normal,
            modes.frozen,
            simulation.counts().total(),
        );
        match reason {
            StopReason::Time => {}
            StopReason::AllFrozen => break,
            other => return Err(format!("stopped early: {other:?}").into()),
        }
    }

    let heap = simulation.snapshot();
    if let Some(slab) = packing_fraction(&heap, WIDTH * WIDTH) {
        println!(
            "φ = {:.4} between z = {:.2} and {:.2}; the paper has 0.640 − 0.11 V_t = {:.4} in a \
             deposit of 4800",
            slab.value,
            slab.from,
            slab.to,
            0.640 - 0.11 * threshold
        );
    }
    println!("deepest overlap: {:.1e} d", simulation.max_overlap());
    Ok(())
}
