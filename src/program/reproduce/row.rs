//! One number of the paper beside the same number found here.

use serde::Serialize;

use crate::program::estimate::{Estimate, significant};

/// What the paper says.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Paper {
    pub(super) value: f64,
    /// What it gives as its error; 0 if it gives none.
    pub(super) error: f64,
}

/// How the two compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    Agrees,
    Differs,
    /// The paper has no number for it, or none that could be held to.
    Shown,
}

impl Verdict {
    pub(super) fn name(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Shown => "(shown)",
        }
    }
}

/// A row of the table.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    /// Which figure or number of the paper.
    pub(super) of: &'static str,
    pub(super) quantity: String,
    pub(super) paper: Option<Paper>,
    pub(super) found: f64,
    /// Standard error; null if it is not known.
    pub(super) error: Option<f64>,
    /// How many runs it is of.
    pub(super) seeds: u64,
    /// Greatest deviation that counts as agreement.
    pub(super) tolerance: Option<f64>,
    pub(super) verdict: Verdict,
    /// What it means.
    pub(super) words: String,
}

impl Row {
    /// Found, with nothing to compare.
    pub(super) fn shown(
        of: &'static str,
        quantity: impl Into<String>,
        found: Estimate,
        seeds: usize,
        words: impl Into<String>,
    ) -> Self {
        Row {
            of,
            quantity: quantity.into(),
            paper: None,
            found: found.mean,
            error: found.error.is_finite().then_some(found.error),
            seeds: seeds as u64,
            tolerance: None,
            verdict: Verdict::Shown,
            words: words.into(),
        }
    }

    /// The same beside the paper's value: it agrees if it is within twice both
    /// errors together, and `allowed` more.
    pub(super) fn beside(mut self, value: f64, error: f64, allowed: f64) -> Self {
        let own = self.error.unwrap_or(0.0);
        let tolerance = 2.0 * own.hypot(error) + allowed;
        self.paper = Some(Paper { value, error });
        self.tolerance = Some(tolerance);
        // Whatever is not a number differs.
        self.verdict = if (self.found - value).abs() <= tolerance {
            Verdict::Agrees
        } else {
            Verdict::Differs
        };
        self
    }

    /// The same beside a bound: it agrees if it is that high, or within twice its
    /// error of it.
    pub(super) fn at_least(mut self, value: f64) -> Self {
        let tolerance = 2.0 * self.error.unwrap_or(0.0);
        self.paper = Some(Paper { value, error: 0.0 });
        self.tolerance = Some(tolerance);
        self.verdict = if self.found + tolerance >= value {
            Verdict::Agrees
        } else {
            Verdict::Differs
        };
        self
    }

    /// The value with its error, to be read.
    pub(super) fn found(&self) -> String {
        let estimate = Estimate {
            mean: self.found,
            error: self.error.unwrap_or(f64::NAN),
        };
        estimate.with_error().unwrap_or_else(|| plain(self.found))
    }

    /// The paper's value, to be read.
    pub(super) fn paper(&self) -> String {
        match self.paper {
            None => "–".to_owned(),
            Some(Paper { value, error }) if error > 0.0 => format!("{} ± {error}", plain(value)),
            Some(Paper { value, .. }) => plain(value),
        }
    }
}

/// Six digits, without zeros that say nothing.
fn plain(value: f64) -> String {
    if !value.is_finite() {
        return "unknown".to_owned();
    }
    let text = significant(value);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_errors() {
        let row = |mean: f64, error: f64| {
            Row::shown("x", "y", Estimate { mean, error }, 3, "")
                .beside(1.0, 0.03, 0.01)
                .verdict
        };
        // 2 √(0.04² + 0.03²) + 0.01 = 0.11.
        assert_eq!(row(1.109, 0.04), Verdict::Agrees);
        assert_eq!(row(1.111, 0.04), Verdict::Differs);
        assert_eq!(row(1.08, f64::NAN), Verdict::Differs);
        assert_eq!(row(f64::NAN, 0.04), Verdict::Differs);
    }

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        assert_eq!(plain(0.640 - 0.11 * 0.05), "0.6345");
        assert_eq!(plain(444.0), "444");
        assert_eq!(plain(1_000.0), "1000");
        assert_eq!(plain(f64::NAN), "unknown");
    }
}
