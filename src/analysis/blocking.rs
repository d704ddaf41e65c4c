//! Means of values that come one after the other, and their errors.

/// Fewer blocks than this say too little of their scatter.
const FEWEST_BLOCKS: usize = 8;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The mean; not a number without values.
    pub value: f64,
    /// Its standard error; not a number for fewer than two values.
    pub error: f64,
    /// How many values it is of.
    pub count: usize,
}

/// The mean of values in the order of time, with a standard error that counts
/// correlation by block averages (Flyvbjerg & Petersen 1989,
/// doi:10.1063/1.457480).
///
/// The values are averaged in blocks of 1, 2, 4, … following ones, as long as
/// there are 8 blocks (a rest at the end is left out of the blocks, not of the
/// mean), and the greatest of the standard errors of the blocks' means is taken.
/// Of 2 to 15 values that is their plain standard error. Where values are
/// independent it is too large by some 10 %; where they are correlated for longer
/// than an eighth of the whole it is too small, and nothing can be done.
///
/// Values that are not finite are passed over, as of bins that were empty.
#[must_use]
pub fn blocked_mean(values: &[f64]) -> Mean {
    let values: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let count = values.len();
    let value = values.iter().sum::<f64>() / count as f64;
    let mut blocks = values;
    let mut error = standard_error(&blocks);
    while blocks.len() >= 2 * FEWEST_BLOCKS {
        blocks = blocks
            .chunks_exact(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        error = error.max(standard_error(&blocks));
    }
    Mean {
        value,
        error,
        count,
    }
}

/// s/√n with n − 1 degrees of freedom.
fn standard_error(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    if values.len() < 2 {
        return f64::NAN;
    }
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (squares / (count * (count - 1.0))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::seeded;
    use rand::RngExt;

    #[test]
    fn few_values_have_their_plain_error() {
        let mean = blocked_mean(&[1.0, 2.0, 3.0, f64::NAN, 4.0]);
        assert_eq!((mean.value, mean.count), (2.5, 4));
        // s² = 5/3.
        assert!((mean.error - (5.0 / 12.0_f64).sqrt()).abs() < 1.0e-15);
        assert!(blocked_mean(&[]).value.is_nan());
        assert!(blocked_mean(&[3.0]).error.is_nan() && blocked_mean(&[3.0]).value == 3.0);
        assert_eq!(blocked_mean(&[0.5; 100]).error, 0.0);
    }

    /// x' = a x + noise: the error of its mean is √((1 + a)/(1 − a)) times that of
    /// independent values.
    fn ratio(memory: f64) -> f64 {
        let mut random = seeded(7);
        let length = 1 << 14;
        let mut sum = 0.0;
        let rounds = 20;
        for _ in 0..rounds {
            let mut x = 0.0;
            let values: Vec<f64> = (0..length)
                .map(|_| {
                    x = memory * x + random.random::<f64>() - 0.5;
                    x
                })
                .collect();
            let known = (1.0 / 12.0_f64).sqrt() / ((1.0 - memory) * f64::from(length).sqrt());
            sum += blocked_mean(&values).error / known;
        }
        sum / f64::from(rounds)
    }

    #[test]
    fn correlation_makes_errors_longer() {
        for memory in [0.0, 0.5, 0.9, 0.98] {
            let ratio = ratio(memory);
            assert!((0.95..1.4).contains(&ratio), "{memory}: {ratio}");
        }
    }
}
