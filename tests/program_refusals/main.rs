//! What the program refuses: with the place, the value and what is allowed,
//! exit code 2, and nothing written.
#![cfg(feature = "program")]

mod bad_input;
mod commands;
mod files;
#[path = "../common/mutate.rs"]
mod mutate;
mod scenarios;

use std::path::Path;
use std::process::{Command, Output};

fn grainfall(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
