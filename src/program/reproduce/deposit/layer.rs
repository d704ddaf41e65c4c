//! Figs. 3 and 4: how many are in motion, and where.

use crate::draw;
use crate::output::Summary;
use crate::plot::{Axis, Chart, Mark, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::deposit::{deposit, least, variations};
use crate::program::reproduce::pictures::side_by_side;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};

/// Area of the base, in d².
const AREA: f64 = 100.0;

const BALL: f64 = core::f64::consts::PI / 6.0;

/// Fig. 3: how many are in motion, and why not as many as in the paper.
pub(in crate::program::reproduce) fn layer(context: &Context<'_>) -> Result<Report, ProgramError> {
    let effort = &context.effort;
    let threshold = least(effort);
    let run = deposit(effort, threshold, 1);
    let series = context.finished.series(&run)?;
    let chart = Chart::new(format!("Fig. 3: grains in time, V_t = {threshold}"))
        .with_axes(
            Axis::new("time", "√(d/g)"),
            Axis::new("number of grains", ""),
        )
        .with(Series::line(
            "normal",
            series.iter().map(|row| [row.time, row.normal]),
        ))
        .with(Series::dashed(
            "frozen",
            series.iter().map(|row| [row.time, row.frozen]),
        ))
        .with_mark(Mark::horizontal(280.0, "paper, normal"));
    let summaries: Result<Vec<Summary>, _> = (1..=effort.seeds)
        .map(|seed| context.finished.summary(&deposit(effort, threshold, seed)))
        .collect();
    let summaries = summaries?;
    let normal: Vec<f64> = summaries.iter().filter_map(|s| s.mean_normal).collect();
    let fraction: Vec<f64> = summaries
        .iter()
        .filter_map(|s| Some(s.packing_fraction.as_ref()?.value))
        .collect();
    let (mean, fraction) = (Estimate::of(&normal), Estimate::of(&fraction));
    let of = "Fig. 3";
    let mut rows = vec![
        Row::shown(
            of,
            format!("⟨N_normal⟩, V_t = {threshold}"),
            mean,
            normal.len(),
            "No reading of the criteria that was tried brings it near the paper's 280 (below). \
             That number is what V_t = 0.1 gives: Fig. 3 may be of another threshold than its \
             caption says.",
        )
        .beside(280.0, 2.0, 0.0),
        Row::shown(
            of,
            "height of the flowing layer, in d: N π/6 over base and φ",
            mean.times(BALL / (AREA * fraction.mean)),
            normal.len(),
            "The paper's 4.4 d for 280 grains leaves out the π/6 of a sphere: it is 2.29 d.",
        ),
    ];
    let coarse = context
        .finished
        .summary(&deposit(effort, 0.1, 1))?
        .mean_normal;
    let coarse = Estimate::exact(coarse.unwrap_or(f64::NAN));
    rows.push(Row::shown(of, "⟨N_normal⟩, V_t = 0.1", coarse, 1, ""));
    for (what, run) in variations(effort) {
        let found = context.finished.summary(&run)?.mean_normal;
        let found = Estimate::exact(found.unwrap_or(f64::NAN));
        let words = "One decision altered, one run.";
        rows.push(Row::shown(
            of,
            format!("the same with {what}"),
            found,
            1,
            words,
        ));
    }
    let table: Vec<Vec<String>> = series
        .iter()
        .map(|row| {
            [row.time, row.normal, row.frozen]
                .map(|x| x.to_string())
                .to_vec()
        })
        .collect();
    Ok(Report {
        rows,
        files: vec![
            ("fig3.svg".to_owned(), chart.to_svg()?),
            (
                "fig3.csv".to_owned(),
                csv_of(&["time", "normal", "frozen"], &table)?,
            ),
        ],
    })
}

/// Fig. 4: three moments.
pub(in crate::program::reproduce) fn pictures(
    context: &Context<'_>,
) -> Result<Report, ProgramError> {
    let frames = context.finished.frames(&deposit(&context.effort, 0.1, 1))?;
    let last = frames.last().map_or(0.0, |frame| frame.time.units());
    let near = |share: f64| {
        let off = |time: f64| (time - share * last).abs();
        frames
            .iter()
            .min_by(|a, b| off(a.time.units()).total_cmp(&off(b.time.units())))
            .map(draw::svg)
    };
    let pictures: Vec<String> = [0.15, 0.5, 1.0].into_iter().filter_map(near).collect();
    Ok(Report {
        rows: Vec::new(),
        files: vec![("fig4.svg".to_owned(), side_by_side(&pictures))],
    })
}
