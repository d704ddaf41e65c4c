//! The distribution of velocities of an elastic gas.

use crate::error::SetupError;
use crate::particle::{Particle, Vector};
use crate::program::estimate::Estimate;
use crate::program::validate::check::{Allowance, Check, Source};
use crate::program::validate::effort::Effort;
use crate::program::validate::fluid::Fluid;

const FRACTION: f64 = 0.2;
const BINS: usize = 40;
/// Samples are so many collisions of each grain apart: by then the fourth moment,
/// which relaxes within two or three, has been forgotten.
const APART: u64 = 10;
/// Blocks a run, whose means are taken for independent: an error from a few runs
/// alone would be good for nothing.
const BLOCKS: u32 = 10;

static MICROCANONICAL: Source = Source {
    name: "exact",
    citation: "Maxwell distribution at fixed energy and momentum: ⟨v⁴⟩/⟨v²⟩² = (1 + 2/D) f/(f + 2) with f = (N − 1) D",
};
static CHI_SQUARE: Source = Source {
    name: "Maxwell, χ²",
    citation: "χ² over its expected value for 40 bins of equal probability, whose counts are tied by their sum and, energy and momentum being fixed, by mean and variance",
};

pub(super) fn checks(effort: Effort) -> Result<Vec<Check>, SetupError> {
    let count = effort.pick(250, 1000, 4000);
    let seeds = effort.pick(2, 3, 5);
    let samples = effort.pick(4, 10, 20);
    let mut kurtoses = Vec::new();
    let mut bins = [0u64; BINS];
    for seed in 1..=seeds {
        // All of one speed, to begin with: the collisions have to do the rest.
        let mut fluid = Fluid::<3>::with_velocities(count, FRACTION, 1.0, seed, one_speed)?;
        fluid.run(50, &mut ());
        for _ in 0..BLOCKS {
            let mut sum = 0.0;
            for _ in 0..samples {
                fluid.run(APART, &mut ());
                let grains = fluid.simulation.snapshot();
                sum += kurtosis(&grains);
                fill(&mut bins, &grains);
            }
            kurtoses.push(sum / f64::from(samples));
        }
    }
    let freedom = ((count - 1) * 3) as f64;
    let exact = 5.0 / 3.0 * freedom / (freedom + 2.0);
    Ok(vec![
        Check::judged(
            format!("⟨v⁴⟩/⟨v²⟩², φ = {FRACTION:.1}"),
            Estimate::of(&kurtoses),
            seeds,
            (exact, &MICROCANONICAL),
            Allowance::four_errors(),
        ),
        Check::judged(
            format!("χ² of one component of v, φ = {FRACTION:.1}"),
            chi_square(&bins),
            seeds,
            (1.0, &CHI_SQUARE),
            Allowance::four_errors(),
        ),
    ])
}

/// Directions as they are, speeds alike but for the total momentum, which
/// vanishes; and about the same energy.
fn one_speed(grains: &mut [Particle<3>]) {
    for grain in grains.iter_mut() {
        let speed = grain.velocity.norm();
        if speed > 0.0 {
            grain.velocity *= 3.0_f64.sqrt() / speed;
        }
    }
    let mean = grains
        .iter()
        .fold(Vector::<3>::zeros(), |sum, grain| sum + grain.velocity)
        / grains.len() as f64;
    for grain in grains {
        grain.velocity -= mean;
    }
}

fn kurtosis(grains: &[Particle<3>]) -> f64 {
    let (mut second, mut fourth) = (0.0, 0.0);
    for grain in grains {
        let square = grain.velocity.norm_squared();
        second += square;
        fourth += square * square;
    }
    fourth * grains.len() as f64 / (second * second)
}

/// Sorts every component into bins of equal probability.
fn fill(bins: &mut [u64; BINS], grains: &[Particle<3>]) {
    let square: f64 = grains.iter().map(|g| g.velocity.norm_squared()).sum();
    let deviation = (square / (3 * grains.len()) as f64).sqrt();
    for grain in grains {
        for component in &grain.velocity {
            let below = 0.5 * libm::erfc(-component / (deviation * std::f64::consts::SQRT_2));
            let bin = (below * BINS as f64) as usize;
            bins[bin.min(BINS - 1)] += 1;
        }
    }
}

/// χ² over the number of free bins, and the standard deviation of that.
fn chi_square(bins: &[u64; BINS]) -> Estimate {
    let total: u64 = bins.iter().sum();
    let expected = total as f64 / BINS as f64;
    let sum: f64 = bins
        .iter()
        .map(|&count| (count as f64 - expected) * (count as f64 - expected) / expected)
        .sum();
    let free = (BINS - 3) as f64;
    Estimate {
        mean: sum / free,
        error: (2.0 / free).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_distribution_is_seen() {
        let mut grains: Vec<Particle<3>> = (0..1000)
            .map(|i| {
                let angle = f64::from(i);
                let velocity = Vector::<3>::new(angle.sin(), angle.cos(), (7.0 * angle).sin());
                Particle::new(Vector::zeros(), velocity)
            })
            .collect();
        one_speed(&mut grains);
        assert!((kurtosis(&grains) - 1.0).abs() < 0.01);
        let mut bins = [0; BINS];
        fill(&mut bins, &grains);
        assert!(chi_square(&bins).mean > 3.0);
    }
}
