//! What a comparison says: a table, a file, a picture.

use crate::output::Summary;
use crate::plot::{Axis, Chart, Mark, Series};
use crate::program::compare::Census;
use crate::program::error::ProgramError;
use crate::program::estimate::{Estimate, significant};
use crate::program::table::table;

/// One run.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) policy: String,
    pub(super) summary: Summary,
    pub(super) census: Census,
}

/// All runs, in the order of the criteria and of the seeds.
#[derive(Clone, Debug)]
pub(super) struct Report {
    policies: Vec<String>,
    rows: Vec<Row>,
}

/// A figure of a run, by its name.
type Figure = (&'static str, fn(&Row) -> Option<f64>);

/// What is compared.
const FIGURES: &[Figure] = &[
    ("time", |row| Some(row.summary.time)),
    ("packing_fraction", |row| {
        row.summary.packing_fraction.as_ref().map(|slab| slab.value)
    }),
    ("mean_normal", |row| row.summary.mean_normal),
    ("events", |row| Some(row.summary.events.total as f64)),
    ("pair", |row| Some(row.summary.events.pair as f64)),
    ("frozen", |row| Some(row.summary.events.frozen as f64)),
    ("wall", |row| Some(row.summary.events.wall as f64)),
    ("wake", |row| Some(row.summary.events.wake as f64)),
    ("check_wake", |row| {
        Some(row.summary.events.check_wake as f64)
    }),
    ("sleep", |row| Some(row.summary.events.sleep as f64)),
    ("elastic", |row| Some(row.summary.events.elastic as f64)),
    ("guard", |row| Some(row.summary.events.guard as f64)),
    ("cpu_seconds", |row| Some(row.summary.cpu_seconds)),
    ("energy_pair", |row| Some(row.summary.energy_ledger.pair)),
    ("energy_frozen", |row| {
        Some(row.summary.energy_ledger.frozen)
    }),
    ("energy_wake", |row| Some(row.summary.energy_ledger.wake)),
    ("energy_wall", |row| Some(row.summary.energy_ledger.wall)),
    ("energy_sleep", |row| Some(row.summary.energy_ledger.sleep)),
    ("energy_given_back", |row| {
        Some(row.summary.energy_ledger.given_back)
    }),
    ("energy_guard", |row| Some(row.summary.energy_ledger.guard)),
    ("sleeps_questioned", |row| Some(row.census.sleeps as f64)),
    ("false_sleeps", |row| Some(row.census.false_sleeps as f64)),
    ("wakes", |row| Some(row.census.wakes as f64)),
    ("false_wakes", |row| Some(row.census.false_wakes as f64)),
];

/// Drawn in relation to the first criterion.
const DRAWN: [(&str, &str); 4] = [
    ("packing_fraction", "packing fraction"),
    ("mean_normal", "normal grains"),
    ("events", "events"),
    ("cpu_seconds", "processor time"),
];

impl Report {
    pub(super) fn new(policies: &[String], rows: Vec<Row>) -> Self {
        Report {
            policies: policies.to_vec(),
            rows,
        }
    }

    /// A figure of all runs of a criterion that have it.
    fn samples(&self, policy: &str, figure: fn(&Row) -> Option<f64>) -> Vec<f64> {
        let rows = self.rows.iter().filter(|row| row.policy == policy);
        rows.filter_map(figure).collect()
    }

    /// A row for each figure, a column for each criterion: means over the seeds.
    pub(super) fn table(&self) -> String {
        let mut head = vec!["mean over seeds".to_owned()];
        head.extend(self.policies.iter().cloned());
        let mut lines = vec![head];
        for (name, figure) in FIGURES {
            let cells: Vec<String> = self
                .policies
                .iter()
                .map(|policy| shown(&self.samples(policy, *figure)))
                .collect();
            // Nothing of the kind in any run.
            if cells.iter().all(|cell| cell.is_empty() || cell == "0") {
                continue;
            }
            let mut line = vec![(*name).to_owned()];
            line.extend(cells);
            lines.push(line);
        }
        table(&lines)
    }

    /// A row for each run.
    pub(super) fn csv(&self) -> Result<String, ProgramError> {
        let failed = |error: csv::Error| ProgramError::io("compare.csv")(error.into());
        let mut writer = csv::Writer::from_writer(Vec::new());
        let names = FIGURES.iter().map(|(name, _)| *name);
        let head = ["policy", "seed"].into_iter().chain(names);
        writer.write_record(head).map_err(failed)?;
        for row in &self.rows {
            let numbers = FIGURES.iter().map(|(_, figure)| match figure(row) {
                Some(value) => value.to_string(),
                None => String::new(),
            });
            let names = [row.policy.clone(), row.summary.seed.to_string()];
            writer
                .write_record(names.into_iter().chain(numbers))
                .map_err(failed)?;
        }
        let bytes = writer
            .into_inner()
            .map_err(|error| ProgramError::io("compare.csv")(error.into_error()))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// What there is in relation to the first criterion, and the shares of false
    /// sleeps and wakes.
    pub(super) fn svg(&self) -> Result<String, ProgramError> {
        let first = self.policies.first().map_or("", String::as_str);
        let names: Vec<String> = self
            .policies
            .iter()
            .enumerate()
            .map(|(number, policy)| format!("{}: {policy}", number + 1))
            .collect();
        let last = self.policies.len() as f64;
        let mut chart = Chart::new(names.join(", "))
            .with_size(900, 480)
            .with_axes(
                Axis::new("criterion", "").with_range(0.5, last + 0.5),
                Axis::new(format!("in units of {first}"), "").logarithmic(),
            )
            .with_mark(Mark::horizontal(1.0, ""));
        for (name, title) in DRAWN {
            let Some((_, figure)) = FIGURES.iter().find(|(known, _)| *known == name) else {
                continue;
            };
            let unit = Estimate::of(&self.samples(first, *figure));
            let estimates = self.policies.iter().enumerate().filter_map(|(at, policy)| {
                let ratio = Estimate::of(&self.samples(policy, *figure)).times(1.0 / unit.mean);
                let drawable = ratio.mean.is_finite() && ratio.mean > 0.0;
                drawable.then_some((at, ratio))
            });
            let estimates: Vec<(usize, Estimate)> = estimates.collect();
            if estimates.is_empty() {
                continue;
            }
            let points = estimates
                .iter()
                .map(|(at, ratio)| [*at as f64 + 1.0, ratio.mean]);
            let errors = estimates.iter().map(|(_, ratio)| {
                if ratio.error.is_finite() && ratio.error < ratio.mean {
                    ratio.error
                } else {
                    0.0
                }
            });
            let series = Series::points(title, points).with_errors(errors.collect());
            chart = chart.with(series);
        }
        Ok(chart.to_svg()?)
    }
}

/// A mean with its error, if there are several; nothing if there is none.
fn shown(samples: &[f64]) -> String {
    match samples {
        [] => String::new(),
        [one] if libm::floor(*one) == *one => format!("{one}"),
        [one] => significant(*one),
        _ => {
            let estimate = Estimate::of(samples);
            estimate
                .with_error()
                .unwrap_or_else(|| format!("{}", estimate.mean))
        }
    }
}
