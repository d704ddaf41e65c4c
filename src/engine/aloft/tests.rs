use proptest::prelude::*;

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::settings::{Limits, StopReason};
use crate::engine::simulation::Simulation;
use crate::error::SetupError;
use crate::model::Parts;
use crate::observe::TrajectoryHash;
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::policy::SlowDescent;
use crate::predict::Polynomial;
use crate::setup::{Rain, seeded};
use crate::time::Time;

type Model<const D: usize> =
    Parts<UniformGravity<D>, Polynomial, Restitution, SlowDescent, Cuboid<D>>;

/// Edge of the box, in d.
const EDGE: f64 = 5.0;

/// A rain that falls aslant on a row of fixed grains, and fountains that rise from
/// there. Across the rain the box is periodic or walled.
fn fountain<const D: usize>(seed: u64, aslant: f64, rising: f64) -> Simulation<Model<D>, D> {
    let mut sides = [Side::periodic(EDGE); D];
    sides[0] = if aslant == 0.0 {
        Side::periodic(EDGE)
    } else {
        Side::Walls {
            low: Some(0.0),
            high: Some(EDGE),
            restitution: 0.9,
        }
    };
    sides[D - 1] = Side::floor(-1.0, 0.5);
    let mut periodic = [true; D];
    periodic[0] = aslant == 0.0;
    let rain = Rain::<D> {
        count: 40,
        lengths: Vector::repeat(EDGE),
        packing_fraction: 0.04,
        origin: Vector::from_fn(|axis, _| if axis == D - 1 { 3.0 } else { 0.0 }),
        periodic,
        ..Rain::default()
    };
    let mut grains = rain.grains(&mut seeded(seed)).unwrap();
    for grain in &mut grains {
        grain.velocity[0] = aslant;
    }
    for place in 0..4 {
        let mut low = Vector::<D>::repeat(0.5);
        low[0] = 0.6 + 1.2 * f64::from(place);
        low[D - 1] = 0.0;
        grains.push(Particle::new(low, Vector::zeros()).with_mode(Mode::Fixed));
        let mut high = low;
        high[D - 1] = 1.2;
        let mut velocity = Vector::<D>::zeros();
        velocity[D - 1] = rising * (1.0 + 0.1 * f64::from(place));
        grains.push(Particle::new(high, velocity));
    }
    let model = Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::default()
        },
        state_policy: SlowDescent::with_threshold(0.1),
        boundary: Cuboid::new(sides).unwrap(),
    };
    Simulation::new(model, grains).unwrap()
}

/// Grains of a rain that overlap are refused, though nobody looks for them later; and so
/// is one that is put among those aloft.
#[test]
fn a_rain_that_overlaps_is_refused() {
    let model = || fountain::<3>(1, 0.0, 0.0).model;
    let mut rain: Vec<_> = (0..40)
        .map(|place| {
            let height = 5.0 + 1.5 * f64::from(place);
            let position = Vector::<3>::new(1.0, 1.0, height);
            Particle::new(position, Vector::<3>::new(0.0, 0.0, -2.5)).with_mode(Mode::Falling)
        })
        .collect();
    let floor =
        Particle::new(Vector::<3>::new(3.0, 3.0, 0.0), Vector::zeros()).with_mode(Mode::Fixed);
    rain.push(floor);
    let mut simulation = Simulation::new(model(), rain.clone()).unwrap();
    assert_eq!(simulation.world.aloft.waiting.len(), 40);
    assert!(matches!(
        simulation.insert(rain[20]),
        Err(SetupError::Overlap { .. })
    ));
    rain[20].position[2] += 0.75;
    assert!(matches!(
        Simulation::new(model(), rain),
        Err(SetupError::Overlap { .. })
    ));
}

/// A grain that is set free high up makes those aloft land sooner.
#[test]
fn one_set_free_among_a_rain_is_seen() {
    let calm = fountain::<3>(3, 0.0, 0.0);
    let mut grains = calm.snapshot();
    let fixed = ParticleId(grains.len() as u32);
    // Higher than all others, and not far below the rain.
    let place = Vector::<3>::new(2.5, 2.5, 1.6);
    grains.push(Particle::new(place, Vector::zeros()).with_mode(Mode::Fixed));
    let mut simulation = Simulation::new(calm.model, grains).unwrap();
    assert!(!simulation.world.aloft.is_empty());
    let ceiling = simulation.world.aloft.ceiling;
    simulation
        .set_free(fixed, Vector::<3>::new(0.0, 0.0, 0.1))
        .unwrap();
    assert!(simulation.world.aloft.ceiling > ceiling);
    assert_eq!(simulation.check_everything(), Ok(()));
    let saved = simulation.save();
    assert!(Simulation::restore(simulation.model, saved).is_ok());
}

#[test]
fn one_aloft_that_can_be_found_is_seen() {
    let mut simulation = fountain::<3>(1, 0.0, 0.0);
    assert_eq!(simulation.check_everything(), Ok(()));
    let (_, lowest) = *simulation.world.aloft.waiting.last().unwrap();
    let position = simulation.world.bodies[lowest as usize].position;
    simulation.world.near.release(lowest, &position, 0.5);
    let fault = simulation.check_everything().unwrap_err();
    assert!(fault.contains("is aloft and in the grid"), "{fault}");
}

/// Gives everybody a list.
fn ground<const D: usize>(simulation: &mut Simulation<Model<D>, D>) {
    while let Some((_, lowest)) = simulation.world.aloft.waiting.pop() {
        simulation.land(lowest);
        simulation
            .world
            .aloft
            .waiting
            .retain(|(_, id)| *id != lowest);
    }
}

fn check<const D: usize>(seed: u64, aslant: f64, rising: f64) -> Result<(), TestCaseError> {
    let mut aloft = fountain::<D>(seed, aslant, rising);
    prop_assert!(aloft.world.aloft.waiting.len() > 20);
    let mut grounded = fountain::<D>(seed, aslant, rising);
    ground(&mut grounded);
    prop_assert!(grounded.world.aloft.is_empty());
    let (mut one, mut other) = (TrajectoryHash::new(), TrajectoryHash::new());
    for step in 1..=40 {
        let limits = Limits {
            time: Time::from_units(0.3 * f64::from(step)),
            ..Limits::events(20_000)
        };
        let reason = aloft.run(&limits, &mut one);
        grounded.run(&limits, &mut other);
        prop_assert_eq!(one.value(), other.value(), "at {}", aloft.time());
        let audit = aloft.audit();
        prop_assert!(audit.missed.is_empty(), "{}", audit.missed[0]);
        prop_assert!(
            aloft.check_everything().is_ok(),
            "{:?}",
            aloft.check_everything()
        );
        if step % 7 == 0 {
            let saved = aloft.save();
            aloft = Simulation::restore(aloft.model, saved).unwrap();
        }
        if reason != StopReason::Time {
            break;
        }
    }
    prop_assert!(aloft.counts().transfer < grounded.counts().transfer);
    prop_assert_eq!(aloft.snapshot(), grounded.snapshot());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn a_rain_falls_the_same_way_aloft(
        seed in 0_u64..1000,
        walled in any::<bool>(),
        aslant in 0.05..0.6,
        rising in 0.0..8.0,
        flat in any::<bool>(),
    ) {
        let aslant = if walled { aslant } else { 0.0 };
        if flat {
            check::<2>(seed, aslant, rising)?;
        } else {
            check::<3>(seed, aslant, rising)?;
        }
    }
}
