//! One quantity that was measured, beside what it should be.

use serde::Serialize;

/// Where a reference value comes from.
#[derive(Debug, Serialize)]
pub(super) struct Source {
    /// Authors and year, for the table.
    pub(super) name: &'static str,
    /// Where it stands.
    pub(super) citation: &'static str,
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub(super) mean: f64,
    pub(super) error: f64,
}

impl Estimate {
    /// Of independent samples. A single one has no known error.
    pub(super) fn of(samples: &[f64]) -> Self {
        let count = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let square = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        Estimate {
            mean,
            error: (square / (count * (count - 1.0))).sqrt(),
        }
    }

    /// Known to rounding.
    pub(super) fn exact(mean: f64) -> Self {
        Estimate { mean, error: 0.0 }
    }

    /// The same in another unit.
    pub(super) fn times(self, factor: f64) -> Self {
        Estimate {
            mean: self.mean * factor,
            error: self.error * factor,
        }
    }
}

/// What is allowed: so many standard errors of the measurement, and so much of
/// the reference value for the accuracy of the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowance {
    errors: f64,
    accuracy: f64,
}

impl Allowance {
    /// Four standard errors and this share of the reference.
    pub(super) const fn four_errors_and(accuracy: f64) -> Self {
        Allowance {
            errors: 4.0,
            accuracy,
        }
    }

    /// Four standard errors: the reference is exact.
    pub(super) const fn four_errors() -> Self {
        Allowance::four_errors_and(0.0)
    }

    /// This share of the reference, whatever the error.
    pub(super) const fn flat(accuracy: f64) -> Self {
        Allowance {
            errors: 0.0,
            accuracy,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    Pass,
    Fail,
    /// For comparison only: nothing was promised.
    Shown,
}

impl Verdict {
    pub(super) fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
            Verdict::Shown => "(shown)",
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Check {
    pub(super) quantity: String,
    pub(super) measured: f64,
    /// Standard error of the mean.
    pub(super) error: f64,
    pub(super) seeds: u64,
    pub(super) reference: f64,
    pub(super) source: &'static Source,
    /// Greatest absolute deviation that passes; none if it is not judged.
    pub(super) allowed: Option<f64>,
    pub(super) verdict: Verdict,
}

impl Check {
    /// Measured over so many seeds and judged.
    pub(super) fn judged(
        quantity: impl Into<String>,
        measured: Estimate,
        seeds: u64,
        (reference, source): (f64, &'static Source),
        allowance: Allowance,
    ) -> Self {
        let allowed = allowance.errors * measured.error + allowance.accuracy * reference.abs();
        let deviation = (measured.mean - reference).abs();
        Check {
            quantity: quantity.into(),
            measured: measured.mean,
            error: measured.error,
            seeds,
            reference,
            source,
            allowed: Some(allowed),
            // Whatever is not a number fails.
            verdict: if deviation <= allowed {
                Verdict::Pass
            } else {
                Verdict::Fail
            },
        }
    }

    /// Put beside a value that it need not meet.
    pub(super) fn shown(
        quantity: impl Into<String>,
        measured: Estimate,
        seeds: u64,
        (reference, source): (f64, &'static Source),
    ) -> Self {
        Check {
            quantity: quantity.into(),
            measured: measured.mean,
            error: measured.error,
            seeds,
            reference,
            source,
            allowed: None,
            verdict: Verdict::Shown,
        }
    }

    /// Deviation over the reference.
    pub(super) fn relative_deviation(&self) -> f64 {
        (self.measured - self.reference) / self.reference.abs()
    }

    /// Deviation in standard errors, where there is an error.
    pub(super) fn deviation_in_errors(&self) -> Option<f64> {
        (self.error > 0.0).then(|| (self.measured - self.reference) / self.error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: Source = Source {
        name: "theory",
        citation: "theory",
    };

    #[test]
    fn verdicts_follow_the_allowance() {
        let judge = |mean: f64, error: f64, allowance| {
            let measured = Estimate { mean, error };
            Check::judged("x", measured, 1, (10.0, &SOURCE), allowance).verdict
        };
        let allowance = Allowance::four_errors_and(0.01);
        assert_eq!(judge(10.49, 0.1, allowance), Verdict::Pass);
        assert_eq!(judge(10.51, 0.1, allowance), Verdict::Fail);
        assert_eq!(judge(9.49, 0.1, allowance), Verdict::Fail);
        assert_eq!(judge(f64::NAN, 0.1, allowance), Verdict::Fail);
        assert_eq!(judge(10.0, f64::NAN, allowance), Verdict::Fail);
        assert_eq!(judge(10.06, 0.1, Allowance::flat(0.005)), Verdict::Fail);
    }

    #[test]
    fn the_error_is_that_of_the_mean() {
        let estimate = Estimate::of(&[1.0, 2.0, 3.0, 4.0]);
        assert!((estimate.mean - 2.5).abs() < 1e-15);
        assert!((estimate.error - (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
    }
}
