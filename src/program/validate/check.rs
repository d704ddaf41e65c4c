//! One quantity that was measured, beside what it should be.

use serde::Serialize;

use crate::program::estimate::Estimate;

/// Where a reference value comes from.
#[derive(Debug, Serialize)]
pub(super) struct Source {
    /// Authors and year, for the table.
    pub(super) name: &'static str,
    /// Where it stands.
    pub(super) citation: &'static str,
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
}
