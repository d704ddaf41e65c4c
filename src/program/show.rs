//! Commands that only print.

use std::fmt::Display;
use std::io::{self, Write};

use serde::Serialize;

use crate::program::cli::CheckArguments;
use crate::program::criteria::Program;
use crate::program::error::ProgramError;
use crate::program::load::{load, unknown};
use crate::scenario::{Preset, SourceKind, json_schema, presets as all_presets};

/// Prints `text` and a new line. A reader that has gone away is no error.
pub(super) fn say(text: &str) -> Result<(), ProgramError> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(ProgramError::io("standard output")(error))
        }
        _ => Ok(()),
    }
}

/// Prints a result for a reader, or as one line of JSON.
pub(super) fn say_result<T: Serialize + Display>(
    result: &T,
    as_json: bool,
) -> Result<(), ProgramError> {
    if !as_json {
        return say(&result.to_string());
    }
    let line = serde_json::to_string(result)
        .map_err(|error| ProgramError::io("standard output")(error.into()))?;
    say(&line)
}

pub(super) fn presets() -> Result<u8, ProgramError> {
    let widest = all_presets()
        .iter()
        .map(|p| p.name.len())
        .max()
        .unwrap_or(0);
    let lines: Vec<String> = all_presets()
        .iter()
        .map(|preset| format!("{:widest$}  {}", preset.name, preset.summary))
        .collect();
    say(&lines.join("\n")).map(|()| 0)
}

pub(super) fn preset(name: &str) -> Result<u8, ProgramError> {
    let preset = Preset::named(name).ok_or_else(|| unknown(name))?;
    say(preset.text.trim_end()).map(|()| 0)
}

pub(super) fn criteria(program: &Program) -> Result<u8, ProgramError> {
    let criteria = program.criteria();
    let widest = criteria.iter().map(|known| known.name.len()).max();
    let widest = widest.unwrap_or(0);
    let lines: Vec<String> = criteria
        .iter()
        .map(|known| format!("{:widest$}  {}", known.name, known.summary))
        .collect();
    say(&lines.join("\n")).map(|()| 0)
}

pub(super) fn schema() -> Result<u8, ProgramError> {
    say(&format!("{:#}", json_schema())).map(|()| 0)
}

pub(super) fn check(arguments: &CheckArguments, program: &Program) -> Result<u8, ProgramError> {
    let loaded = load(&arguments.scenario, arguments.set.clone(), program)?;
    let (origin, scenario) = (&loaded.origin, &loaded.scenario);
    let given = program.runner(scenario).check(origin, scenario)?.grains;
    let mut parts = Vec::new();
    if given > 0 {
        parts.push(format!("{given} given"));
    }
    for source in &scenario.grains {
        match source.kind() {
            Ok(SourceKind::Base(_)) => parts.push("a base to make".to_owned()),
            Ok(SourceKind::Rain(rain)) => parts.push(format!("{} to rain", rain.count)),
            Ok(SourceKind::Gas(gas)) => parts.push(format!("{} of a gas to make", gas.count)),
            Ok(SourceKind::Drum(_)) => parts.push("a drum to fill".to_owned()),
            Ok(SourceKind::OneByOne(drops)) => {
                parts.push(format!("{} to drop one by one", drops.count));
            }
            Ok(SourceKind::Grain(_) | SourceKind::File(_)) | Err(_) => {}
        }
    }
    say(&format!(
        "{} is fine: {} dimensions; grains: {}",
        origin.name,
        scenario.axes(),
        parts.join(", ")
    ))
    .map(|()| 0)
}
