//! Whole runs from the command line.
#![cfg(feature = "program")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn place() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn grainfall(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs and expects an exit code; says what was printed.
fn expect(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = grainfall(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    if code == 0 {
        assert_eq!(said, "", "a pipe is told nothing but results");
    }
    String::from_utf8(output.stdout).unwrap()
}

fn summary(run: &Path) -> Value {
    let text = fs::read_to_string(run.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The rows of a table without quotes.
fn rows(file: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(file).unwrap();
    text.lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// The paper's deposition, made small.
const SMALL: [&str; 10] = [
    "run",
    "deposition",
    "--set",
    "grains.1.rain.count=60",
    "--set",
    "parameters.elastic_speed=1e-3",
    "--set",
    "boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
    "--set",
    "output.frames_every=2",
];

fn small(folder: &Path, more: &[&str]) -> Value {
    let arguments: Vec<&str> = SMALL.iter().chain(more).copied().collect();
    expect(folder, 0, &arguments);
    let out = more.iter().position(|word| *word == "--out");
    let run = out.map_or("runs/deposition-1", |at| more[at + 1]);
    summary(&folder.join(run))
}

#[test]
fn a_deposition_leaves_a_folder() {
    let place = place();
    let told = small(place.path(), &[]);
    let run = place.path().join("runs/deposition-1");
    let names: BTreeSet<String> = fs::read_dir(&run)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let wanted = ["frames.xyz", "scenario.toml", "series.csv", "summary.json"];
    assert_eq!(names, wanted.map(str::to_owned).into());

    for (key, inside) in [
        ("time", &[][..]),
        ("stop_reason", &[]),
        ("seed", &[]),
        (
            "events",
            &[
                "total",
                "pair",
                "frozen",
                "wake",
                "sleep",
                "check",
                "support",
                "check_wake",
                "wall",
                "transfer",
                "elastic",
                "guard",
            ],
        ),
        (
            "particles",
            &["total", "normal", "frozen", "falling", "fixed"],
        ),
        ("kinetic_energy", &[]),
        ("potential_energy", &[]),
        (
            "energy_ledger",
            &[
                "at_start",
                "at_end",
                "pair",
                "frozen",
                "wake",
                "wall",
                "sleep",
                "given_back",
                "fall",
                "guard",
                "moving",
                "growth",
                "crossing",
                "field",
                "inserted",
                "sum",
                "relative_error",
                "elastic_spared",
            ],
        ),
        ("packing_fraction", &["value", "from", "to"]),
        ("mean_normal", &[]),
        ("max_overlap", &[]),
        ("cpu_seconds", &[]),
        ("events_per_second", &[]),
        ("trajectory_hash", &[]),
    ] {
        let value = told
            .get(key)
            .unwrap_or_else(|| panic!("no {key} in {told}"));
        for name in inside {
            assert!(value[name].is_number(), "{key}.{name} in {told}");
        }
    }
    assert_eq!(told["stop_reason"], "all_frozen");
    assert_eq!(told["trajectory_hash"].as_str().unwrap().len(), 16);
    assert_eq!(told["particles"]["frozen"], 60);
    assert_eq!(told["particles"]["normal"], 0);
    let grains = told["particles"]["total"].as_u64().unwrap();
    let events = &told["events"];
    let total: u64 = ["pair", "frozen", "wake", "sleep", "check_wake", "wall"]
        .iter()
        .map(|kind| events[kind].as_u64().unwrap())
        .sum();
    assert_eq!(events["total"].as_u64(), Some(total));
    // Every grain fell asleep, and woke as often as it slept again.
    let sleeps = events["sleep"].as_u64().unwrap();
    assert_eq!(sleeps, 60 + events["wake"].as_u64().unwrap());

    let series = rows(&run.join("series.csv"));
    let (first, last) = (&series[1], series.last().unwrap());
    let column = |name: &str| series[0].iter().position(|found| found == name).unwrap();
    assert_eq!(
        (
            first[column("falling")].as_str(),
            first[column("time")].as_str()
        ),
        ("60", "0.0")
    );
    assert_eq!(last[column("events")], total.to_string());
    assert_eq!(
        last[column("time")].parse::<f64>().ok(),
        told["time"].as_f64()
    );
    for row in &series[1..] {
        let modes = ["normal", "falling", "frozen", "fixed"];
        let count: u64 = modes
            .iter()
            .map(|mode| row[column(mode)].parse::<u64>().unwrap())
            .sum();
        assert_eq!(count, grains);
    }

    let frames = fs::read_to_string(run.join("frames.xyz")).unwrap();
    let headers: Vec<&str> = frames
        .lines()
        .filter(|line| line.contains("Lattice"))
        .collect();
    let end = told["time"].as_f64().unwrap();
    assert_eq!(headers.len(), (end / 2.0).floor() as usize + 2);
    assert!(headers[1].contains("pbc=\"T T F\"") && headers[1].contains("Time=2 "));
    assert!(headers[1].contains("Properties=id:I:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:type:S:1"));
}

/// What is written, how often, and in how many slices, changes nothing; the
/// resolved scenario in the run folder is the run.
#[test]
fn the_same_scenario_is_the_same_run() {
    let place = place();
    let first = small(place.path(), &[]);
    let watched = small(
        place.path(),
        &[
            "--out",
            "watched",
            "--set",
            "output.series_every=0.013",
            "--set",
            "output.events=true",
        ],
    );
    assert_eq!(first["trajectory_hash"], watched["trajectory_hash"]);
    assert_eq!(first["events"], watched["events"]);
    assert_eq!(first["mean_normal"], watched["mean_normal"]);
    // What the guards do is told, but is no physical event.
    let mut events = rows(&place.path().join("watched/events.csv"));
    events.retain(|row| row[1] != "guard");
    assert_eq!(
        Some(events.len() as u64 - 1),
        first["events"]["total"].as_u64()
    );

    expect(
        place.path(),
        0,
        &["run", "runs/deposition-1/scenario.toml", "--out", "again"],
    );
    let again = summary(&place.path().join("again"));
    assert_eq!(first["trajectory_hash"], again["trajectory_hash"]);
    for file in ["series.csv", "frames.xyz", "scenario.toml"] {
        let one = fs::read(place.path().join("runs/deposition-1").join(file)).unwrap();
        let other = fs::read(place.path().join("again").join(file)).unwrap();
        assert_eq!(one, other, "{file}");
    }

    let other = small(place.path(), &["--seed", "2", "--out", "other"]);
    assert_ne!(first["trajectory_hash"], other["trajectory_hash"]);
    assert_eq!(other["seed"], 2);
    let kept = fs::read_to_string(place.path().join("other/scenario.toml")).unwrap();
    assert!(
        kept.contains("seed = 2") && kept.contains("count = 60"),
        "{kept}"
    );
}

#[test]
fn an_earlier_run_is_kept_unless_forced() {
    let place = place();
    let run = place.path().join("runs/bounce-1");
    expect(place.path(), 0, &["run", "bounce", "--until", "1.5"]);
    let first = summary(&run);
    let output = grainfall(place.path(), &["run", "bounce"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("--force") && said.contains("runs/bounce-1"),
        "{said}"
    );
    assert_eq!(summary(&run), first);

    fs::write(run.join("notes.txt"), "mine").unwrap();
    for stale in ["input-0.xyz", "picture.svg"] {
        fs::write(run.join(stale), "of the run before").unwrap();
    }
    expect(
        place.path(),
        0,
        &["run", "bounce", "--force", "--set", "output.events=false"],
    );
    assert_eq!(summary(&run)["time"], 4.0);
    for stale in ["events.csv", "input-0.xyz", "picture.svg"] {
        assert!(!run.join(stale).exists(), "{stale} is of the run before");
    }
    assert_eq!(fs::read_to_string(run.join("notes.txt")).unwrap(), "mine");

    fs::write(place.path().join("file"), "").unwrap();
    expect(
        place.path(),
        2,
        &["run", "bounce", "--out", "file", "--force"],
    );
    expect(place.path(), 2, &["run", "bounce", "--out", "file/inside"]);
}

/// Fig. 1: t_n = 1, 1.8, 2.12, …; asleep half-way between the bounces at
/// 2.327872 and 2.3311488.
#[test]
fn the_ball_bounces_and_sleeps_on_time() {
    let place = place();
    let said = expect(place.path(), 0, &["run", "bounce"]);
    assert!(
        said.contains("7 wall") && said.contains("1 sleep"),
        "{said}"
    );
    let events = rows(&place.path().join("runs/bounce-1/events.csv"));
    let head = "time,kind,particle,other,wall,impact_speed,impulse_x,impulse_y";
    assert_eq!(events[0].join(","), head);
    let (mut time, mut speed) = (1.0, 1.0);
    for bounce in &events[1..8] {
        assert_eq!(bounce[1..5], ["wall", "0", "", "0"]);
        assert!(
            (bounce[0].parse::<f64>().unwrap() - time).abs() < 1.0e-12,
            "{bounce:?}"
        );
        assert!(
            (bounce[5].parse::<f64>().unwrap() - speed).abs() < 1.0e-12,
            "{bounce:?}"
        );
        assert!((bounce[7].parse::<f64>().unwrap() - 1.4 * speed).abs() < 1.0e-12);
        speed *= 0.4;
        time += 2.0 * speed;
    }
    assert_eq!(events[8][1], "sleep");
    assert!((events[8][0].parse::<f64>().unwrap() - 2.3295104).abs() < 1.0e-10);
    let frames = fs::read_to_string(place.path().join("runs/bounce-1/frames.xyz")).unwrap();
    let last: Vec<&str> = frames.lines().last().unwrap().split(' ').collect();
    let height = last[2].parse::<f64>().unwrap() - 0.5;
    assert!((height - 1.342177e-6).abs() < 1.0e-12, "{height}");
    assert_eq!(*last.last().unwrap(), "frozen");
}

#[test]
fn the_full_dynamics_collapses() {
    let place = place();
    let said = expect(place.path(), 3, &["run", "bounce-full"]);
    assert!(said.contains("collapse"), "{said}");
    let told = summary(&place.path().join("runs/bounce-full-1"));
    assert_eq!(told["stop_reason"], "collapse");
    assert_eq!(told["collapse"]["particles"], serde_json::json!([0]));
    for time in [&told["time"], &told["collapse"]["time"]] {
        assert!(
            (time.as_f64().unwrap() - 7.0 / 3.0).abs() < 1.0e-9,
            "{told}"
        );
    }
    // The state is saved.
    let frames = fs::read_to_string(place.path().join("runs/bounce-full-1/frames.xyz")).unwrap();
    assert_eq!(frames.matches("Lattice").count(), 2);
}

#[test]
fn the_regularised_dynamics_bounces_for_ever() {
    let place = place();
    expect(place.path(), 0, &["run", "bounce-regularised"]);
    let told = summary(&place.path().join("runs/bounce-regularised-1"));
    assert_eq!(told["stop_reason"], "time");
    assert_eq!(told["particles"]["normal"], 1);
    // Elastic from the fifth bounce on, which comes with 0.4⁴ = 0.0256 < V_c.
    let events = &told["events"];
    assert_eq!(
        events["wall"].as_u64().unwrap() - events["elastic"].as_u64().unwrap(),
        4
    );
    let energy = told["kinetic_energy"].as_f64().unwrap()
        + (told["potential_energy"].as_f64().unwrap() - 0.5);
    assert!((energy - 0.5 * 0.0256 * 0.0256).abs() < 1.0e-12, "{energy}");
}

#[test]
fn an_arch_holds() {
    let place = place();
    expect(place.path(), 0, &["run", "arch"]);
    let told = summary(&place.path().join("runs/arch-1"));
    assert_eq!(told["stop_reason"], "all_frozen");
    assert_eq!(told["events"]["sleep"], 2);
    assert_eq!(told["packing_fraction"], Value::Null);
    assert_eq!(told["mean_normal"], Value::Null);
}

#[test]
fn grains_come_one_by_one() {
    let place = place();
    expect(
        place.path(),
        0,
        &[
            "run",
            "one-by-one",
            "--set",
            "grains.1.one_by_one.count=8",
            "--set",
            "output.events=true",
        ],
    );
    let run = place.path().join("runs/one-by-one-1");
    let told = summary(&run);
    assert_eq!(told["stop_reason"], "all_frozen");
    assert_eq!(told["particles"]["frozen"], 8);
    assert_eq!(told["events"]["sleep"], 8);
    assert_eq!(told["events"]["pair"], 0);
    // Each hits for the first time only after the one before it sleeps.
    let mut asleep: Vec<String> = Vec::new();
    let mut seen: Vec<String> = Vec::new();
    for event in &rows(&run.join("events.csv"))[1..] {
        if !seen.contains(&event[2]) {
            assert_eq!(asleep.len(), seen.len(), "{event:?}");
            seen.push(event[2].clone());
        }
        if event[1] == "sleep" {
            asleep.push(event[2].clone());
        }
    }
    assert_eq!(seen.len(), 8);
}

#[test]
fn a_gas_keeps_its_energy() {
    let place = place();
    for preset in ["gas", "gas2d"] {
        let small = [
            "--set",
            "grains.0.gas.count=100",
            "--set",
            "stop.events=3000",
        ];
        let arguments: Vec<&str> = ["run", preset].into_iter().chain(small).collect();
        expect(place.path(), 0, &arguments);
        let told = summary(&place.path().join(format!("runs/{preset}-1")));
        assert_eq!(told["stop_reason"], "events");
        assert_eq!(told["events"]["total"], 3000);
        let axes = if preset == "gas" { 3.0 } else { 2.0 };
        let energy = told["kinetic_energy"].as_f64().unwrap() / (50.0 * axes);
        assert!((energy - 1.0).abs() < 1.0e-12, "{energy}");
        assert_eq!(told["packing_fraction"], Value::Null);
    }
}

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

/// A run that has gone nowhere yet stops in good order.
#[cfg(unix)]
#[test]
fn signals_end_a_run_in_good_order() {
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let place = place();
        let mut running = Command::new(env!("CARGO_BIN_EXE_grainfall"))
            .current_dir(place.path())
            .args([
                "run",
                "gas",
                "--set",
                "grains.0.gas.count=50",
                "--until",
                "1e7",
            ])
            .args(["--set", "output.series_every=1"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Until it is under way: the folder is made before signals are heard,
        // the first rows reach the disk after.
        let series = place.path().join("runs/gas-1/series.csv");
        let patience = Instant::now();
        while fs::metadata(&series).map_or(0, |about| about.len()) == 0 {
            assert_eq!(running.try_wait().unwrap(), None, "it ended by itself");
            if patience.elapsed() > Duration::from_secs(300) {
                running.kill().unwrap();
                panic!("it never started");
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let pid = running.id().to_string();
        let sent = Command::new("kill")
            .args(["-s", signal, &pid])
            .status()
            .unwrap();
        assert!(sent.success());
        assert_eq!(running.wait().unwrap().code(), Some(code));
        let told = summary(&place.path().join("runs/gas-1"));
        assert_eq!(told["stop_reason"], "interrupted");
        let rows = rows(&series);
        let last = rows.last().unwrap();
        assert_eq!(last.len(), rows[0].len(), "the last row is whole");
        assert_eq!(last[0].parse::<f64>().ok(), told["time"].as_f64());
    }
}

/// Whoever reads the output may stop listening.
#[cfg(unix)]
#[test]
fn closed_pipes_are_no_failure() {
    use std::process::Stdio;

    let place = place();
    fs::write(place.path().join("bad.toml"), "dimension = 7\n").unwrap();
    // Standard output and errors, both closed before anything is written.
    for (arguments, code) in [
        (&["presets"][..], 0),
        (&["preset", "arch"], 0),
        (&["schema"], 0),
        (&["--help"], 0),
        (&["check", "bounce"], 0),
        (&["check", "bad.toml"], 2),
        (&["check", "nowhere.toml"], 1),
        (&["check"], 2),
        (&["run", "bounce", "--until", "1"], 0),
        (&["draw", "runs/bounce-1"], 0),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = Command::new(env!("CARGO_BIN_EXE_grainfall"))
            .current_dir(place.path())
            .args(arguments)
            .stdout(Stdio::from(writer.try_clone().unwrap()))
            .stderr(Stdio::from(writer))
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}: {status}");
    }
}

/// A full disk ends a run with a message and exit code 1. A limit on the size
/// of files stands for it: writing fails in the same way.
#[cfg(unix)]
#[test]
fn a_full_disk_is_told() {
    let place = place();
    let limited = |arguments: &str| {
        let program = env!("CARGO_BIN_EXE_grainfall");
        let script = format!("trap '' XFSZ; ulimit -f 8; exec '{program}' {arguments}");
        Command::new("sh")
            .current_dir(place.path())
            .args(["-c", &script])
            .output()
            .unwrap()
    };
    let output = limited("run bounce --set output.series_every=1e-5");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("series.csv"), "{said}");
    assert!(!said.contains("panicked"), "{said}");

    // A picture that does not fit leaves none, and no scraps.
    expect(
        place.path(),
        0,
        &["run", "gas2d", "--until", "0.01", "--out", "disks"],
    );
    let output = limited("draw disks");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("picture.svg"), "{said}");
    let left = fs::read_dir(place.path().join("disks")).unwrap();
    let names: Vec<_> = left.map(|entry| entry.unwrap().file_name()).collect();
    assert!(
        names
            .iter()
            .all(|name| !name.to_string_lossy().contains("picture")),
        "{names:?}"
    );

    // Where the system has a device that is always full, so is the output.
    if let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") {
        let output = Command::new(env!("CARGO_BIN_EXE_grainfall"))
            .args(["preset", "arch"])
            .stdout(full)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("standard output"), "{said}");
    }
}

/// Where nothing can be written, nothing is run.
#[test]
fn a_folder_that_cannot_be_made_is_told() {
    let place = place();
    fs::write(place.path().join("file"), "").unwrap();
    let output = grainfall(place.path(), &["run", "bounce", "--out", "file/inside"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("file/inside is no folder"), "{said}");
    // Not even the administrator can make one there.
    #[cfg(target_os = "linux")]
    {
        let output = grainfall(place.path(), &["run", "bounce", "--out", "/proc/nowhere"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("/proc/nowhere"), "{said}");
    }
}

/// Nothing moves and nothing ever will: the run ends by itself and does not
/// fill the disk with rows.
#[test]
fn a_run_in_which_nothing_happens_ends() {
    let place = place();
    let scenario = "dimension = 2\nstop = { events = 5 }\ngravity = \"none\"\n\
                    grains = [{ position = [0, 0], velocity = [1, 0] }]\n";
    fs::write(place.path().join("lonely.toml"), scenario).unwrap();
    expect(place.path(), 0, &["run", "lonely.toml"]);
    let run = place.path().join("runs/lonely-1");
    assert!(rows(&run.join("series.csv")).len() < 2000);
    let told = summary(&run);
    assert_eq!(told["events"]["total"], 0);
}

#[test]
fn an_audited_run_is_the_same_run() {
    let place = place();
    let plain = small(place.path(), &["--out", "plain"]);
    let audited = small(place.path(), &["--out", "audited", "--audit", "500"]);
    assert_eq!(plain["trajectory_hash"], audited["trajectory_hash"]);
    for file in ["series.csv", "frames.xyz", "scenario.toml"] {
        let of = |run: &str| fs::read(place.path().join(run).join(file)).unwrap();
        assert!(of("plain") == of("audited"), "{file} differs");
    }
    let text = fs::read_to_string(place.path().join("audited/audit.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["missed"], Value::Array(Vec::new()));
    let events = audited["events"]["total"].as_u64().unwrap();
    assert_eq!(found["audits"], events / 500);
    assert!(found["predicted"].as_u64().unwrap() > 1000);
    assert!(found["deepest_overlap"].as_f64().unwrap() < 1.0e-12);
}

// ------------------------------------------------------------------- bench

/// Measures and says what the line of JSON holds.
fn measured(folder: &Path, arguments: &[&str]) -> Value {
    let arguments: Vec<&str> = ["bench"].iter().chain(arguments).copied().collect();
    let said = expect(folder, 0, &arguments);
    assert_eq!(said.lines().count(), 1, "{said}");
    serde_json::from_str(&said).unwrap()
}

#[test]
fn a_measured_gas_is_the_same_gas_each_time() {
    let place = place();
    let gas = |seed| {
        let arguments = [
            "gas",
            "--quick",
            "--json",
            "--hash",
            "--count",
            "256",
            "--collisions",
            "3000",
            "--seed",
            seed,
        ];
        measured(place.path(), &arguments)
    };
    let first = gas("1");
    assert_eq!(first["benchmark"], "gas");
    assert_eq!(first["count"], 256);
    assert_eq!(first["collisions"], 3000);
    assert_eq!(first["equilibrated"], 1.0);
    let number = |key: &str| first[key].as_f64().unwrap();
    assert!(number("nanoseconds_per_collision") > 0.0);
    assert!(number("energy_drift").abs() < 1e-13);
    // Three standard errors of about 2 √(…/3000) are well within this.
    let compressibility = number("compressibility");
    assert!((compressibility / number("carnahan_starling") - 1.0).abs() < 0.1);
    if cfg!(target_os = "linux") {
        assert!(number("peak_bytes_per_particle") >= number("bytes_per_particle"));
    }
    let hash = first["trajectory_hash"].as_str().unwrap();
    assert_eq!(hash.len(), 16);
    assert_eq!(gas("1")["trajectory_hash"], hash);
    assert_ne!(gas("2")["trajectory_hash"], hash);
}

#[test]
fn a_fluid_is_grown_and_measured_in_parts() {
    let place = place();
    let arguments = [
        "bench",
        "gas",
        "--count",
        "200",
        "--packing-fraction",
        "0.5",
        "--start",
        "fluid",
        "--equilibrate",
        "0.1",
        "--collisions",
        "500",
        "--repeats",
        "3",
    ];
    let said = expect(place.path(), 0, &arguments);
    for part in [
        "200 spheres at φ = 0.5, from a fluid",
        "1500 collisions in",
        "least of 3",
    ] {
        assert!(said.contains(part), "{said}\nlacks {part}");
    }
}

#[test]
fn a_measured_deposition_is_that_of_a_run() {
    let place = place();
    let deposition = [
        "deposition",
        "--count",
        "60",
        "--width",
        "4",
        "--elastic-speed",
        "1e-3",
        "--json",
        "--hash",
    ];
    let whole = measured(place.path(), &deposition);
    let run = small(place.path(), &["--quiet"]);
    assert_eq!(whole["trajectory_hash"], run["trajectory_hash"]);
    assert_eq!(whole["events"], run["events"]["total"]);
    assert_eq!(whole["by_kind"]["pair"], run["events"]["pair"]);
    assert_eq!(whole["packing_fraction"], run["packing_fraction"]["value"]);
    assert_eq!(whole["frozen"], 60);

    // Two windows that follow each other are as many events as one.
    let window = |more: &[&str]| {
        let arguments: Vec<&str> = deposition.iter().chain(more).copied().collect();
        measured(place.path(), &arguments)
    };
    let events = |outcome: &Value| outcome["events"].as_u64().unwrap();
    let both = window(&["--until", "9"]);
    let first = window(&["--until", "7"]);
    let second = window(&["--from", "7", "--until", "9"]);
    assert!(events(&first) > 0 && events(&second) > 0);
    assert_eq!(events(&first) + events(&second), events(&both));
    assert_eq!(second["mean_normal"], Value::Null);
    let third = window(&["--from", "7", "--events", "100"]);
    assert_eq!(events(&third), 100);
}

#[test]
fn growth_and_scaling_write_tables() {
    let place = place();
    let growth = [
        "bench",
        "growth",
        "--quick",
        "--count",
        "40",
        "--sleep-speeds",
        "0,0.1",
        "--until",
        "3",
        "--out",
        "growth.csv",
    ];
    let said = expect(place.path(), 0, &growth);
    let table = rows(&place.path().join("growth.csv"));
    assert_eq!(said.lines().count(), table.len());
    // The heads, and t = 0 … 3 twice.
    assert_eq!(table.len(), 9);
    assert_eq!(table[0][..3], ["sleep_speed", "time", "processor_seconds"]);
    for row in &table[1..] {
        let grains: u64 = row[4..].iter().map(|n| n.parse::<u64>().unwrap()).sum();
        assert_eq!(grains, 40);
    }
    let scaling = [
        "bench",
        "scaling",
        "--quick",
        "--only",
        "gas",
        "--largest",
        "256",
        "--out",
        "scaling.csv",
    ];
    expect(place.path(), 0, &scaling);
    let table = rows(&place.path().join("scaling.csv"));
    let column = |at: usize| table.iter().map(|row| row[at].clone()).collect::<Vec<_>>();
    assert_eq!(column(0), ["system", "gas", "gas"]);
    assert_eq!(column(1), ["grains", "108", "256"]);
    assert_eq!(column(6)[1], "1.000");
}

#[test]
fn figures_that_need_no_runs_are_made_at_once() {
    let place = tempfile::tempdir().unwrap();
    expect(place.path(), 0, &["reproduce", "fig1", "fig2", "--quick"]);
    let folder = place.path().join("reproduced-quick");
    for name in [
        "fig1.svg",
        "fig1.csv",
        "fig2.svg",
        "fig2.csv",
        "reproduce.md",
    ] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    let text = std::fs::read_to_string(folder.join("reproduce.json")).unwrap();
    let told: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows: Vec<&serde_json::Value> = told["parts"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|part| part["rows"].as_array().unwrap())
        .collect();
    // The printed formula lacks a factor; the exact series comes out.
    assert_eq!(rows[0]["verdict"], "differs");
    assert_eq!(rows[1]["verdict"], "agrees");
    assert!((rows[1]["found"].as_f64().unwrap() - 4.0 / 3.0).abs() < 1.0e-9);
    // Both orders of falling asleep.
    assert!(
        rows[3..5]
            .iter()
            .all(|row| row["found"].as_f64().unwrap() > 10.0)
    );
}
