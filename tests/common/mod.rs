//! What several of these tests use: models put together from the built-in
//! parts, and a few scenes.

// Every test program uses some of these only.
#![allow(dead_code)]

use grainfall::analysis::highest_surface;
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, UniformGravity};
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind, Parts};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::setup::{Base, Gas, Rain, Sizes, seeded};
use grainfall::{Particle, Time, Vector, WallId};

/// A model of grains under gravity.
pub(crate) type Heavy<S, const D: usize> =
    Parts<UniformGravity<D>, Polynomial, Restitution, S, Cuboid<D>>;

/// A model of a gas.
pub(crate) type Free<const D: usize> = Parts<ForceFree, Polynomial, Restitution, Never, Cuboid<D>>;

/// Unit gravity down the last axis in a box with these sides.
pub(crate) fn heavy<S, const D: usize>(
    rule: Restitution,
    policy: S,
    sides: [Side; D],
) -> Heavy<S, D> {
    Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: rule,
        state_policy: policy,
        boundary: Cuboid::new(sides).unwrap(),
    }
}

/// No gravity, and nobody sleeps.
pub(crate) fn free<const D: usize>(rule: Restitution, sides: [Side; D]) -> Free<D> {
    Parts {
        dynamics: ForceFree,
        predictor: Polynomial,
        collision_rule: rule,
        state_policy: Never,
        boundary: Cuboid::new(sides).unwrap(),
    }
}

/// The paper's rule with another elastic cut-off.
pub(crate) fn rule(elastic_speed: f64) -> Restitution {
    Restitution {
        elastic_speed,
        ..Restitution::default()
    }
}

/// Lets a simulation run and writes down all that happens.
pub(crate) fn watch<M: Model<D>, const D: usize>(
    simulation: &mut Simulation<M, D>,
    limits: &Limits,
) -> (StopReason, Vec<Occurrence<D>>) {
    let mut events = Vec::new();
    let why = simulation.run(limits, &mut |event: &Occurrence<D>| events.push(*event));
    (why, events)
}

/// Lets a simulation run and hashes what happens.
pub(crate) fn hash<M: Model<D>, const D: usize>(
    simulation: &mut Simulation<M, D>,
    limits: &Limits,
) -> u64 {
    let mut hash = TrajectoryHash::new();
    simulation.run(limits, &mut hash);
    hash.value()
}

/// Limits at a time in plain units.
pub(crate) fn until(units: f64) -> Limits {
    Limits::until(Time::from_units(units))
}

/// What happened to whom, without when.
pub(crate) type What = (OccurrenceKind, u32, Option<u32>, Option<WallId>);

/// What an event says happened, without when.
pub(crate) fn what<const D: usize>(event: &Occurrence<D>) -> What {
    (
        event.kind,
        event.particle.0,
        event.other.map(|id| id.0),
        event.wall,
    )
}

/// Panics unless two numbers agree to within `tolerance`.
#[track_caller]
pub(crate) fn close(found: f64, wanted: f64, tolerance: f64, name: &str) {
    let off = (found - wanted).abs();
    assert!(
        off <= tolerance,
        "{name}: found {found:e}, wanted {wanted:e}, off by {off:e}, allowed {tolerance:e}"
    );
}

/// Grains of a small deposition: a rough base and a rain, periodic with `width`.
pub(crate) fn rain_on_base<const D: usize>(
    seed: u64,
    count: usize,
    width: f64,
    sizes: Sizes,
) -> Vec<Particle<D>> {
    let mut rng = seeded(seed);
    let mut lengths = Vector::repeat(width);
    lengths[D - 1] = 2.0;
    let mut grains = Base::<D> {
        sizes,
        lengths,
        ..Base::default()
    }
    .grains(&mut rng)
    .unwrap();
    let mut rain = Rain::<D> {
        count,
        sizes,
        lengths,
        ..Rain::default()
    };
    rain.origin[D - 1] = highest_surface(&grains).unwrap();
    grains.extend(rain.grains(&mut rng).unwrap());
    grains
}

/// The sides of a deposition's box.
pub(crate) fn periodic_laterally<const D: usize>(width: f64) -> [Side; D] {
    let mut sides = [Side::periodic(width); D];
    sides[D - 1] = Side::Open;
    sides
}

/// A small deposition with the coarse cut-off V_c = 1e-3, V_t = 0.1.
pub(crate) fn deposition<const D: usize>(
    seed: u64,
    count: usize,
    width: f64,
    sizes: Sizes,
) -> Simulation<Heavy<SlowDescent, D>, D> {
    let grains = rain_on_base(seed, count, width, sizes);
    let model = heavy(
        rule(1.0e-3),
        SlowDescent::default(),
        periodic_laterally(width),
    );
    Simulation::new(model, grains).unwrap()
}

/// A gas in a periodic box: the grains and the box.
pub(crate) fn gas_grains<const D: usize>(
    seed: u64,
    count: usize,
    packing_fraction: f64,
    sizes: Sizes,
) -> (Vec<Particle<D>>, [Side; D]) {
    let (grains, lengths) = Gas::<D> {
        count,
        sizes,
        packing_fraction,
        ..Gas::default()
    }
    .grains(&mut seeded(seed))
    .unwrap();
    (
        grains,
        std::array::from_fn(|axis| Side::periodic(lengths[axis])),
    )
}

/// A gas in a periodic box.
pub(crate) fn gas<const D: usize>(
    seed: u64,
    count: usize,
    packing_fraction: f64,
    rule: Restitution,
) -> Simulation<Free<D>, D> {
    let (grains, sides) = gas_grains(seed, count, packing_fraction, Sizes::default());
    Simulation::new(free(rule, sides), grains).unwrap()
}
