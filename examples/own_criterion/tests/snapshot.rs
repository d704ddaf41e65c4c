//! What the criterion does, in two and three dimensions, and that the program
//! carries it everywhere.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn program(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_own-criterion"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs the scenario beside the sources; says the exit code and the summary.
fn run(folder: &Path, name: &str, more: &[&str]) -> (Option<i32>, Value) {
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/tired.toml");
    let mut arguments = vec!["run", scenario, "--quiet", "--out", name];
    arguments.extend(more);
    let code = program(folder, &arguments).status.code();
    let text = std::fs::read_to_string(folder.join(name).join("summary.json")).unwrap();
    (code, serde_json::from_str(&text).unwrap())
}

fn line(name: &str, summary: &Value) -> String {
    let events = &summary["events"];
    format!(
        "{name}: {} sleeps, {} wakes, {} frozen; {}\n",
        events["sleep"], events["wake"], summary["particles"]["frozen"], summary["trajectory_hash"]
    )
}

const PLANE: [&str; 4] = [
    "--set",
    "dimension=2",
    "--set",
    "boundaries=[{periodic={length=8}},\"open\"]",
];

#[test]
fn the_same_source_in_the_plane_and_in_space() {
    let place = tempfile::tempdir().unwrap();
    let (code, space) = run(place.path(), "space", &[]);
    assert_eq!(code, Some(0));
    let (code, plane) = run(place.path(), "plane", &PLANE);
    assert_eq!(code, Some(0));
    let table = line("space", &space) + &line("plane", &plane);
    insta::assert_snapshot!(table, @r#"
    space: 21 sleeps, 9 wakes, 12 frozen; "db0320374531253d"
    plane: 35 sleeps, 23 wakes, 12 frozen; "fb84d5a517fc78ac"
    "#);
    // What it left out stands in the scenario that was run.
    let text = std::fs::read_to_string(place.path().join("space/scenario.toml")).unwrap();
    assert!(
        text.contains("[criteria.tired]\nslow_hits = 4\nspeed = 0.1"),
        "{text}"
    );
}

#[test]
fn an_interrupted_run_goes_on_with_it() {
    let place = tempfile::tempdir().unwrap();
    let (_, whole) = run(place.path(), "whole", &[]);
    let (_, part) = run(place.path(), "part", &["--set", "stop.events=2000"]);
    assert_ne!(part["trajectory_hash"], whole["trajectory_hash"]);
    // Killed after its second checkpoint, of which the first holds nothing yet.
    let killed = place.path().join("killed");
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/tired.toml");
    let mut child = Command::new(env!("CARGO_BIN_EXE_own-criterion"))
        .current_dir(place.path())
        .args([
            "run",
            scenario,
            "--quiet",
            "--out",
            "killed",
            "--checkpoint-every",
            "1",
        ])
        .spawn()
        .unwrap();
    while !killed.join("checkpoint.previous").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended before");
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let resumed = program(place.path(), &["resume", "killed", "--quiet"]);
    assert_eq!(resumed.status.code(), Some(0));
    let text = std::fs::read_to_string(killed.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["trajectory_hash"], whole["trajectory_hash"]);
}

#[test]
fn its_parameters_are_checked_and_it_is_listed() {
    let place = tempfile::tempdir().unwrap();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/tired.toml");
    let set = "criteria.tired.slow_hit=2";
    let refused = program(place.path(), &["check", scenario, "--set", set]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(said.contains("did you mean `slow_hits`?"), "{said}");
    let listed = program(place.path(), &["criteria"]);
    let said = String::from_utf8(listed.stdout).unwrap();
    assert!(
        said.starts_with("tired                 slow collisions in a row\n"),
        "{said}"
    );
    assert!(said.contains("\nslow_descent "), "{said}");
}

#[test]
fn it_is_compared_and_explained() {
    let place = tempfile::tempdir().unwrap();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/tired.toml");
    let policies = "tired,slow_descent";
    let compared = program(place.path(), &["compare", scenario, "--policies", policies]);
    let said = String::from_utf8(compared.stdout).unwrap();
    assert_eq!(compared.status.code(), Some(0), "{said}");
    assert!(
        said.contains("| tired ") && said.contains("false_sleeps"),
        "{said}"
    );

    let (_, summary) = run(place.path(), "space", &[]);
    let last = summary["particles"]["total"].as_u64().unwrap() - 1;
    let last = last.to_string();
    let asked = program(
        place.path(),
        &["why", "space", "--particle", &last, "--json"],
    );
    let answer: Value = serde_json::from_slice(&asked.stdout).unwrap();
    assert_eq!(answer["mode"], "frozen");
    assert_eq!(answer["fell_asleep"]["condition"], "slow hit");
    assert_eq!(answer["fell_asleep"]["limit"], 0.1);
}
