//! Stress and forces, measured while a simulation runs.

use grainfall::analysis::{Bins, Container, Stress, StressMeter};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, UniformGravity};
use grainfall::engine::{Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Dynamics, Occurrence, OccurrenceKind, Parts};
use grainfall::observe::{CollisionalTransfer, ForceMeter};
use grainfall::policy::{Never, SlowDescent};
use grainfall::predict::Polynomial;
use grainfall::setup::{Gas, seeded};
use grainfall::{Mode, Particle, ParticleId, Time, Vector, WallId};

use crate::near;

type Model<Y, const D: usize> = Parts<Y, Polynomial, Restitution, Never, Cuboid<D>>;

fn elastic<Y: Dynamics<D>, const D: usize>(dynamics: Y, boundary: Cuboid<D>) -> Model<Y, D> {
    Parts {
        dynamics,
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Never,
        boundary,
    }
}

fn at(units: f64) -> Limits {
    Limits::until(Time::from_units(units))
}

/// Of all that moves.
fn momentum(grains: &[Particle<2>]) -> Vector<2> {
    grains.iter().fold(Vector::zeros(), |sum, grain| {
        sum + grain.velocity * grain.mass
    })
}

/// Two disks that meet head-on at x = 0, at an angle to the axes; slabs across
/// the vertical.
fn head_on(angle: f64, bins: Bins) -> Vec<Stress<2>> {
    let way = Vector::<2>::new(angle.cos(), angle.sin());
    let grains = [-1.0, 1.0].map(|side| Particle::new(way * side, way * (-0.25 * side)));
    let boundary = Cuboid::<2>::open();
    let container = Container::new(Vector::repeat(-2.0), Vector::repeat(4.0), [false; 2]).unwrap();
    let mut simulation = Simulation::new(elastic(ForceFree, boundary), grains.to_vec()).unwrap();
    let mut meter = StressMeter::new(container, 1, bins, simulation.time()).unwrap();
    simulation.run(&at(4.0), &mut meter);
    meter.sample(&simulation.snapshot());
    meter.stresses(simulation.time())
}

#[test]
fn one_collision_transfers_what_it_should() {
    // The impulse is 0.5 over a branch of 1, in the time 4 and the area 16.
    let size = 0.5 / 64.0;
    let whole = Bins::new(-2.0, 2.0, 1).unwrap();
    let found = head_on(0.0, whole)[0];
    near(found.collisional[(0, 0)], size, 1.0e-15);
    near(found.collisional[(1, 1)], 0.0, 1.0e-15);
    // Both fly apart at 0.25: Σ m v v = 2 · 0.0625, and nothing drifts.
    near(found.kinetic[(0, 0)], 0.125 / 16.0, 1.0e-15);
    near(found.pressure(), 0.5 * (size + 0.125 / 16.0), 1.0e-15);
    // Along n: σ = s n ⊗ n.
    let found = head_on(1.0, whole)[0];
    let (sin, cos) = 1.0_f64.sin_cos();
    near(found.collisional[(0, 1)], size * sin * cos, 1.0e-15);
    near(found.collisional[(1, 0)], size * sin * cos, 1.0e-15);
    near(found.collisional[(1, 1)], size * sin * sin, 1.0e-15);
}

#[test]
fn a_branch_is_shared_among_the_slabs_it_goes_through() {
    // Upright, from −½ to ½: slabs from −2 to 2, of 0.8. The third has the middle
    // 0.8 of it, its neighbours 0.1 each; each slab has a fifth of the volume.
    let found = head_on(
        std::f64::consts::FRAC_PI_2,
        Bins::new(-2.0, 2.0, 5).unwrap(),
    );
    let size = 0.5 / 64.0 * 5.0;
    for (slab, share) in found.iter().zip([0.0, 0.1, 0.8, 0.1, 0.0]) {
        near(slab.collisional[(1, 1)], share * size, 1.0e-14);
    }
}

#[test]
fn the_trace_is_the_virial_whatever_the_slabs() {
    let gas = Gas::<3> {
        count: 150,
        packing_fraction: 0.35,
        ..Gas::default()
    };
    let (grains, edges) = gas.grains(&mut seeded(5)).unwrap();
    let boundary = Cuboid::new([0, 1, 2].map(|axis| Side::periodic(edges[axis]))).unwrap();
    let container = Container::around(&boundary, &grains).unwrap();
    let mut simulation = Simulation::new(elastic(ForceFree, boundary), grains).unwrap();
    let virial = CollisionalTransfer::new(simulation.time());
    // From anywhere to one period on: branches go round the edges.
    let bins = Bins::new(-0.7, edges[1] - 0.7, 7).unwrap();
    let meter = StressMeter::new(container, 1, bins, simulation.time()).unwrap();
    let mut watch = (virial, meter);
    for step in 1..=40 {
        simulation.run(&at(0.1 * f64::from(step)), &mut watch);
        watch.1.sample(&simulation.snapshot());
    }
    let (virial, meter) = watch;
    let now = simulation.time();
    let slabs = meter.stresses(now);
    let mean = |of: &dyn Fn(&Stress<3>) -> f64| slabs.iter().map(of).sum::<f64>() / 7.0;
    let energy = simulation.kinetic_energy();
    let collisional = virial.pressure::<3>(now, 0.0, edges.product());
    near(
        mean(&|slab| slab.collisional.trace() / 3.0),
        collisional,
        1.0e-9 * collisional,
    );
    // The kinetic part is 2 E/(D V), but for the drift of 21 grains in a slab.
    let kinetic = 2.0 * energy / (3.0 * edges.product());
    near(
        mean(&|slab| slab.kinetic.trace() / 3.0),
        kinetic,
        0.02 * kinetic,
    );
    for slab in &slabs {
        let asymmetry = slab.collisional - slab.collisional.transpose();
        assert!(asymmetry.abs().max() < 1.0e-9 * collisional);
    }
}

#[test]
fn the_floor_bears_the_weight_of_a_gas() {
    let grains: Vec<Particle<2>> = (0..24)
        .map(|i| {
            let place =
                Vector::<2>::new(0.6 + 1.3 * f64::from(i % 4), 1.0 + 1.5 * f64::from(i / 4));
            let sideways = f64::from(i * 7 % 11) / 11.0 - 0.5;
            Particle::new(place, Vector::<2>::new(sideways, 0.3 * sideways))
        })
        .collect();
    let sides = [
        Side::Walls {
            low: Some(0.0),
            high: Some(5.2),
            restitution: 1.0,
        },
        Side::floor(0.0, 1.0),
    ];
    let boundary = Cuboid::new(sides).unwrap();
    let walls = grainfall::model::Boundary::walls(&boundary).len();
    let model = elastic(UniformGravity::<2>::down(), boundary);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let before = momentum(&simulation.snapshot());
    let mut forces = ForceMeter::new(simulation.time());
    simulation.run(&at(30.0), &mut forces);
    let change = momentum(&simulation.snapshot()) - before;
    let now = simulation.time();
    let on_walls = (0..walls)
        .map(|wall| forces.on_wall(WallId(wall as u16), now))
        .fold(Vector::<2>::zeros(), |sum, force| sum + force);
    // Weight, less what the gas has gained.
    near(on_walls[1], -24.0 - change[1] / 30.0, 1.0e-9);
    near(on_walls[0], -change[0] / 30.0, 1.0e-9);
    assert_eq!(forces.on_grains(|_| true, now), Vector::<2>::zeros());
}

#[test]
fn grains_that_fall_asleep_give_their_momentum_to_the_ground() {
    // A disk bounces on a fixed one until it sleeps on its top.
    let model = Parts {
        dynamics: UniformGravity::<2>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: SlowDescent::with_threshold(0.05),
        boundary: Cuboid::open(),
    };
    let base = Particle::fixed(Vector::<2>::zeros());
    let ball = Particle::new(Vector::<2>::new(0.0, 2.0), Vector::zeros());
    let mut simulation = Simulation::new(model, vec![base, ball]).unwrap();
    let mut forces = ForceMeter::new(simulation.time());
    simulation.run(&Limits::all_frozen(), &mut forces);
    let now = simulation.time();
    let on_base = forces.on_grains(|id| id == ParticleId(0), now);
    assert_eq!(on_base, forces.on_grain(ParticleId(0), now));
    // It was heavy all the time, and is at rest at both ends.
    assert_eq!(simulation.particle(ParticleId(1)).mode, Mode::Frozen);
    near(on_base[1] + forces.by_sleep(now)[1], -1.0, 1.0e-9);
    assert!(forces.by_sleep(now)[1].abs() < 0.05);
    assert_eq!(forces.on_grain(ParticleId(1), now), Vector::<2>::zeros());
}

#[test]
fn the_momentum_of_a_heap_is_accounted_for() {
    // Disks fall on a row of fixed ones, sleep, and wake each other.
    let mut grains: Vec<Particle<2>> = (0..12)
        .map(|i| Particle::fixed(Vector::<2>::new(f64::from(i) + 0.5, 0.0)))
        .collect();
    for i in 0..72 {
        let (column, row) = (f64::from(i % 9), f64::from(i / 9));
        let place = Vector::<2>::new(0.7 + 1.3 * column + 0.09 * row, 2.0 + 1.4 * row);
        grains.push(Particle::new(
            place,
            Vector::<2>::new(0.3 - 0.07 * column, -1.0),
        ));
    }
    let model = Parts {
        dynamics: UniformGravity::<2>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::default()
        },
        state_policy: SlowDescent::with_threshold(0.1),
        boundary: Cuboid::new([Side::periodic(12.0), Side::Open]).unwrap(),
    };
    // The projection at the end of a cascade changes grains that no event names.
    let settings = Settings {
        guards: Guards::floor_and_hold(1.0e-4, 1.0e-9),
        ..Settings::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, settings).unwrap();
    let before = momentum(&simulation.snapshot());
    let (mut weight, mut since, mut awake, mut woken) = (0.0, Time::ZERO, 72.0, 0);
    let watch = |occurrence: &Occurrence<2>| {
        weight += awake * (occurrence.time - since);
        since = occurrence.time;
        match occurrence.kind {
            OccurrenceKind::Sleep => awake -= 1.0,
            OccurrenceKind::Wake | OccurrenceKind::CheckWake => {
                awake += 1.0;
                woken += 1;
            }
            _ => {}
        }
    };
    let mut watching = (ForceMeter::new(simulation.time()), watch);
    let why = simulation.run(&at(3.2), &mut watching);
    assert_eq!(why, StopReason::Time);
    let (forces, _) = watching;
    let now = simulation.time();
    weight += awake * (now - since);
    assert!(woken > 20 && awake < 72.0, "{woken} {awake}");
    let after = momentum(&simulation.snapshot());
    let taken = forces.on_grains(|_| true, now) + forces.by_sleep(now);
    let known = before - after - Vector::<2>::new(0.0, weight);
    near(3.2 * taken[0], known[0], 1.0e-9 * weight);
    near(3.2 * taken[1], known[1], 1.0e-9 * weight);
}
