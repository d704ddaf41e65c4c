//! The command `compare`: one scenario under several sleep criteria.

mod arguments;
mod census;
mod report;

pub(super) use arguments::CompareArguments;
pub(super) use census::{Census, Had, TakeCensus};

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::output::{RunFolder, Summary};
use crate::program::compare::report::{Report, Row};
use crate::program::criteria::Program;
use crate::program::drive::{Job, Options};
use crate::program::error::ProgramError;
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::program::sweep::{SweepArguments, Variation, carry_out};

pub(super) fn compare(arguments: &CompareArguments, program: &Program) -> Result<u8, ProgramError> {
    let policies = arguments.policies.join(",");
    let varied: Variation = format!("sleep.criterion={policies}")
        .parse()
        .map_err(|_| ProgramError::Policies { policies })?;
    let mut set = vec![varied];
    set.extend(arguments.set.iter().cloned());
    let sweep = SweepArguments {
        scenario: arguments.scenario.clone(),
        set,
        seeds: arguments.seeds,
        seed: arguments.seed,
        threads: arguments.threads,
        out: arguments.out.clone(),
        until: arguments.until,
        checkpoint_every: None,
        force: arguments.force,
        quiet: arguments.quiet,
    };
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    let done = carry_out(&sweep, "compare", program, &signals)?;
    if done.exit_code != 0 {
        return Ok(done.exit_code);
    }
    let rows = take_census(&done.runs, done.threads, program, &signals)?;
    let Some(rows) = rows else {
        return Ok(signals.exit_code().unwrap_or(1));
    };
    let report = Report::new(&arguments.policies, rows);
    let write = |name: &str, text: String| {
        let file = done.folder.join(name);
        crate::output::write_atomically(&file, text.as_bytes())
            .map_err(ProgramError::io(file.display().to_string()))
    };
    write("compare.csv", report.csv()?)?;
    write("compare.svg", report.svg()?)?;
    if !arguments.quiet {
        say(format!("{}\n\n{}", done.folder.display(), report.table()).trim_end())?;
    }
    Ok(0)
}

/// Questions all runs, several at a time; `None` if a signal has come.
fn take_census(
    runs: &[(String, PathBuf)],
    threads: usize,
    program: &Program,
    signals: &Signals,
) -> Result<Option<Vec<Row>>, ProgramError> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<(usize, Result<Row, ProgramError>)>> = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..threads.min(runs.len()) {
            scope.spawn(|| {
                while signals.exit_code().is_none() {
                    let run = next.fetch_add(1, Ordering::Relaxed);
                    let Some((policy, folder)) = runs.get(run) else {
                        break;
                    };
                    let row = row_of(policy, folder, program, signals);
                    if signals.exit_code().is_some() {
                        break;
                    }
                    if let Ok(mut found) = found.lock() {
                        found.push((run, row));
                    }
                }
            });
        }
    });
    let mut found = found.into_inner().unwrap_or_default();
    found.sort_by_key(|(run, _)| *run);
    if found.len() < runs.len() {
        return Ok(None);
    }
    let rows: Result<Vec<Row>, ProgramError> = found.into_iter().map(|(_, row)| row).collect();
    rows.map(Some)
}

/// What a run has come to, and its census.
fn row_of(
    policy: &str,
    folder: &std::path::Path,
    program: &Program,
    signals: &Signals,
) -> Result<Row, ProgramError> {
    let folder = RunFolder::open(folder)?;
    let job = Job::begun(folder, Options::default(), program)?;
    let ended = job.folder.file("summary.json");
    let summary =
        Summary::of(job.folder.path()).map_err(ProgramError::io(ended.display().to_string()))?;
    let runner = program.runner(&job.scenario);
    let had = Had {
        events: summary.events.total,
        sleeps: summary.events.sleep,
    };
    let census = runner.census(&job, had, signals)?;
    Ok(Row {
        policy: policy.to_owned(),
        summary,
        census,
    })
}
