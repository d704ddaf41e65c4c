//! Parts of one's own: the tests of the examples that show them. `cargo test` builds
//! examples but does not run what they test.

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
