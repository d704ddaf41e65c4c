//! How densely deposits are packed: φ(V_t), and the loosest.

use crate::analysis::{LineFit, line_fit};
use crate::plot::{Axis, Chart, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::deposit::{one_by_one, over_seeds};
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};

/// φ(V_t), a straight line.
pub(in crate::program::reproduce) fn fraction(
    context: &Context<'_>,
) -> Result<Report, ProgramError> {
    let found = over_seeds(context, |s| Some(s.packing_fraction.as_ref()?.value))?;
    let points: Vec<[f64; 2]> = found.iter().map(|(t, phi)| [*t, phi.mean]).collect();
    let errors: Vec<f64> = found.iter().map(|(_, phi)| phi.error).collect();
    // The scatter between seeds of one threshold is itself uncertain; the line's
    // own scatter is the better judge.
    let fit = line_fit(&points, None);
    let seeds = context.effort.seeds as usize;
    let mut chart = Chart::new("Packing fraction of deposits")
        .with_axes(Axis::new("V_t", "√(gd)"), Axis::new("φ", ""))
        .with(Series::points("found", points.clone()).with_errors(errors))
        .with(Series::dashed(
            "paper: 0.640 − 0.11 V_t",
            [0.0, 0.1].map(|t| [t, 0.640 - 0.11 * t]),
        ));
    let mut rows = Vec::new();
    if let Some(fit) = fit {
        chart = chart.with(Series::line("fit", [0.0, 0.1].map(|t| [t, fit.at(t)])));
        let LineFit {
            intercept,
            slope,
            intercept_error,
            slope_error,
            ..
        } = fit;
        let of = "φ(V_t)";
        let words = "A deposit of other grains than the paper's, on another base; the small quick \
                     ones are looser, for the base reaches far into them.";
        rows.push(
            Row::shown(
                of,
                "φ at V_t → 0",
                Estimate {
                    mean: intercept,
                    error: intercept_error,
                },
                seeds,
                words,
            )
            .beside(0.640, 0.001, context.effort.fraction_allowed),
        );
        rows.push(
            Row::shown(
                of,
                "slope of φ, in 1/√(gd)",
                Estimate {
                    mean: slope,
                    error: slope_error,
                },
                seeds,
                words,
            )
            .beside(-0.11, 0.01, 10.0 * context.effort.fraction_allowed),
        );
    }
    for (threshold, phi) in &found {
        let paper = 0.640 - 0.11 * threshold;
        rows.push(
            Row::shown("φ(V_t)", format!("φ at V_t = {threshold}"), *phi, seeds, "").beside(
                paper,
                0.001,
                context.effort.fraction_allowed,
            ),
        );
    }
    let table: Vec<Vec<String>> = found
        .iter()
        .map(|(t, phi)| [*t, phi.mean, phi.error].map(|x| x.to_string()).to_vec())
        .collect();
    Ok(Report {
        rows,
        files: vec![
            ("fraction.svg".to_owned(), chart.to_svg()?),
            (
                "fraction.csv".to_owned(),
                csv_of(&["threshold", "packing_fraction", "error"], &table)?,
            ),
        ],
    })
}

/// One by one.
pub(in crate::program::reproduce) fn loosest(
    context: &Context<'_>,
) -> Result<Report, ProgramError> {
    let effort = &context.effort;
    let mut rows = Vec::new();
    for speed in [0.05, 0.01] {
        let mut values = Vec::new();
        for seed in 1..=effort.seeds {
            let summary = context.finished.summary(&one_by_one(effort, speed, seed))?;
            values.extend(summary.packing_fraction.map(|phi| phi.value));
        }
        let row = Row::shown(
            "one by one",
            format!(
                "φ of {} grains, V_sleep = {speed}, no wake-up",
                effort.drops
            ),
            Estimate::of(&values),
            values.len(),
            "The paper does not say its V_sleep: the smaller it is, the farther a grain rolls \
             down before it falls asleep, and the denser they lie. Looser than by rain in any case.",
        );
        rows.push(row.beside(0.586, 0.0005, effort.fraction_allowed));
    }
    Ok(Report {
        rows,
        files: Vec::new(),
    })
}
