//! Gases.

use crate::{BIMODAL, least_gap, volume};
use grainfall::setup::{Gas, Sizes, seeded};
use grainfall::{Mode, SetupError, Vector};

// ---------------------------------------------------------------- the gas

#[test]
fn a_gas_is_what_was_asked_for() {
    fn check<const D: usize>(count: usize, sizes: Sizes, fraction: f64, aspect: Vector<D>) {
        let gas = Gas::<D> {
            count,
            sizes,
            packing_fraction: fraction,
            temperature: 0.37,
            aspect,
        };
        let (grains, lengths) = gas.grains(&mut seeded(11)).unwrap();
        assert_eq!(grains.len(), count);
        assert!((volume(&grains) / lengths.product() / fraction - 1.0).abs() < 1e-13);
        assert!((lengths[0] / lengths[D - 1] * aspect[D - 1] / aspect[0] - 1.0).abs() < 1e-14);
        let gap = least_gap(&grains, &lengths, [true; D]);
        assert!(gap > 0.0, "{gap:e}");
        let mut momentum = Vector::<D>::zeros();
        let mut twice_energy = 0.0;
        for grain in &grains {
            assert_eq!(grain.mode, Mode::Normal);
            for axis in 0..D {
                assert!((0.0..lengths[axis]).contains(&grain.position[axis]));
            }
            momentum += grain.velocity * grain.mass;
            twice_energy += 2.0 * grain.kinetic_energy();
        }
        assert!(momentum.norm() < 1e-11, "{momentum}");
        assert!((twice_energy / (D * count) as f64 - 0.37).abs() < 1e-14);
    }
    check::<3>(500, Sizes::default(), 0.05, Vector::<3>::repeat(1.0));
    check::<3>(500, Sizes::default(), 0.5, Vector::<3>::new(1.0, 2.0, 0.7));
    check::<3>(400, BIMODAL, 0.58, Vector::<3>::repeat(1.0));
    check::<3>(
        400,
        Sizes::LogNormal {
            median: 10.0,
            spread: 0.15,
        },
        0.4,
        Vector::<3>::repeat(3.0),
    );
    check::<2>(300, Sizes::default(), 0.7, Vector::<2>::repeat(1.0));
    check::<2>(300, BIMODAL, 0.75, Vector::<2>::new(1.0, 1.5));
    check::<1>(50, BIMODAL, 0.8, Vector::<1>::repeat(1.0));
    check::<4>(600, Sizes::default(), 0.2, Vector::<4>::repeat(1.0));
}

/// Steinhardt's global bond order Q₆ (doi:10.1103/PhysRevB.28.784) of the bonds
/// shorter than `cut_off`. By the addition theorem its square is the mean of
/// P₆ of the angle between any two bonds.
fn bond_order(places: &[Vector<3>], lengths: &Vector<3>, cut_off: f64) -> f64 {
    let mut bonds = Vec::new();
    for i in 0..places.len() {
        for j in 0..i {
            let mut bond = places[i] - places[j];
            for axis in 0..3 {
                bond[axis] -= lengths[axis] * (bond[axis] / lengths[axis]).round();
            }
            if bond.norm() < cut_off {
                bonds.push(bond.normalize());
            }
        }
    }
    let mut sum = 0.0;
    for a in &bonds {
        for b in &bonds {
            let x = a.dot(b) * a.dot(b);
            sum += (231.0 * x * x * x - 315.0 * x * x + 105.0 * x - 5.0) / 16.0;
        }
    }
    (sum / (bonds.len() * bonds.len()) as f64).sqrt()
}

#[test]
fn a_dense_gas_is_no_crystal() {
    let gas = Gas::<3> {
        count: 500,
        packing_fraction: 0.5,
        ..Gas::default()
    };
    let (grains, lengths) = gas.grains(&mut seeded(3)).unwrap();
    let places: Vec<_> = grains.iter().map(|grain| grain.position).collect();
    let edge = lengths[0] / 5.0;
    let mut crystal = Vec::new();
    for code in 0..125 {
        let corner = [code % 5, code / 5 % 5, code / 25].map(f64::from);
        for offset in [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.0],
            [0.5, 0.0, 0.5],
            [0.0, 0.5, 0.5],
        ] {
            crystal.push((Vector::<3>::from(corner) + Vector::<3>::from(offset)) * edge);
        }
    }
    let ordered = bond_order(&crystal, &lengths, 1.35);
    assert!((ordered - 0.574_52).abs() < 1e-5, "{ordered}");
    // Independent bonds would give about 1/√2000 = 0.02.
    let found = bond_order(&places, &lengths, 1.35);
    assert!(found < 0.06, "{found}");
}

#[test]
fn impossible_gases_are_refused() {
    let refuse = |change: fn(&mut Gas<3>)| {
        let mut gas = Gas::<3> {
            count: 200,
            ..Gas::default()
        };
        change(&mut gas);
        gas.grains(&mut seeded(1)).unwrap_err()
    };
    let jammed = refuse(|gas| gas.packing_fraction = 0.72);
    let SetupError::Parameter { field, allowed, .. } = jammed else {
        panic!("{jammed}");
    };
    assert!(field == "packing_fraction" && allowed.contains("jam"));
    let tiny = refuse(|gas| gas.count = 3);
    assert!(matches!(tiny, SetupError::PeriodTooShort { .. }), "{tiny}");
    let alone = refuse(|gas| gas.count = 1);
    assert!(matches!(
        alone,
        SetupError::Parameter { field: "count", .. }
    ));
    let cold = refuse(|gas| gas.temperature = -1.0);
    assert!(matches!(
        cold,
        SetupError::Parameter {
            field: "temperature",
            ..
        }
    ));
    let flat = refuse(|gas| gas.aspect[1] = 0.0);
    assert!(matches!(
        flat,
        SetupError::Parameter {
            field: "aspect",
            ..
        }
    ));
    let sizes = refuse(|gas| gas.sizes = Sizes::Equal { diameter: -1.0 });
    assert!(matches!(
        sizes,
        SetupError::Parameter {
            field: "diameter",
            ..
        }
    ));
}
