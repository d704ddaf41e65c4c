//! Whole runs from the command line.
#![cfg(feature = "program")]

mod benchmarks;
mod deposition;
mod endings;
mod files;
mod presets;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn place() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn grainfall(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs and expects an exit code; says what was printed.
fn expect(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = grainfall(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    if code == 0 {
        assert_eq!(said, "", "a pipe is told nothing but results");
    }
    String::from_utf8(output.stdout).unwrap()
}

fn summary(run: &Path) -> Value {
    let text = fs::read_to_string(run.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The rows of a table without quotes.
fn rows(file: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(file).unwrap();
    text.lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// The paper's deposition, made small.
const SMALL: [&str; 10] = [
    "run",
    "deposition",
    "--set",
    "grains.1.rain.count=60",
    "--set",
    "parameters.elastic_speed=1e-3",
    "--set",
    "boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
    "--set",
    "output.frames_every=2",
];

fn small(folder: &Path, more: &[&str]) -> Value {
    let arguments: Vec<&str> = SMALL.iter().chain(more).copied().collect();
    expect(folder, 0, &arguments);
    let out = more.iter().position(|word| *word == "--out");
    let run = out.map_or("runs/deposition-1", |at| more[at + 1]);
    summary(&folder.join(run))
}
