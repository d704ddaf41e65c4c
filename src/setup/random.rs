//! Random numbers. The arithmetic from bits to values is written out here, so
//! that a seed means the same initial state with every version of every library.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The generator of random numbers that belongs to `seed`.
#[must_use]
pub fn seeded(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A multiple of 2⁻⁵³, uniform in `[0, 1)`.
pub(super) fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    const STEP: f64 = 1.0 / (1u64 << 53) as f64;
    (rng.next_u64() >> 11) as f64 * STEP
}

/// A number from the normal distribution of mean 0 and variance 1, by
/// Marsaglia's polar method (doi:10.1137/1006063).
pub(super) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    loop {
        let x = 2.0 * uniform(rng) - 1.0;
        let y = 2.0 * uniform(rng) - 1.0;
        let square = x * x + y * y;
        if square < 1.0 && square > 0.0 {
            return x * (-2.0 * libm::log(square) / square).sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_have_their_moments() {
        let mut rng = seeded(1);
        let count = 100_000;
        let (mut first, mut second) = (0.0, 0.0);
        for _ in 0..count {
            let x = uniform(&mut rng);
            assert!((0.0..1.0).contains(&x));
            first += x;
            second += x * x;
        }
        // Five standard errors: √(1/12/n) and √(4/45/n).
        assert!((first / f64::from(count) - 0.5).abs() < 4.6e-3);
        assert!((second / f64::from(count) - 1.0 / 3.0).abs() < 4.8e-3);
    }

    #[test]
    fn normal_numbers_have_their_moments() {
        let mut rng = seeded(2);
        let count = 100_000;
        let mut moments = [0.0; 5];
        for _ in 0..count {
            let z = normal(&mut rng);
            let mut power = 1.0;
            for moment in &mut moments {
                *moment += power / f64::from(count);
                power *= z;
            }
        }
        // Five standard errors: √((⟨z^2k⟩ − ⟨z^k⟩²)/n) with 1, 3, 15, 105.
        for (k, (known, variance)) in [(1.0, 0.0), (0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)]
            .into_iter()
            .enumerate()
        {
            let tolerance = 5.0 * f64::sqrt(variance / f64::from(count)) + 1e-9;
            assert!((moments[k] - known).abs() < tolerance, "moment {k}");
        }
    }
}
