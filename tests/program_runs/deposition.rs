//! A small deposition: what it leaves, that it is the same each time, and what is refused.

use std::collections::BTreeSet;
use std::fs;

use crate::{expect, grainfall, place, rows, small, summary};
use serde_json::Value;

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
