//! Fig. 5: processor time while a deposit grows.

use crate::analysis::line_fit;
use crate::engine::{Limits, Simulation, StopReason};
use crate::plot::{Axis, Chart, Series};
use crate::policy::Criterion;
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::load::open;
use crate::program::processor::ProcessorClock;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, assigned, csv_of};
use crate::scenario::{Start, read_text};
use crate::time::Time;

/// Time between two looks at the clock, in √(d/g).
const EVERY: f64 = 0.5;
/// No curve takes longer, in seconds.
const LONGEST: f64 = 600.0;

/// A look: time, processor seconds so far, events so far.
type Look = [f64; 3];

/// A deposit with V_sleep = V_wakeup = `threshold`, looked at while it grows.
fn curve(context: &Context<'_>, threshold: f64, until: f64) -> Result<Vec<Look>, ProgramError> {
    let (_, mut origin) = open("deposition", context.program)?;
    origin.assignments = assigned(&[
        format!("grains.1.rain.count={}", context.effort.growing.0),
        format!(
            "parameters.elastic_speed={:?}",
            context.effort.elastic_speed
        ),
        format!("parameters.sleep_speed={threshold:?}"),
        format!("parameters.wake_speed={threshold:?}"),
    ])?;
    let scenario = read_text(&origin)?;
    let start = Start::<3>::new(&origin, &scenario)?;
    let policy = Criterion::SlowDescent(scenario.slow_descent());
    let model = scenario.gravity_model(policy, start.boundary.clone());
    let mut simulation = Simulation::with_settings(model, start.grains, scenario.settings())?;
    let clock = ProcessorClock::start();
    let mut looks = Vec::new();
    let mut time = 0.0;
    while time < until && clock.seconds() < LONGEST {
        time += EVERY;
        let limits = Limits {
            time: Time::from_units(time),
            all_frozen: true,
            ..Limits::default()
        };
        let why = simulation.run(&limits, &mut ());
        looks.push([time, clock.seconds(), simulation.counts().total() as f64]);
        if why != StopReason::Time {
            break;
        }
    }
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
        let looks = curve(context, threshold, until)?;
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
