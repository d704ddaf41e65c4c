//! In what order the grains of a scenario are numbered.

use grainfall::Particle;
use grainfall::scenario::{Preset, Start, read_text};

/// The grains with which a preset starts.
fn start_of(preset: &str, assignments: &[&str]) -> Vec<Particle<3>> {
    let mut origin = Preset::named(preset).unwrap().origin();
    origin.assignments = assignments.iter().map(|set| set.parse().unwrap()).collect();
    let scenario = read_text(&origin).unwrap();
    Start::<3>::new(&origin, &scenario).unwrap().grains
}

#[test]
fn numbering_changes_the_order_within_each_source_alone() {
    let few = "grains.1.rain.count=200";
    let drawn = start_of("deposition", &[few]);
    let space = start_of("deposition", &[few, "numbering=\"space\""]);
    assert_ne!(drawn, space);
    let fixed = drawn.len() - 200;
    for part in [0..fixed, fixed..drawn.len()] {
        let sorted = |grains: &[Particle<3>]| {
            let mut grains = grains[part.clone()].to_vec();
            grains.sort_by_key(|grain| grain.position.map(f64::to_bits).data.0);
            grains
        };
        assert_eq!(sorted(&drawn), sorted(&space));
    }
}
