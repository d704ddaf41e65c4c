//! How the number of events depends on the threshold.

use crate::analysis::line_fit;
use crate::output::Summary;
use crate::plot::{Axis, Chart, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::deposit::over_seeds;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};

/// How the number of events depends on the threshold.
pub(in crate::program::reproduce) fn cost(context: &Context<'_>) -> Result<Report, ProgramError> {
    type Kind = (&'static str, fn(&Summary) -> f64);
    let kinds: [Kind; 4] = [
        ("all events", |s| s.events.total as f64),
        ("events but elastic ones", |s| {
            (s.events.total - s.events.elastic) as f64
        }),
        ("normal–normal collisions", |s| s.events.pair as f64),
        ("normal–frozen collisions", |s| s.events.frozen as f64),
    ];
    let mut chart = Chart::new("Number of events of a deposit").with_axes(
        Axis::new("V_t", "√(gd)").logarithmic(),
        Axis::new("events", "").logarithmic(),
    );
    let (mut rows, mut table) = (Vec::new(), Vec::new());
    for (place, (name, of)) in kinds.into_iter().enumerate() {
        let found = over_seeds(context, |s| Some(of(s)))?;
        for (threshold, events) in &found {
            table.push(vec![
                name.to_owned(),
                threshold.to_string(),
                events.mean.to_string(),
            ]);
        }
        let logs: Vec<[f64; 2]> = found
            .iter()
            .map(|(t, events)| [libm::log(*t), libm::log(events.mean)])
            .collect();
        chart = chart.with(Series::points(
            name,
            found.iter().map(|(t, n)| [*t, n.mean]),
        ));
        let exponent = line_fit(&logs, None).map_or(Estimate::exact(f64::NAN), |fit| Estimate {
            mean: fit.slope,
            error: fit.slope_error,
        });
        let row = Row::shown(
            "cost",
            format!("exponent of {name} against V_t"),
            exponent,
            context.effort.seeds as usize,
            "The paper does not say which events it counts. Those that the cut-off makes elastic \
             depend on V_c as well.",
        );
        rows.push(if place == 0 {
            row.beside(-1.2, 0.0, context.effort.exponent_allowed)
        } else {
            row
        });
    }
    Ok(Report {
        rows,
        files: vec![
            ("cost.svg".to_owned(), chart.to_svg()?),
            (
                "cost.csv".to_owned(),
                csv_of(&["events", "threshold", "number"], &table)?,
            ),
        ],
    })
}
