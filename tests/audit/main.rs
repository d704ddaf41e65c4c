//! Random small systems, looked through from outside after every event: all
//! pairs, all images, all walls, energy and counts.

#[path = "../common/mod.rs"]
mod common;

mod auditor;
mod systems;

use auditor::audit;
use proptest::prelude::*;
use systems::{policy, put_together, raw, room};

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn disks(
        raws in prop::collection::vec(raw(), 1..30),
        room in room(),
        elastic_speed in prop_oneof![Just(0.0), 1.0e-6..1.0e-3, 1.0e-3..0.02f64],
        policy in policy(),
    ) {
        let heap = put_together::<2>(&raws, room, elastic_speed, policy);
        audit(heap, 800)?;
    }

    #[test]
    fn spheres(
        raws in prop::collection::vec(raw(), 1..60),
        room in room(),
        elastic_speed in prop_oneof![Just(0.0), 1.0e-6..1.0e-3, 1.0e-3..0.02f64],
        policy in policy(),
    ) {
        let heap = put_together::<3>(&raws, room, elastic_speed, policy);
        audit(heap, 600)?;
    }
}
