//! Parts of one's own: the tests of the examples that show them. `cargo test` builds
//! examples but does not run what they test.

use std::collections::HashSet;

// What only their `main` uses.
#[allow(dead_code)]
#[path = "../examples/own_boundary.rs"]
mod boundary;
#[allow(dead_code)]
#[path = "../examples/own_collision_rule.rs"]
mod collision_rule;
#[allow(dead_code)]
#[path = "../examples/own_dynamics.rs"]
mod dynamics;
#[allow(dead_code)]
#[path = "../examples/own_predictor.rs"]
mod predictor;
#[allow(dead_code)]
#[path = "../examples/own_shaken_floor.rs"]
mod shaken_floor;

/// Every line of code in the chapters, but for what they import, is one of the example
/// that is tested here.
#[test]
fn the_book_shows_the_examples() {
    let chapters = [
        (
            include_str!("../book/src/own-collision-rule.md"),
            "own_collision_rule",
            include_str!("../examples/own_collision_rule.rs"),
        ),
        (
            include_str!("../book/src/own-dynamics.md"),
            "own_dynamics",
            include_str!("../examples/own_dynamics.rs"),
        ),
        (
            include_str!("../book/src/own-predictor.md"),
            "own_predictor",
            include_str!("../examples/own_predictor.rs"),
        ),
        (
            include_str!("../book/src/own-boundary.md"),
            "own_boundary",
            concat!(
                include_str!("../examples/own_boundary.rs"),
                include_str!("../examples/own_shaken_floor.rs")
            ),
        ),
    ];
    for (chapter, name, example) in chapters {
        let known: HashSet<&str> = example.lines().map(str::trim).collect();
        let mut inside = false;
        let mut compared = 0;
        for line in chapter.lines().map(str::trim) {
            match line {
                "```rust" | "```rust,ignore" => inside = true,
                "```" => inside = false,
                _ if !inside || line.starts_with("use ") || line.starts_with("# ") => {}
                _ => {
                    compared += 1;
                    assert!(known.contains(line), "{name}: {line}");
                }
            }
        }
        assert!(compared > 20, "{name}: {compared}");
    }
}
