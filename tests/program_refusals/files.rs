//! Files and arguments.

use crate::scenarios::{GOOD, assert_refused};
use crate::{grainfall, message};

#[test]
fn bad_files_of_grains_are_refused() {
    let scenario = "dimension = 3\n[[grains]]\nfile = \"g.xyz\"\n";
    for (grains, wanted) in [
        ("", "empty"),
        ("many\n\n", "`many`"),
        ("99999999999\n\n", "at most 10000000"),
        ("2\n\nA 0 0 0\n", "ends after line 3"),
        (
            "1\nProperties=pos:R:3\n0 zero 0\n",
            "line 3 of the XYZ file: position is `zero`",
        ),
        (
            "1\nProperties=pos:R:3:radius:R:1\n0 0 0 inf\n",
            "radius is `inf`",
        ),
        (
            "1\nProperties=pos:R:3:mode:S:1\n0 0 0 awake\n",
            "mode is `awake`; normal, falling, frozen or fixed is wanted",
        ),
        ("1\nProperties=pos:R\n0 0 0\n", "name:kind:width"),
        (
            "2\nProperties=id:I:1:pos:R:3\n1 0 0 0\n1 5 0 0\n",
            "only once",
        ),
        ("2\n\nA 0 0 0\nA 0 0 0.5\n", "overlap by 5e-1 d"),
    ] {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("bad.toml"), scenario).unwrap();
        std::fs::write(place.path().join("g.xyz"), grains).unwrap();
        let output = grainfall(place.path(), &["check", "bad.toml"]);
        let said = message(&output);
        assert_eq!(output.status.code(), Some(2), "{grains}\n{said}");
        assert!(
            said.contains(wanted) && said.contains("grains[0]"),
            "{grains}\n{said}"
        );
    }
}

#[test]
fn bad_assignments_are_refused_as_such() {
    for (set, wanted) in [
        (
            "parametrs.x=1",
            "--set parametrs.x=1: parametrs: unknown key",
        ),
        (
            "parameters.restitution=hi",
            "--set parameters.restitution=hi: ",
        ),
        ("parameters.restitution=2", "parameters.restitution is 2"),
        ("grains.5.mass=1", "grains has 1 entries"),
        ("dimension.x=1", "dimension is no table (integer)"),
        ("seed", "has no `=`"),
    ] {
        let place = tempfile::tempdir().unwrap();
        let output = grainfall(place.path(), &["run", "bounce", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(
            message(&output).contains(wanted),
            "{set}: {}",
            message(&output)
        );
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    }
}

#[test]
fn what_is_not_there_is_told_apart() {
    let place = tempfile::tempdir().unwrap();
    let output = grainfall(place.path(), &["run", "depositoin"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("did you mean `deposition`?"));
    let output = grainfall(place.path(), &["run", "mine.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(message(&output).contains("cannot read mine.toml"));
    let output = grainfall(place.path(), &["draw", "nothing"]);
    assert_eq!(output.status.code(), Some(1));
    let output = grainfall(place.path(), &["draw", "nothing", "--time", "nan"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("finite"));
    let output = grainfall(place.path(), &["fly"]);
    assert_eq!(output.status.code(), Some(2));
}

/// Numbers and files that are made to hang a careless reader or to eat its
/// memory.
#[test]
fn hostile_input_is_refused_quickly() {
    let deep = format!("x = {}\n{GOOD}", "[".repeat(100_000));
    assert_refused("bad.toml", &deep, &["not TOML"]);
    let deep = "[".repeat(100_000);
    assert_refused("bad.json", &deep, &["not JSON"]);
    let long_key = format!("{} = 1\n{GOOD}", "k".repeat(1_000_000));
    assert_refused("bad.toml", &long_key, &["unknown key"]);
    let boxed = r#"dimension = 3
boundaries = [{ periodic = { length = 1e8 } }, { periodic = { length = 1e8 } }, "open"]
[[grains]]
"#;
    for (source, wanted) in [
        ("base = { thickness = 2 }", "at most 10000000"),
        ("rain = { count = 99999999 }", "1 to 10000000"),
        ("rain = { count = 99999999999999999999 }", "not TOML"),
        ("one_by_one = { count = 1000000000 }", "1 to 10000000"),
        (
            "rain = { count = 5, sizes = { kind = \"log_normal\", median = 1, spread = 99 } }",
            "0 … 2",
        ),
    ] {
        assert_refused("bad.toml", &format!("{boxed}{source}\n"), &[wanted]);
    }
}
