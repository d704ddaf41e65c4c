//! Runs that end before their time, or could not write.

use std::fs;
use std::process::Command;

use crate::{expect, grainfall, place, rows, summary};

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
