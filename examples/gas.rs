//! A gas of hard grains in two and three dimensions, by one generic function:
//! elastic, where the pressure is known, and inelastic, where it cools.
//!
//! cargo run --release --example gas

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::ForceFree;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Occurrence, Parts};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::setup::{Gas, seeded};
use grainfall::{Particle, SetupError};

/// What a run of the gas gave.
struct Measured {
    /// Pressure over that of an ideal gas of the same density and temperature.
    compressibility: f64,
    /// Collisions that a grain took part in, on average.
    collisions_each: f64,
    /// Temperature at the end over that at the start.
    cooling: f64,
}

/// Runs a gas of 1000 grains at this packing fraction for 50 000 collisions.
fn run<const D: usize>(packing_fraction: f64, restitution: f64) -> Result<Measured, SetupError> {
    let gas = Gas::<D> {
        packing_fraction,
        ..Gas::default()
    };
    let (grains, lengths) = gas.grains(&mut seeded(1))?;
    let count = grains.len() as f64;
    let model = Parts {
        dynamics: ForceFree,
        predictor: Polynomial,
        collision_rule: Restitution::constant(restitution),
        state_policy: Never,
        boundary: Cuboid::new(std::array::from_fn(|axis| Side::periodic(lengths[axis])))?,
    };
    let mut simulation = Simulation::new(model, grains)?;
    let temperature = |grains: &[Particle<D>]| {
        let energy: f64 = grains.iter().map(Particle::kinetic_energy).sum();
        2.0 * energy / (D as f64 * count)
    };

    // Let the gas forget how it was made.
    simulation.run(&Limits::events(10_000), &mut ());
    let start = (simulation.time(), simulation.counts().pair);
    let warm = temperature(&simulation.snapshot());

    // An observer sees every event; the virial theorem asks for the sum of the
    // momenta exchanged, each over the distance of the centres, here 1 d.
    let mut exchanged = 0.0;
    simulation.run(&Limits::events(60_000), &mut |event: &Occurrence<D>| {
        exchanged += event.impulse.norm();
    });

    let collisions = (simulation.counts().pair - start.1) as f64;
    let elapsed = simulation.time() - start.0;
    Ok(Measured {
        compressibility: 1.0 + exchanged / (D as f64 * count * warm * elapsed),
        collisions_each: 2.0 * collisions / count,
        cooling: temperature(&simulation.snapshot()) / warm,
    })
}

fn main() -> Result<(), SetupError> {
    let fraction: f64 = 0.3;

    // Equations of state: Henderson 1975 (doi:10.1080/00268977500102511) for
    // disks, Carnahan & Starling 1969 (doi:10.1063/1.1672048) for spheres.
    let hole = 1.0 - fraction;
    let disks = (1.0 + fraction * fraction / 8.0) / (hole * hole);
    let spheres = (1.0 + fraction + fraction * fraction - fraction * fraction * fraction)
        / (hole * hole * hole);
    println!("elastic, φ = {fraction}: pressure over that of the ideal gas");
    let found = run::<2>(fraction, 1.0)?;
    println!("  2D: {:.3} (theory {disks:.3})", found.compressibility);
    let found = run::<3>(fraction, 1.0)?;
    println!("  3D: {:.3} (theory {spheres:.3})", found.compressibility);

    // Haff's law: as long as the gas stays homogeneous a collision costs
    // (1 − α²) T on average, so ln T falls by (1 − α²)/D for each collision of
    // a grain.
    let restitution: f64 = 0.98;
    println!("inelastic, α = {restitution}: T over T₀ after the same number of collisions");
    let law = |measured: &Measured, dimension: f64| {
        let loss = (1.0 - restitution * restitution) / dimension;
        (-loss * measured.collisions_each).exp()
    };
    let found = run::<2>(fraction, restitution)?;
    println!(
        "  2D: {:.2e} (Haff {:.2e})",
        found.cooling,
        law(&found, 2.0)
    );
    let found = run::<3>(fraction, restitution)?;
    println!(
        "  3D: {:.2e} (Haff {:.2e})",
        found.cooling,
        law(&found, 3.0)
    );
    Ok(())
}
