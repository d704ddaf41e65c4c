//! Killed, and stopped by signals: they go on.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::{RUNS, assert_same, command, expect, kill, place, reason, start, wait_for};
use grainfall::setup::seeded;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

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
