//! Events per second of what `grainfall bench` does not measure: disks, and
//! spheres of two sizes.
//!
//! cargo bench --bench variants

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::ForceFree;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Model, Parts};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::setup::{Gas, Sizes, seeded};

/// Collisions in one timed run.
const EVENTS: u64 = 10_000;

/// A gas that has forgotten how it was made.
fn in_equilibrium<const D: usize>(gas: Gas<D>) -> Simulation<impl Model<D>, D> {
    let (grains, lengths) = gas.grains(&mut seeded(1)).expect("a valid gas");
    let sides = std::array::from_fn(|axis| Side::periodic(lengths[axis]));
    let model = Parts {
        dynamics: ForceFree,
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Never,
        boundary: Cuboid::new(sides).expect("a valid box"),
    };
    let mut simulation = Simulation::new(model, grains).expect("a valid start");
    simulation.run(&Limits::events(5 * gas.count as u64), &mut ());
    simulation
}

/// Times collisions of one and the same gas: it is stationary, so each run is
/// like the one before.
fn measure<const D: usize>(criterion: &mut Criterion, name: &str, sizes: Sizes, fractions: &[f64]) {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(EVENTS));
    for &packing_fraction in fractions {
        let mut simulation = in_equilibrium(Gas::<D> {
            packing_fraction,
            sizes,
            ..Gas::default()
        });
        let name = BenchmarkId::new("phi", packing_fraction);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let limits = Limits::events(simulation.counts().total() + EVENTS);
                simulation.run(&limits, &mut ())
            });
        });
    }
    group.finish();
}

fn disks(criterion: &mut Criterion) {
    measure::<2>(criterion, "disks", Sizes::default(), &[0.3, 0.6]);
}

fn mixture(criterion: &mut Criterion) {
    let sizes = Sizes::Bimodal {
        small: 1.0,
        large: 3.0,
        large_fraction: 0.1,
    };
    measure::<3>(criterion, "spheres of two sizes", sizes, &[0.3, 0.5]);
}

criterion_group!(benches, disks, mixture);
criterion_main!(benches);
