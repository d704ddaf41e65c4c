//! Haff's law: how a homogeneous gas of inelastic grains cools.

use std::f64::consts::PI;

use crate::analysis::kinetic_theory::{
    cooling_rate, homogeneous_length, viscosity_disks, viscosity_spheres,
};
use crate::analysis::{contact_value, kolafa_labik_malijevsky, virial_disks};
use crate::error::SetupError;
use crate::program::estimate::Estimate;
use crate::program::validate::check::{Allowance, Check, Source};
use crate::program::validate::effort::Effort;
use crate::program::validate::fluid::Fluid;

const FRACTION: f64 = 0.05;

/// Collisions of each grain before the rate is measured, in which the velocity
/// distribution takes its form; and then, in each of two halves.
const BEFORE: u64 = 8;
const HALF: u64 = 12;

/// Enskog's theory leaves out that grains which have collided move alike; in a
/// gas as dilute as this it is good to about this.
const ACCURACY: f64 = 0.02;

static COOLING: Source = Source {
    name: "van Noije-Ernst",
    citation: "T. P. C. van Noije and M. H. Ernst 1998, doi:10.1007/s100350050009, in Haff's law (P. K. Haff 1983, doi:10.1017/S0022112083003419), with Enskog's χ",
};
static LINEAR: Source = Source {
    name: "Haff's law",
    citation: "P. K. Haff 1983, doi:10.1017/S0022112083003419: 1/√T grows linearly as long as the gas is homogeneous",
};
static LENGTH: Source = Source {
    name: "homogeneous",
    citation: "shear modes of wavelength L in a box shorter than L_c = 2π√(2ν/ζ) stay at 1/(1 − L²/L_c²) times the thermal energy (linear theory; Goldhirsch and Zanetti 1993, doi:10.1103/PhysRevLett.70.1619)",
};

/// In so many dimensions.
struct Kind {
    name: &'static str,
    compressibility: fn(f64) -> f64,
    viscosity: fn(f64, f64, f64) -> f64,
    count: usize,
    restitutions: &'static [f64],
}

static SPHERES: Kind = Kind {
    name: "spheres",
    compressibility: kolafa_labik_malijevsky,
    viscosity: viscosity_spheres,
    count: 1000,
    restitutions: &[0.7, 0.8, 0.9, 0.95],
};

static DISKS: Kind = Kind {
    name: "disks",
    compressibility: virial_disks,
    viscosity: viscosity_disks,
    count: 250,
    restitutions: &[0.8, 0.9],
};

pub(super) fn checks(effort: Effort) -> Result<Vec<Check>, SetupError> {
    let mut checks = cooling::<3>(effort, &SPHERES)?;
    checks.extend(cooling::<2>(effort, &DISKS)?);
    Ok(checks)
}

fn cooling<const D: usize>(effort: Effort, kind: &Kind) -> Result<Vec<Check>, SetupError> {
    let seeds = effort.pick(5, 12, 200);
    let restitutions = match effort {
        Effort::Short => &kind.restitutions[1..2],
        _ => kind.restitutions,
    };
    let contact = contact_value::<D>(FRACTION, (kind.compressibility)(FRACTION));
    let mut checks = Vec::new();
    for &restitution in restitutions {
        let mut rates = Vec::new();
        let mut bends = Vec::new();
        let mut shears = Vec::new();
        let mut box_over_length = 0.0;
        let mut theory = 0.0;
        for seed in 1..=seeds {
            let mut fluid = Fluid::<D>::new(kind.count, FRACTION, restitution, seed)?;
            let density = fluid.density();
            theory = cooling_rate::<D>(density, 1.0, contact, restitution);
            let viscosity = (kind.viscosity)(density, 1.0, contact) / density;
            box_over_length = fluid.edge / homogeneous_length(viscosity, theory);
            let mut points = Vec::new();
            for collisions in [BEFORE, HALF, HALF] {
                fluid.run(collisions, &mut ());
                points.push((fluid.simulation.time(), 1.0 / fluid.temperature().sqrt()));
            }
            // ζ = ζ₁ √T, so 1/√T grows by ζ₁/2 a unit of time.
            let slope = |from: usize, to: usize| {
                2.0 * (points[to].1 - points[from].1) / (points[to].0 - points[from].0)
            };
            rates.push(slope(0, 2));
            bends.push(slope(1, 2) / slope(0, 1));
            shears.push(shear_energy(&fluid));
        }
        let name = |what: &str| format!("{what}, {}, α = {restitution:.2}", kind.name);
        checks.push(Check::judged(
            name("ζ/√T"),
            Estimate::of(&rates),
            seeds,
            (theory, &COOLING),
            Allowance::four_errors_and(ACCURACY),
        ));
        checks.push(Check::judged(
            name("late over early slope of 1/√T"),
            Estimate::of(&bends),
            seeds,
            (1.0, &LINEAR),
            Allowance::four_errors_and(ACCURACY),
        ));
        checks.push(Check::shown(
            name(&format!("longest shear mode, L = {box_over_length:.2} L_c")),
            Estimate::of(&shears),
            seeds,
            (1.0 / (1.0 - box_over_length * box_over_length), &LENGTH),
        ));
    }
    Ok(checks)
}

/// Energy of the longest shear modes over their thermal energy: the mean over
/// all axes of |Σ v e^ikx|² m/(N T) with v across x.
fn shear_energy<const D: usize>(fluid: &Fluid<D>) -> f64 {
    let grains = fluid.simulation.snapshot();
    let mut sum = 0.0;
    for along in 0..D {
        let wave: Vec<(f64, f64)> = grains
            .iter()
            .map(|grain| {
                let phase = 2.0 * PI * grain.position[along] / fluid.edge;
                (libm::cos(phase), libm::sin(phase))
            })
            .collect();
        for across in (0..D).filter(|&axis| axis != along) {
            let (mut real, mut imaginary) = (0.0, 0.0);
            for (grain, (cos, sin)) in grains.iter().zip(&wave) {
                real += grain.velocity[across] * cos;
                imaginary += grain.velocity[across] * sin;
            }
            sum += real * real + imaginary * imaginary;
        }
    }
    let modes = (D * (D - 1)) as f64;
    sum / (modes * fluid.count as f64 * fluid.temperature())
}
