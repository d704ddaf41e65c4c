//! The program `grainfall`, whose grains are on a chute.

use std::process::ExitCode;

use grainfall::program::Program;
use own_parts::Chute;

fn main() -> ExitCode {
    Program::with_parts::<Chute>("chute").main()
}
