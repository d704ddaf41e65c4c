//! What is not gone on with, and what is left behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{assert_same, command, content, expect, forget_count, place, reason, start, wait_for};
use serde_json::Value;

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
