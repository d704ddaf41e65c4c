//! Collisions per second of an elastic gas in equilibrium.
//!
//! cargo bench --bench gas

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::ForceFree;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Model, Parts};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::setup::{Gas, seeded};

/// Collisions in one timed run.
const EVENTS: u64 = 10_000;

/// A gas of this many grains that has forgotten how it was made.
fn gas<const D: usize>(count: usize, packing_fraction: f64) -> Simulation<impl Model<D>, D> {
    let gas = Gas::<D> {
        count,
        packing_fraction,
        ..Gas::default()
    };
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
    simulation.run(&Limits::events(5 * count as u64), &mut ());
    simulation
}

/// Times collisions of one and the same gas: it is stationary, so each run is
/// like the one before.
fn measure<const D: usize>(criterion: &mut Criterion, cases: &[(usize, f64)]) {
    let mut group = criterion.benchmark_group(format!("elastic gas, {D}D"));
    group.throughput(Throughput::Elements(EVENTS));
    for &(count, packing_fraction) in cases {
        let mut simulation = gas::<D>(count, packing_fraction);
        let name = BenchmarkId::new(format!("phi {packing_fraction}"), count);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let limits = Limits::events(simulation.counts().total() + EVENTS);
                simulation.run(&limits, &mut ())
            });
        });
    }
    group.finish();
}

fn spheres(criterion: &mut Criterion) {
    let cases = [(1000, 0.1), (1000, 0.3), (1000, 0.5), (10_000, 0.3)];
    measure::<3>(criterion, &cases);
}

fn disks(criterion: &mut Criterion) {
    measure::<2>(criterion, &[(1000, 0.3), (1000, 0.6)]);
}

criterion_group!(benches, spheres, disks);
criterion_main!(benches);
