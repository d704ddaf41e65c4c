//! Velocities of a gas.

use rand_chacha::ChaCha8Rng;

use crate::particle::Vector;
use crate::setup::random::normal;

/// Maxwellian velocities for grains of these masses, in √(gd), with zero total
/// momentum and exactly the kinetic temperature ⟨m v²⟩/D; all zero if there is
/// but one grain.
pub(super) fn thermal<const D: usize>(
    masses: &[f64],
    temperature: f64,
    rng: &mut ChaCha8Rng,
) -> Vec<Vector<D>> {
    let mut velocities: Vec<Vector<D>> = masses
        .iter()
        .map(|mass| Vector::from_fn(|_, _| normal(rng)) / mass.sqrt())
        .collect();
    let momentum = velocities
        .iter()
        .zip(masses)
        .fold(Vector::<D>::zeros(), |sum, (velocity, mass)| {
            sum + velocity * *mass
        });
    let drift = momentum / masses.iter().sum::<f64>();
    for velocity in &mut velocities {
        *velocity -= drift;
    }
    if velocities.len() == 1 {
        velocities[0] = Vector::zeros();
    }
    set_temperature(&mut velocities, masses, temperature);
    velocities
}

/// Scales velocities to the kinetic temperature ⟨m v²⟩/D, in mgd; nothing if
/// none moves.
pub(super) fn set_temperature<const D: usize>(
    velocities: &mut [Vector<D>],
    masses: &[f64],
    temperature: f64,
) {
    let twice_energy: f64 = velocities
        .iter()
        .zip(masses)
        .map(|(velocity, mass)| mass * velocity.norm_squared())
        .sum();
    if twice_energy > 0.0 {
        let factor = (temperature * (D * masses.len()) as f64 / twice_energy).sqrt();
        for velocity in velocities {
            *velocity *= factor;
        }
    }
}
