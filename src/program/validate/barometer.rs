//! The density of an elastic gas on a floor under gravity.

use crate::analysis::{ball_volume, kolafa_labik_malijevsky};
use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::{Guards, Limits, Settings, Simulation};
use crate::error::SetupError;
use crate::model::Parts;
use crate::particle::{Particle, Vector};
use crate::policy::Criterion;
use crate::predict::Polynomial;
use crate::program::estimate::Estimate;
use crate::program::validate::check::{Allowance, Check, Source};
use crate::program::validate::effort::Effort;
use crate::setup::{Gas, seeded};
use crate::time::Time;

/// Temperature, in mgd, and so the scale height, in d.
const TEMPERATURE: f64 = 10.0;
/// What n Z at the floor is, as a packing fraction.
const FLOOR_FRACTION: f64 = 4.0e-3;
/// Where the bands end, in scale heights.
const BANDS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 3.0, f64::INFINITY];
/// Time between samples, in √(d/g).
const APART: f64 = 4.0;

/// Within a diameter of the floor the gas is denser than the hydrostatic equation
/// has it, by 4 φ = 1.6 % at contact: about 0.2 % of what is in the lowest band.
const ACCURACY: f64 = 2.0e-3;

static HYDROSTATIC: Source = Source {
    name: "hydrostatics",
    citation: "dP/dz = −m g n with P = n T Z, Z of J. Kolafa, S. Labík and A. Malijevský 2004, doi:10.1039/B402792B, times the exact (1 − m g z/E)^(f/2 + N − 2) e^(m g z/T) of an ideal gas at fixed energy and lateral momentum, f = 3N − 2",
};
static EQUIPARTITION: Source = Source {
    name: "exact",
    citation: "a Maxwell distribution of the same temperature at all heights; at fixed energy an ideal gas has ⟨E − m g z⟩ for every grain alike, which makes less than 1/N",
};

pub(super) fn checks(effort: Effort) -> Result<Vec<Check>, SetupError> {
    let count = effort.pick(200, 500, 1000);
    let seeds = effort.pick(2, 4, 8);
    let (settling, blocks, samples) = effort.pick((100.0, 4, 25), (300.0, 4, 75), (300.0, 8, 75));
    let mut heights = Vec::new();
    let mut ratios = Vec::new();
    let mut shares = vec![Vec::new(); BANDS.len()];
    let profile = Profile::new(count);
    // ⟨z⟩ = T would be that of an ideal gas: T has to come out right.
    let energy =
        TEMPERATURE * (0.5 * degrees_of_freedom(count) + count as f64 * profile.mean_height());
    for seed in 1..=seeds {
        let mut simulation = gas(count, energy, seed)?;
        let mut time = settling;
        simulation.run(&Limits::until(Time::from_units(time)), &mut ());
        for _ in 0..blocks {
            let mut sums = Sums::default();
            for _ in 0..samples {
                time += APART;
                simulation.run(&Limits::until(Time::from_units(time)), &mut ());
                sums.add(&simulation.snapshot());
            }
            let grains = (samples * count) as f64;
            heights.push(sums.height / grains / TEMPERATURE);
            ratios.push((sums.energy[1] / sums.counts[1]) / (sums.energy[0] / sums.counts[0]));
            let mut below = 0.0;
            for (band, share) in shares.iter_mut().enumerate() {
                share.push((sums.below[band] - below) / grains);
                below = sums.below[band];
            }
        }
    }
    let mut checks = vec![Check::judged(
        "⟨z⟩/T",
        Estimate::of(&heights),
        seeds,
        (profile.mean_height(), &HYDROSTATIC),
        Allowance::four_errors_and(ACCURACY),
    )];
    let mut from = 0.0;
    for (share, to) in shares.iter().zip(BANDS) {
        let range = if to.is_finite() {
            format!("{from} < z/T < {to}")
        } else {
            format!("{from} < z/T")
        };
        checks.push(Check::judged(
            format!("share of grains at {range}"),
            Estimate::of(share),
            seeds,
            (profile.share(from, to), &HYDROSTATIC),
            Allowance::four_errors_and(ACCURACY),
        ));
        from = to;
    }
    checks.push(Check::judged(
        "temperature above z = T over that below",
        Estimate::of(&ratios),
        seeds,
        (1.0, &EQUIPARTITION),
        Allowance::four_errors_and(1.0 / count as f64),
    ));
    Ok(checks)
}

type Model = Parts<UniformGravity<3>, Polynomial, Restitution, Criterion, Cuboid<3>>;

/// Edge of the square floor for so many grains, in d.
fn floor_edge(count: usize) -> f64 {
    // Weight over area is n T Z at the floor.
    let column = FLOOR_FRACTION / ball_volume::<3>(0.5) * TEMPERATURE;
    (count as f64 / column).sqrt()
}

/// Grains spread evenly up to two scale heights, with energy for the
/// temperature that is wanted once they are in equilibrium.
fn gas(count: usize, energy: f64, seed: u64) -> Result<Simulation<Model, 3>, SetupError> {
    let edge = floor_edge(count);
    let height = 2.0 * TEMPERATURE;
    let source = Gas::<3> {
        count,
        packing_fraction: count as f64 * ball_volume::<3>(0.5) / (edge * edge * height),
        temperature: TEMPERATURE,
        aspect: Vector::<3>::new(edge / height, edge / height, 1.0),
        ..Gas::default()
    };
    let (mut grains, edges) = source.grains(&mut seeded(seed))?;
    // The energy exactly as wanted.
    let potential: f64 = grains.iter().map(|grain| grain.position[2]).sum();
    let kinetic: f64 = grains.iter().map(Particle::kinetic_energy).sum();
    let factor = ((energy - potential) / kinetic).sqrt();
    for grain in &mut grains {
        grain.velocity *= factor;
    }
    let model = Parts {
        dynamics: UniformGravity::<3>::down(),
        predictor: Polynomial,
        collision_rule: Restitution::elastic(),
        state_policy: Criterion::Never,
        boundary: Cuboid::new([
            Side::periodic(edges[0]),
            Side::periodic(edges[1]),
            // Heights are those of centres above where they touch the floor.
            Side::floor(-0.5, 1.0),
        ])?,
    };
    let settings = Settings {
        guards: Guards::none(),
        ..Settings::default()
    };
    Simulation::with_settings(model, grains, settings)
}

/// f: all velocities but the two lateral components of the total momentum.
fn degrees_of_freedom(count: usize) -> f64 {
    (3 * count - 2) as f64
}

#[derive(Default)]
struct Sums {
    height: f64,
    /// Grains below the end of each band.
    below: [f64; BANDS.len()],
    /// Below and above one scale height.
    counts: [f64; 2],
    energy: [f64; 2],
}

impl Sums {
    fn add(&mut self, grains: &[Particle<3>]) {
        for grain in grains {
            let height = grain.position[2];
            self.height += height;
            for (below, end) in self.below.iter_mut().zip(BANDS) {
                if height < end * TEMPERATURE {
                    *below += 1.0;
                }
            }
            let side = usize::from(height > TEMPERATURE);
            self.counts[side] += 1.0;
            self.energy[side] += grain.kinetic_energy();
        }
    }
}

/// The density that is expected, in steps of the scale height / 1000.
struct Profile {
    densities: Vec<f64>,
}

const STEPS: usize = 1000;
const TOP: usize = 30;

impl Profile {
    fn new(count: usize) -> Self {
        // E/T of an ideal gas.
        let shares = 0.5 * degrees_of_freedom(count) + count as f64;
        let step = 1.0 / STEPS as f64;
        let product = |fraction: f64| fraction * kolafa_labik_malijevsky(fraction);
        let slope = |fraction: f64| {
            let fall = 1e-3 * fraction;
            (product(fraction + fall) - product(fraction - fall)) / (2.0 * fall)
        };
        // d(φZ)/dz = −φ, heights in scale heights, from φZ at the floor.
        let fall = |fraction: f64| -fraction / slope(fraction);
        let mut fraction = FLOOR_FRACTION;
        while product(fraction) / FLOOR_FRACTION - 1.0 > 1e-14 {
            fraction *= FLOOR_FRACTION / product(fraction);
        }
        let densities = (0..=TOP * STEPS)
            .map(|place| {
                let height = place as f64 * step;
                let here = fraction;
                let half = here + 0.5 * step * fall(here);
                fraction += step * fall(half);
                let left = (1.0 - height / shares).max(0.0);
                here * libm::pow(left, shares - 2.0) * libm::exp(height)
            })
            .collect();
        Profile { densities }
    }

    /// ∫ n z^power dz between two heights, by the trapezium rule.
    fn integral(&self, from: f64, to: f64, power: i32) -> f64 {
        let place = |height: f64| ((height * STEPS as f64).round() as usize).min(TOP * STEPS);
        let value =
            |place: usize| self.densities[place] * (place as f64 / STEPS as f64).powi(power);
        (place(from)..place(to))
            .map(|left| 0.5 * (value(left) + value(left + 1)) / STEPS as f64)
            .sum()
    }

    fn share(&self, from: f64, to: f64) -> f64 {
        self.integral(from, to, 0) / self.integral(0.0, f64::INFINITY, 0)
    }

    /// In scale heights.
    fn mean_height(&self) -> f64 {
        self.integral(0.0, f64::INFINITY, 1) / self.integral(0.0, f64::INFINITY, 0)
    }
}
