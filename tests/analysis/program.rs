//! The command `grainfall analyse`.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use grainfall::analysis::Container;
use grainfall::boundary::{Cuboid, Side};
use grainfall::output::Frame;
use grainfall::{Particle, Time, Vector};

use crate::fcc;

fn analyse(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder)
        .arg("analyse")
        .args(arguments)
        .output()
        .unwrap()
}

fn printed(output: &Output) -> String {
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Writes frames of these grains, which drift along x by a tenth of a diameter a
/// unit of time, to a file.
fn write(file: &Path, grains: &[Particle<3>], container: &Container<3>, times: &[f64]) {
    let sides = [0, 1, 2].map(|axis| Side::periodic(container.lengths[axis]));
    let boundary = Cuboid::new(sides).unwrap();
    let mut text = Vec::new();
    for &time in times {
        let drift = Vector::<3>::new(0.1, 0.0, 0.0);
        let moved: Vec<Particle<3>> = grains
            .iter()
            .map(|grain| Particle {
                position: grain.position + drift * time,
                velocity: drift,
                ..*grain
            })
            .collect();
        let frame = Frame::new(&moved, Time::from_units(time), &boundary);
        frame.write(&mut text).unwrap();
    }
    fs::write(file, text).unwrap();
}

/// A column of a table, by its name.
fn column(file: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|head| head == name);
    let place = place.unwrap_or_else(|| panic!("no {name} in {}", file.display()));
    let cell = |line: &str| {
        line.split(',')
            .nth(place)
            .unwrap()
            .parse()
            .unwrap_or(f64::NAN)
    };
    lines.map(cell).collect()
}

#[test]
fn a_drifting_crystal_is_measured_from_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let (grains, container) = fcc(4, true);
    let file = folder.path().join("crystal.xyz");
    write(&file, &grains, &container, &[0.0, 1.0, 2.0, 3.0]);
    let said = printed(&analyse(folder.path(), &["crystal.xyz", "--bins", "4"]));
    assert!(
        said.starts_with("crystal.xyz: 4 frames, t = 0.0000 to 3.0000; 256 grains"),
        "{said}"
    );
    let out = folder.path().join("analysis");
    for name in [
        "profile",
        "map",
        "rdf",
        "contacts",
        "fabric",
        "velocity",
        "temperature",
        "msd",
    ] {
        let picture = fs::read_to_string(out.join(format!("{name}.svg"))).unwrap();
        assert!(
            picture.starts_with("<svg") && picture.ends_with("</svg>\n"),
            "{name}"
        );
        assert!(
            !fs::read_to_string(out.join(format!("{name}.csv")))
                .unwrap()
                .contains("NaN")
        );
    }
    let close = 0.740_480_489_693_061;
    let close_to = |found: &[f64], known: f64| {
        assert!(!found.is_empty());
        assert!(
            found.iter().all(|one| (one - known).abs() < 1.0e-9),
            "{found:?} {known}"
        );
    };
    close_to(&column(&out.join("profile.csv"), "packing_fraction"), close);
    close_to(&column(&out.join("map.csv"), "packing_fraction"), close);
    close_to(&column(&out.join("velocity.csv"), "velocity_x"), 0.1);
    close_to(&column(&out.join("temperature.csv"), "temperature"), 0.0);
    let contacts = column(&out.join("contacts.csv"), "contacts");
    close_to(&contacts, 12.0);
    let msd = column(&out.join("msd.csv"), "mean_square_displacement");
    assert_eq!(msd.len(), 3);
    for (value, lapse) in msd.iter().zip([1.0, 2.0, 3.0]) {
        close_to(&[*value], 0.01 * lapse * lapse);
    }
    // Again, to elsewhere, gives the same bytes.
    printed(&analyse(
        folder.path(),
        &["crystal.xyz", "--bins", "4", "--out", "again"],
    ));
    for entry in fs::read_dir(&out).unwrap() {
        let name = entry.unwrap().file_name();
        let other = folder.path().join("again").join(&name);
        assert_eq!(
            fs::read(out.join(&name)).unwrap(),
            fs::read(other).unwrap(),
            "{name:?}"
        );
    }
}

#[test]
fn what_can_not_be_analysed_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (grains, container) = fcc(3, true);
    write(&at("one.xyz"), &grains, &container, &[5.0]);
    write(&at("none.xyz"), &grains, &container, &[]);
    fs::create_dir(at("empty")).unwrap();
    fs::create_dir(at("sweep")).unwrap();
    fs::write(at("sweep/sweep.toml"), "").unwrap();
    let flat = Particle::<2>::fixed(Vector::<2>::zeros());
    let frame = Frame::new(&[flat], Time::ZERO, &Cuboid::<2>::open());
    let mut text = Vec::new();
    frame.write(&mut text).unwrap();
    fs::write(at("flat.xyz"), text).unwrap();
    fs::write(at("broken.xyz"), "3\nProperties=pos:R:3\n0 0 0\n").unwrap();
    for (arguments, known) in [
        (
            vec!["missing"],
            "missing cannot be analysed: there is no such folder or file",
        ),
        (vec!["empty"], "there is no frames.xyz in it"),
        (vec!["sweep"], "analyse one of the runs in it"),
        (vec!["none.xyz"], "there are no frames in it"),
        (
            vec!["one.xyz", "--from", "6"],
            "none of its 1 frames is within --from and --to",
        ),
        (vec!["one.xyz", "msd"], "a displacement needs two frames"),
        (
            vec!["one.xyz", "rdf", "--farthest", "4"],
            "half of the shortest period",
        ),
        (
            vec!["one.xyz", "map", "--across", "z"],
            "--across is z, which is up",
        ),
        (
            vec!["flat.xyz", "profile", "--axis", "z"],
            "--axis is z, and its frames have 2",
        ),
        (vec!["one.xyz", "colour"], "invalid value 'colour'"),
        (vec!["one.xyz", "--slab", "x=3,1"], "3 is not below 1"),
        (vec!["one.xyz", "--slab", "w=3,1"], "`w` is no axis"),
        (vec!["one.xyz", "--axis", "w"], "invalid value 'w'"),
        (vec!["broken.xyz"], "broken.xyz"),
    ] {
        let error = refused(&analyse(folder.path(), &arguments));
        assert!(error.contains(known), "{arguments:?}: {error}");
    }
    // A refusal leaves nothing behind.
    assert!(!at("analysis").exists());
    // What one frame does not allow is left out of everything, and told.
    let output = analyse(folder.path(), &["one.xyz"]);
    assert!(printed(&output).contains("profile"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("note: no msd: "));
}

#[test]
fn stress_and_force_are_those_of_the_run_itself() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let small = [
        "run",
        "deposition",
        "--set",
        "grains.1.rain.count=60",
        "--set",
        "boundaries=[{periodic={length=4}},{periodic={length=4}},\"open\"]",
        "--set",
        "parameters.elastic_speed=1e-3",
        "--out",
        "heap",
        "--quiet",
    ];
    let ran = Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(place)
        .args(small)
        .status();
    assert!(ran.unwrap().success());
    let files = |folder: &Path| -> Vec<(String, Vec<u8>)> {
        let mut files: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|file| file.is_file())
            .map(|file| (file.display().to_string(), fs::read(&file).unwrap()))
            .collect();
        files.sort();
        files
    };
    let run = place.join("heap");
    let before = files(&run);
    let said = printed(&analyse(place, &["heap", "stress", "force", "--bins", "3"]));
    let hash = "the last frame came out the same, bit by bit";
    assert_eq!(said.matches(hash).count(), 2, "{said}");
    assert_eq!(files(&run), before, "the run's own files were touched");
    // Momentum: each grain comes with 2.5 downwards and ends at rest; from its
    // first collision on it is heavy, until it sleeps.
    let table = run.join("analysis/force.csv");
    let times = column(&table, "time");
    let length = 2.0 * times[0];
    assert!((times[1] - times[0] - length).abs() < 1.0e-9);
    let upwards: f64 = ["fixed_z", "asleep_z", "by_sleep_z"]
        .iter()
        .flat_map(|name| column(&table, name))
        .sum();
    let taken = -upwards * length;
    assert!(taken > 60.0 * 2.5, "{taken}");
    let pressures = column(&run.join("analysis/stress.csv"), "collisional_zz");
    assert_eq!(pressures.len(), 3);
    assert!(pressures.iter().all(|pressure| *pressure > 0.0));
    // Another scenario goes another way.
    let text = fs::read_to_string(run.join("scenario.toml")).unwrap();
    fs::write(
        run.join("scenario.toml"),
        text.replace("seed = 1", "seed = 2"),
    )
    .unwrap();
    fs::remove_dir_all(run.join("analysis")).unwrap();
    let error = refused(&analyse(place, &["heap", "stress", "--bins", "3"]));
    assert!(error.contains("it comes to another frame"), "{error}");
    assert!(!run.join("analysis").exists());
    let error = refused(&analyse(place, &["heap/frames.xyz", "force"]));
    assert!(
        error.contains("with its scenario.toml, is wanted"),
        "{error}"
    );
}

#[test]
fn velocities_are_relative_to_ground_that_turns() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "\
dimension = 2
gravity = 1.0
boundaries = [\"open\", \"open\"]
rotation = { angular_velocity = 0.1, of = \"ground\" }
stop = { time = 0.5 }

[[grains]]
position = [-0.5, -3.0]
mode = \"fixed\"

[[grains]]
position = [0.5, -3.0]
mode = \"fixed\"

[[grains]]
position = [0.0, -2.1339]
mode = \"frozen\"

[[grains]]
position = [4.0, 3.0]
velocity = [-0.3, 0.4]
";
    fs::write(folder.path().join("carried.toml"), scenario).unwrap();
    let ran = Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .current_dir(folder.path())
        .args(["run", "carried.toml", "--out", "carried", "--quiet"])
        .status();
    assert!(ran.unwrap().success());
    let found = |component: &str| {
        let only = [
            "carried",
            "velocity",
            "--bins",
            "1",
            "--slab",
            "y=-2.5,-1.5",
            "--to",
            "0",
        ];
        let mut arguments = only.to_vec();
        arguments.extend(["--component", component]);
        printed(&analyse(folder.path(), &arguments));
        column(
            &folder.path().join("carried/analysis/velocity.csv"),
            &format!("velocity_{component}"),
        )
    };
    // The frozen one is carried along at Ω r, as the ground is; so it rests.
    let text = fs::read_to_string(folder.path().join("carried/frames.xyz")).unwrap();
    assert!(
        text.lines()
            .nth(4)
            .unwrap()
            .starts_with("2 0.0 -2.1339 0.0 0.2133"),
        "{text}"
    );
    for component in ["x", "y"] {
        assert!(found(component).iter().all(|speed| speed.abs() < 1.0e-15));
    }
    // The one that flies has the velocity of ground at (4, 3).
    let said = printed(&analyse(
        folder.path(),
        &["carried", "velocity", "--to", "0", "--bins", "1"],
    ));
    assert!(said.contains("greatest 0.0000"), "{said}");
}

#[test]
fn the_surface_lies_below_the_lid() {
    // Disks in rows that rise by one in two, up to x/2, under a lid of fixed ones.
    let folder = tempfile::tempdir().unwrap();
    let mut grains = Vec::new();
    for column in 0..20 {
        let x = f64::from(column);
        for row in 0..8 {
            let place = Vector::<2>::new(x, 0.5 * x - f64::from(row));
            grains.push(Particle::frozen(place));
        }
        grains.push(Particle::fixed(Vector::<2>::new(x, 14.0)));
    }
    let frame = Frame::new(&grains, Time::ZERO, &Cuboid::<2>::open());
    let mut text = Vec::new();
    frame.write(&mut text).unwrap();
    fs::write(folder.path().join("slope.xyz"), text).unwrap();
    let said = printed(&analyse(folder.path(), &["slope.xyz", "angle"]));
    let heights = folder.path().join("analysis/angle.csv");
    for (x, height) in column(&heights, "x")
        .iter()
        .zip(column(&heights, "height_of_highest_grain"))
    {
        assert!((height - 0.5 * x - 0.5).abs() < 1.0e-9, "{x} {height}");
    }
    let of_map = column(&heights, "height_of_map");
    let slope = (of_map[19] - of_map[0]) / 19.0;
    assert!((slope - 0.5).abs() < 0.02, "{slope}");
    assert!(
        said.contains("of the highest grains rises at 26.565"),
        "{said}"
    );
}
