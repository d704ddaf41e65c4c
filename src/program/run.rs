//! The command `run`.

use std::path::{Path as FilePath, PathBuf};

use toml::Value;

use crate::output::RunFolder;
use crate::program::cli::RunArguments;
use crate::program::drive::{self, Job};
use crate::program::error::ProgramError;
use crate::program::load::{Loaded, load};
use crate::program::show::check_grains;
use crate::program::signals::Signals;
use crate::scenario::{Assignment, Dimension, Gravity, Path, Scenario, Start};

pub(super) fn run(arguments: &RunArguments) -> Result<u8, ProgramError> {
    let loaded = load(&arguments.scenario, assignments(arguments))?;
    let seed = loaded.scenario.seed;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-{seed}", loaded.name)));
    // Before grains are made, which may take a while.
    RunFolder::check(&folder, arguments.force)?;
    match loaded.scenario.dimension {
        Dimension::Two => begin::<2>(arguments, loaded, &folder),
        Dimension::Three => begin::<3>(arguments, loaded, &folder),
    }
}

/// Refuses what can be refused at once, makes the folder, and starts.
fn begin<const D: usize>(
    arguments: &RunArguments,
    loaded: Loaded,
    folder: &FilePath,
) -> Result<u8, ProgramError> {
    let Loaded {
        mut origin,
        scenario,
        ..
    } = loaded;
    let given = check_grains::<D>(&origin, &scenario)?;
    let signals = Signals::listen().map_err(ProgramError::io("signals"))?;
    let folder = RunFolder::create(folder, arguments.force)?;
    let (text, scenario) = drive::begin(&folder, &scenario, given.files())?;
    drop(given);
    // What it names may have stood in the run that has just been overwritten.
    origin.folder = folder.path().to_path_buf();
    let job = Job {
        origin,
        scenario,
        folder,
        text,
        checkpoint_every: arguments.checkpoint_every,
        audit: arguments.audit,
        quiet: arguments.quiet,
    };
    let done = start::<D>(&job, &signals);
    if let Err(ProgramError::Scenario(_)) = done {
        job.folder.discard();
    }
    done
}

/// Makes the grains and picks the model: without gravity nobody sleeps.
pub(super) fn start<const D: usize>(job: &Job, signals: &Signals) -> Result<u8, ProgramError> {
    let start = Start::<D>::new(&job.origin, &job.scenario)?;
    let scenario: &Scenario = &job.scenario;
    match scenario.gravity {
        Gravity::None => {
            let model = |boundary| scenario.floating_model(boundary);
            drive::drive(job, start, model, signals)
        }
        Gravity::Down(_) | Gravity::Along(_) => {
            let model = |boundary| scenario.gravity_model(boundary);
            drive::drive(job, start, model, signals)
        }
    }
}

/// All values given on the command line; `--seed` and `--until` come last.
fn assignments(arguments: &RunArguments) -> Vec<Assignment> {
    let mut all = arguments.set.clone();
    if let Some(seed) = arguments.seed {
        // The parser keeps it within the range of whole numbers of TOML.
        let value = Value::Integer(i64::try_from(seed).unwrap_or(i64::MAX));
        let path = Path::root().key("seed");
        all.push(Assignment::new(path, value, format!("--seed {seed}")));
    }
    if let Some(until) = arguments.until {
        let path = Path::root().key("stop").key("time");
        let text = format!("--until {until:?}");
        all.push(Assignment::new(path, Value::Float(until), text));
    }
    all
}
