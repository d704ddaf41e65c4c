//! Walls and fillings of drums.

use crate::common::{close, rule};
use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::TurningGravity;
use grainfall::engine::Simulation;
use grainfall::model::Parts;
use grainfall::policy::Never;
use grainfall::predict::Turning;
use grainfall::setup::{Drum, seeded};
use grainfall::{Mode, SetupError, Vector};

#[test]
fn the_paper_s_wall_has_785_grains() {
    let wall = Drum::default().wall::<3>().unwrap();
    assert_eq!(wall.len(), 5 * 157);
    close(Drum::default().length(), 5.25, 1.0e-12, "length");
    for grain in &wall {
        let [x, y, z] = [grain.position.x, grain.position.y, grain.position.z];
        close(x.hypot(z), 25.0, 1.0e-12, "radius");
        assert!(grain.mode == Mode::Fixed && (0.0..5.25).contains(&y));
    }
    // Neighbours along the ring are an arc of 1.0005 apart.
    let arc = 2.0 * (0.5 * (wall[1].position - wall[0].position).norm() / 25.0).asin() * 25.0;
    close(arc, 1.0005, 1.0e-4, "arc");
}

#[test]
fn a_filling_sleeps_up_to_its_level() {
    let drum = Drum {
        radius: 6.0,
        rings: 3,
        level: -1.0,
        ..Drum::default()
    };
    let grains = drum.grains::<3>(&mut seeded(1)).unwrap();
    let filling = &grains[drum.wall::<3>().unwrap().len()..];
    for grain in filling {
        let [x, z] = [grain.position.x, grain.position.z];
        assert!(grain.mode == Mode::Frozen && z <= -1.0 && x.hypot(z) < 5.5);
    }
    // The segment of the inner circle below the level, at a random packing.
    let inner = 5.5_f64;
    let half_angle = (1.0 / inner).acos();
    let area = inner * inner * (half_angle - half_angle.sin() * half_angle.cos());
    let solid = filling.len() as f64 * core::f64::consts::PI / 6.0;
    let fraction = solid / (area * drum.length());
    assert!((0.5..0.66).contains(&fraction), "{fraction}");
    // The engine finds no overlap.
    let sides = [Side::Open, Side::periodic(drum.length()), Side::Open];
    let model = Parts {
        dynamics: TurningGravity::<3>::new(-Vector::z(), 0.1, [0, 2]),
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: Never,
        boundary: Cuboid::new(sides).unwrap(),
    };
    Simulation::new(model, grains).unwrap();
}

#[test]
fn drums_through_which_grains_would_slip_are_refused() {
    let refused = |drum: Drum, name: &str| {
        let Err(SetupError::Parameter { field, .. }) = drum.wall::<3>() else {
            panic!("{drum:?}");
        };
        assert_eq!(field, name);
    };
    let drum = Drum::default();
    refused(
        Drum {
            arc_spacing: 1.9,
            ..drum.clone()
        },
        "arc_spacing",
    );
    refused(
        Drum {
            ring_spacing: f64::NAN,
            ..drum.clone()
        },
        "ring_spacing",
    );
    refused(
        Drum {
            radius: 1.0,
            ..drum.clone()
        },
        "radius",
    );
    refused(Drum { rings: 1, ..drum }, "rings");
}
