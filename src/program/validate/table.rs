//! A subject's checks as a table, in Markdown, and their sources.

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
    let mut rows = vec![HEADINGS.map(str::to_owned)];
    rows.extend(outcome.checks.iter().map(row));
    let widths: Vec<usize> = (0..HEADINGS.len())
        .map(|column| {
            rows.iter()
                .map(|row| width(&row[column]))
                .max()
                .unwrap_or(0)
        })
        .collect();
    let line = |row: &[String; HEADINGS.len()]| {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, &wide)| format!("{cell}{}", " ".repeat(wide - width(cell))))
            .collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule: Vec<String> = widths.iter().map(|&wide| "-".repeat(wide + 2)).collect();

    let mut text = format!("## {}: {}\n\n", outcome.subject, outcome.summary);
    text += &line(&rows[0]);
    text += &format!("|{}|\n", rule.join("|"));
    for row in &rows[1..] {
        text += &line(row);
    }
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

fn row(check: &Check) -> [String; HEADINGS.len()] {
    [
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

/// As many columns as a terminal gives it; there are no wide characters here.
fn width(text: &str) -> usize {
    text.chars().count()
}

/// Two digits of the error.
fn with_error(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return format!("{value:.12}");
    }
    let places = (1.0 - libm::floor(libm::log10(error))).clamp(0.0, 12.0) as usize;
    format!("{value:.places$} ± {error:.places$}")
}

fn significant(value: f64) -> String {
    let places = if value == 0.0 {
        0.0
    } else {
        5.0 - libm::floor(libm::log10(value.abs()))
    };
    format!("{value:.*}", places.clamp(0.0, 12.0) as usize)
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
        assert_eq!(with_error(1234.5, 12.0), "1234 ± 12");
        assert_eq!(significant(3.983983), "3.98398");
        assert_eq!(percent(-0.0026), "-0.260 %");
        assert_eq!(percent(2.0e-14), "+2e-12 %");
    }
}
