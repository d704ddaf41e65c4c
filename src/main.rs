//! The command-line program `grainfall`.

use std::process::ExitCode;

fn main() -> ExitCode {
    grainfall::program::main()
}
