//! Sweeps: they do not depend on threads, and go on after any end.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Instant;

use crate::{
    TIMINGS, assert_same, command, content, expect, forget_count, kill, place, start, wait_for,
};
use grainfall::setup::seeded;
use rand::RngExt;
use serde_json::Value;

/// Two values each of two things; eight runs of a quarter of a second.
const SWEEP: [&str; 9] = [
    "sweep",
    "deposition",
    "--set=grains.1.rain.count=40,60",
    "--set=parameters.elastic_speed=1e-3",
    "--set=parameters.sleep_speed=0.05,1e-1",
    "--set=boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
    "--set=output.frames_every=2",
    "--seeds=2",
    "--seed=3",
];

/// Its folders, in their order.
const FOLDERS: [&str; 8] = [
    "count=40_sleep_speed=0.05_seed=3",
    "count=40_sleep_speed=0.05_seed=4",
    "count=40_sleep_speed=0.1_seed=3",
    "count=40_sleep_speed=0.1_seed=4",
    "count=60_sleep_speed=0.05_seed=3",
    "count=60_sleep_speed=0.05_seed=4",
    "count=60_sleep_speed=0.1_seed=3",
    "count=60_sleep_speed=0.1_seed=4",
];

fn sweep(more: &[&'static str]) -> Vec<&'static str> {
    SWEEP.iter().chain(more).copied().collect()
}

/// The cells of `runs.csv` by column, row by row; a quoted cell is one.
fn runs(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(folder.join("runs.csv")).unwrap();
    let cells = |line: &str| {
        let mut cells = vec![String::new()];
        let mut quoted = false;
        for letter in line.chars() {
            match letter {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(String::new()),
                _ => cells.last_mut().unwrap().push(letter),
            }
        }
        cells
    };
    let mut lines = text.lines();
    let head = cells(lines.next().unwrap());
    lines
        .map(|line| {
            let row = cells(line);
            assert_eq!(row.len(), head.len(), "{line}");
            head.iter().cloned().zip(row).collect()
        })
        .collect()
}

/// One column of `runs.csv`.
fn column(folder: &Path, name: &str) -> Vec<String> {
    let cell = |mut row: BTreeMap<String, String>| row.remove(name).unwrap();
    runs(folder).into_iter().map(cell).collect()
}

/// Two sweeps have left the same, but for timings.
#[track_caller]
fn assert_same_sweep(one: &Path, other: &Path) {
    let names = |folder: &Path| -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    assert_eq!(names(one), names(other));
    for name in names(one) {
        if one.join(&name).is_dir() {
            assert_same(&one.join(&name), &other.join(&name));
        }
    }
    let untimed = |folder: &Path| {
        let mut rows = runs(folder);
        for row in &mut rows {
            for key in TIMINGS {
                assert!(row.remove(key).is_some());
            }
        }
        rows
    };
    assert_eq!(untimed(one), untimed(other));
    let text = |folder: &Path| fs::read_to_string(folder.join("sweep.toml")).unwrap();
    assert_eq!(text(one), text(other));
}

#[test]
fn a_sweep_does_not_depend_on_threads() {
    let place = place();
    let one = place.path().join("one");
    let said = expect(place.path(), 0, &sweep(&["--out=one", "--threads=1"]));
    assert!(said.contains("8 of 8 runs finished"), "{said}");
    expect(
        place.path(),
        0,
        &sweep(&["--out=three", "--threads=3", "-q"]),
    );
    assert_same_sweep(&one, &place.path().join("three"));

    // The order is that of the combinations.
    assert_eq!(column(&one, "folder"), FOLDERS);
    let counts = column(&one, "grains[1].rain.count");
    assert_eq!(counts, ["40", "40", "40", "40", "60", "60", "60", "60"]);
    let speeds = column(&one, "parameters.sleep_speed");
    assert_eq!(speeds[..4], ["0.05", "0.05", "0.1", "0.1"]);
    for (row, folder) in runs(&one).iter().zip(FOLDERS) {
        let text = fs::read_to_string(one.join(folder).join("summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(row["trajectory_hash"], summary["trajectory_hash"]);
        assert_eq!(row["events"], summary["events"]["total"].to_string());
        assert_eq!(row["seed"], summary["seed"].to_string());
        assert_eq!(row["ended"], "all_frozen");
        let fraction: f64 = row["packing_fraction"].parse().unwrap();
        assert_eq!(
            summary["packing_fraction"]["value"].as_f64(),
            Some(fraction)
        );
    }

    // Each is what `run` makes of it.
    let mut single = sweep(&["--out=single", "--seed=4"]);
    single.retain(|word| !word.contains("seeds") && *word != "--seed=3");
    single[0] = "run";
    single[2] = "--set=grains.1.rain.count=60";
    single[4] = "--set=parameters.sleep_speed=1e-1";
    expect(place.path(), 0, &single);
    assert_same(&one.join(FOLDERS[7]), &place.path().join("single"));
}

#[test]
fn killed_sweeps_go_on() {
    let place = place();
    let began = Instant::now();
    expect(place.path(), 0, &sweep(&["--out=whole"]));
    let took = began.elapsed();
    let mut rng = seeded(7);
    let mut kills = 0;
    loop {
        let arguments = sweep(&["--out=killed", "--checkpoint-every=0.7", "--threads=2"]);
        let mut running = command(place.path(), &arguments).spawn().unwrap();
        if kills < 6 {
            let part: f64 = rng.random();
            std::thread::sleep(took.mul_f64(0.6 * part * part));
            running.kill().unwrap();
        }
        let status = running.wait().unwrap();
        if status.code() == Some(0) {
            break;
        }
        assert_eq!(status.code(), None, "it failed");
        kills += 1;
    }
    assert!(kills > 0);
    let killed = place.path().join("killed");
    assert_same_sweep(&place.path().join("whole"), &killed);

    // Once more, and nothing is touched but for what is missing.
    let written = |folder: &str| {
        let file = killed.join(folder).join("summary.json");
        fs::metadata(file).unwrap().modified().unwrap()
    };
    let before: Vec<_> = FOLDERS.iter().map(|folder| written(folder)).collect();
    fs::remove_dir_all(killed.join(FOLDERS[2])).unwrap();
    expect(place.path(), 0, &sweep(&["--out=killed"]));
    let after: Vec<_> = FOLDERS.iter().map(|folder| written(folder)).collect();
    let same: Vec<bool> = before.iter().zip(&after).map(|(a, b)| a == b).collect();
    assert_eq!(
        same,
        [true, true, false, true, true, true, true, true],
        "{FOLDERS:?}"
    );
    assert_same_sweep(&place.path().join("whole"), &killed);

    // A run that is not the sweep's any more is not taken for one.
    let scenario = killed.join(FOLDERS[1]).join("scenario.toml");
    let text = fs::read_to_string(&scenario).unwrap();
    fs::write(&scenario, text + "# mine\n").unwrap();
    expect(place.path(), 3, &sweep(&["--out=killed", "-q"]));
    let rows = runs(&killed);
    assert_eq!(rows[1]["ended"], "error");
    assert!(rows[1]["error"].contains("has been changed"), "{rows:?}");
    assert!(rows[0]["ended"] == "all_frozen" && rows[2]["ended"] == "all_frozen");
}

#[test]
fn signals_end_all_runs_of_a_sweep() {
    let place = place();
    let folder = place.path().join("stopped");
    let arguments = |more: &[&'static str]| {
        let mut arguments = start(2, &["--set=stop.time=39.5,40", "--seeds=3"]);
        arguments.retain(|word| *word != "--set=stop.time=40");
        arguments[0] = "sweep";
        arguments.extend(more);
        arguments
    };
    expect(place.path(), 0, &arguments(&["--out=whole", "-q"]));
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let _ = fs::remove_dir_all(&folder);
        let began = arguments(&["--out=stopped", "--threads=2"]);
        let mut running = command(place.path(), &began).spawn().unwrap();
        let first = folder.join("time=39.5_seed=2/frames.xyz");
        wait_for(&mut running, || {
            fs::metadata(&first).is_ok_and(|about| about.len() > 0)
        });
        // It is being written to, and waits for this.
        kill(&running, "STOP");
        let said = expect(place.path(), 2, &began);
        assert!(said.contains("another grainfall process"), "{said}");
        let said = expect(place.path(), 2, &[&began[..], &["--force"]].concat());
        assert!(said.contains("another grainfall process"), "{said}");
        kill(&running, signal);
        kill(&running, "CONT");
        assert_eq!(running.wait().unwrap().code(), Some(code));
        let ended = column(&folder, "ended");
        let interrupted = ended.iter().filter(|ended| *ended == "interrupted");
        assert!(interrupted.count() > 0, "{ended:?}");
        assert_eq!(ended[5], "unfinished");
        for (ended, name) in ended.iter().zip(column(&folder, "folder")) {
            let run = folder.join(name);
            assert_eq!(ended == "unfinished", !run.exists());
            assert_eq!(ended == "interrupted", run.join("checkpoint").exists());
        }
    }
    let said = expect(place.path(), 2, &["resume", "stopped"]);
    assert!(said.contains("the same `grainfall sweep`"), "{said}");
    expect(place.path(), 0, &arguments(&["--out=stopped", "-q"]));
    assert_same_sweep(&place.path().join("whole"), &folder);
}

#[test]
fn a_run_that_stops_early_does_not_end_a_sweep() {
    let place = place();
    let arguments = [
        "sweep",
        "bounce-full",
        "--set=parameters.elastic_speed=0,1e-3",
        "--until=5",
        "--threads=1",
    ];
    let folder = place.path().join("runs/bounce-full-sweep");
    let summary = folder.join("elastic_speed=0_seed=1/summary.json");
    let written = || fs::metadata(&summary).unwrap().modified().unwrap();
    let mut first = None;
    for _ in 0..2 {
        let said = expect(place.path(), 3, &arguments);
        assert!(
            said.contains("1 of 2 runs finished, 1 stopped early")
                && said.contains("elastic_speed=0_seed=1: collapse"),
            "{said}"
        );
        assert_eq!(column(&folder, "ended"), ["collapse", "time"]);
        // It would collapse again.
        assert_eq!(*first.get_or_insert_with(written), written());
    }
    // Neither does one that can't be set up.
    let arguments = [
        "sweep",
        "gas",
        "--set=grains.0.gas.packing_fraction=0.73,0.1",
        "--set=grains.0.gas.count=100",
        "--until=1",
        "--out=gas",
    ];
    expect(place.path(), 3, &arguments);
    let folder = place.path().join("gas");
    assert_eq!(column(&folder, "ended"), ["error", "time"]);
    let errors = column(&folder, "error");
    assert!(
        errors[0].contains("packing_fraction is 0.73") && errors[1].is_empty(),
        "{errors:?}"
    );
    assert!(!folder.join("packing_fraction=0.73_seed=1").exists());
}

#[test]
fn runs_that_another_version_has_finished_are_finished() {
    let place = place();
    let arguments = ["sweep", "bounce", "--until=5", "--seeds=2", "--out=s"];
    expect(place.path(), 0, &arguments);
    let folder = place.path().join("s");
    let events = column(&folder, "events");
    // Who did not count these asked nobody; what the other has done nobody knows.
    forget_count(&folder.join("seed=1"), "support");
    forget_count(&folder.join("seed=2"), "guard");
    let before = content(&folder.join("seed=2"));
    let said = expect(place.path(), 0, &arguments);
    assert!(
        said.contains("2 of 2 runs finished\n") && said.contains("missing field `guard`"),
        "{said}"
    );
    assert_eq!(column(&folder, "ended"), ["time", "time"]);
    assert_eq!(column(&folder, "events"), [events[0].as_str(), ""]);
    let [none, missing] = column(&folder, "error").try_into().unwrap();
    assert!(none.is_empty() && missing.contains("guard"), "{missing}");
    assert_eq!(content(&folder.join("seed=2")), before);
}

#[test]
fn another_sweep_into_the_same_folder_is_refused() {
    let place = place();
    let bounce = |more: &[&'static str]| {
        let mut arguments = vec!["sweep", "mine.toml", "-q", "--out=here"];
        arguments.extend(more);
        arguments
    };
    let preset = expect(place.path(), 0, &["preset", "bounce"]);
    let file = place.path().join("mine.toml");
    fs::write(&file, &preset).unwrap();
    let first = bounce(&["--set=parameters.sleep_speed=0.01,0.02", "--seeds=2"]);
    expect(place.path(), 0, &first);
    let here = place.path().join("here");
    let both = [
        "sweep",
        "mine.toml",
        "--set=parameters.sleep_speed,parameters.wake_speed=0.01,0.02",
        "--out=both",
    ];
    let said = expect(place.path(), 0, &both);
    assert!(said.contains("2 of 2 runs finished"), "{said}");
    for path in ["parameters.sleep_speed", "parameters.wake_speed"] {
        assert_eq!(column(&place.path().join("both"), path), ["0.01", "0.02"]);
    }
    let run = place
        .path()
        .join("both/sleep_speed=0.02_seed=1/scenario.toml");
    let text = fs::read_to_string(run).unwrap();
    assert!(
        text.contains("sleep_speed = 0.02\nwake_speed = 0.02\n"),
        "{text}"
    );
    let before = content(&here.join("sleep_speed=0.01_seed=2"));
    for (other, wanted) in [
        (
            bounce(&["--set=parameters.sleep_speed=0.01,0.03", "--seeds=2"]),
            "set[0].values: [0.01, 0.02] there, [0.01, 0.03] here",
        ),
        (
            bounce(&["--set=parameters.sleep_speed=0.01,0.02"]),
            "seeds: 2 there, 1 here",
        ),
        (
            [&first[..], &["--seed=2"]].concat(),
            "first_seed: 1 there, 2 here",
        ),
        (
            [&first[..], &["--until=3"]].concat(),
            "set[1]: nothing there, { path = \"stop.time\", values = [3.0] } here",
        ),
    ] {
        let said = expect(place.path(), 2, &other);
        assert!(said.contains("here holds another sweep"), "{said}");
        assert!(said.contains(wanted), "{said}\nlacks {wanted}");
    }
    // So is the same one of a scenario that has been changed, but for comments.
    fs::write(&file, format!("# mine\n{preset}")).unwrap();
    expect(place.path(), 0, &first);
    let longer = format!("{preset}\n").replacen("title = \"", "title = \"My ", 1);
    assert!(longer.contains("My "), "{preset}");
    fs::write(&file, longer).unwrap();
    let said = expect(place.path(), 2, &first);
    assert!(said.contains("scenario.title: \""), "{said}");
    assert!(content(&here.join("sleep_speed=0.01_seed=2")) == before);

    // It may be overwritten; what is not of a sweep stays.
    fs::write(here.join("notes.txt"), "mine").unwrap();
    let kept = here.join("sleep_speed=0.02_seed=2/notes.txt");
    fs::write(&kept, "mine, too").unwrap();
    expect(place.path(), 0, &bounce(&["--force", "--seeds=1"]));
    assert!(here.join("seed=1/summary.json").exists() && here.join("notes.txt").exists());
    assert!(!here.join("sleep_speed=0.01_seed=1").exists());
    assert!(kept.exists() && !kept.with_file_name("summary.json").exists());
    assert_eq!(column(&here, "folder"), ["seed=1"]);
    // What is none is not overwritten.
    fs::create_dir(place.path().join("other")).unwrap();
    fs::write(place.path().join("other/notes.txt"), "mine").unwrap();
    let said = expect(place.path(), 2, &["sweep", "bounce", "--out=other"]);
    assert!(said.contains("already holds notes.txt"), "{said}");
    fs::write(here.join("sweep.toml"), "seeds = ").unwrap();
    let said = expect(place.path(), 2, &bounce(&["--seeds=1"]));
    assert!(said.contains("does not say what the sweep is of"), "{said}");
}
