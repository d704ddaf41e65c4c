//! What is made of the files of a run, and what the program says of itself.

use std::fs;

use crate::{expect, place, small, summary};
use serde_json::Value;

/// The last frame of one run starts another, whose folder is complete in itself.
#[test]
fn a_frame_starts_another_run() {
    let place = place();
    expect(place.path(), 0, &["run", "arch", "--until", "0.3"]);
    let scenario = "dimension = 2\ngrains = [{ file = \"runs/arch-1/frames.xyz\" }]\n\
                    parameters = { sleep_speed = 0.05, wake_speed = 0.5 }\n";
    fs::write(place.path().join("more.toml"), scenario).unwrap();
    expect(place.path(), 0, &["run", "more.toml"]);
    fs::rename(place.path().join("runs/more-1"), place.path().join("moved")).unwrap();
    fs::remove_dir_all(place.path().join("runs")).unwrap();
    expect(
        place.path(),
        0,
        &["run", "moved/scenario.toml", "--out", "again"],
    );
    let one = summary(&place.path().join("moved"));
    let other = summary(&place.path().join("again"));
    assert_eq!(one["trajectory_hash"], other["trajectory_hash"]);
    assert_eq!(one["stop_reason"], "all_frozen");
    // In place: the file that is read is one of those that are written.
    expect(
        place.path(),
        0,
        &["run", "again/scenario.toml", "--out", "again", "--force"],
    );
    assert_eq!(
        summary(&place.path().join("again"))["trajectory_hash"],
        one["trajectory_hash"]
    );
    // Or one that is taken away.
    let scenario = scenario.replace("runs/arch-1", "again");
    fs::write(place.path().join("more.toml"), scenario).unwrap();
    let arguments = ["run", "more.toml", "--out", "again", "--force"];
    expect(place.path(), 0, &arguments);
    assert_eq!(
        summary(&place.path().join("again"))["stop_reason"],
        "all_frozen"
    );
}

#[test]
fn runs_are_drawn() {
    let place = place();
    small(place.path(), &[]);
    let said = expect(
        place.path(),
        0,
        &["draw", "runs/deposition-1", "--time", "2.2"],
    );
    assert!(said.contains("picture.svg: t = 2.000000"), "{said}");
    let picture = fs::read_to_string(place.path().join("runs/deposition-1/picture.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("falling"));
    expect(
        place.path(),
        0,
        &["draw", "runs/deposition-1/frames.xyz", "--out", "last.svg"],
    );
    let last = fs::read_to_string(place.path().join("last.svg")).unwrap();
    assert!(!last.contains("falling") && last.contains("60 frozen"));
}

#[test]
fn the_program_explains_itself() {
    let place = place();
    let help = expect(place.path(), 0, &["--help"]);
    for word in [
        "run", "presets", "preset", "check", "schema", "draw", "130", "Examples",
    ] {
        assert!(help.contains(word), "{word}");
    }
    let help = expect(place.path(), 0, &["run", "--help"]);
    for word in [
        "--seed",
        "--out",
        "--set",
        "--until",
        "--force",
        "--quiet",
        "summary.json",
    ] {
        assert!(help.contains(word), "{word}");
    }
    let list = expect(place.path(), 0, &["presets"]);
    for name in ["deposition", "one-by-one", "bounce", "arch", "gas", "gas2d"] {
        assert!(
            list.lines()
                .any(|line| line.split(' ').next() == Some(name)),
            "{name}"
        );
    }
    for line in list.lines() {
        let name = line.split(' ').next().unwrap();
        let text = expect(place.path(), 0, &["preset", name]);
        let file = place.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        let checked = expect(place.path(), 0, &["check", file.to_str().unwrap()]);
        assert!(checked.contains("is fine"), "{checked}");
    }
    let schema: Value = serde_json::from_str(&expect(place.path(), 0, &["schema"])).unwrap();
    assert_eq!(schema["title"], "Scenario of grainfall");
    assert_eq!(expect(place.path(), 0, &["run", "bounce", "--quiet"]), "");
}
