//! Crystals.

use crate::volume;
use grainfall::setup::{Crystal, seeded};
use grainfall::{Mode, Particle, SetupError, Vector};

// ---------------------------------------------------------------- the crystal

#[test]
fn a_crystal_has_its_density_and_twelve_neighbours_each() {
    for (cells, packing_fraction) in [(3, 0.1), (4, 0.3), (3, 0.5), (2, 0.7)] {
        let crystal = Crystal {
            cells,
            packing_fraction,
            temperature: 2.0,
        };
        let (grains, edges) = crystal.grains(&mut seeded(3)).unwrap();
        assert_eq!(grains.len(), 4 * cells * cells * cells);
        let found = volume(&grains) / edges.product();
        assert!((found / packing_fraction - 1.0).abs() < 1e-14, "{found}");
        // Four grains a cell, each a face's half diagonal from the next.
        let nearest = edges[0] / cells as f64 / 2.0_f64.sqrt();
        for a in &grains {
            assert!(a.mode == Mode::Normal && a.diameter == 1.0 && a.mass == 1.0);
            let mut neighbours = 0;
            for b in &grains {
                let mut distance = b.position - a.position;
                for axis in 0..3 {
                    distance[axis] -= edges[axis] * (distance[axis] / edges[axis]).round();
                }
                let distance = distance.norm();
                let next = (distance / nearest - 1.0).abs() < 1e-12;
                // The next shell is √2 as far away. A box of two cells shows each
                // of its grains once, but those in the first shell all.
                assert!(
                    next || distance == 0.0 || distance > 1.41 * nearest,
                    "{distance}"
                );
                neighbours += u32::from(next);
            }
            assert_eq!(neighbours, 12, "φ = {packing_fraction}");
            assert!(a.position.iter().all(|x| *x > 0.0 && *x < edges[0]));
        }
        let momentum: Vector<3> = grains.iter().map(|grain| grain.velocity).sum();
        assert!(momentum.norm() < 1e-12);
        let energy: f64 = grains.iter().map(Particle::kinetic_energy).sum();
        let per_grain = energy / grains.len() as f64;
        assert!((per_grain - 3.0).abs() < 1e-12, "{per_grain}");
    }
}

#[test]
fn crystals_that_cannot_be_are_refused() {
    let crystal = |cells, packing_fraction, temperature| {
        Crystal {
            cells,
            packing_fraction,
            temperature,
        }
        .grains(&mut seeded(1))
    };
    // Where the grains touch, π/√18.
    assert!(crystal(3, 0.74, 1.0).is_ok());
    for refused in [
        crystal(0, 0.3, 1.0),
        crystal(1001, 0.3, 1.0),
        crystal(3, 0.741, 1.0),
        crystal(3, 0.0, 1.0),
        crystal(3, f64::NAN, 1.0),
        crystal(3, 0.3, -1.0),
        crystal(3, 0.3, f64::INFINITY),
    ] {
        assert!(matches!(refused, Err(SetupError::Parameter { .. })));
    }
    let narrow = crystal(1, 0.3, 1.0);
    assert!(matches!(narrow, Err(SetupError::PeriodTooShort { .. })));
}

#[test]
fn numbers_of_grains_that_fill_cells() {
    for (count, cells) in [(4, 1), (32, 2), (1372, 7), (1_000_188, 63)] {
        assert_eq!(Crystal::cells_of(count), Some(cells));
        assert_eq!(Crystal::counts_around(count), (count, count));
    }
    assert_eq!(Crystal::counts_around(1000), (864, 1372));
    for count in [0, 1, 5, 1000, usize::MAX] {
        assert_eq!(Crystal::cells_of(count), None, "{count}");
    }
}
