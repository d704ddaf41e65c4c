//! What has become of runs: `runs.csv`, and a table for people.

use std::path::Path;

use crate::output::{Ending, StoppedBy, Summary};
use crate::program::error::ProgramError;
use crate::program::estimate::{Estimate, significant};
use crate::program::sweep::names::shortened;
use crate::program::sweep::plan::Plan;
use crate::program::table::table;

/// So many combinations are shown to people.
const MOST_ROWS: usize = 60;
/// So many runs that have stopped early, or have left no figures, are named.
const MOST_NAMED: usize = 10;

/// What is known of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::program) struct Outcome {
    /// Why it ended, if it has.
    ended: Option<StoppedBy>,
    summary: Option<Summary>,
    /// Why it has no summary, if it has ended: another version of the program has run it.
    unread: Option<String>,
    /// Why it could not be carried on with: the exit code and a message.
    failure: Option<(u8, String)>,
}

impl Outcome {
    /// What a run has left in its folder.
    pub(in crate::program) fn read(folder: &Path) -> Self {
        let Some(ending) = Ending::of(folder) else {
            return Outcome::default();
        };
        let (summary, unread) = match Summary::of(folder) {
            Ok(summary) => (Some(summary), None),
            Err(error) => (None, Some(format!("(its figures can't be read: {error})"))),
        };
        Outcome {
            ended: Some(ending.stop_reason),
            summary,
            unread,
            failure: None,
        }
    }

    /// What is known after an attempt to carry it out.
    pub(super) fn after(folder: &Path, done: Result<(), ProgramError>) -> Self {
        Outcome {
            failure: done.err().map(|error| (error.exit_code(), message(&error))),
            ..Outcome::read(folder)
        }
    }

    /// Whether it has come to an end of its own.
    pub(in crate::program) fn is_finished(&self) -> bool {
        self.failure.is_none() && self.ended.is_some_and(StoppedBy::is_finished)
    }

    /// Whether it has collapsed: if it went on, it would do so again.
    pub(super) fn is_collapsed(&self) -> bool {
        self.ended() == "collapse"
    }

    /// Whether it stopped early, for a reason of its own.
    pub(in crate::program) fn is_failed(&self) -> bool {
        matches!(self.ended(), "collapse" | "error")
    }

    /// Whether reading or writing failed.
    pub(super) fn is_io(&self) -> bool {
        self.failure.as_ref().is_some_and(|(code, _)| *code == 1)
    }

    /// How it ended, in a word.
    fn ended(&self) -> &'static str {
        if self.failure.is_some() {
            return "error";
        }
        match self.ended {
            None => "unfinished",
            Some(StoppedBy::AllFrozen) => "all_frozen",
            Some(StoppedBy::Time) => "time",
            Some(StoppedBy::Events) => "events",
            Some(StoppedBy::Collapse) => "collapse",
            Some(StoppedBy::Interrupted) => "interrupted",
            Some(StoppedBy::Error) => "error",
        }
    }

    fn message(&self) -> &str {
        let error = || self.summary.as_ref()?.error.as_deref();
        match &self.failure {
            Some((_, message)) => message,
            None => error().or(self.unread.as_deref()).unwrap_or_default(),
        }
    }
}

/// On one line, without the line of a scenario that it points at.
fn message(error: &ProgramError) -> String {
    let text = error.to_string();
    match error {
        ProgramError::Scenario(_) => text.lines().take(1).collect(),
        _ => text.lines().map(str::trim).collect::<Vec<_>>().join(" "),
    }
}

/// A figure of a run.
struct Figure {
    name: &'static str,
    of: fn(&Summary) -> Option<f64>,
    /// Whether it is a whole number.
    whole: bool,
    /// How it stands in the table for people.
    shown: Shown,
}

enum Shown {
    No,
    /// Its mean over the seeds.
    Mean(&'static str),
    Largest(&'static str),
    Sum(&'static str),
}

const fn count(name: &'static str, of: fn(&Summary) -> Option<f64>) -> Figure {
    Figure {
        name,
        of,
        whole: true,
        shown: Shown::No,
    }
}

const fn number(name: &'static str, of: fn(&Summary) -> Option<f64>, shown: Shown) -> Figure {
    Figure {
        name,
        of,
        whole: false,
        shown,
    }
}

/// In the order of the columns.
const FIGURES: [Figure; 19] = [
    number("time", |s| Some(s.time), Shown::Mean("time")),
    number(
        "packing_fraction",
        |s| Some(s.packing_fraction?.value),
        Shown::Mean("packing fraction"),
    ),
    number("mean_normal", |s| s.mean_normal, Shown::Mean("mean normal")),
    Figure {
        shown: Shown::Mean("events"),
        ..count("events", |s| Some(s.events.total as f64))
    },
    count("pair_events", |s| Some(s.events.pair as f64)),
    count("frozen_events", |s| Some(s.events.frozen as f64)),
    count("wake_events", |s| Some(s.events.wake as f64)),
    count("sleep_events", |s| Some(s.events.sleep as f64)),
    count("wall_events", |s| Some(s.events.wall as f64)),
    count("grains", |s| Some(s.particles.total as f64)),
    count("normal", |s| Some(s.particles.normal as f64)),
    count("falling", |s| Some(s.particles.falling as f64)),
    count("frozen", |s| Some(s.particles.frozen as f64)),
    number("kinetic_energy", |s| Some(s.kinetic_energy), Shown::No),
    number("potential_energy", |s| Some(s.potential_energy), Shown::No),
    number("energy_change", |s| Some(s.energy_ledger.sum), Shown::No),
    number(
        "max_overlap",
        |s| Some(s.max_overlap),
        Shown::Largest("deepest overlap"),
    ),
    number("cpu_seconds", |s| Some(s.cpu_seconds), Shown::Sum("CPU s")),
    number(
        "events_per_second",
        |s| Some(s.events_per_second),
        Shown::No,
    ),
];

/// `runs.csv`: a row for each run, in their order.
pub(super) fn runs_csv(plan: &Plan, outcomes: &[Outcome]) -> Result<Vec<u8>, ProgramError> {
    let failed = |error: csv::Error| ProgramError::io("runs.csv")(error.into());
    let mut rows = csv::Writer::from_writer(Vec::new());
    let mut head = vec!["folder".to_owned()];
    let paths = plan.variations.iter().flat_map(|set| &set.paths);
    head.extend(paths.map(ToString::to_string));
    head.extend(["seed", "ended"].map(str::to_owned));
    head.extend(FIGURES.iter().map(|figure| figure.name.to_owned()));
    head.extend(["trajectory_hash", "error"].map(str::to_owned));
    rows.write_record(&head).map_err(failed)?;
    for (run, outcome) in outcomes.iter().enumerate() {
        let (combination, seed) = plan.combination_of(run);
        let summary = outcome.summary.as_ref();
        let mut row = vec![plan.folder_of(run)];
        for (set, value) in plan.variations.iter().zip(plan.values_of(combination)) {
            row.extend(set.paths.iter().map(|_| value.clone()));
        }
        row.extend([seed.to_string(), outcome.ended().to_owned()]);
        row.extend(FIGURES.iter().map(|figure| {
            let value = summary.and_then(figure.of);
            value.map_or(String::new(), |value| match figure.whole {
                true => format!("{value:.0}"),
                false => format!("{value:?}"),
            })
        }));
        let hash = summary.map_or("", |summary| &summary.trajectory_hash);
        row.extend([hash, outcome.message()].map(str::to_owned));
        rows.write_record(&row).map_err(failed)?;
    }
    rows.into_inner()
        .map_err(|error| ProgramError::io("runs.csv")(error.into_error()))
}

/// The figures of finished runs, a row for each combination of values.
pub(super) fn for_people(plan: &Plan, outcomes: &[Outcome]) -> String {
    let seeds = plan.seeds as usize;
    let varied: Vec<usize> = (0..plan.variations.len())
        .filter(|&number| plan.variations[number].is_varied())
        .collect();
    // Only what some run has.
    let summaries = |runs: &[Outcome]| -> Vec<Summary> {
        let finished = runs.iter().filter(|outcome| outcome.is_finished());
        finished
            .filter_map(|outcome| outcome.summary.clone())
            .collect()
    };
    let all = summaries(outcomes);
    let figures: Vec<(&Figure, &str)> = FIGURES
        .iter()
        .filter_map(|figure| match figure.shown {
            Shown::No => None,
            Shown::Mean(name) | Shown::Largest(name) | Shown::Sum(name) => Some((figure, name)),
        })
        .filter(|(figure, _)| all.iter().any(|summary| (figure.of)(summary).is_some()))
        .collect();

    let mut head: Vec<String> = varied
        .iter()
        .map(|&number| plan.variations[number].title())
        .collect();
    head.push("finished".to_owned());
    head.extend(figures.iter().map(|(_, name)| (*name).to_owned()));
    let mut rows = vec![head];
    for (combination, runs) in outcomes.chunks(seeds).enumerate().take(MOST_ROWS) {
        let values = plan.values_of(combination);
        let finished = summaries(runs);
        let mut row: Vec<String> = varied
            .iter()
            .map(|&number| shortened(&values[number], 40))
            .collect();
        let count = runs.iter().filter(|run| run.is_finished()).count();
        row.push(format!("{count} of {seeds}"));
        row.extend(figures.iter().map(|(figure, _)| {
            let samples: Vec<f64> = finished.iter().filter_map(figure.of).collect();
            cell(&samples, figure)
        }));
        rows.push(row);
    }
    let mut text = table(&rows);
    if let more @ 1.. = plan.combinations().saturating_sub(MOST_ROWS) {
        text += &format!("… and {more} more combinations in runs.csv\n");
    }
    text
}

/// Names the runs that have stopped early, or have left no figures, a line each.
pub(super) fn failures(plan: &Plan, outcomes: &[Outcome]) -> String {
    let failed = |(_, outcome): &(usize, &Outcome)| outcome.is_failed() || outcome.unread.is_some();
    let failed: Vec<_> = outcomes.iter().enumerate().filter(failed).collect();
    let mut text: String = failed
        .iter()
        .take(MOST_NAMED)
        .map(|(run, outcome)| {
            let what = format!("{} {}", outcome.ended(), outcome.message());
            format!("{}: {}\n", plan.folder_of(*run), what.trim_end())
        })
        .collect();
    if let more @ 1.. = failed.len().saturating_sub(MOST_NAMED) {
        text += &format!("… and {more} more in runs.csv\n");
    }
    text
}

fn cell(samples: &[f64], figure: &Figure) -> String {
    if samples.is_empty() {
        return "–".to_owned();
    }
    match figure.shown {
        Shown::No => String::new(),
        Shown::Mean(_) => {
            let estimate = Estimate::of(samples);
            let alone = || match figure.whole {
                true => format!("{:.0}", estimate.mean),
                false => significant(estimate.mean),
            };
            estimate.with_error().unwrap_or_else(alone)
        }
        Shown::Largest(_) => format!("{:.1e}", samples.iter().copied().fold(0.0, f64::max)),
        Shown::Sum(_) => format!("{:.1}", samples.iter().sum::<f64>()),
    }
}
