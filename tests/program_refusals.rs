//! What the program refuses: with the place, the value and what is allowed,
//! exit code 2, and nothing written.
#![cfg(feature = "program")]

#[path = "common/bad_input.rs"]
mod bad_input;
#[path = "common/mutate.rs"]
mod mutate;

use std::path::Path;
use std::process::{Command, Output};

const GOOD: &str = r#"dimension = 2
boundaries = ["open", { walls = { low = 0.0, restitution = 0.4 } }]
[parameters]
restitution = 0.7
[stop]
time = 5
[output]
series_every = 1
[[grains]]
position = [0.0, 1.0]
[[grains]]
position = [3.0, 1.0]
"#;

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

/// Runs a text and expects a refusal that holds all of `wanted`, and no folder.
fn assert_refused(file: &str, text: &str, wanted: &[&str]) {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join(file), text).unwrap();
    for command in ["check", "run"] {
        let output = grainfall(place.path(), &[command, file]);
        let said = message(&output);
        assert_eq!(output.status.code(), Some(2), "{command} {text}\n{said}");
        assert!(output.stdout.is_empty(), "{text}");
        for part in wanted {
            assert!(
                said.contains(part),
                "{command} {text}\n{said}\nlacks {part}"
            );
        }
        assert!(
            said.len() < 2000,
            "a message nobody reads: {} bytes",
            said.len()
        );
    }
    let left: Vec<_> = std::fs::read_dir(place.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "something was written for {text}");
}

#[test]
fn the_good_one_is_good() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("good.toml"), GOOD).unwrap();
    let output = grainfall(place.path(), &["check", "good.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
}

/// What to replace in the good scenario, by what, and what is said of it.
const REPLACED: &[(&str, &str, &[&str])] = &[
    (
        "restitution = 0.7",
        "restituion = 0.7",
        &[
            "bad.toml:4:1",
            "parameters.restituion",
            "did you mean `restitution`?",
        ],
    ),
    (
        "restitution = 0.7",
        "restitution = 1.7",
        &["bad.toml:4:15", "parameters.restitution is 1.7", "0 to 1"],
    ),
    (
        "restitution = 0.7",
        "restitution = \"high\"",
        &["bad.toml:4:15", "string \"high\"", "expected a number"],
    ),
    (
        "restitution = 0.7",
        "sleep_speed = -0.1",
        &[
            "bad.toml:4:15",
            "parameters.sleep_speed is -0.1",
            "0 or more",
        ],
    ),
    (
        "restitution = 0.7",
        "wake_speed = inf",
        &["bad.toml:4:14", "parameters.wake_speed is inf", "\"never\""],
    ),
    (
        "restitution = 0.7",
        "wake_speed = \"always\"",
        &["bad.toml:4:14", "\"always\"", "a number or \"never\""],
    ),
    (
        "dimension = 2",
        "dimension = 4",
        &["bad.toml:1:13", "4 dimensions", "2 or 3"],
    ),
    (
        "dimension = 2\n",
        "",
        &["bad.toml", "missing key `dimension`"],
    ),
    (
        "dimension = 2",
        "dimension = 3",
        &["bad.toml:2:14", "boundaries", "3 entries"],
    ),
    (
        "dimension = 2",
        "dimension = 2 2",
        &["bad.toml:1:", "not TOML"],
    ),
    (
        "[3.0, 1.0]",
        "[0.5, 1.0]",
        &[
            "bad.toml:12:12",
            "grains 0 and 1 overlap by 5e-1 d",
            "grains[0].position",
        ],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 0.2]",
        &[
            "bad.toml:12:12",
            "grain 1 reaches 3e-1 d",
            "boundaries[1].walls.low",
        ],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, nan]",
        &["bad.toml:12:18", "grains[1].position[1] is NaN", "finite"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0, 2.0]",
        &["bad.toml:12:12", "3 components", "2 are needed"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1e30]",
        &["bad.toml:12:18", "between -1e9 and 1e9"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0]\ndiameter = -1",
        &[
            "bad.toml:13:12",
            "grains[1].diameter is -1",
            "greater than 0",
        ],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0]\nmass = 0",
        &["bad.toml:13:8", "grains[1].mass is 0", "greater than 0"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0]\nmode = \"sleeping\"",
        &["bad.toml:13:8", "unknown choice `sleeping`", "`frozen`"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0]\nvelocity = [1, 0]\nmode = \"frozen\"",
        &["bad.toml:13:12", "at rest"],
    ),
    (
        "[3.0, 1.0]",
        "[3.0, 1.0]\nfile = \"more.xyz\"",
        &["bad.toml:11:1", "position and file at once", "exactly one"],
    ),
    (
        "position = [3.0, 1.0]",
        "rain.count = 10",
        &["bad.toml:12:1", "grains[1].rain", "boundaries[0]"],
    ),
    (
        "position = [3.0, 1.0]",
        "gas = { count = 10, packing_fraction = 0.3 }",
        &["bad.toml:12:7", "its own periodic box"],
    ),
    (
        "\"open\"",
        "\"opne\"",
        &["bad.toml:2:15", "did you mean `open`?"],
    ),
    (
        "\"open\"",
        "\"periodic\"",
        &["bad.toml:2:15", "expected a table"],
    ),
    (
        "\"open\"",
        "{ periodic = { length = -3 } }",
        &["bad.toml:2:39", "boundaries[0].periodic.length is -3"],
    ),
    (
        "\"open\"",
        "{ periodic = { length = 1.5 } }",
        &["bad.toml:2:15", "at least 2 d"],
    ),
    (
        "low = 0.0",
        "low = 0.0, high = -1.0",
        &["bad.toml:2:53", "more than low = 0 is allowed"],
    ),
    (
        "time = 5",
        "time = -5",
        &["bad.toml:6:8", "stop.time is -5"],
    ),
    (
        "time = 5",
        "events = 5.5",
        &["bad.toml:6:10", "a whole number"],
    ),
    (
        "series_every = 1",
        "series_every = 1e-8",
        &["bad.toml:8:16", "1e7 samples"],
    ),
    (
        "[parameters]",
        "[self_check]\ninterval = 0\n[parameters]",
        &["bad.toml:4:12", "self_check.interval is 0"],
    ),
];

#[test]
fn bad_values_are_refused_at_their_place() {
    for (from, to, wanted) in REPLACED {
        assert!(GOOD.contains(from), "{from}");
        assert_refused("bad.toml", &GOOD.replacen(from, to, 1), wanted);
    }
}

#[test]
fn a_run_that_cannot_end_is_refused() {
    let text = format!("gravity = \"none\"\n{}", GOOD.replace("time = 5", ""));
    assert_refused(
        "bad.toml",
        &text,
        &["bad.toml:6:1", "give stop.time or stop.events"],
    );
}

#[test]
fn no_grains_are_refused() {
    let text = GOOD.split("[[grains]]").next().unwrap().to_owned();
    assert_refused("bad.toml", &text, &["missing key `grains`"]);
    let text = format!("grains = []\n{text}");
    assert_refused("bad.toml", &text, &["bad.toml:1:10", "at least one source"]);
}

#[test]
fn json_is_refused_by_its_paths() {
    let good = r#"{"dimension": 2, "stop": {"time": 1}, "grains": [{"position": [1, 2]}]}"#;
    for (from, to, wanted) in [
        (
            "[1, 2]",
            "[1, 2], \"mas\": 3",
            "grains[0].mas: unknown key `mas`",
        ),
        (
            "[1, 2]",
            "[1, 2], \"diameter\": -3",
            "grains[0].diameter is -3",
        ),
        ("\"time\": 1", "\"time\": 1, \"time\": 2", "bad.json:1:"),
        ("[1, 2]", "[1, null]", "a list may not hold null"),
        ("}]}", "}]", "not JSON"),
        ("2,", "\"two\",", "dimension: invalid type: string \"two\""),
    ] {
        assert!(good.contains(from), "{from}");
        assert_refused("bad.json", &good.replacen(from, to, 1), &[wanted]);
    }
}

#[test]
fn bad_files_of_grains_are_refused() {
    let scenario = "dimension = 3\n[[grains]]\nfile = \"g.xyz\"\n";
    for (grains, wanted) in [
        ("", "empty"),
        ("many\n\n", "`many`"),
        ("99999999999\n\n", "at most 10000000"),
        ("2\n\nA 0 0 0\n", "ends after line 3"),
        (
            "1\nProperties=pos:R:3\n0 zero 0\n",
            "line 3 of the XYZ file: position is `zero`",
        ),
        (
            "1\nProperties=pos:R:3:radius:R:1\n0 0 0 inf\n",
            "radius is `inf`",
        ),
        (
            "1\nProperties=pos:R:3:mode:S:1\n0 0 0 awake\n",
            "mode is `awake`",
        ),
        (
            "1\nProperties=pos:R:3:type:S:1\n0 0 0 Si\n",
            "type is `Si`; normal, falling, frozen or fixed is wanted",
        ),
        ("1\nProperties=pos:R\n0 0 0\n", "name:kind:width"),
        (
            "2\nProperties=id:I:1:pos:R:3\n1 0 0 0\n1 5 0 0\n",
            "only once",
        ),
        ("2\n\nA 0 0 0\nA 0 0 0.5\n", "overlap by 5e-1 d"),
    ] {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("bad.toml"), scenario).unwrap();
        std::fs::write(place.path().join("g.xyz"), grains).unwrap();
        let output = grainfall(place.path(), &["check", "bad.toml"]);
        let said = message(&output);
        assert_eq!(output.status.code(), Some(2), "{grains}\n{said}");
        assert!(
            said.contains(wanted) && said.contains("grains[0]"),
            "{grains}\n{said}"
        );
    }
}

#[test]
fn bad_assignments_are_refused_as_such() {
    for (set, wanted) in [
        (
            "parametrs.x=1",
            "--set parametrs.x=1: parametrs: unknown key",
        ),
        (
            "parameters.restitution=hi",
            "--set parameters.restitution=hi: ",
        ),
        ("parameters.restitution=2", "parameters.restitution is 2"),
        ("grains.5.mass=1", "grains has 1 entries"),
        ("dimension.x=1", "dimension is no table (integer)"),
        ("seed", "has no `=`"),
    ] {
        let place = tempfile::tempdir().unwrap();
        let output = grainfall(place.path(), &["run", "bounce", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(
            message(&output).contains(wanted),
            "{set}: {}",
            message(&output)
        );
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    }
}

#[test]
fn what_is_not_there_is_told_apart() {
    let place = tempfile::tempdir().unwrap();
    let output = grainfall(place.path(), &["run", "depositoin"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("did you mean `deposition`?"));
    let output = grainfall(place.path(), &["run", "mine.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(message(&output).contains("cannot read mine.toml"));
    let output = grainfall(place.path(), &["draw", "nothing"]);
    assert_eq!(output.status.code(), Some(1));
    let output = grainfall(place.path(), &["draw", "nothing", "--time", "nan"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("finite"));
    let output = grainfall(place.path(), &["fly"]);
    assert_eq!(output.status.code(), Some(2));
}

/// Numbers and files that are made to hang a careless reader or to eat its
/// memory.
#[test]
fn hostile_input_is_refused_quickly() {
    let deep = format!("x = {}\n{GOOD}", "[".repeat(100_000));
    assert_refused("bad.toml", &deep, &["not TOML"]);
    let deep = "[".repeat(100_000);
    assert_refused("bad.json", &deep, &["not JSON"]);
    let long_key = format!("{} = 1\n{GOOD}", "k".repeat(1_000_000));
    assert_refused("bad.toml", &long_key, &["unknown key"]);
    let boxed = r#"dimension = 3
boundaries = [{ periodic = { length = 1e8 } }, { periodic = { length = 1e8 } }, "open"]
[[grains]]
"#;
    for (source, wanted) in [
        ("base = { thickness = 2 }", "at most 10000000"),
        ("rain = { count = 99999999 }", "1 to 10000000"),
        ("rain = { count = 99999999999999999999 }", "not TOML"),
        ("one_by_one = { count = 1000000000 }", "1 to 10000000"),
        (
            "rain = { count = 5, sizes = { kind = \"log_normal\", median = 1, spread = 99 } }",
            "0 … 2",
        ),
    ] {
        assert_refused("bad.toml", &format!("{boxed}{source}\n"), &[wanted]);
    }
}

/// Very many grains in the reach of one, or at one place.
#[test]
fn crowds_are_refused_quickly() {
    let place = tempfile::tempdir().unwrap();
    let scenario = "dimension = 3\n[[grains]]\nfile = \"g.xyz\"\n";
    std::fs::write(place.path().join("bad.toml"), scenario).unwrap();
    let head = "Properties=pos:R:3:radius:R:1";
    let spread: String = (0..50_000)
        .map(|k| format!("{} {} {} 0.5\n", k % 37, k / 37 % 37, k / 1369))
        .collect();
    let piled = "0 0 0 0.5\n".repeat(50_000);
    for grains in [
        format!("50001\n{head}\n{spread}18 18 -1000 999\n"),
        format!("50000\n{head}\n{piled}"),
    ] {
        std::fs::write(place.path().join("g.xyz"), grains).unwrap();
        let output = grainfall(place.path(), &["check", "bad.toml"]);
        assert_eq!(output.status.code(), Some(2));
        let said = message(&output);
        assert!(
            said.contains("bad.toml:2:1") && said.contains("pairs"),
            "{said}"
        );
    }
}

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
