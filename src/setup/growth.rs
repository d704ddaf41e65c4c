//! Dense random packings by growth: Lubachevsky & Stillinger 1990,
//! doi:10.1007/BF01025983.

use rand_chacha::ChaCha8Rng;

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::{ForceFree, Growing};
use crate::engine::{Guards, Limits, Settings, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::Parts;
use crate::particle::{Particle, Vector};
use crate::policy::Never;
use crate::predict::Polynomial;
use crate::setup::insertion::insert;
use crate::setup::mass_of;
use crate::setup::region::Region;
use crate::setup::velocities::{set_temperature, thermal};
use crate::time::Time;

/// Growth of a diameter in the time a grain takes to cross it.
const RATE: f64 = 0.05;

/// Diameters grow by this factor before the heat of compression is taken out.
const STAGE: f64 = 1.02;

/// Diameters grow by this much too far, so that the grains are a hair apart
/// when they get the diameters that were wanted.
const EXCESS: f64 = 1.0e-9;

/// A stage that needs more events than this for each grain has jammed: at
/// φ = 0.60 it needs about 25.
const EVENTS_EACH: u64 = 500;

/// Why there is no packing.
pub(super) enum Failure {
    /// The grains jammed before they had grown to their size.
    Jammed,
    /// The set-up itself is wrong.
    Setup(SetupError),
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        Failure::Setup(error)
    }
}

/// Disordered places for grains of these diameters, in the same order, that
/// don't overlap, however dense, up to where random packings jam.
///
/// Small images of the grains are put in at random; then they move as an
/// elastic gas while they grow, all in proportion.
pub(super) fn packed<const D: usize>(
    region: &Region<D>,
    diameters: &[f64],
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Vector<D>>, Failure> {
    let solid: f64 = diameters
        .iter()
        .map(|&diameter| crate::analysis::ball_volume::<D>(0.5 * diameter))
        .sum();
    let ratio = insertable_fraction(D) * region.volume() / solid;
    if ratio >= 1.0 {
        return Ok(insert(region, diameters, rng)?);
    }
    let (mut scale, mut places) = seeds(region, diameters, libm::pow(ratio, 1.0 / D as f64), rng)?;

    // In units of the mean grain: then thermal speeds are about one diameter
    // per unit of time, and the growth is slow beside them whatever the sizes.
    let mean = diameters.iter().sum::<f64>() / diameters.len() as f64;
    let masses: Vec<f64> = diameters
        .iter()
        .map(|diameter| mass_of::<D>(diameter / mean))
        .collect();
    let temperature = mean * mean;
    let mut velocities = thermal::<D>(&masses, temperature, rng);

    let boundary = Cuboid::new(std::array::from_fn(|axis| {
        let (origin, length) = (region.origin[axis], region.lengths[axis]);
        if region.periodic[axis] {
            Side::Periodic { origin, length }
        } else {
            Side::Walls {
                low: Some(origin),
                high: Some(origin + length),
                restitution: 1.0,
            }
        }
    }))?;
    let wanted = 1.0 + EXCESS;
    while scale < wanted {
        let next = (scale * STAGE).min(wanted);
        let grains: Vec<Particle<D>> = (0..diameters.len())
            .map(|i| {
                Particle::new(places[i], velocities[i])
                    .with_diameter(diameters[i] * scale)
                    .with_mass(masses[i])
            })
            .collect();
        let model = Parts {
            dynamics: Growing::new(ForceFree, RATE),
            predictor: Polynomial,
            collision_rule: Restitution::elastic(),
            state_policy: Never,
            boundary: boundary.clone(),
        };
        // Guards are against grains that come to rest; here none does.
        let settings = Settings {
            guards: Guards::none(),
            ..Settings::default()
        };
        let mut simulation = Simulation::with_settings(model, grains, settings)?;
        let limits = Limits {
            time: Time::from_units((next / scale - 1.0) / RATE),
            events: EVENTS_EACH * diameters.len() as u64,
            ..Limits::default()
        };

        if simulation.run(&limits, &mut ()) != StopReason::Time {
            return Err(Failure::Jammed);
        }
        for (i, grain) in simulation.snapshot().iter().enumerate() {
            places[i] = grain.position;
            velocities[i] = grain.velocity;
        }
        set_temperature(&mut velocities, &masses, temperature);
        scale = next;
    }
    Ok(places)
}

/// Random places for images of the grains scaled by `scale`, or by less where
/// that leaves no room, as between narrow walls; and the scale.
fn seeds<const D: usize>(
    region: &Region<D>,
    diameters: &[f64],
    mut scale: f64,
    rng: &mut ChaCha8Rng,
) -> Result<(f64, Vec<Vector<D>>), SetupError> {
    let mut attempts = 0;
    loop {
        let small: Vec<f64> = diameters.iter().map(|diameter| diameter * scale).collect();
        match insert(region, &small, rng) {
            Err(SetupError::NoRoom { .. }) if attempts < 10 => {
                attempts += 1;
                scale *= 0.85;
            }
            placed => return Ok((scale, placed?)),
        }
    }
}

/// A packing fraction that random insertion reaches with ease: half of where it
/// jams (0.75, 0.55, 0.38, 0.26, … in 1, 2, 3, 4, … dimensions).
fn insertable_fraction(dimension: usize) -> f64 {
    (1..dimension).fold(0.37, |fraction, _| fraction * 0.71)
}
