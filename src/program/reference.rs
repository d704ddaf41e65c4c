//! The reference of the book, told by the program itself.

mod commands;
mod markdown;
mod scenario;

use std::fs;
use std::path::PathBuf;

use clap::Args;

use crate::program::error::ProgramError;
use crate::program::show::say;

/// What can be typed after `grainfall reference`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  grainfall reference
  grainfall reference --out book/src      renews the reference in the book

Written are reference-commands.md, from what --help says of every command, and
reference-scenario.md, from the schema of scenarios. Files that are there already
are replaced.")]
pub(super) struct ReferenceArguments {
    /// The folder to write to
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

/// Writes both pages.
pub(super) fn reference(arguments: &ReferenceArguments) -> Result<u8, ProgramError> {
    for (name, text) in [
        ("reference-commands.md", commands::page()),
        ("reference-scenario.md", scenario::page()),
    ] {
        let file = arguments.out.join(name);
        fs::write(&file, text).map_err(ProgramError::io(file.display().to_string()))?;
        say(&format!("written to {}", file.display()))?;
    }
    Ok(0)
}
