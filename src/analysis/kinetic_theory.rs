//! Kinetic theory of equal smooth hard spheres of unit diameter and mass, after
//! Enskog: collision frequency, cooling, transport.
//!
//! `density` is the number of grains per volume, in d^−D; `temperature` the
//! kinetic one, ⟨m v²⟩/D, in mgd; `contact` the pair distribution function at
//! contact χ (see [`contact_value`](crate::analysis::contact_value)).

use std::f64::consts::PI;

use crate::analysis::ball_volume;

/// How often one grain collides, in √(g/d): Ω n χ √(T/π), where Ω is the surface
/// of the unit sphere (Chapman & Cowling, *The Mathematical Theory of Non-Uniform
/// Gases*, 3rd edition 1970, sections 5.2 and 16.2).
#[must_use]
pub fn collision_frequency<const D: usize>(density: f64, temperature: f64, contact: f64) -> f64 {
    let surface = D as f64 * ball_volume::<D>(1.0);
    surface * density * contact * (temperature / PI).sqrt()
}

/// a₂, the first Sonine coefficient of the velocity distribution of a gas that
/// cools homogeneously with this restitution: van Noije & Ernst 1998,
/// doi:10.1007/s100350050009.
#[must_use]
pub fn sonine_coefficient<const D: usize>(restitution: f64) -> f64 {
    let (d, a) = (D as f64, restitution);
    16.0 * (1.0 - a) * (1.0 - 2.0 * a * a)
        / (9.0 + 24.0 * d + (8.0 * d - 41.0) * a + 30.0 * a * a * (1.0 - a))
}

/// ζ = −Ṫ/T of a gas that cools homogeneously, in √(g/d), with the first Sonine
/// correction: (1 − α²)(1 + 3 a₂/16)/D times the collision frequency of the
/// elastic gas (van Noije & Ernst 1998, doi:10.1007/s100350050009).
#[must_use]
pub fn cooling_rate<const D: usize>(
    density: f64,
    temperature: f64,
    contact: f64,
    restitution: f64,
) -> f64 {
    let frequency = collision_frequency::<D>(density, temperature, contact);
    let correction = 1.0 + 3.0 / 16.0 * sonine_coefficient::<D>(restitution);
    (1.0 - restitution * restitution) * correction * frequency / D as f64
}

/// Self-diffusion coefficient of elastic spheres in the Enskog theory, in d√(gd):
/// 1.01896 · 3/(8 n χ) √(T/π); the leading number is what higher Sonine orders
/// add (Chapman & Cowling 1970, section 10.6).
#[must_use]
pub fn self_diffusion_spheres(density: f64, temperature: f64, contact: f64) -> f64 {
    1.01896 * 0.375 / (density * contact) * (temperature / PI).sqrt()
}

/// Shear viscosity of elastic spheres in the Enskog theory, in m√(g/d)/d:
/// 1.016 · (5/16) √(T/π) (1/χ + 0.8 b + 0.7614 b² χ), b = 2πn/3 (Chapman &
/// Cowling 1970, section 16.5).
#[must_use]
pub fn viscosity_spheres(density: f64, temperature: f64, contact: f64) -> f64 {
    let volume = 2.0 * PI / 3.0 * density;
    1.016
        * 0.3125
        * (temperature / PI).sqrt()
        * (1.0 / contact + 0.8 * volume + 0.7614 * volume * volume * contact)
}

/// Shear viscosity of elastic disks in the Enskog theory, in m√(g/d):
/// 1.022 · ½ √(T/π) (1/χ + b + 0.8729 b² χ), b = πn/2 (Gass 1971,
/// doi:10.1063/1.1675116).
#[must_use]
pub fn viscosity_disks(density: f64, temperature: f64, contact: f64) -> f64 {
    let area = 0.5 * PI * density;
    1.022
        * 0.5
        * (temperature / PI).sqrt()
        * (1.0 / contact + area + 0.8729 * area * area * contact)
}

/// The longest box in which a cooling gas stays homogeneous, in d: 2π √(2ν/ζ),
/// with the kinematic viscosity ν and the cooling rate ζ at the same temperature.
/// In a longer one shear flows outlive the heat and grow (Goldhirsch & Zanetti
/// 1993, doi:10.1103/PhysRevLett.70.1619).
#[must_use]
pub fn homogeneous_length(kinematic_viscosity: f64, cooling_rate: f64) -> f64 {
    2.0 * PI * (2.0 * kinematic_viscosity / cooling_rate).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_prefactors() {
        let three = collision_frequency::<3>(0.1, 1.0, 1.0) / (0.4 * PI.sqrt());
        let two = collision_frequency::<2>(0.1, 1.0, 1.0) / (0.2 * PI.sqrt());
        assert!((three - 1.0).abs() < 1e-15 && (two - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_sonine_coefficient_has_its_form_in_three_dimensions_and_its_zero() {
        for a in [0.5, 0.7, 0.9_f64] {
            let wanted = 16.0 * (1.0 - a) * (1.0 - 2.0 * a * a)
                / (81.0 - 17.0 * a + 30.0 * a * a * (1.0 - a));
            assert!((sonine_coefficient::<3>(a) - wanted).abs() < 1e-15);
        }
        assert!(sonine_coefficient::<2>(0.5_f64.sqrt()).abs() < 1e-15);
    }
}
