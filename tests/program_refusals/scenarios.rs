//! Scenarios: keys, values, grains.

use crate::{grainfall, message};

pub(crate) const GOOD: &str = r#"dimension = 2
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

/// Runs a text and expects a refusal that holds all of `wanted`, and no folder.
pub(crate) fn assert_refused(file: &str, text: &str, wanted: &[&str]) {
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
    let text = GOOD.replace("time = 5", "") + "[rotation]\nangular_velocity = 0.1\n";
    assert_refused(
        "bad.toml",
        &text,
        &["bad.toml:5:1", "give stop.time or stop.events"],
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
