//! Packings by growth instead of by falling.

use crate::plot::{Axis, Chart, Mark, Series};
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};
use crate::setup::{Jam, seeded};

/// P V/N T at which a packing counts as jammed.
const JAMMED: f64 = 1.0e5;

pub(super) fn report(context: &Context<'_>) -> Result<Report, ProgramError> {
    let (count, rates) = context.effort.packed;
    let seeds = context.effort.seeds;
    let (mut points, mut errors, mut table) = (Vec::new(), Vec::new(), Vec::new());
    let mut rows = Vec::new();
    for &rate in rates {
        let jam = Jam {
            count,
            rate,
            compressibility: JAMMED,
        };
        let mut fractions = Vec::new();
        for seed in 1..=seeds {
            let jammed = jam.packing::<3>(&mut seeded(seed))?;
            let (fraction, pressure) = (jammed.packing_fraction, jammed.compressibility);
            table.push(
                [rate, seed as f64, fraction, pressure]
                    .map(|x| x.to_string())
                    .to_vec(),
            );
            fractions.push(fraction);
        }
        let found = Estimate::of(&fractions);
        points.push([rate, found.mean]);
        errors.push(found.error);
        let row = Row::shown(
            "other makers",
            format!("φ of {count} grains grown at {rate} until they jam"),
            found,
            fractions.len(),
            "Random close packing is no sharp number: slower growth packs a little denser, and \
             crystals when it is very slow.",
        );
        rows.push(row.beside(0.64, 0.0, 0.01));
    }
    let chart = Chart::new("Packing by growth")
        .with_axes(
            Axis::new("growth rate", "thermal speed").logarithmic(),
            Axis::new("φ", ""),
        )
        .with(Series::points("jammed", points).with_errors(errors))
        .with_mark(Mark::horizontal(0.64, "paper"));
    Ok(Report {
        rows,
        files: vec![
            ("makers.svg".to_owned(), chart.to_svg()?),
            (
                "makers.csv".to_owned(),
                csv_of(
                    &["rate", "seed", "packing_fraction", "compressibility"],
                    &table,
                )?,
            ),
        ],
    })
}
