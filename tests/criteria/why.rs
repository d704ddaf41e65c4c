//! `grainfall why`: golden answers, and that a replay finds what a run did and
//! leaves no trace.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use serde_json::Value;

pub(crate) fn grainfall(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap_or(-1),
        text(output.stdout),
        text(output.stderr),
    )
}

fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap())
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect()
}

#[test]
fn the_arch_answers() {
    let place = tempfile::tempdir().unwrap();
    let run = ["run", "arch", "--out", "arch", "--quiet"];
    assert_eq!(grainfall(place.path(), &run).0, 0);
    let before = content(&place.path().join("arch"));
    let mut said = String::new();
    for question in [
        // One sleeps on a fixed one and leans on its partner, which moves.
        &["--particle", "1", "--time", "0.55"][..],
        &["--particle", "2", "--time", "0.55"],
        // Both asleep, at the end.
        &["--particle", "2"],
    ] {
        let mut arguments = vec!["why", "arch"];
        arguments.extend(question);
        let (code, answer, error) = grainfall(place.path(), &arguments);
        assert_eq!(code, 0, "{error}");
        said += &answer;
    }
    insta::assert_snapshot!(said, @r"
    grain 1 at t = 0.550000: asleep since t = 0.549136
    last to fall asleep at t = 0.547699: speed below V_sleep (2.324737e-3 against 5.000000e-2)
    last not to fall asleep at t = 0.540514: going down (-6.145823e-4 against 0.000000e0)
    supported by
      grain 0 (frozen, below), gap 6.242895e-7
    supports nobody
    grain 2 at t = 0.550000: awake since t = 0.000000 or before, speed 5.526271e-3
    last not to fall asleep at t = 0.538577: on a static grain (0.000000e0 against 1.000000e0)
    supported by
      grain 3 (frozen, below), gap 1.855353e-5
    supports
      grain 3 (frozen, below, braced), gap 1.855353e-5
    grain 2 at t = 0.556029: asleep since t = 0.556029
    last to fall asleep at t = 0.553865: speed below V_sleep (9.385619e-3 against 5.000000e-2)
    last not to fall asleep at t = 0.538577: on a static grain (0.000000e0 against 1.000000e0)
    supported by
      grain 3 (frozen, below), gap 3.752497e-6
    supports
      grain 1 (frozen, above), gap 1.356795e-5
    ");
    assert_eq!(
        content(&place.path().join("arch")),
        before,
        "a trace is left"
    );

    let (code, _, error) = grainfall(place.path(), &["why", "arch", "--particle", "4"]);
    assert_eq!(code, 2);
    assert!(
        error.contains("no grain 4") && error.contains("counted from 0"),
        "{error}"
    );
}

/// A small deposition that is killed after its first checkpoint but one.
fn killed(place: &Path) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(place)
        .args(["run", "deposition", "--out", "killed", "--quiet"])
        .args(["--set", "grains.1.rain.count=60"])
        .args(["--set", "parameters.elastic_speed=1e-3"])
        .args([
            "--set",
            "boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
        ])
        .args(["--checkpoint-every", "4"])
        .spawn()
        .unwrap();
    while !place.join("killed/checkpoint.previous").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn from_a_checkpoint_the_answer_is_that_from_the_start() {
    let place = tempfile::tempdir().unwrap();
    killed(place.path());
    let whole = place.path().join("whole");
    fs::create_dir(&whole).unwrap();
    let scenario = place.path().join("killed/scenario.toml");
    fs::copy(&scenario, whole.join("scenario.toml")).unwrap();
    let ask = |run: &str, particle: &str| -> Value {
        let question = [
            "why",
            run,
            "--particle",
            particle,
            "--time",
            "17.5",
            "--json",
        ];
        let (code, said, error) = grainfall(place.path(), &question);
        assert_eq!(code, 0, "{error}");
        serde_json::from_str(&said).unwrap()
    };
    let before = content(&place.path().join("killed"));
    let mut later = 0;
    for particle in ["40", "55", "70", "80"] {
        let (one, two) = (ask("killed", particle), ask("whole", particle));
        assert!(one["replayed_from"].as_f64() > Some(0.0));
        assert_eq!(two["replayed_from"].as_f64(), Some(0.0));
        for key in ["time", "mode", "speed", "supported_by", "supports"] {
            assert_eq!(one[key], two[key], "{key} of grain {particle}");
        }
        // Since the checkpoint both have heard the same.
        if one["stayed_awake"].is_object() {
            assert_eq!(one["stayed_awake"], two["stayed_awake"]);
            later += 1;
        }
    }
    assert!(later > 0, "nobody was asked in the meantime");
    assert_eq!(
        content(&place.path().join("killed")),
        before,
        "a trace is left"
    );
}
