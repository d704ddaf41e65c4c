//! The command `reproduce`: the paper's figures and numbers, made again.

mod arch;
mod arguments;
mod bounce;
mod deposit;
mod drum;
mod effort;
mod growing;
mod makers;
mod pictures;
mod report;
mod row;
mod runs;

pub(super) use arguments::ReproduceArguments;

use std::fs;
use std::path::Path;
use std::thread;
use std::time::Instant;

use crate::output::write_atomically;
use crate::program::criteria::Program;
use crate::program::error::ProgramError;
use crate::program::progress::{bar, show_on, time_left};
use crate::program::reproduce::arguments::Part;
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::runs::{Finished, RunList, RunSpec};
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::program::sweep::{Crew, Outcome, Tasks};
use crate::scenario::Assignment;

/// What a figure is made from.
struct Context<'a> {
    effort: Effort,
    finished: Finished<'a>,
}

/// What has come of it.
struct Report {
    rows: Vec<Row>,
    /// Names and contents.
    files: Vec<(String, String)>,
}

/// A figure, or one of the numbers.
struct Subject {
    part: Part,
    title: &'static str,
    /// The runs that it needs.
    runs: fn(&Effort) -> Vec<RunSpec>,
    report: fn(&Context<'_>) -> Result<Report, ProgramError>,
}

/// None: it is made at once.
fn at_once(_: &Effort) -> Vec<RunSpec> {
    Vec::new()
}

static SUBJECTS: [Subject; 11] = [
    Subject {
        part: Part::Fig1,
        title: "Fig. 1: a bouncing ball",
        runs: at_once,
        report: bounce::report,
    },
    Subject {
        part: Part::Fig2,
        title: "Fig. 2: an arch",
        runs: at_once,
        report: arch::report,
    },
    Subject {
        part: Part::Fig3,
        title: "Fig. 3: normal and frozen grains",
        runs: deposit::layer_runs,
        report: deposit::layer,
    },
    Subject {
        part: Part::Fig4,
        title: "Fig. 4: snapshots of a deposition",
        runs: deposit::picture_runs,
        report: deposit::pictures,
    },
    Subject {
        part: Part::Fig5,
        title: "Fig. 5: processor time",
        runs: at_once,
        report: growing::report,
    },
    Subject {
        part: Part::Numbers,
        title: "Packing fraction against V_t",
        runs: deposit::rain_runs,
        report: deposit::fraction,
    },
    Subject {
        part: Part::Numbers,
        title: "One by one",
        runs: deposit::one_by_one_runs,
        report: deposit::loosest,
    },
    Subject {
        part: Part::Numbers,
        title: "Number of events against V_t",
        runs: deposit::rain_runs,
        report: deposit::cost,
    },
    Subject {
        part: Part::Numbers,
        title: "Packings by growth",
        runs: at_once,
        report: makers::report,
    },
    Subject {
        part: Part::Fig6,
        title: "Fig. 6: the rotating drum",
        runs: drum::map_runs,
        report: drum::map,
    },
    Subject {
        part: Part::Fig7,
        title: "Fig. 7: velocity profiles",
        runs: drum::profile_runs,
        report: drum::profiles,
    },
];

pub(super) fn reproduce(
    arguments: &ReproduceArguments,
    program: &Program,
) -> Result<u8, ProgramError> {
    let effort = if arguments.quick {
        Effort::quick(arguments.seeds)
    } else {
        Effort::full(arguments.seeds)
    };
    let chosen: Vec<&Subject> = SUBJECTS
        .iter()
        .filter(|subject| arguments.wants(subject.part))
        .collect();
    let folder = arguments.folder();
    let runs = folder.join("runs");
    fs::create_dir_all(&runs).map_err(ProgramError::io(runs.display().to_string()))?;
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    signals.begin();
    let mut list = RunList::new(program);
    for subject in &chosen {
        for run in (subject.runs)(&effort) {
            list.add(run);
        }
    }
    carry_out(&list, &runs, arguments, &signals)?;
    if let Some(code) = signals.exit_code() {
        say("interrupted; the same command goes on from here")?;
        return Ok(code);
    }
    let context = Context {
        effort,
        finished: Finished { folder: &runs },
    };
    let mut parts = Vec::new();
    for subject in chosen {
        let made = (subject.report)(&context)?;
        for (name, text) in &made.files {
            let path = folder.join(name);
            let shown = path.display().to_string();
            write_atomically(&path, text.as_bytes()).map_err(ProgramError::io(shown))?;
        }
        let part = report::Part {
            title: subject.title,
            files: made.files.into_iter().map(|(name, _)| name).collect(),
            rows: made.rows,
        };
        if !arguments.quiet {
            say(&report::text(&part))?;
        }
        parts.push(part);
    }
    report::write(&folder, &effort, &parts)?;
    if !arguments.quiet {
        say(&report::verdicts(&folder, &parts))?;
    }
    Ok(0)
}

/// Carries out what is not finished yet, on all cores.
fn carry_out(
    list: &RunList<'_>,
    folder: &Path,
    arguments: &ReproduceArguments,
    signals: &Signals,
) -> Result<(), ProgramError> {
    let all = list.runs();
    if all == 0 {
        return Ok(());
    }
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let crew = Crew {
        plan: list,
        folder,
        threads: arguments
            .threads
            .map_or(cores, |threads| usize::from(threads.get())),
        checkpoint_every: None,
        signals,
        program: list.program(),
    };
    let progress = bar(arguments.quiet);
    let began = Instant::now();
    let mut outcomes: Vec<Option<Outcome>> = vec![None; all];
    let worked = crew.work(|ended, gauges| {
        for (run, outcome) in ended {
            outcomes[run] = Some(outcome);
        }
        if let Some(bar) = &progress {
            let done = outcomes.iter().flatten().count();
            let part = done as f64 + gauges.iter().map(|gauge| gauge.share()).sum::<f64>();
            let left = time_left(began.elapsed(), part / all as f64);
            show_on(
                bar,
                part / all as f64,
                format!("{done} of {all} runs, {left}"),
            );
        }
    });
    if let Some(bar) = progress {
        bar.finish_and_clear();
    }
    worked?;
    if signals.exit_code().is_some() {
        return Ok(());
    }
    let unfinished = |run: &usize| !outcomes[*run].as_ref().is_some_and(Outcome::is_finished);
    match (0..all).find(unfinished) {
        None => Ok(()),
        Some(run) => Err(ProgramError::Reproduction {
            what: format!(
                "the run {} has not come to its end; its folder tells why",
                folder.join(list.folder_of(run)).display()
            ),
        }),
    }
}

/// What would stand after `--set`.
fn assigned(texts: &[String]) -> Result<Vec<Assignment>, ProgramError> {
    let parse = |text: &String| {
        text.parse().map_err(|_| ProgramError::Reproduction {
            what: format!("{text} is no assignment"),
        })
    };
    texts.iter().map(parse).collect()
}

/// A table as CSV.
fn csv_of(columns: &[&str], rows: &[Vec<String>]) -> Result<String, ProgramError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let failed = |error: csv::Error| ProgramError::io("a table")(error.into());
    table.write_record(columns).map_err(failed)?;
    for row in rows {
        table.write_record(row).map_err(failed)?;
    }
    let bytes = table
        .into_inner()
        .map_err(|error| ProgramError::io("a table")(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
