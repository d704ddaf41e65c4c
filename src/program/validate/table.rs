//! A subject's checks as a table, in Markdown, and their sources.

use crate::program::estimate::{Estimate, significant};
use crate::program::table::table;
use crate::program::validate::Outcome;
use crate::program::validate::check::{Check, Source};

const HEADINGS: [&str; 8] = [
    "quantity",
    "measured",
    "seeds",
    "reference",
    "source",
    "off by",
    "in errors",
    "verdict",
];

pub(super) fn of(outcome: &Outcome) -> String {
    let mut rows = vec![HEADINGS.map(str::to_owned).to_vec()];
    rows.extend(outcome.checks.iter().map(row));
    let mut text = format!("## {}: {}\n\n", outcome.subject, outcome.summary);
    text += &table(&rows);
    text.push('\n');
    for source in sources(&outcome.checks) {
        text += &format!("- {}: {}\n", source.name, source.citation);
    }
    text + &format!("- {:.1} s of processor time\n", outcome.seconds)
}

/// Each once, in the order in which they are met.
fn sources(checks: &[Check]) -> Vec<&'static Source> {
    let mut found: Vec<&'static Source> = Vec::new();
    for check in checks {
        if !found.iter().any(|known| std::ptr::eq(*known, check.source)) {
            found.push(check.source);
        }
    }
    found
}

fn row(check: &Check) -> Vec<String> {
    vec![
        check.quantity.clone(),
        with_error(check.measured, check.error),
        check.seeds.to_string(),
        significant(check.reference),
        check.source.name.to_owned(),
        percent(check.relative_deviation()),
        check
            .deviation_in_errors()
            .map_or("–".to_owned(), |errors| format!("{errors:+.1}")),
        check.verdict.name().to_owned(),
    ]
}

/// Two digits of the error.
fn with_error(value: f64, error: f64) -> String {
    let estimate = Estimate { mean: value, error };
    estimate
        .with_error()
        .unwrap_or_else(|| format!("{value:.12}"))
}

fn percent(share: f64) -> String {
    if share != 0.0 && share.abs() < 1e-6 {
        format!("{:+.0e} %", 100.0 * share)
    } else {
        format!("{:+.3} %", 100.0 * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_mean_something() {
        assert_eq!(with_error(3.98512, 0.00123), "3.9851 ± 0.0012");
        assert_eq!(with_error(0.5, 0.0), "0.500000000000");
        assert_eq!(percent(-0.0026), "-0.260 %");
        assert_eq!(percent(2.0e-14), "+2e-12 %");
    }
}
