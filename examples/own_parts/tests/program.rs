//! The parts are those of every run of the program, and of no other program's.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

const OWN: &str = env!("CARGO_BIN_EXE_own-parts");
const STOCK: &str = env!("CARGO_BIN_EXE_stock");
const CHUTE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/chute.toml");

/// Exit code, and what was said on both streams.
fn program(binary: &str, folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let done = Command::new(binary)
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = [done.stdout, done.stderr].concat();
    (done.status.code(), String::from_utf8(text).unwrap())
}

/// Runs a scenario that is written out; its summary.
fn run(binary: &str, folder: &Path, name: &str, scenario: &str) -> Value {
    let file = format!("{name}.toml");
    std::fs::write(folder.join(&file), scenario).unwrap();
    let (code, said) = program(binary, folder, &["run", &file, "--quiet", "--out", name]);
    assert_eq!(code, Some(0), "{said}");
    summary(&folder.join(name))
}

fn summary(run: &Path) -> Value {
    let text = std::fs::read_to_string(run.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn without_tilt_and_loss_they_are_the_built_in_ones() {
    let place = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(CHUTE).unwrap();
    let built_in = text.split("[parts.chute]").next().unwrap();
    let stock = run(STOCK, place.path(), "stock", built_in);
    // They may be left out, for there are defaults.
    let own = run(OWN, place.path(), "own", built_in);
    assert_eq!(own["trajectory_hash"], stock["trajectory_hash"]);
    let tilted = run(OWN, place.path(), "tilted", &text);
    assert_ne!(tilted["trajectory_hash"], stock["trajectory_hash"]);
}

/// Two grains meet head on at a relative speed of 1: α = 0.7 − 0.2.
#[test]
fn restitution_falls_with_speed() {
    let place = tempfile::tempdir().unwrap();
    let scenario = "dimension = 2\ngravity = \"none\"\nstop.time = 3.0\n\
        grains = [{ position = [0, 0], velocity = [0.5, 0] }, \
        { position = [2, 0], velocity = [-0.5, 0] }]\nparts.chute.loss = 0.2";
    let after = run(OWN, place.path(), "pair", scenario);
    let energy = after["kinetic_energy"].as_f64().unwrap();
    assert!((energy - 0.25 * 0.5 * 0.5).abs() < 1.0e-15, "{energy}");
}

/// A grain let go goes t²/2 along gravity, which leans by 30°.
#[test]
fn gravity_leans() {
    let place = tempfile::tempdir().unwrap();
    let scenario = "dimension = 2\nstop.time = 2.0\noutput.frames_every = 2.0\n\
        grains = [{ position = [0, 0] }]\nparts.chute.tilt = 30";
    run(OWN, place.path(), "fall", scenario);
    let text = std::fs::read_to_string(place.path().join("fall/frames.xyz")).unwrap();
    // id x y vx vy …
    let last: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
    let number = |column: usize| last[column].parse::<f64>().unwrap();
    let (x, y) = (number(1), number(2));
    assert!((x - 1.0).abs() < 1.0e-12, "{x}");
    assert!((y + 3.0_f64.sqrt()).abs() < 1.0e-12, "{y}");
}

#[test]
fn a_run_is_gone_on_with_them_and_no_others() {
    let place = tempfile::tempdir().unwrap();
    // Long enough to be killed on the way.
    let text = std::fs::read_to_string(CHUTE)
        .unwrap()
        .replace("count = 12", "count = 150");
    let whole = run(OWN, place.path(), "whole", &text);
    let kill = |binary: &str, scenario: &str, name: &str| {
        let mut child = Command::new(binary)
            .current_dir(place.path())
            .args(["run", scenario, "--quiet", "--out", name])
            .args(["--checkpoint-every", "1"])
            .spawn()
            .unwrap();
        let killed = place.path().join(name);
        while !killed.join("checkpoint.previous").exists() {
            assert!(child.try_wait().unwrap().is_none(), "it has ended before");
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        killed
    };
    let killed = kill(OWN, "whole.toml", "killed");
    // The program as it is has not these parts, and says so.
    let (code, said) = program(STOCK, place.path(), &["resume", "killed", "--quiet"]);
    assert_eq!(code, Some(2));
    assert!(said.contains("no parts `chute` are known here"), "{said}");
    let (code, said) = program(OWN, place.path(), &["resume", "killed", "--quiet"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(
        summary(&killed)["trajectory_hash"],
        whole["trajectory_hash"]
    );

    // Nor does a run of that program go on with these parts.
    let plain = text.split("[parts.chute]").next().unwrap();
    std::fs::write(place.path().join("plain.toml"), plain).unwrap();
    kill(STOCK, "plain.toml", "plain");
    let (code, said) = program(OWN, place.path(), &["resume", "plain", "--quiet"]);
    assert_eq!(code, Some(2));
    assert!(said.contains("a run without the parts `chute`"), "{said}");
}

#[test]
fn a_run_is_explained_and_compared_with_them() {
    let place = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(CHUTE).unwrap();
    let whole = run(OWN, place.path(), "whole", &text);
    let why = ["why", "whole", "--particle", "40", "--json"];
    assert_eq!(program(OWN, place.path(), &why).0, Some(0));
    let policies = "slow_descent,isostatic_support";
    let compare = ["compare", CHUTE, "--policies", policies];
    let (code, said) = program(OWN, place.path(), &compare);
    assert_eq!(code, Some(0), "{said}");
    let alike = format!("| {} ", whole["events"]["pair"]);
    assert!(said.contains(&alike), "{alike} is not in {said}");
}

#[test]
fn wrong_parameters_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let refused = |set: &str| {
        let (code, said) = program(OWN, place.path(), &["check", CHUTE, "--set", set]);
        assert_eq!(code, Some(2), "{said}");
        said
    };
    assert!(refused("parts.chute.tlit=1").contains("did you mean `tilt`?"));
    assert!(refused("parts.slide.tilt=1").contains("`chute`"));
    let said = refused("parts.chute.loss=-1");
    assert!(
        said.contains("parts.chute.loss") && said.contains("0 … 1"),
        "{said}"
    );
}
