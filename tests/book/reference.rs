//! The reference pages against the program that they describe.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::pages::folder;

fn grainfall(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_grainfall"))
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn the_reference_is_that_of_the_program() {
    let place = tempfile::tempdir().unwrap();
    let written = grainfall(&["reference", "--out", place.path().to_str().unwrap()]);
    assert!(written.status.success(), "{written:?}");
    for name in ["reference-commands.md", "reference-scenario.md"] {
        let read = |folder: &Path| fs::read_to_string(folder.join(name)).unwrap_or_default();
        let (told, stands) = (read(place.path()), read(&folder()));
        let first = told
            .lines()
            .zip(stands.lines())
            .find(|(told, stands)| told != stands);
        assert!(
            told == stands,
            "book/src/{name} differs from the program, first in {first:?}; renew it with\n  cargo \
             run --release -- reference --out book/src"
        );
    }
}

/// Every number of the schema that has bounds, with the path to it.
fn bounded(definitions: &Value, path: &str, schema: &Value, found: &mut Vec<(String, Value)>) {
    for option in ["oneOf", "anyOf"]
        .iter()
        .filter_map(|key| schema[key].as_array())
        .flatten()
    {
        bounded(definitions, path, option, found);
    }
    if let Some(name) = schema["$ref"]
        .as_str()
        .and_then(|name| name.rsplit('/').next())
    {
        bounded(definitions, path, &definitions[name], found);
    }
    if schema["items"].is_object() {
        bounded(definitions, &format!("{path}.0"), &schema["items"], found);
    }
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        let inner = if path.is_empty() {
            key.clone()
        } else {
            format!("{path}.{key}")
        };
        bounded(definitions, &inner, property, found);
    }
    let bounds = ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"];
    if bounds.iter().any(|bound| schema[bound].is_number()) {
        found.push((path.to_owned(), schema.clone()));
    }
}

/// A scenario in which such a key can stand, and what has to be set besides.
fn place_for(path: &str) -> Option<(&'static str, String, Vec<&'static str>)> {
    // Sizes are the same everywhere; they are tried in a rain.
    let (source, key) = path.strip_prefix("grains.0.").map_or(("", path), |rest| {
        rest.split_once('.').unwrap_or((rest, rest))
    });
    if key.starts_with("sizes.") && source != "rain" {
        return None;
    }
    let sizes = match key {
        "sizes.diameter" => vec!["grains.1.rain.sizes.kind=equal"],
        "sizes.small" | "sizes.large" | "sizes.large_fraction" => {
            vec!["grains.1.rain.sizes={kind=\"bimodal\",small=0.8,large=1.2,large_fraction=0.5}"]
        }
        "sizes.least" | "sizes.most" => {
            vec!["grains.1.rain.sizes={kind=\"uniform\",least=0.8,most=1.2}"]
        }
        "sizes.median" | "sizes.spread" => {
            vec!["grains.1.rain.sizes={kind=\"log_normal\",median=1,spread=0.1}"]
        }
        _ => Vec::new(),
    };
    Some(match source {
        "rain" => ("deposition", path.replace("grains.0", "grains.1"), sizes),
        "base" => ("deposition", path.to_owned(), sizes),
        "one_by_one" => ("one-by-one", path.replace("grains.0", "grains.1"), sizes),
        "gas" => ("gas", path.replace("aspect.0", "aspect"), sizes),
        "drum" => ("drum", path.to_owned(), sizes),
        "diameter" | "mass" => ("arch", path.to_owned(), sizes),
        _ if path.starts_with("boundaries.0.walls") => (
            "arch",
            path.replace("boundaries.0", "boundaries.1"),
            vec!["boundaries=[\"open\",{walls={low=-9,restitution=0.5}}]"],
        ),
        _ if path.starts_with("rotation") || path.starts_with("self_check") => {
            ("drum", path.to_owned(), sizes)
        }
        _ => ("deposition", path.to_owned(), sizes),
    })
}

/// What the reference calls allowed is what is allowed: just beyond the bounds of a
/// number, `check` refuses it, and by its name.
#[test]
fn bounds_in_the_reference_are_those_of_the_program() {
    let schema: Value = serde_json::from_slice(&grainfall(&["schema"]).stdout).unwrap();
    let mut found = Vec::new();
    bounded(&schema["$defs"], "", &schema, &mut found);
    let (mut tried, mut accepted) = (0, Vec::new());
    for (path, schema) in found {
        let Some((preset, path, besides)) = place_for(&path) else {
            continue;
        };
        let whole = schema.to_string().contains("integer");
        let step = |bound: f64| {
            if whole {
                1.0
            } else {
                1e-3 * bound.abs().max(1e-3)
            }
        };
        let beyond = [
            schema["minimum"].as_f64().map(|least| least - step(least)),
            schema["maximum"].as_f64().map(|most| most + step(most)),
            schema["exclusiveMinimum"].as_f64(),
            schema["exclusiveMaximum"].as_f64(),
        ];
        for value in beyond.into_iter().flatten() {
            let assignment = if path.ends_with("aspect") {
                format!("{path}=[{value},1,1]")
            } else {
                format!("{path}={value}")
            };
            let mut arguments = vec!["check", preset];
            for set in besides.iter().copied().chain([assignment.as_str()]) {
                arguments.extend(["--set", set]);
            }
            let checked = grainfall(&arguments);
            let said = String::from_utf8_lossy(&checked.stderr);
            let key = path.rsplit('.').next().unwrap();
            if checked.status.code() != Some(2) || !said.contains(key) {
                accepted.push(format!("{arguments:?}: {said}"));
            }
            tried += 1;
        }
    }
    assert!(accepted.is_empty(), "{}", accepted.join("\n"));
    assert!(tried > 70, "{tried} values are tried");
}
