//! Events per second in the layer of moving grains on top of a growing heap:
//! where a deposition spends its time.
//!
//! cargo bench --bench deposition

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use grainfall::analysis::highest_surface;
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Model, Parts};
use grainfall::policy::SlowDescent;
use grainfall::predict::Polynomial;
use grainfall::setup::{Base, Rain, seeded};
use grainfall::{Particle, Time, Vector};

/// Events in one timed run.
const EVENTS: u64 = 20_000;
/// Edge of the base, in d.
const WIDTH: f64 = 10.0;
/// Grains in the rain.
const COUNT: usize = 600;
/// When more than half of them have landed, in √(d/g).
const HALF_TIME: f64 = 15.0;

/// The paper's deposition at V_t = 0.1.
fn deposition(grains: Vec<Particle<3>>) -> Simulation<impl Model<3>, 3> {
    let sides = [Side::periodic(WIDTH), Side::periodic(WIDTH), Side::Open];
    let model = Parts {
        dynamics: UniformGravity::<3>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: SlowDescent::default(),
        boundary: Cuboid::new(sides).expect("a valid box"),
    };
    Simulation::new(model, grains).expect("a valid start")
}

/// A heap on which grains still rain.
fn half_settled() -> Vec<Particle<3>> {
    let mut rng = seeded(1);
    let base = Base::<3>::default();
    let mut grains = base.grains(&mut rng).expect("a valid base");
    let mut rain = Rain::<3> {
        count: COUNT,
        lengths: Vector::<3>::new(WIDTH, WIDTH, 0.0),
        ..Rain::default()
    };
    rain.origin[2] = highest_surface(&grains).expect("a base with grains");
    grains.extend(rain.grains(&mut rng).expect("a valid rain"));
    let mut simulation = deposition(grains);
    simulation.run(&Limits::until(Time::from_units(HALF_TIME)), &mut ());
    simulation.snapshot()
}

fn layer(criterion: &mut Criterion) {
    let grains = half_settled();
    let mut group = criterion.benchmark_group("deposition");
    group.throughput(Throughput::Elements(EVENTS));
    group.sample_size(20);
    // Every run starts from the same heap. Making the simulation, which
    // predicts everything once, is not timed.
    group.bench_function("layer, V_t 0.1", |bencher| {
        bencher.iter_batched(
            || deposition(grains.clone()),
            |mut simulation| {
                simulation.run(&Limits::events(EVENTS), &mut ());
                simulation
            },
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(benches, layer);
criterion_main!(benches);
