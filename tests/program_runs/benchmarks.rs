//! `grainfall bench`: its systems are the same each time.

use std::path::Path;

use crate::{expect, place, rows, small};
use serde_json::Value;

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
