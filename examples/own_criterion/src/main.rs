//! The program `grainfall`, which now knows the criterion `tired`.

use std::process::ExitCode;

use grainfall::program::Program;
use own_criterion::Tired;

fn main() -> ExitCode {
    Program::new()
        .with_criterion::<Tired>("tired", "slow collisions in a row")
        .main()
}
