//! The command `sweep`: many runs, on several threads.

mod crew;
mod error;
mod folder;
mod names;
mod outcome;
mod plan;
mod values;

pub(super) use crate::program::cli::SweepArguments;
pub(super) use crew::{Crew, Tasks};
pub use error::SweepError;
pub(super) use outcome::Outcome;
pub(super) use values::Variation;

use std::path::PathBuf;
use std::thread;
use std::time::Instant;

use indicatif::ProgressBar;

use crate::program::criteria::Program;
use crate::program::error::ProgramError;
use crate::program::progress::{bar, show_on, time_left};
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::program::sweep::folder::SweepFolder;
use crate::program::sweep::outcome::{failures, for_people, runs_csv};
use crate::program::sweep::plan::Plan;

/// The most runs of a sweep.
pub(super) const MOST_RUNS: u64 = 100_000;

pub(super) fn sweep(arguments: &SweepArguments, program: &Program) -> Result<u8, ProgramError> {
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    let (plan, folder, outcomes) = work(arguments, "sweep", program, &signals)?;
    if !arguments.quiet {
        tell(&plan, &folder, &outcomes)?;
    }
    Ok(exit_code(&outcomes, &signals))
}

/// What a sweep has come to.
pub(super) struct Done {
    pub(super) exit_code: u8,
    /// Of the sweep.
    pub(super) folder: PathBuf,
    /// The first value and the folder of each run.
    pub(super) runs: Vec<(String, PathBuf)>,
    pub(super) threads: usize,
}

/// Carries a sweep out; its folder is called after `purpose`, and nothing is told
/// but what went wrong.
pub(super) fn carry_out(
    arguments: &SweepArguments,
    purpose: &str,
    program: &Program,
    signals: &Signals,
) -> Result<Done, ProgramError> {
    let (plan, folder, outcomes) = work(arguments, purpose, program, signals)?;
    let exit_code = exit_code(&outcomes, signals);
    if exit_code != 0 && !arguments.quiet {
        tell(&plan, &folder, &outcomes)?;
    }
    let run = |run: usize| {
        let (combination, _) = plan.combination_of(run);
        let value = plan.values_of(combination).swap_remove(0);
        (value, folder.path().join(plan.folder_of(run)))
    };
    Ok(Done {
        exit_code,
        folder: folder.path().to_path_buf(),
        runs: (0..plan.runs()).map(run).collect(),
        threads: threads(arguments),
    })
}

fn work(
    arguments: &SweepArguments,
    purpose: &str,
    program: &Program,
    signals: &Signals,
) -> Result<(Plan, SweepFolder, Vec<Outcome>), ProgramError> {
    let plan = Plan::new(arguments, program)?;
    let named = || PathBuf::from("runs").join(format!("{}-{purpose}", plan.name));
    let path = arguments.out.clone().unwrap_or_else(named);
    let folder = SweepFolder::open(&path, &plan.text, arguments.force)?;
    let read = |run| Outcome::read(&folder.path().join(plan.folder_of(run)));
    let mut outcomes: Vec<Outcome> = (0..plan.runs()).map(read).collect();
    folder.write_runs(&runs_csv(&plan, &outcomes)?)?;

    let crew = Crew {
        plan: &plan,
        folder: folder.path(),
        threads: threads(arguments),
        checkpoint_every: arguments.checkpoint_every,
        signals,
        program,
    };
    let progress = Progress::new(bar(arguments.quiet), &outcomes);
    // One that can't be written now may be later, and nothing is lost by that.
    let mut written = Ok(());
    signals.begin();
    let worked = crew.work(|ended, gauges| {
        for gauge in gauges {
            for note in gauge.take_notes() {
                progress.note(&note);
            }
        }
        let mut news = written.is_err();
        for (run, outcome) in ended {
            news |= outcomes[run] != outcome;
            outcomes[run] = outcome;
        }
        if news {
            written = runs_csv(&plan, &outcomes).and_then(|text| folder.write_runs(&text));
        }
        let shares: Vec<f64> = gauges.iter().map(|gauge| gauge.share()).collect();
        progress.show(&outcomes, &shares);
    });
    progress.finish();
    worked?;
    written?;
    Ok((plan, folder, outcomes))
}

fn threads(arguments: &SweepArguments) -> usize {
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    arguments.threads.map_or_else(cores, usize::from)
}

/// A signal comes first, then what the user can put right, then what has
/// stopped early.
fn exit_code(outcomes: &[Outcome], signals: &Signals) -> u8 {
    let ended = |outcome: &Outcome| outcome.is_finished() || outcome.is_failed();
    match signals.exit_code() {
        Some(code) if !outcomes.iter().all(ended) => code,
        _ if outcomes.iter().any(Outcome::is_io) => 1,
        _ if outcomes.iter().all(Outcome::is_finished) => 0,
        _ => 3,
    }
}

/// Prints how it all ended.
fn tell(plan: &Plan, folder: &SweepFolder, outcomes: &[Outcome]) -> Result<(), ProgramError> {
    let count = |what: fn(&Outcome) -> bool| outcomes.iter().filter(|one| what(one)).count();
    let finished = count(Outcome::is_finished);
    let failed = count(Outcome::is_failed);
    let left = outcomes.len() - finished - failed;
    let shown = folder.path().display();
    let mut text = format!("{shown}: {finished} of {} runs finished", outcomes.len());
    if failed > 0 {
        text += &format!(", {failed} stopped early");
    }
    if left > 0 {
        text += &format!(", {left} left; the same command goes on with them");
    }
    text += "\n\n";
    text += &for_people(plan, outcomes);
    let failures = failures(plan, outcomes);
    if !failures.is_empty() {
        text += &format!("\n{failures}");
    }
    say(text.trim_end())
}

/// A line for the whole sweep.
struct Progress {
    bar: Option<ProgressBar>,
    began: Instant,
    /// How many runs were finished before.
    before: usize,
}

impl Progress {
    fn new(bar: Option<ProgressBar>, outcomes: &[Outcome]) -> Self {
        Progress {
            bar,
            began: Instant::now(),
            before: done(outcomes),
        }
    }

    /// Shows that so much is done of the runs that go on.
    fn show(&self, outcomes: &[Outcome], shares: &[f64]) {
        let Some(bar) = &self.bar else { return };
        let done = done(outcomes);
        let part = done as f64 + shares.iter().sum::<f64>();
        let (all, before) = (outcomes.len() as f64, self.before as f64);
        let left = time_left(self.began.elapsed(), (part - before) / (all - before));
        let message = format!("{done} of {} runs, {left}", outcomes.len());
        show_on(bar, part / all, message);
    }

    /// Something that people should know.
    fn note(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| eprintln!("note:{text}")),
            None => eprintln!("note:{text}"),
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// How many runs need not be waited for.
fn done(outcomes: &[Outcome]) -> usize {
    let done = |outcome: &&Outcome| outcome.is_finished() || outcome.is_failed();
    outcomes.iter().filter(done).count()
}
