//! Interrupted runs go on: in the end the folder is that of a run that was
//! never interrupted.
#![cfg(all(feature = "program", unix))]

#[path = "common/sweeps.rs"]
mod sweeps;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use grainfall::setup::seeded;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use tempfile::TempDir;

/// What takes how long is not the same twice.
const TIMINGS: [&str; 2] = ["cpu_seconds", "events_per_second"];

fn place() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainfall"));
    command
        .current_dir(folder)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

fn grainfall(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .output()
        .unwrap()
}

/// Runs and expects an exit code; says what was printed, errors last.
fn expect(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = grainfall(folder, arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    said
}

/// The content of all files of a run, without timings.
fn content(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(run).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let mut bytes = fs::read(run.join(&name)).unwrap();
        if name == "summary.json" {
            let mut summary: serde_json::Map<String, Value> =
                serde_json::from_slice(&bytes).unwrap();
            for key in TIMINGS {
                assert!(summary.remove(key).is_some_and(|value| value.is_number()));
            }
            bytes = serde_json::to_vec(&summary).unwrap();
        }
        files.insert(name, bytes);
    }
    files
}

#[track_caller]
fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (content(one), content(other));
    assert!(
        one.keys().eq(other.keys()),
        "{:?} {:?}",
        one.keys(),
        other.keys()
    );
    for (name, bytes) in &one {
        assert!(*bytes == other[name], "{name} is not the same");
    }
}

fn reason(run: &Path) -> Option<String> {
    let text = fs::read_to_string(run.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_str(&text).unwrap();
    Some(summary["stop_reason"].as_str().unwrap().to_owned())
}

/// Runs of all kinds, each about a second long.
const RUNS: [&[&str]; 4] = [
    &[
        "deposition",
        "--set=grains.1.rain.count=80",
        "--set=parameters.elastic_speed=1e-3",
        "--set=boundaries=[{periodic={length=5}},{periodic={length=5}},\"open\"]",
        "--set=output.frames_every=2",
        "--set=output.series_every=0.1",
        "--set=self_check.interval=0.1",
    ],
    &[
        "one-by-one",
        "--set=grains.1.one_by_one.count=40",
        "--set=boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
        "--set=output.events=true",
        "--set=output.frames_every=20",
    ],
    &[
        "gas-inelastic",
        "--set=grains.0.gas.count=300",
        "--set=stop.time=40",
        "--set=output.events=true",
    ],
    &[
        "gas2d",
        "--set=grains.0.gas.count=200",
        "--set=stop.time=60",
    ],
];

fn start(number: usize, more: &[&'static str]) -> Vec<&'static str> {
    let mut arguments = vec!["run"];
    arguments.extend(RUNS[number]);
    arguments.extend(more);
    arguments
}

fn wait_for(running: &mut Child, what: impl Fn() -> bool) {
    let patience = Instant::now();
    while !what() && running.try_wait().unwrap().is_none() {
        assert!(
            patience.elapsed() < Duration::from_secs(300),
            "it never came"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn kill(running: &Child, signal: &str) {
    let pid = running.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(sent.unwrap().success());
}

/// Starts a run, kills it up to `most` times at random moments, and lets it come to
/// its end; says how often it was killed, and how often while it ran.
fn kill_and_resume(
    folder: &Path,
    number: usize,
    every: &'static str,
    took: Duration,
    most: u32,
    rng: &mut ChaCha8Rng,
) -> u32 {
    let begin = start(number, &["--out=killed", "--force", every]);
    let run = folder.join("killed");
    let mut kills = 0;
    loop {
        let resumes = run.join("scenario.toml").exists();
        let arguments: &[&str] = if resumes {
            &["resume", "killed", every]
        } else {
            &begin
        };
        let mut running = command(folder, arguments).spawn().unwrap();
        if kills < most {
            // Moments near the start count as much as those late in the run.
            let part: f64 = rng.random();
            std::thread::sleep(took.mul_f64(0.7 * part * part));
            running.kill().unwrap();
        }
        let status = running.wait().unwrap();
        if status.code() == Some(0) {
            return kills;
        }
        assert_eq!(status.code(), None, "it failed: {arguments:?}");
        kills += 1;
    }
}

fn kills(total: u32, seed: u64) {
    let place = place();
    let mut whole = Vec::new();
    for number in 0..RUNS.len() {
        let began = Instant::now();
        let out: &str = ["--out=0", "--out=1", "--out=2", "--out=3"][number];
        expect(place.path(), 0, &start(number, &[out]));
        whole.push(began.elapsed());
    }
    let mut rng = seeded(seed);
    let mut killed = 0;
    let mut rounds = 0;
    let most = (total / RUNS.len() as u32).clamp(1, 12);
    while killed < total || rounds < RUNS.len() {
        let number = rounds % RUNS.len();
        let every = ["--checkpoint-every=0.7", "--checkpoint-every=5"][rounds / RUNS.len() % 2];
        killed += kill_and_resume(place.path(), number, every, whole[number], most, &mut rng);
        assert_same(
            &place.path().join(number.to_string()),
            &place.path().join("killed"),
        );
        fs::remove_dir_all(place.path().join("killed")).unwrap();
        rounds += 1;
    }
    println!("killed {killed} times in {rounds} runs");
}

#[test]
fn killed_runs_go_on() {
    kills(8, 1);
}

/// The long version: `cargo test --test program_resume -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn runs_killed_two_hundred_times_go_on() {
    kills(200, 2);
}

#[test]
fn signals_save_the_state() {
    let place = place();
    expect(place.path(), 0, &start(1, &["--out=whole"]));
    let run = place.path().join("stopped");
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let _ = fs::remove_dir_all(&run);
        let arguments = start(1, &["--out=stopped"]);
        let mut running = command(place.path(), &arguments).spawn().unwrap();
        let frames = run.join("frames.xyz");
        wait_for(&mut running, || {
            fs::metadata(&frames).is_ok_and(|about| about.len() > 0)
        });
        // It is being written to.
        let said = expect(place.path(), 2, &["resume", "stopped"]);
        assert!(said.contains("another grainfall process"), "{said}");
        let again = start(1, &["--out=stopped", "--force"]);
        let said = expect(place.path(), 2, &again);
        assert!(said.contains("another grainfall process"), "{said}");
        kill(&running, signal);
        assert_eq!(running.wait().unwrap().code(), Some(code));
        assert_eq!(reason(&run).as_deref(), Some("interrupted"));
        // Once more before it is let go.
        let mut running = command(place.path(), &["resume", "stopped"])
            .spawn()
            .unwrap();
        wait_for(&mut running, || !run.join("summary.json").exists());
        kill(&running, signal);
        assert_eq!(running.wait().unwrap().code(), Some(code));
        let said = expect(place.path(), 0, &["resume", "stopped"]);
        assert!(said.contains("all grains are at rest"), "{said}");
        assert_same(&place.path().join("whole"), &run);
    }
}

#[test]
fn a_finished_run_is_left_alone() {
    let place = place();
    let run = place.path().join("runs/bounce-1");
    expect(place.path(), 0, &["run", "bounce"]);
    let before = content(&run);
    let written = |name: &str| fs::metadata(run.join(name)).unwrap().modified().unwrap();
    let summary = written("summary.json");
    let said = expect(place.path(), 0, &["resume", "runs/bounce-1"]);
    assert!(said.contains("finished already"), "{said}");
    assert_eq!(content(&run), before);
    assert_eq!(written("summary.json"), summary);
    assert_eq!(
        expect(place.path(), 0, &["resume", "-q", "runs/bounce-1"]),
        ""
    );
}

/// Takes one of the numbers of events out of a summary, as of a program that did not
/// count them.
fn forget_count(run: &Path, name: &str) {
    let file = run.join("summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let events = summary["events"].as_object_mut().unwrap();
    assert!(events.remove(name).is_some());
    fs::write(&file, serde_json::to_vec(&summary).unwrap()).unwrap();
}

#[test]
fn a_run_that_another_version_has_finished_is_left_alone() {
    let place = place();
    let run = place.path().join("runs/bounce-1");
    expect(place.path(), 0, &["run", "bounce"]);
    for name in ["support", "guard"] {
        forget_count(&run, name);
        let before = content(&run);
        let said = expect(place.path(), 0, &["resume", "runs/bounce-1"]);
        assert!(said.contains("finished already"), "{said}");
        assert_eq!(content(&run), before);
    }
}

#[test]
fn what_is_no_run_is_refused() {
    let place = place();
    let said = expect(place.path(), 2, &["resume", "nowhere"]);
    assert!(
        said.contains("nowhere") && said.contains("no such folder"),
        "{said}"
    );
    let said = expect(place.path(), 2, &["resume", "."]);
    assert!(said.contains("no scenario.toml"), "{said}");
    let said = expect(place.path(), 2, &["run", "bounce", "--checkpoint-every=-1"]);
    assert!(said.contains("1e-9"), "{said}");
    for wrong in ["--audit=0", "--audit=1e4", "--audit=-3"] {
        let said = expect(place.path(), 2, &["run", "bounce", wrong]);
        assert!(said.contains("a whole number from 1 on"), "{said}");
    }
    fs::write(place.path().join("scenario.toml"), "dimension = 2\n").unwrap();
    let said = expect(place.path(), 2, &["resume", "."]);
    assert!(
        said.contains("error") && !said.contains("panicked"),
        "{said}"
    );
}

/// A run that collapses has its state saved, and collapses again.
#[test]
fn a_collapse_is_kept() {
    let place = place();
    let run = place.path().join("runs/bounce-full-1");
    expect(place.path(), 3, &["run", "bounce-full"]);
    let before = content(&run);
    assert!(before.contains_key("checkpoint"));
    assert_eq!(reason(&run).as_deref(), Some("collapse"));
    expect(place.path(), 3, &["resume", "runs/bounce-full-1"]);
    let after = content(&run);
    for (name, bytes) in before {
        // Besides the state they hold processor time.
        if !name.starts_with("checkpoint") {
            assert!(after[&name] == bytes, "{name}");
        }
    }
}

/// What an audit said of another part of the run is not left beside the rest.
#[test]
fn audits_of_an_earlier_part_are_taken_away() {
    let place = place();
    let audit = place.path().join("runs/bounce-full-1/audit.json");
    expect(place.path(), 3, &["run", "bounce-full", "--audit", "10"]);
    assert!(audit.exists());
    expect(place.path(), 3, &["resume", "runs/bounce-full-1"]);
    assert!(!audit.exists());
}

/// Of two runs that are begun in one folder at the same moment one is refused.
#[test]
fn a_folder_belongs_to_one_run() {
    for _ in 0..5 {
        let place = place();
        let runs = ["1", "2"].map(|seed| {
            let arguments = ["run", "bounce", "--seed", seed, "--out", "both"];
            command(place.path(), &arguments).spawn().unwrap()
        });
        let codes = runs.map(|mut run| run.wait().unwrap().code().unwrap());
        let winner = match codes {
            [0, 2] => 1,
            [2, 0] => 2,
            _ => panic!("{codes:?}"),
        };
        let run = place.path().join("both");
        let scenario = fs::read_to_string(run.join("scenario.toml")).unwrap();
        assert!(scenario.contains(&format!("seed = {winner}\n")));
        let text = fs::read_to_string(run.join("summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(summary["seed"], winner);
    }
}

/// A folder as a run leaves it that was killed, with two checkpoints.
fn killed(place: &Path) -> PathBuf {
    let run = place.join("killed");
    let newest = run.join("checkpoint");
    let previous = run.join("checkpoint.previous");
    // Not at the moment when one takes the place of the other.
    while !newest.exists() {
        let _ = fs::remove_dir_all(&run);
        let arguments = start(0, &["--out=killed", "--checkpoint-every=1"]);
        let mut running = command(place, &arguments).spawn().unwrap();
        // The first one says that nothing has been set up.
        wait_for(&mut running, || {
            fs::metadata(&previous).is_ok_and(|about| about.len() > 1000)
        });
        running.kill().unwrap();
        running.wait().unwrap();
        assert_eq!(reason(&run), None, "it ended by itself");
    }
    run
}

#[test]
fn damaged_checkpoints_are_refused_by_name() {
    let place = place();
    expect(place.path(), 0, &start(0, &["--out=whole"]));
    let whole = place.path().join("whole");
    let run = killed(place.path());
    let newest = run.join("checkpoint");
    let previous = run.join("checkpoint.previous");
    let good = fs::read(&newest).unwrap();
    let kept = fs::read(&previous).unwrap();
    let kept_content = content(&run);
    let truncated = good[..good.len() / 2].to_vec();
    let mut corrupted = good.clone();
    corrupted[good.len() / 2] ^= 4;
    let mut newer = good.clone();
    newer[8] += 1;
    let other_format = format!("format {}", newer[8]);
    let cases: [(&[u8], &str); 4] = [
        (&truncated, "truncated"),
        (&corrupted, "corrupted"),
        (&newer, &other_format),
        (b"picture", "no checkpoint"),
    ];
    for (bytes, said_of_it) in cases {
        fs::write(&newest, bytes).unwrap();
        fs::write(&previous, bytes).unwrap();
        let said = expect(place.path(), 2, &["resume", "killed"]);
        assert!(
            said.contains("killed/checkpoint ")
                && said.contains("killed/checkpoint.previous")
                && said.contains(said_of_it)
                && said.contains("grainfall run killed/scenario.toml"),
            "{said}"
        );
    }
    // Nothing was touched.
    fs::write(&newest, &good).unwrap();
    fs::write(&previous, &kept).unwrap();
    assert!(content(&run) == kept_content);
    // The scenario has been changed.
    let scenario = fs::read_to_string(run.join("scenario.toml")).unwrap();
    fs::write(run.join("scenario.toml"), format!("{scenario}\n# mine\n")).unwrap();
    let said = expect(place.path(), 2, &["resume", "killed"]);
    assert!(said.contains("scenario.toml has been changed"), "{said}");
    fs::write(run.join("scenario.toml"), &scenario).unwrap();
    // A file has been cut.
    let series = fs::read(run.join("series.csv")).unwrap();
    fs::write(run.join("series.csv"), &series[..10]).unwrap();
    let said = expect(place.path(), 2, &["resume", "killed"]);
    assert!(said.contains("series.csv has 10 bytes"), "{said}");
    fs::write(run.join("series.csv"), &series).unwrap();
    // One of the two is good.
    fs::write(&newest, &truncated).unwrap();
    let said = expect(place.path(), 0, &["resume", "killed"]);
    assert!(
        said.contains("truncated") && said.contains("going on from killed/checkpoint.previous"),
        "{said}"
    );
    assert_same(&whole, &run);
}

/// A file system that takes no more: the run says so, and goes on later.
#[test]
fn a_full_disk_leaves_the_last_checkpoint() {
    let place = place();
    expect(place.path(), 0, &start(0, &["--out=whole"]));
    let run = place.path().join("full");
    let arguments = start(0, &["--out=full", "--checkpoint-every=1"]);
    // No file may have more than 200 blocks of 512 bytes.
    let output = Command::new("sh")
        .current_dir(place.path())
        .args(["-c", "trap '' XFSZ; ulimit -f 200; exec \"$0\" \"$@\""])
        .arg(env!("CARGO_BIN_EXE_grainfall"))
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("File too large") && said.contains("grainfall resume full"),
        "{said}"
    );
    assert_eq!(reason(&run).as_deref(), Some("error"));
    let checkpoint = fs::metadata(run.join("checkpoint")).unwrap();
    assert!(checkpoint.len() > 1000, "a state is in it");
    expect(place.path(), 0, &["resume", "full"]);
    assert_same(&place.path().join("whole"), &run);
}

/// A set-up that is refused leaves nothing behind.
#[test]
fn a_refused_set_up_leaves_nothing() {
    let place = place();
    let said = expect(
        place.path(),
        2,
        &["run", "gas", "--set=grains.0.gas.packing_fraction=0.73"],
    );
    assert!(said.contains("gas"), "{said}");
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0, "{said}");
}
