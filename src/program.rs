//! The command-line program.
//!
//! Exit codes: 0 done · 1 input or output, or a validation, failed · 2 the input is refused ·
//! 3 stopped early, with the state saved · 130 and 143 stopped by a signal.

mod analyse;
mod bench;
mod cli;
mod compare;
mod criteria;
mod draw;
mod drive;
mod error;
mod estimate;
mod load;
mod means;
mod parts;
mod processor;
mod progress;
mod rain;
mod reference;
mod reproduce;
mod resume;
mod run;
mod runner;
mod show;
mod signals;
mod sweep;
mod table;
mod timing;
mod validate;
mod why;

pub use criteria::Program;
pub use error::ProgramError;
pub use parts::{Refit, RefittedProgram};
pub use sweep::SweepError;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::program::cli::{Cli, Command};

/// Runs the program with the arguments of this process, and says how it went.
#[must_use]
pub fn main() -> ExitCode {
    Program::new().main()
}

fn run_command(program: &Program) -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(arguments) => run::run(&arguments, program),
        Command::Resume(arguments) => resume::resume(&arguments, program),
        Command::Sweep(arguments) => sweep::sweep(&arguments, program),
        Command::Compare(arguments) => compare::compare(&arguments, program),
        Command::Why(arguments) => why::why(&arguments, program),
        Command::Criteria => show::criteria(program),
        Command::Presets => show::presets(),
        Command::Preset { name } => show::preset(&name),
        Command::Check(arguments) => show::check(&arguments, program),
        Command::Schema => show::schema(),
        Command::Reference(arguments) => reference::reference(&arguments),
        Command::Draw(arguments) => draw::draw(&arguments),
        Command::Analyse(arguments) => analyse::analyse(&arguments),
        // The paper's model, whatever parts this program has.
        Command::Reproduce(arguments) => reproduce::reproduce(&arguments, &Program::new()),
        Command::Validate(arguments) => validate::validate(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
    };
    match done {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            // Nobody may be listening; the exit code says it too.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
