//! The command `resume`.

use std::fs;
use std::io;

use crate::output::{Checkpoint, CheckpointError, Ending, RunFolder};
use crate::program::cli::ResumeArguments;
use crate::program::criteria::Program;
use crate::program::drive::{Attempt, Job, Options};
use crate::program::error::ProgramError;
use crate::program::runner::Runner;
use crate::program::show::say;
use crate::program::signals::Signals;
use crate::scenario::{Origin, ScenarioError, read_text};

pub(super) fn resume(arguments: &ResumeArguments, program: &Program) -> Result<u8, ProgramError> {
    let options = Options {
        checkpoint_every: arguments.checkpoint_every,
        audit: arguments.audit,
        quiet: arguments.quiet,
        gauge: None,
    };
    let folder = RunFolder::open(&arguments.folder)?;
    let shown = folder.path().display().to_string();
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    match continued(folder, options, &signals, program)? {
        Continued::Ended(code) => Ok(code),
        Continued::Finished(reason) => {
            if !arguments.quiet {
                say(&format!(
                    "{shown}: finished already ({reason}); nothing to do"
                ))?;
            }
            Ok(0)
        }
    }
}

impl Job {
    /// The run that was begun in a folder, as its `scenario.toml` says.
    pub(super) fn begun(
        folder: RunFolder,
        options: Options,
        program: &Program,
    ) -> Result<Self, ProgramError> {
        let file = folder.file("scenario.toml");
        let mut origin = Origin::open(&file)?;
        program.acquaint_run(&mut origin);
        let scenario = read_text(&origin).map_err(ScenarioError::from)?;
        let text = fs::read(&file).map_err(access(&folder, "scenario.toml"))?;
        Ok(Job {
            origin,
            scenario,
            folder,
            text,
            options,
        })
    }
}

/// What has become of a run that was begun earlier.
pub(super) enum Continued {
    /// It had come to its end, and why.
    Finished(&'static str),
    /// It has gone on, and this is its exit code.
    Ended(u8),
}

/// Goes on with the run in a folder, unless it is finished.
pub(super) fn continued(
    folder: RunFolder,
    options: Options,
    signals: &Signals,
    program: &Program,
) -> Result<Continued, ProgramError> {
    let _lock = folder.lock()?;
    if let Some(reason) = finished(&folder) {
        // Of a run that was killed at its very end.
        tidy(&folder)?;
        Checkpoint::clear(&folder).map_err(access(&folder, "checkpoint"))?;
        return Ok(Continued::Finished(reason));
    }
    let job = Job::begun(folder, options, program)?;
    newest_good(&job, program.runner(&job.scenario), signals).map(Continued::Ended)
}

/// Goes on from the newest checkpoint that is good.
fn newest_good(job: &Job, runner: &dyn Runner, signals: &Signals) -> Result<u8, ProgramError> {
    let mut reasons = String::new();
    for (name, found) in Checkpoint::all(&job.folder) {
        let shown = job.folder.file(name).display().to_string();
        let unusable = match found {
            Err(CheckpointError::Io(source)) => {
                return Err(ProgramError::Io {
                    file: shown,
                    source,
                });
            }
            Err(error) => error.to_string(),
            Ok(checkpoint) if !checkpoint.is_of(&job.text) => {
                "is of another scenario: scenario.toml has been changed".to_owned()
            }
            Ok(checkpoint) => {
                let skipped = &reasons;
                let beforehand = || prepare(job, skipped, &shown);
                match runner.go_on(job, &checkpoint.state, signals, &beforehand)? {
                    Attempt::Done(code) => return Ok(code),
                    Attempt::NothingYet => {
                        prepare(job, skipped, &shown)?;
                        return runner.start(job, signals);
                    }
                    Attempt::Unusable(reason) => format!("is unusable: {reason}"),
                }
            }
        };
        reasons.push_str(&format!("\n  {shown} {unusable}"));
    }
    Err(ProgramError::Unresumable {
        folder: job.folder.path().display().to_string(),
        reasons,
        advice: format!(
            "`grainfall run {} --out ANOTHER` runs the same from the start",
            job.folder.file("scenario.toml").display()
        ),
    })
}

/// A good checkpoint has been found: says so if it is not the newest, and takes
/// away what is out of date.
fn prepare(job: &Job, skipped: &str, name: &str) -> Result<(), ProgramError> {
    if !skipped.is_empty() {
        job.options
            .note(format!("{skipped}\n  going on from {name}"));
    }
    for name in ["summary.json", "audit.json"] {
        match fs::remove_file(job.folder.file(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(access(&job.folder, name)(error));
            }
            _ => {}
        }
    }
    tidy(&job.folder)
}

fn tidy(folder: &RunFolder) -> Result<(), ProgramError> {
    folder
        .tidy()
        .map_err(ProgramError::io(folder.path().display().to_string()))
}

fn access(folder: &RunFolder, name: &str) -> impl FnOnce(io::Error) -> ProgramError + use<> {
    ProgramError::io(folder.file(name).display().to_string())
}

/// Why a run came to its end, if it did of its own.
fn finished(folder: &RunFolder) -> Option<&'static str> {
    let reason = Ending::of(folder.path())?.stop_reason;
    reason.is_finished().then(|| reason.words())
}
