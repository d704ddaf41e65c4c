//! Self-diffusion of elastic spheres.

use std::f64::consts::PI;

use crate::analysis::kinetic_theory::{
    collision_frequency, self_diffusion_spheres, viscosity_spheres,
};
use crate::analysis::{ball_volume, contact_value, kolafa_labik_malijevsky};
use crate::engine::Limits;
use crate::error::SetupError;
use crate::observe::Displacements;
use crate::particle::Vector;
use crate::program::estimate::Estimate;
use crate::program::validate::check::{Allowance, Check, Source};
use crate::program::validate::effort::Effort;
use crate::program::validate::fluid::Fluid;

/// The dilute one is compared with Enskog's theory.
const FRACTIONS: [f64; 5] = [0.02, 0.1, 0.2, 0.3, 0.4];

/// Samples from the beginning to the end of the stretch over which the slope of
/// the mean square displacement is taken.
const SAMPLES: usize = 8;

/// ξ of a cubic box in the finite-size correction.
const CUBE: f64 = 2.837_297;

/// What a grain diffuses less in a periodic box than in an infinite one:
/// ξ T/(6π (η + nD) L). It is the correction of Yeh & Hummer 2004,
/// doi:10.1021/jp0477147, where η + nD stands for η: the grain's own diffusion
/// helps to end its memory of the flow that it has made (Ernst, Hauge & van
/// Leeuwen 1970, doi:10.1103/PhysRevLett.25.1254), which is half of it in a gas
/// and next to nothing in a liquid.
fn size_correction(viscosity: f64, density: f64, diffusion: f64, edge: f64) -> f64 {
    CUBE / (6.0 * PI * (viscosity + density * diffusion) * edge)
}

static ENSKOG: Source = Source {
    name: "Enskog",
    citation: "S. Chapman and T. G. Cowling 1970, sections 10.6 and 16.2, the first term in the density",
};
static RUCKENSTEIN: Source = Source {
    name: "Ruckenstein-Liu",
    citation: "E. Ruckenstein and H. Liu 1997, Ind. Eng. Chem. Res. 36, 3927, a fit to the simulations of B. J. Alder, D. M. Gass and T. E. Wainwright 1970, doi:10.1063/1.1673845, and of J. J. Erpenbeck and W. W. Wood 1991, doi:10.1103/PhysRevA.43.4254",
};
static SPEEDY: Source = Source {
    name: "Speedy 1987",
    citation: "R. J. Speedy 1987, doi:10.1080/00268978700102371",
};

/// D over that of the Enskog theory, both to first order in the Sonine
/// polynomials, after Ruckenstein & Liu.
fn ruckenstein_liu(density: f64) -> f64 {
    let cube = density * density * density;
    1.0 + 0.94605 * density * density.sqrt() + 1.4022 * cube - 5.6898 * cube * density * density
        + 2.6626 * cube * cube * density
}

/// D after Speedy at temperature 1, in d√(T/m).
fn speedy(density: f64) -> f64 {
    let square = density * density;
    0.375 / (density * PI.sqrt()) * (1.0 - density / 1.09) * (1.0 + square * (0.4 - 0.83 * square))
}

pub(super) fn checks(effort: Effort) -> Result<Vec<Check>, SetupError> {
    let count = effort.pick(256, 500, 2000);
    let seeds = effort.pick(2, 3, 5);
    let stretches = effort.pick(12, 8, 8);
    let fractions = match effort {
        Effort::Short => &FRACTIONS[2..3],
        _ => &FRACTIONS[..],
    };
    let mut checks = Vec::new();
    for &fraction in fractions {
        let density = fraction / ball_volume::<3>(0.5);
        let contact = contact_value::<3>(fraction, kolafa_labik_malijevsky(fraction));
        let viscosity = viscosity_spheres(density, 1.0, contact);
        let mut values = Vec::new();
        let mut edge = 0.0;
        for seed in 1..=seeds {
            let mut fluid = Fluid::<3>::new(count, fraction, 1.0, seed)?;
            fluid.run(effort.pick(50, 100, 100), &mut ());
            // Long after a shear wave has crossed the box: then the images slow
            // the grain down as the correction says.
            let crossing = fluid.edge * fluid.edge * density / (4.0 * PI * PI * viscosity);
            let begin =
                (3.0 * crossing).max(10.0 / collision_frequency::<3>(density, 1.0, contact));
            values.extend(slopes(&mut fluid, begin, stretches));
            edge = fluid.edge;
        }
        let single = Estimate::of(&values);
        let correction = size_correction(viscosity, density, single.mean, edge);
        let whole = Estimate {
            mean: single.mean + correction,
            error: single.error,
        };
        // In units of Enskog's value, first Sonine order.
        let first_order = self_diffusion_spheres(density, 1.0, contact) / 1.01896;
        let name = format!(
            "D/D_E, φ = {fraction:.2}, of it {:.3} for the size of the box",
            correction / first_order
        );
        let ratio = whole.times(1.0 / first_order);
        if fraction < 0.05 {
            // The next term in the density is about 1 % here.
            checks.push(Check::judged(
                name,
                ratio,
                seeds,
                (1.01896, &ENSKOG),
                Allowance::four_errors_and(0.015),
            ));
        } else {
            // The fit scatters about the simulations by as much.
            checks.push(Check::judged(
                name.clone(),
                ratio,
                seeds,
                (ruckenstein_liu(density), &RUCKENSTEIN),
                Allowance::four_errors_and(0.03),
            ));
            checks.push(Check::shown(
                name,
                ratio,
                seeds,
                (speedy(density) / first_order, &SPEEDY),
            ));
        }
    }
    Ok(checks)
}

/// D in the box as it is, over successive stretches of time: (⟨r²(3b)⟩ −
/// ⟨r²(b)⟩)/(6 · 2b), for many starting times. In units of a gas of temperature 1.
fn slopes(fluid: &mut Fluid<3>, begin: f64, stretches: usize) -> Vec<f64> {
    let unit = 1.0 / fluid.temperature().sqrt();
    let simulation = &mut fluid.simulation;
    let start = simulation.time();
    let mut displacements = Displacements::new(start, &simulation.snapshot());
    let step = begin * unit / SAMPLES as f64;
    let (short, long) = (SAMPLES, 3 * SAMPLES);
    let mut track: Vec<Vec<Vector<3>>> = Vec::new();
    let mut slopes = Vec::new();
    for sample in 0..=long * stretches {
        let now = start + step * sample as f64;
        simulation.run(&Limits::until(now), &mut displacements);
        track.push(displacements.at(now, &simulation.snapshot()));
    }
    let mean_square = |from: usize, to: usize| {
        let pairs = track[from].iter().zip(&track[to]);
        pairs.map(|(a, b)| (b - a).norm_squared()).sum::<f64>() / fluid.count as f64
    };
    for stretch in 0..stretches - 1 {
        let origins = stretch * long..(stretch + 1) * long;
        let count = origins.len() as f64;
        let sum: f64 = origins
            .map(|origin| mean_square(origin, origin + long) - mean_square(origin, origin + short))
            .sum();
        let time = step * (long - short) as f64;
        slopes.push(sum / count / (6.0 * time) * unit);
    }
    slopes
}
