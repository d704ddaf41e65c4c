//! Equations of state of elastic hard spheres and disks in equilibrium: the
//! compressibility factor Z = P / (n T) as a function of the packing fraction φ.

use crate::particle::Vector;

/// Z of hard spheres after Carnahan & Starling 1969, doi:10.1063/1.1672048:
/// (1 + φ + φ² − φ³) / (1 − φ)³.
///
/// Up to φ = 0.49 it is low by at most 0.3 %.
#[must_use]
pub fn carnahan_starling(packing_fraction: f64) -> f64 {
    let rest = 1.0 - packing_fraction;
    polynomial(&[1.0, 1.0, 1.0, -1.0], packing_fraction) / (rest * rest * rest)
}

/// Z of hard spheres after Kolafa, Labík & Malijevský 2004,
/// doi:10.1039/B402792B: a polynomial in φ/(1 − φ) fitted to the virial
/// coefficients and to long simulations of the fluid.
#[must_use]
pub fn kolafa_labik_malijevsky(packing_fraction: f64) -> f64 {
    const COEFFICIENTS: [f64; 23] = {
        let mut c = [0.0; 23];
        c[0] = 1.0;
        c[1] = 4.0;
        c[2] = 6.0;
        c[3] = 2.364_768_4;
        c[4] = -0.869_855_1;
        c[5] = 1.106_280_3;
        c[6] = -1.101_422_1;
        c[7] = 0.666_058_66;
        c[8] = -0.036_334_31;
        c[10] = -0.209_651_64;
        c[14] = 0.105_555_69;
        c[22] = -0.008_723_80;
        c
    };
    polynomial(&COEFFICIENTS, packing_fraction / (1.0 - packing_fraction))
}

/// Z of hard disks after Henderson 1975, doi:10.1080/00268977500102511:
/// (1 + φ²/8) / (1 − φ)².
///
/// It is too high by 0.1 % at φ = 0.4, 0.5 % at 0.5, 1.2 % at 0.6.
#[must_use]
pub fn henderson(packing_fraction: f64) -> f64 {
    let rest = 1.0 - packing_fraction;
    (1.0 + 0.125 * packing_fraction * packing_fraction) / (rest * rest)
}

/// Bₙ/B₂ⁿ⁻¹ of hard disks, n = 1 … 10: Clisby & McCoy 2006, table 1,
/// doi:10.1007/s10955-005-8080-0. The third is 4/3 − √3/π.
const DISK_VIRIALS: [f64; 10] = [
    1.0,
    1.0,
    0.782_004_437_7,
    0.532_231_80,
    0.333_556_04,
    0.198_842_5,
    0.114_872_8,
    0.064_993_0,
    0.036_219_3,
    0.019_953_7,
];

/// The same of hard spheres.
const SPHERE_VIRIALS: [f64; 10] = [
    1.0,
    1.0,
    0.625,
    0.286_949_5,
    0.110_252,
    0.038_881_98,
    0.013_023_54,
    0.004_183_2,
    0.001_309_4,
    0.000_403_5,
];

/// Z of hard disks: the \[4/5\] Padé approximant of the virial series with the
/// ten coefficients of Clisby & McCoy 2006, doi:10.1007/s10955-005-8080-0.
///
/// Where the series is cut matters by less than 0.01 % up to φ = 0.5, 0.03 % at
/// 0.6 and 0.1 % at 0.65 (the \[5/4\] approximant differs by this much).
#[must_use]
pub fn virial_disks(packing_fraction: f64) -> f64 {
    approximant(&DISK_VIRIALS, 2.0 * packing_fraction)
}

/// Z of hard spheres from the same source as [`virial_disks`].
#[must_use]
pub fn virial_spheres(packing_fraction: f64) -> f64 {
    approximant(&SPHERE_VIRIALS, 4.0 * packing_fraction)
}

/// The \[4/5\] Padé approximant of a power series in x.
fn approximant(series: &[f64; 10], x: f64) -> f64 {
    let term = |k: isize| usize::try_from(k).map_or(0.0, |k| series[k]);
    // 1 + q₁ x + … + q₅ x⁵ times the series has no terms x⁵ … x⁹.
    let equations = nalgebra::SMatrix::<f64, 5, 5>::from_fn(|row, column| {
        term(4 + row as isize - column as isize)
    });
    let right = Vector::<5>::from_fn(|row, _| -series[5 + row]);
    let Some(tail) = equations.lu().solve(&right) else {
        return f64::NAN;
    };
    let mut below = [1.0; 6];
    below[1..].copy_from_slice(tail.as_slice());
    let above: [f64; 5] =
        std::array::from_fn(|i| (0..=i).map(|j| below[j] * series[i - j]).sum::<f64>());
    polynomial(&above, x) / polynomial(&below, x)
}

/// c₀ + c₁ x + c₂ x² + …
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// χ, the pair distribution function at contact, that belongs to a Z of elastic
/// equal spheres: (Z − 1) / (2^(D−1) φ). It is what the Enskog theory needs.
#[must_use]
pub fn contact_value<const D: usize>(packing_fraction: f64, compressibility: f64) -> f64 {
    let second_virial = (1..D).fold(1.0, |product, _| 2.0 * product);
    (compressibility - 1.0) / (second_virial * packing_fraction)
}

/// What has to be added to Z of the infinite system for `count` grains in a
/// periodic box, to first order in 1/N: (φ/2N) ∂ ln S/∂φ with
/// 1/S = ∂(φ Z)/∂φ. It comes from the number of grains not fluctuating
/// (Lebowitz & Percus 1961, doi:10.1103/PhysRev.124.1673).
#[must_use]
pub fn periodic_correction(
    compressibility: impl Fn(f64) -> f64,
    packing_fraction: f64,
    count: usize,
) -> f64 {
    let step = 1.0e-3 * packing_fraction;
    let product = |fraction: f64| fraction * compressibility(fraction);
    let before = product(packing_fraction - step);
    let here = product(packing_fraction);
    let after = product(packing_fraction + step);
    let first = (after - before) / (2.0 * step);
    let second = (after - 2.0 * here + before) / (step * step);
    -packing_fraction * second / (2.0 * count as f64 * first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equations_for_spheres_agree_as_far_as_they_should() {
        for percent in 1..=49 {
            let fraction = f64::from(percent) / 100.0;
            let best = kolafa_labik_malijevsky(fraction);
            let virial = virial_spheres(fraction) / best - 1.0;
            assert!(virial.abs() < 1.0e-3, "{fraction}: {virial:e}");
            if percent <= 30 {
                assert!(virial.abs() < 3.0e-6, "{fraction}: {virial:e}");
            }
            let simple = carnahan_starling(fraction) / best - 1.0;
            assert!((-3.0e-3..0.0).contains(&simple), "{fraction}: {simple:e}");
        }
    }

    #[test]
    fn the_equations_for_disks_agree_as_far_as_they_should() {
        for percent in 1..=69 {
            let fraction = f64::from(percent) / 100.0;
            let simple = henderson(fraction) / virial_disks(fraction) - 1.0;
            let allowed = if percent <= 30 { 3.0e-4 } else { 0.026 };
            assert!(simple.abs() < allowed, "{fraction}: {simple:e}");
        }
    }

    #[test]
    fn the_third_virial_coefficients_are_the_exact_ones() {
        let exact = 4.0 / 3.0 - 3.0_f64.sqrt() / std::f64::consts::PI;
        assert!((DISK_VIRIALS[2] - exact).abs() < 1.0e-9);
        // B₃ = 10 for spheres of unit volume; from the fourth on, in φ.
        let third = |z: fn(f64) -> f64| (z(1.0e-3) - 1.0 - 4.0e-3 - 1.84e-8) * 1.0e6;
        assert!((third(kolafa_labik_malijevsky) - 10.0).abs() < 1.0e-3);
        assert!((third(virial_spheres) - 10.0).abs() < 1.0e-3);
    }

    #[test]
    fn contact_values_and_corrections_have_their_limits() {
        assert!((contact_value::<3>(1e-6, carnahan_starling(1e-6)) - 1.0).abs() < 1e-5);
        assert!((contact_value::<2>(1e-6, henderson(1e-6)) - 1.0).abs() < 1e-5);
        // Second virial coefficient alone: N grains make N − 1 partners.
        let correction = periodic_correction(carnahan_starling, 1.0e-4, 100);
        assert!((correction / -4.0e-6 - 1.0).abs() < 2.0e-3);
    }
}
