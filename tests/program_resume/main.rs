//! Interrupted runs go on: in the end the folder is that of a run that was
//! never interrupted.
#![cfg(all(feature = "program", unix))]

mod kills;
mod refusals;
mod sweeps;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

fn place() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainfall"));
    command
        .current_dir(folder)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

fn grainfall(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .output()
        .unwrap()
}

/// Runs and expects an exit code; says what was printed, errors last.
fn expect(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = grainfall(folder, arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    said
}

/// The content of all files of a run, without timings.
fn content(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(run).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let mut bytes = fs::read(run.join(&name)).unwrap();
        if name == "summary.json" {
            let mut summary: serde_json::Map<String, Value> =
                serde_json::from_slice(&bytes).unwrap();
            for key in TIMINGS {
                assert!(summary.remove(key).is_some_and(|value| value.is_number()));
            }
            bytes = serde_json::to_vec(&summary).unwrap();
        }
        files.insert(name, bytes);
    }
    files
}

#[track_caller]
fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (content(one), content(other));
    assert!(
        one.keys().eq(other.keys()),
        "{:?} {:?}",
        one.keys(),
        other.keys()
    );
    for (name, bytes) in &one {
        assert!(*bytes == other[name], "{name} is not the same");
    }
}

/// Takes one of the numbers of events out of a summary, as of a program that did not
/// count them.
fn forget_count(run: &Path, name: &str) {
    let file = run.join("summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let events = summary["events"].as_object_mut().unwrap();
    assert!(events.remove(name).is_some());
    fs::write(&file, serde_json::to_vec(&summary).unwrap()).unwrap();
}

fn reason(run: &Path) -> Option<String> {
    let text = fs::read_to_string(run.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_str(&text).unwrap();
    Some(summary["stop_reason"].as_str().unwrap().to_owned())
}

/// Runs of all kinds, each about a second long.
const RUNS: [&[&str]; 4] = [
    &[
        "deposition",
        "--set=grains.1.rain.count=80",
        "--set=parameters.elastic_speed=1e-3",
        "--set=boundaries=[{periodic={length=5}},{periodic={length=5}},\"open\"]",
        "--set=output.frames_every=2",
        "--set=output.series_every=0.1",
        "--set=self_check.interval=0.1",
    ],
    &[
        "one-by-one",
        "--set=grains.1.one_by_one.count=40",
        "--set=boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
        "--set=output.events=true",
        "--set=output.frames_every=20",
    ],
    &[
        "gas-inelastic",
        "--set=grains.0.gas.count=300",
        "--set=stop.time=40",
        "--set=output.events=true",
    ],
    &[
        "gas2d",
        "--set=grains.0.gas.count=200",
        "--set=stop.time=60",
    ],
];

fn start(number: usize, more: &[&'static str]) -> Vec<&'static str> {
    let mut arguments = vec!["run"];
    arguments.extend(RUNS[number]);
    arguments.extend(more);
    arguments
}

fn wait_for(running: &mut Child, what: impl Fn() -> bool) {
    let patience = Instant::now();
    while !what() && running.try_wait().unwrap().is_none() {
        assert!(
            patience.elapsed() < Duration::from_secs(300),
            "it never came"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn kill(running: &Child, signal: &str) {
    let pid = running.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(sent.unwrap().success());
}

/// What takes how long is not the same twice.
const TIMINGS: [&str; 2] = ["cpu_seconds", "events_per_second"];
