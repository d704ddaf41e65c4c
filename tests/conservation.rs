//! What an elastic gas in a periodic box keeps: momentum and energy, the way
//! back, and its course when seen from a moving frame; and where the energy of
//! all others goes.

mod common;

use common::{close, free, gas_grains, heavy, periodic_laterally, rain_on_base, rule, until};
use common::{watch, what};
use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{
    ForceFree, Growing, Trochoid, TurningGravity, TurningGround, UniformGravity,
};
use grainfall::engine::{EnergyLedger, Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Boundary, Dynamics, Model, Parts};
use grainfall::policy::{EnergyStore, Never, SelfCheck, SlowDescent};
use grainfall::predict::{Polynomial, Turning};
use grainfall::setup::Sizes;
use grainfall::{Mode, Particle, Time, Vector};

const MIXED: Sizes = Sizes::Bimodal {
    small: 0.7,
    large: 1.3,
    large_fraction: 0.4,
};

fn momentum<const D: usize>(grains: &[Particle<D>]) -> Vector<D> {
    grains.iter().map(|grain| grain.velocity * grain.mass).sum()
}

fn energy<const D: usize>(grains: &[Particle<D>]) -> f64 {
    grains.iter().map(Particle::kinetic_energy).sum()
}

/// Runs an elastic gas for so many collisions and holds it to what rounding
/// allows.
///
/// One collision rounds each component of a momentum p by at most ε/2 of it,
/// with a sign that does not care: after E collisions the sum has walked at
/// random to about √E ε/2 times the size of a grain's share. The bound is that
/// times 16, for the few roundings in each collision and for bad luck.
///
/// Energy does not walk, it drifts: the length of a unit normal is off by up to
/// ε/2, and where the contact distance is 1 d the rounding of the square root
/// prefers one sign. A normal longer by δ adds 2δ of the energy of the motion
/// along it, of the order of a grain's mean energy. So the bound is 2ε of that
/// for every collision: 6 parts in 10¹³ of the whole after a million.
fn conserves<const D: usize>(packing_fraction: f64, sizes: Sizes, collisions: u64) {
    let (grains, sides) = gas_grains::<D>(5, 500, packing_fraction, sizes);
    let (p, e) = (momentum(&grains), energy(&grains));
    let share = grains
        .iter()
        .map(|grain| grain.mass * grain.velocity.norm())
        .fold(0.0, f64::max);
    let count = grains.len() as f64;
    let mut simulation = Simulation::new(free(Restitution::elastic(), sides), grains).unwrap();
    let why = simulation.run(&Limits::events(collisions), &mut ());
    assert_eq!(why, StopReason::Events);
    assert_eq!(simulation.counts().pair, collisions);

    let after = simulation.snapshot();
    let walk = 16.0 * (collisions as f64).sqrt() * 0.5 * f64::EPSILON;
    let off = (momentum(&after) - p).norm();
    println!("{D}D: momentum off by {off:e}, allowed {:e}", walk * share);
    assert!(off < walk * share, "momentum off by {off:e}");
    let off = energy(&after) - e;
    let drift = 2.0 * f64::EPSILON * collisions as f64 * e / count;
    println!("{D}D: energy off by {off:e}, allowed {drift:e}");
    assert!(off.abs() < drift, "energy off by {off:e}");
    close(
        simulation.kinetic_energy(),
        energy(&after),
        0.0,
        "kinetic energy",
    );
    assert!(simulation.max_overlap() < 1.0e-12);
}

#[test]
fn a_million_collisions_keep_momentum_and_energy() {
    conserves::<3>(0.3, MIXED, 1_000_000);
}

#[test]
fn so_in_the_plane() {
    conserves::<2>(0.6, Sizes::default(), 300_000);
}

/// Largest distance of two states of the same grains, in d.
fn farthest<const D: usize>(
    boundary: &impl Boundary<D>,
    one: &[Particle<D>],
    other: &[Particle<D>],
) -> f64 {
    let apart = |(a, b): (&Particle<D>, &Particle<D>)| {
        boundary.displacement(&a.position, &b.position).norm()
    };
    one.iter().zip(other).map(apart).fold(0.0, f64::max)
}

/// There and back: velocities reversed, the gas must come back.
///
/// An error δ of a grain's place turns, at a collision after a free path ℓ, into
/// one of its direction of about 2 δ/σ and so into 2 δ ℓ/σ at the next one:
/// with ℓ a few tenths of σ and more than one grain to be led astray a factor
/// of up to 4 or so each. So 10⁻¹⁵ grows to less than 10⁻⁶ in 15 collisions a
/// grain; half of them are made on the way there. Were the normal of a single
/// collision wrong, say that of a periodic image of an earlier moment, the
/// gas would not come back at all.
fn comes_back<const D: usize>(packing_fraction: f64, sizes: Sizes, collisions_each: u64) {
    let (start, sides) = gas_grains::<D>(11, 60, packing_fraction, sizes);
    let boundary = Cuboid::new(sides).unwrap();
    let model = free(Restitution::elastic(), sides);
    let mut there = Simulation::new(model.clone(), start.clone()).unwrap();
    let collisions = collisions_each * start.len() as u64 / 2;
    there.run(&Limits::events(collisions), &mut ());
    let time = there.time().units();
    let turned: Vec<Particle<D>> = there
        .snapshot()
        .into_iter()
        .map(|grain| Particle {
            velocity: -grain.velocity,
            ..grain
        })
        .collect();
    // It went far enough for the way back to mean something: grains have
    // crossed faces, and are elsewhere.
    assert!(farthest(&boundary, &start, &turned) > 1.0);

    let mut back = Simulation::new(model, turned).unwrap();
    let (_, events) = watch(&mut back, &until(time));
    let crossed = events
        .iter()
        .filter(|event| {
            let (one, two) = (event.particle, event.other.unwrap());
            let (one, two) = (&start[one.index()], &start[two.index()]);
            (0..D).any(|axis| {
                let apart = one.position[axis] - two.position[axis];
                let period = boundary.period(axis).unwrap();
                apart.abs() > 0.5 * period.length
            })
        })
        .count();
    assert!(crossed > 20, "{crossed} collisions across faces");
    // The last on the way there ended it: undone, it is the first on the way back.
    assert_eq!(events.len() as u64, collisions);

    let end = back.snapshot();
    let off = farthest(&boundary, &start, &end);
    println!("{D}D: came back to within {off:e} d");
    assert!(off < 1.0e-6, "off by {off:e} d");
    for (one, other) in start.iter().zip(&end) {
        let off = (one.velocity + other.velocity).norm();
        assert!(off < 1.0e-6, "velocity off by {off:e}");
    }
}

#[test]
fn a_reversed_gas_comes_back_through_periodic_faces() {
    comes_back::<3>(0.2, Sizes::default(), 14);
    comes_back::<3>(0.4, MIXED, 14);
    comes_back::<2>(0.5, MIXED, 14);
}

/// Seen from a frame that moves at `boost` all happens as before.
///
/// The grains start from the same places with the same relative velocities up
/// to ε times the boost, and so after k collisions each differ by about 4ᵏ
/// times that (see above): 10⁻⁹ in time holds for k = 10.
fn is_the_same_in_a_moving_frame<const D: usize>(packing_fraction: f64, boost: Vector<D>) {
    let (grains, sides) = gas_grains::<D>(3, 80, packing_fraction, MIXED);
    let boosted = grains
        .iter()
        .map(|grain| Particle {
            velocity: grain.velocity + boost,
            ..*grain
        })
        .collect();
    let limits = Limits::events(10 * grains.len() as u64 / 2);
    let model = free(Restitution::constant(0.95), sides);
    let mut here = Simulation::new(model.clone(), grains).unwrap();
    let (_, events) = watch(&mut here, &limits);
    let mut there = Simulation::new(model, boosted).unwrap();
    let (_, seen) = watch(&mut there, &limits);
    let mut latest: f64 = 0.0;
    for (place, (event, seen)) in events.iter().zip(&seen).enumerate() {
        assert_eq!(what(event), what(seen), "event {place}");
        latest = latest.max((event.time - seen.time).abs());
        let off = (seen.velocity - boost - event.velocity).norm();
        assert!(off < 1.0e-7, "velocity off by {off:e} at event {place}");
    }
    println!("{D}D: times off by {latest:e}");
    assert!(latest < 1.0e-9, "times off by {latest:e}");
}

#[test]
fn a_gas_is_the_same_in_a_moving_frame() {
    is_the_same_in_a_moving_frame(0.3, Vector::<3>::new(3.0, -7.0, 11.0));
    is_the_same_in_a_moving_frame(0.5, Vector::<2>::new(-20.0, 1.0 / 3.0));
}

/// Total energy of every grain, in mgd; none of fixed ones.
fn energies<const D: usize>(grains: &[Particle<D>], gravity: &Vector<D>) -> Vec<f64> {
    let of = |grain: &Particle<D>| match grain.mode {
        Mode::Fixed => 0.0,
        _ => grain.kinetic_energy() - grain.mass * gravity.dot(&grain.position),
    };
    grains.iter().map(of).collect()
}

/// Goes through a run event by event and holds the ledger to what can be seen
/// from outside. Between two events grains only fly: the energies of falling
/// grains, and of those that cross a periodic side, change on the way.
///
/// The 10⁻¹² is of the energies of the grains whose velocities the event has
/// changed; 10⁻¹⁵ of those of all covers the rounding of this sum itself.
fn explains_every_event<M: Model<D>, const D: usize>(
    mut simulation: Simulation<M, D>,
    gravity: Vector<D>,
    events: u64,
) -> EnergyLedger {
    for _ in 0..events {
        let grains = simulation.snapshot();
        let before = energies(&grains, &gravity);
        let so_far = simulation.energy_ledger().sum();
        let one_more = Limits::events(simulation.counts().total() + 1);
        if simulation.run(&one_more, &mut ()) != StopReason::Events {
            break;
        }
        let after = energies(&simulation.snapshot(), &gravity);
        let mut change = 0.0;
        let mut allowed = 0.0;
        for (place, grain) in simulation.snapshot().iter().enumerate() {
            change += after[place] - before[place];
            let touched = grain.velocity != grains[place].velocity;
            let part = if touched { 1.0e-12 } else { 1.0e-15 };
            allowed += part * (after[place].abs() + before[place].abs());
        }
        let noted = simulation.energy_ledger().sum() - so_far;
        let time = simulation.time();
        close(noted, change, allowed, &format!("ledger at {time}"));
    }
    let ledger = simulation.energy_ledger();
    let now: f64 = energies(&simulation.snapshot(), &gravity).iter().sum();
    close(ledger.now, now, 1.0e-12 * now.abs().max(1.0), "energy now");
    assert!(ledger.relative_error().abs() < 1.0e-12, "{ledger:?}");
    ledger
}

#[test]
fn the_ledger_explains_a_deposit_that_is_checked() {
    let policy = SlowDescent {
        energy_store: EnergyStore::EnergyAfter,
        self_check: Some(SelfCheck::default()),
        ..SlowDescent::with_threshold(0.1)
    };
    let model = heavy(rule(1.0e-3), policy, periodic_laterally::<3>(4.0));
    let grains = rain_on_base::<3>(3, 40, 4.0, Sizes::default());
    let simulation = Simulation::new(model, grains).unwrap();
    let ledger = explains_every_event(simulation, -Vector::z(), 20_000);
    // Everything that takes or gives has had its turn.
    for loss in [ledger.pair, ledger.frozen, ledger.sleep, ledger.fall] {
        assert!(loss < 0.0, "{ledger:?}");
    }
    assert!(ledger.given_back > 0.0 && ledger.elastic_spared > 0.0);
    let nothing = [ledger.moving, ledger.growth, ledger.wall, ledger.inserted];
    assert_eq!(nothing, [0.0; 4]);
}

#[test]
fn the_ledger_explains_floors_holds_and_insertions() {
    let sides = [
        Side::Walls {
            low: Some(0.0),
            high: Some(6.0),
            restitution: 0.8,
        },
        Side::floor(0.0, 0.5),
    ];
    let model = heavy(rule(1.0e-3), SlowDescent::with_threshold(0.05), sides);
    let at = |x: f64, y: f64| Particle::new(Vector::<2>::new(x, y), Vector::<2>::new(0.3, -0.1));
    let grains = (0..12)
        .map(|i| at(1.0 + 1.3 * f64::from(i % 4), 1.0 + 1.2 * f64::from(i / 4)))
        .collect();
    let settings = Settings {
        guards: Guards::floor_and_hold(1.0e-2, 1.0e-9),
        ..Settings::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, settings).unwrap();
    simulation.insert(at(3.0, 9.0)).unwrap();
    let ledger = explains_every_event(simulation, -Vector::y(), 4000);
    assert!(ledger.wall < 0.0 && ledger.guard > 0.0, "{ledger:?}");
    assert!(ledger.inserted > 9.0);
}

#[test]
fn the_ledger_explains_a_chute_with_a_paddle() {
    let gravity = Vector::<2>::new(0.3, -0.9);
    let model = Parts {
        dynamics: UniformGravity::new(gravity),
        predictor: Polynomial,
        collision_rule: Restitution::default(),
        state_policy: Never,
        boundary: Cuboid::new([Side::periodic(6.0), Side::floor(0.0, 0.7)]).unwrap(),
    };
    let mut grains: Vec<Particle<2>> = (0..6)
        .map(|i| {
            Particle::new(
                Vector::<2>::new(0.9 * f64::from(i), 3.0),
                Vector::<2>::zeros(),
            )
        })
        .filter(|grain| grain.position.x < 5.0)
        .map(|grain| Particle {
            diameter: 0.8,
            ..grain
        })
        .collect();
    let mut paddle = Particle::fixed(Vector::<2>::new(3.0, 1.1));
    paddle.velocity = Vector::<2>::new(0.5, 0.0);
    grains.push(paddle);
    let simulation = Simulation::new(model, grains).unwrap();
    let ledger = explains_every_event(simulation, gravity, 3000);
    assert!(ledger.crossing > 0.0 && ledger.moving != 0.0, "{ledger:?}");
}

/// Grains in a ring of fixed ones, in the plane.
fn ring(velocities: f64) -> Vec<Particle<2>> {
    let turn = |k: i32| libm::sincos(0.25 * core::f64::consts::PI * f64::from(k) / 3.0);
    let fixed = (0..24).map(|k| {
        let (sin, cos) = turn(k);
        Particle::fixed(Vector::<2>::new(4.0 * cos, 4.0 * sin))
    });
    let free = (0..12).map(|k| {
        let place = Vector::<2>::new(1.1 * f64::from(k % 4) - 1.6, 1.1 * f64::from(k / 4) - 1.1);
        Particle::new(place, Vector::<2>::new(0.1 * f64::from(k), velocities))
    });
    fixed.chain(free).collect()
}

fn turning<Y: Dynamics<2, Flight = Trochoid<2>>>(dynamics: Y) -> EnergyLedger {
    let policy = SlowDescent {
        self_check: Some(SelfCheck::default()),
        ..SlowDescent::with_threshold(0.2)
    };
    let model = Parts {
        dynamics,
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: policy,
        boundary: Cuboid::new([Side::Open, Side::Open]).unwrap(),
    };
    let mut simulation = Simulation::new(model, ring(0.2)).unwrap();
    let why = simulation.run(&Limits::until(Time::from_units(20.0)), &mut ());
    assert_eq!(why, StopReason::Time);
    let counts = simulation.counts();
    assert!(counts.sleep > 20 && counts.check_wake > 10, "{counts:?}");
    assert!(simulation.max_overlap() < 1.0e-11);
    let ledger = simulation.energy_ledger();
    assert!(ledger.relative_error().abs() < 1.0e-12, "{ledger:?}");
    ledger
}

#[test]
fn the_ledger_explains_gravity_that_turns() {
    let gravity = -Vector::<2>::y();
    let ledger = turning(TurningGravity::new(gravity, 0.3, [0, 1]));
    // It keeps the heap in motion.
    assert!(ledger.field > 1.0 && ledger.moving == 0.0, "{ledger:?}");
}

#[test]
fn the_ledger_explains_ground_that_turns() {
    let gravity = -Vector::<2>::y();
    let ground = TurningGround::new(gravity, -0.3, [0, 1], Vector::<2>::zeros());
    let ledger = turning(ground);
    assert!(ledger.moving > 1.0, "{ledger:?}");
    assert!(ledger.field.abs() < 1.0e-9, "{ledger:?}");
}

#[test]
fn the_ledger_explains_growth() {
    let (grains, sides) = gas_grains::<3>(4, 60, 0.2, Sizes::default());
    let model = Parts {
        dynamics: Growing::new(ForceFree, 0.05),
        predictor: Polynomial,
        collision_rule: Restitution::constant(0.9),
        state_policy: Never,
        boundary: Cuboid::new(sides).unwrap(),
    };
    let simulation = Simulation::new(model, grains).unwrap();
    let ledger = explains_every_event(simulation, Vector::zeros(), 3000);
    assert!(ledger.growth > 0.0 && ledger.pair < 0.0);
}

#[test]
fn a_long_run_keeps_its_ledger() {
    let mut simulation = common::deposition::<3>(7, 200, 5.0, Sizes::default());
    simulation.run(&Limits::all_frozen(), &mut ());
    let ledger = simulation.energy_ledger();
    println!("{:e} in {:?}", ledger.relative_error(), simulation.counts());
    assert!(ledger.relative_error().abs() < 1.0e-9, "{ledger:?}");
    assert!(ledger.guard != 0.0);
}
