//! `grainfall compare`: each run is the one that `run` makes, and the censuses
//! count what they say.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::why::grainfall;

const SMALL: [&str; 8] = [
    "--set",
    "grains.1.rain.count=30",
    "--set",
    "parameters.elastic_speed=1e-3",
    "--set",
    "boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
    "--until",
    "20",
];

/// The rows of compare.csv, by name of column.
fn rows(folder: &Path) -> Vec<Vec<(String, String)>> {
    let text = fs::read_to_string(folder.join("compare.csv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells = line.split(',').map(str::to_owned);
            names
                .iter()
                .map(|name| (*name).to_owned())
                .zip(cells)
                .collect()
        })
        .collect()
}

fn of(row: &[(String, String)], name: &str) -> f64 {
    let (_, cell) = row.iter().find(|(known, _)| known == name).unwrap();
    cell.parse().unwrap()
}

#[test]
fn criteria_side_by_side() {
    let place = tempfile::tempdir().unwrap();
    let mut arguments = vec!["compare", "deposition", "--out", "both", "--seeds", "2"];
    arguments.extend(["--policies", "slow_descent,isostatic_support"]);
    arguments.extend(SMALL);
    let (code, said, error) = grainfall(place.path(), &arguments);
    assert_eq!(code, 0, "{error}");
    assert!(said.contains("| slow_descent ") && said.contains("| isostatic_support "));
    let both = place.path().join("both");
    let rows = rows(&both);
    assert_eq!(rows.len(), 4);
    for row in &rows {
        assert_eq!(of(row, "sleeps_questioned"), 20.0);
        assert!(of(row, "false_sleeps") <= 20.0);
        // A grain sleeps no oftener than it woke, but for those that lie there.
        let (wakes, sleeps) = (of(row, "wakes"), of(row, "sleep"));
        assert!(of(row, "wake") + of(row, "check_wake") == wakes);
        assert!(sleeps >= wakes && of(row, "false_wakes") <= wakes);
    }
    let picture = fs::read_to_string(both.join("compare.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("packing fraction"));

    // The same as by itself; and the same again, on one thread.
    let mut alone = vec![
        "run",
        "deposition",
        "--out",
        "alone",
        "--quiet",
        "--seed",
        "2",
    ];
    alone.extend(["--set", "sleep.criterion=isostatic_support"]);
    alone.extend(SMALL);
    assert_eq!(grainfall(place.path(), &alone).0, 0);
    let hash = |run: &Path| -> Value {
        let text = fs::read_to_string(run.join("summary.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()["trajectory_hash"].clone()
    };
    let folders = fs::read_dir(&both)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let is_wanted = |folder: &std::path::PathBuf| {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        name.starts_with("criterion=isostatic_support") && name.ends_with("seed=2")
    };
    let within = folders.into_iter().find(is_wanted).unwrap();
    assert_eq!(hash(&within), hash(&place.path().join("alone")));
    let before = fs::read_to_string(both.join("compare.csv")).unwrap();
    arguments.extend(["--threads", "1"]);
    assert_eq!(grainfall(place.path(), &arguments).0, 0);
    assert_eq!(
        fs::read_to_string(both.join("compare.csv")).unwrap(),
        before
    );
}

/// In a pit, 0.01 d above the bottom, a grain has not the energy to move by 0.05 d:
/// every sleep is right. On a perch, a little beside the top of another
/// grain, the paper's rule puts a grain to sleep that would have rolled off, as the
/// paper says of it.
#[test]
fn false_sleeps_are_found() {
    let place = tempfile::tempdir().unwrap();
    let counted = |name: &str, grains: &str| {
        let scenario = format!(
            "dimension = 2\nstop.time = 12\nparameters.elastic_speed = 1e-3\n\
             boundaries = [{{ periodic = {{ length = 12 }} }}, \"open\"]\n{grains}"
        );
        fs::write(place.path().join(format!("{name}.toml")), scenario).unwrap();
        let file = format!("{name}.toml");
        let mut arguments = vec!["compare", &file, "--out", name, "--quiet"];
        arguments.extend(["--policies", "slow_descent"]);
        let (code, _, error) = grainfall(place.path(), &arguments);
        assert_eq!(code, 0, "{error}");
        let rows = rows(&place.path().join(name));
        (
            of(&rows[0], "sleeps_questioned"),
            of(&rows[0], "false_sleeps"),
        )
    };
    let pit = "grains = [{ position = [5.4, 0], mode = \"fixed\" }, \
               { position = [6.6, 0], mode = \"fixed\" }, { position = [6.001, 0.81] }]";
    let (questioned, wrong) = counted("pit", pit);
    assert!(questioned > 0.0);
    assert_eq!(wrong, 0.0);
    let perch = "grains = [{ position = [3, 0], mode = \"fixed\" }, { position = [3.01, 1.2] }]";
    let (questioned, wrong) = counted("perch", perch);
    assert!(questioned > 0.0);
    assert_eq!(wrong, questioned);
}

/// A run in which nothing happens ends, and so does its census.
#[test]
fn nothing_that_happens_is_compared() {
    let place = tempfile::tempdir().unwrap();
    let scenario = "dimension = 2\ngravity = \"none\"\nstop.events = 100\n\
        boundaries = [{ periodic = { length = 10 } }, { periodic = { length = 10 } }]\n\
        grains = [{ position = [1, 1], velocity = [0.1, 0] }, \
        { position = [1, 5], velocity = [0.1, 0] }]";
    fs::write(place.path().join("still.toml"), scenario).unwrap();
    let arguments = [
        "compare",
        "still.toml",
        "--policies",
        "slow_descent",
        "--out",
        "still",
    ];
    assert_eq!(grainfall(place.path(), &arguments).0, 0);
    let rows = rows(&place.path().join("still"));
    assert_eq!(
        (of(&rows[0], "events"), of(&rows[0], "sleeps_questioned")),
        (0.0, 0.0)
    );
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let refused = |policies: &str| {
        let (code, _, error) =
            grainfall(place.path(), &["compare", "arch", "--policies", policies]);
        assert_eq!(code, 2, "{policies}");
        error
    };
    assert!(refused("slow_descent,isostatic_suport").contains("did you mean `isostatic_support`?"));
    assert!(refused("never,never").contains("never"));
    let (code, _, error) = grainfall(
        place.path(),
        &["compare", "deposition", "--policies", "slow_descent,never"],
    );
    assert_eq!(code, 2);
    assert!(error.contains("if nobody sleeps"), "{error}");
}
