//! The command `run`.

use std::path::PathBuf;

use toml::Value;

use crate::output::RunFolder;
use crate::program::cli::RunArguments;
use crate::program::drive::{Job, drive};
use crate::program::error::ProgramError;
use crate::program::load::load;
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
    let job = Job {
        origin: loaded.origin,
        scenario: loaded.scenario,
        folder,
        force: arguments.force,
        quiet: arguments.quiet,
    };
    match job.scenario.dimension {
        Dimension::Two => start::<2>(&job),
        Dimension::Three => start::<3>(&job),
    }
}

/// Picks the model: without gravity nobody sleeps.
fn start<const D: usize>(job: &Job) -> Result<u8, ProgramError> {
    let start = Start::<D>::new(&job.origin, &job.scenario)?;
    let boundary = start.boundary.clone();
    let scenario: &Scenario = &job.scenario;
    match scenario.gravity {
        Gravity::None => drive(job, start, scenario.floating_model(boundary)),
        Gravity::Down(_) | Gravity::Along(_) => drive(job, start, scenario.gravity_model(boundary)),
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
        let text = format!("--until {until}");
        all.push(Assignment::new(path, Value::Float(until), text));
    }
    all
}
