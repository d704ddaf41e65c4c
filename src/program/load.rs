//! From what was typed to a scenario.

use std::path::Path;

use crate::program::criteria::Program;
use crate::program::error::ProgramError;
use crate::scenario::{Assignment, Origin, Preset, Scenario, nearest, presets, read_text};

/// A scenario and what it is called.
pub(super) struct Loaded {
    pub(super) name: String,
    pub(super) origin: Origin,
    pub(super) scenario: Scenario,
}

/// Reads a preset or a scenario file.
pub(super) fn load(
    named: &str,
    assignments: Vec<Assignment>,
    program: &Program,
) -> Result<Loaded, ProgramError> {
    let (name, mut origin) = open(named, program)?;
    origin.assignments = assignments;
    let scenario = read_text(&origin)?;
    Ok(Loaded {
        name,
        origin,
        scenario,
    })
}

/// The text of a preset or of a scenario file, and what it is called.
pub(super) fn open(named: &str, program: &Program) -> Result<(String, Origin), ProgramError> {
    let (name, mut origin) = find(named)?;
    program.acquaint(&mut origin);
    Ok((name, origin))
}

fn find(named: &str) -> Result<(String, Origin), ProgramError> {
    if let Some(preset) = Preset::named(named) {
        return Ok((named.to_owned(), preset.origin()));
    }
    let path = Path::new(named);
    if !path.exists() && !looks_like_a_file(path) {
        return Err(unknown(named));
    }
    let stem = path.file_stem().unwrap_or_default();
    Ok((stem.to_string_lossy().into_owned(), Origin::open(path)?))
}

fn looks_like_a_file(path: &Path) -> bool {
    path.extension().is_some() || path.components().count() > 1
}

/// There is nothing of this name.
pub(super) fn unknown(name: &str) -> ProgramError {
    let names = presets().iter().map(|preset| preset.name);
    ProgramError::UnknownScenario {
        name: name.to_owned(),
        hint: match nearest(name, names) {
            Some(near) => format!("; did you mean `{near}`?"),
            None => "; `grainfall presets` lists the presets".to_owned(),
        },
    }
}
