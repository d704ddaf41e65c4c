//! The program `grainfall` as it is, for the tests to compare with.

use std::process::ExitCode;

fn main() -> ExitCode {
    grainfall::program::main()
}
