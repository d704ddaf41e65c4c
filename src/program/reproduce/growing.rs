//! Fig. 5: processor time while a deposit grows.

use crate::analysis::line_fit;
use crate::engine::Limits;
use crate::plot::{Axis, Chart, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::rain::{PAPER_WIDTH, Rain, sampled};
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};
use crate::time::Time;

/// Time between two looks at the clock, in √(d/g).
const EVERY: f64 = 0.5;
/// No curve takes longer, in seconds.
const LONGEST: f64 = 600.0;

/// A look: time, processor seconds so far, events so far.
type Look = [f64; 3];

/// A deposit with V_sleep = V_wakeup = `threshold`, looked at while it grows.
fn curve(effort: &Effort, threshold: f64, until: f64) -> Result<Vec<Look>, ProgramError> {
    let rain = Rain {
        count: effort.growing.0,
        width: PAPER_WIDTH,
        sleep_speed: threshold,
        elastic_speed: effort.elastic_speed,
        seed: 1,
    };
    let limits = Limits {
        time: Time::from_units(until),
        all_frozen: true,
        ..Limits::default()
    };
    let mut looks = Vec::new();
    let mut simulation = rain.simulation(|| {})?;
    sampled(
        &mut simulation,
        EVERY,
        &limits,
        LONGEST,
        |simulation, cost| {
            let time = simulation.time().units();
            // The start has no place on logarithmic axes.
            if time > 0.0 {
                looks.push([time, cost.seconds, cost.events as f64]);
            }
            Ok(())
        },
    )?;
    Ok(looks)
}

/// The exponent of the events per unit of time against time, once the layer that
/// flows has formed: 0 if the cost grows linearly, 1 if quadratically.
fn exponent(looks: &[Look], from: f64) -> Estimate {
    let rates: Vec<[f64; 2]> = looks
        .windows(2)
        .filter(|pair| pair[0][0] >= from)
        .map(|pair| {
            let rate = (pair[1][2] - pair[0][2]) / (pair[1][0] - pair[0][0]);
            let middle = 0.5 * (pair[0][0] + pair[1][0]);
            [libm::log(middle), libm::log(rate)]
        })
        .collect();
    match line_fit(&rates, None) {
        Some(fit) => Estimate {
            mean: fit.slope,
            error: fit.slope_error,
        },
        None => Estimate::exact(f64::NAN),
    }
}

pub(super) fn report(context: &Context<'_>) -> Result<Report, ProgramError> {
    let (_, without, with) = context.effort.growing;
    let mut chart = Chart::new("Fig. 5: processor time of a growing deposit").with_axes(
        Axis::new("time", "√(d/g)").logarithmic(),
        Axis::new("processor time", "s").logarithmic(),
    );
    let (mut rows, mut table) = (Vec::new(), Vec::new());
    for (threshold, until) in [(0.0, without), (0.05, with), (0.1, with)] {
        let looks = curve(&context.effort, threshold, until)?;
        for [time, seconds, events] in &looks {
            table.push(
                [threshold, *time, *seconds, *events]
                    .map(|x| x.to_string())
                    .to_vec(),
            );
        }
        let points = looks.iter().map(|[time, seconds, _]| [*time, *seconds]);
        chart = chart.with(Series::line(format!("V_t = {threshold}"), points));
        let row = Row::shown(
            "Fig. 5",
            format!("exponent of the events per time against time, V_t = {threshold}"),
            exponent(&looks, 0.5 * until),
            1,
            if threshold > 0.0 {
                "With sleep only the flowing layer costs: so much per unit of time, whatever has \
                 settled. 0 is a cost that grows linearly."
            } else {
                "Without sleep every grain that has landed goes on colliding, and ever faster: 1 is \
                 a cost that grows as the square of time, which the paper has as the least."
            },
        );
        rows.push(if threshold > 0.0 {
            row.beside(0.0, 0.0, context.effort.exponent_allowed)
        } else {
            row.at_least(1.0)
        });
    }
    Ok(Report {
        rows,
        files: vec![
            ("fig5.svg".to_owned(), chart.to_svg()?),
            (
                "fig5.csv".to_owned(),
                csv_of(
                    &["threshold", "time", "processor_seconds", "events"],
                    &table,
                )?,
            ),
        ],
    })
}
