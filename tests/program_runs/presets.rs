//! Presets: that their runs do what they are for.

use std::fs;

use crate::{expect, place, rows, summary};
use serde_json::Value;

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
