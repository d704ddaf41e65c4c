//! The command `run`.

use std::path::{Path as FilePath, PathBuf};

use toml::Value;

use crate::output::RunFolder;
use crate::program::cli::RunArguments;
use crate::program::criteria::Program;
use crate::program::drive::{self, Job, Options};
use crate::program::error::ProgramError;
use crate::program::load::{Loaded, load};
use crate::program::signals::Signals;
use crate::scenario::{Assignment, Origin, Path, Scenario};

pub(super) fn run(arguments: &RunArguments, program: &Program) -> Result<u8, ProgramError> {
    let mut assignments = arguments.set.clone();
    assignments.extend(arguments.seed.map(seed_is));
    assignments.extend(arguments.until.map(until));
    let loaded = load(&arguments.scenario, assignments, program)?;
    let seed = loaded.scenario.seed;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-{seed}", loaded.name)));
    // Before grains are made, which may take a while.
    RunFolder::check(&folder, arguments.force)?;
    let options = Options {
        checkpoint_every: arguments.checkpoint_every,
        audit: arguments.audit,
        quiet: arguments.quiet,
        gauge: None,
    };
    let Loaded {
        origin, scenario, ..
    } = loaded;
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    Run {
        origin,
        scenario,
        folder: &folder,
        force: arguments.force,
        options,
        program,
    }
    .begin(&signals)
}

/// A run that has not begun.
pub(super) struct Run<'a> {
    pub(super) origin: Origin,
    pub(super) scenario: Scenario,
    /// Where to.
    pub(super) folder: &'a FilePath,
    /// Whether an earlier run may be overwritten.
    pub(super) force: bool,
    pub(super) options: Options,
    /// What knows the criterion that it names.
    pub(super) program: &'a Program,
}

impl Run<'_> {
    /// Refuses what can be refused at once, makes the folder, runs, and says the exit
    /// code.
    pub(super) fn begin(self, signals: &Signals) -> Result<u8, ProgramError> {
        let mut origin = self.origin;
        let runner = self.program.runner(&self.scenario);
        let given = runner.check(&origin, &self.scenario)?;
        let folder = RunFolder::create(self.folder, self.force)?;
        let (text, scenario) = drive::begin(&folder, &self.scenario, &given.files)?;
        drop(given);
        // What it names may have stood in the run that has just been overwritten.
        origin.folder = folder.path().to_path_buf();
        let job = Job {
            origin,
            scenario,
            folder,
            text,
            options: self.options,
        };
        let done = self.program.runner(&job.scenario).start(&job, signals);
        if let Err(ProgramError::Scenario(_)) = done {
            job.folder.discard();
        }
        done
    }
}

/// What `--seed` says.
pub(super) fn seed_is(seed: u64) -> Assignment {
    // The parser keeps it within the range of whole numbers of TOML.
    let value = Value::Integer(i64::try_from(seed).unwrap_or(i64::MAX));
    Assignment::new(Path::root().key("seed"), value, format!("--seed {seed}"))
}

/// What `--until` says.
pub(super) fn until(time: f64) -> Assignment {
    let path = Path::root().key("stop").key("time");
    Assignment::new(path, Value::Float(time), format!("--until {time:?}"))
}
