//! Sweeps, measurements, validations.

use crate::scenarios::GOOD;
use crate::{grainfall, message};

/// Every combination of a sweep is looked at before any is run.
#[test]
fn sweeps_are_refused_as_a_whole() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("good.toml"), GOOD).unwrap();
    let most = (i64::MAX as u64).to_string();
    let thousand: Vec<String> = (0..1000).map(|n| format!("{n}e-9")).collect();
    let thousand = format!("--set=parameters.sleep_speed={}", thousand.join(","));
    let speeds = "--set=parameters.sleep_speed=0.1,0.2";
    let cases: [(&[&str], &[&str]); 17] = [
        (
            &["--set=parameters.restitution=0.5,1.5", speeds],
            &[
                "--set parameters.restitution=1.5: parameters.restitution is 1.5; a number from 0 to 1",
                "where parameters.restitution = 1.5, parameters.sleep_speed = 0.1",
            ],
        ),
        (
            &["--set=parameters.restituion=0.5,0.6"],
            &["did you mean `restitution`?", "where"],
        ),
        // Two values that are good each by itself.
        (
            &[
                "--set=grains.0.position=[0,1],[3,3]",
                "--set=grains.1.position=[3,1],[0,1]",
            ],
            &[
                "grains 0 and 1 overlap",
                "where grains[0].position = [0, 1], grains[1].position = [0, 1]",
            ],
        ),
        (
            &["--set=parameters.restitution=0.5,,0.6"],
            &["value 2 of the list is empty"],
        ),
        (
            &["--set=gravity=[0,1"],
            &["the [ that opens value 1 of the list is never closed"],
        ),
        (&["--set=gravity"], &["has no `=`"]),
        (
            &["--set=parameters.sleep_speed=0.1,0.2,1e-1"],
            &["parameters.sleep_speed = 0.1 and parameters.sleep_speed = 0.1 are the same"],
        ),
        (
            &["--set=parameters.sleep_speed=1,1.0"],
            &["parameters.sleep_speed = 1 and parameters.sleep_speed = 1.0 are the same"],
        ),
        (
            &[speeds, "--set=parameters.sleep_speed=0.3"],
            &["give all its values at once"],
        ),
        (
            &["--set=stop.time=1,2", "--until=3"],
            &["stop.time is given by", "--until 3"],
        ),
        (
            &["--set=stop.time,seed,stop.time=1,2"],
            &["--seeds N", "--seed N"],
        ),
        (
            &["--set=stop.time,title,stop.time=1,2"],
            &["stop.time is given by"],
        ),
        (&["--seeds=0"], &["0", "1..=100000"]),
        (&["--threads=0"], &["1..=4096"]),
        (&["--seeds=2", "--seed", &most], &["beyond the largest"]),
        (
            &["--seeds=101", &thousand],
            &["1000 combinations", "101 seeds", "at most 100000"],
        ),
        (&["--checkpoint-every=-1"], &["1e-9"]),
    ];
    for (arguments, wanted) in cases {
        let all = [&["sweep", "good.toml"], arguments].concat();
        let output = grainfall(place.path(), &all);
        let said = message(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}\n{said}");
        for part in wanted {
            assert!(said.contains(part), "{arguments:?}\n{said}\nlacks {part}");
        }
    }
    let output = grainfall(place.path(), &["sweep", "depositoin"]);
    assert!(message(&output).contains("did you mean `deposition`?"));
    let left = std::fs::read_dir(place.path()).unwrap().count();
    assert_eq!(left, 1, "something was written");
}

#[test]
fn subjects_of_validation_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let refused = grainfall(folder.path(), &["validate", "bounces", "bouncing"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(refused.stdout.is_empty(), "it began all the same");
    let text = message(&refused);
    assert!(
        text.contains("`bouncing`") && text.contains("bounces"),
        "{text}"
    );

    let unwritable = ["validate", "bounces", "--out", "nowhere/found.json"];
    let refused = grainfall(folder.path(), &unwritable);
    assert_eq!(refused.status.code(), Some(1));
    assert!(refused.stdout.is_empty(), "it began all the same");

    let done = grainfall(
        folder.path(),
        &["validate", "bounces", "--out", "found.json"],
    );
    assert_eq!(done.status.code(), Some(0), "{}", message(&done));
    let table = String::from_utf8(done.stdout).unwrap();
    assert!(table.contains("6 passed, 0 failed"), "{table}");
    let found = std::fs::read_to_string(folder.path().join("found.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    let checks = found[0]["checks"].as_array().unwrap();
    assert_eq!(checks.len(), 6);
    assert!(checks.iter().all(|check| check["verdict"] == "pass"));
}

#[test]
fn measurements_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: &[(&str, &[&str])] = &[
        (
            "gas --count 1000",
            &["1000", "864", "1372", "--start fluid"],
        ),
        ("gas --count 0", &["--count", "from 1 to"]),
        (
            "gas --count 108 --packing-fraction 0.75",
            &["0.75", "0.7405"],
        ),
        (
            "gas --packing-fraction -1",
            &["--packing-fraction", "above 0"],
        ),
        ("gas --count 4 --packing-fraction 0.7", &["at least 2 d"]),
        ("gas --collisions 0", &["--collisions", "from 1 on"]),
        ("gas --equilibrate nan", &["--equilibrate", "from 0 on"]),
        ("gas --start glass", &["glass", "crystal", "fluid"]),
        ("deposition --sleep-speed -0.1", &["--sleep-speed"]),
        ("deposition --from 5 --until 5", &["until is 5", "--from"]),
        ("deposition --until 5 --events 7", &["--events"]),
        (
            "deposition --count 10 --width 1",
            &["width is 1;", "2 or more"],
        ),
        (
            "deposition --quick --count 10 --width 4 --from 1000",
            &["from is 1000", "before all grains sleep"],
        ),
        ("growth --sleep-speeds 0.1,-1", &["sleep_speeds is -1"]),
        ("growth --step 0", &["--step", "above 0"]),
        ("scaling --only sand", &["sand", "frozen"]),
    ];
    for (typed, wanted) in cases {
        let arguments: Vec<&str> = std::iter::once("bench")
            .chain(typed.split_whitespace())
            .collect();
        let refused = grainfall(folder.path(), &arguments);
        let said = message(&refused);
        assert_eq!(refused.status.code(), Some(2), "{typed}\n{said}");
        assert!(refused.stdout.is_empty(), "{typed} began all the same");
        for part in *wanted {
            assert!(said.contains(part), "{typed}\n{said}\nlacks {part}");
        }
    }
    let unwritable = ["bench", "growth", "--quick", "--out", "nowhere/growth.csv"];
    let refused = grainfall(folder.path(), &unwritable);
    assert_eq!(refused.status.code(), Some(1));
    assert!(refused.stdout.is_empty(), "it began all the same");
}
