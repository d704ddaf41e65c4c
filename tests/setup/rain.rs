//! Rain.

use crate::{BIMODAL, lateral, least_gap, volume};
use grainfall::analysis::{highest_surface, lowest_surface};
use grainfall::setup::{Rain, Sizes, seeded};
use grainfall::{Mode, SetupError, Vector};

// ---------------------------------------------------------------- the rain

#[test]
fn the_papers_rain() {
    let rain = Rain::<3>::default();
    let grains = rain.grains(&mut seeded(1)).unwrap();
    assert_eq!(grains.len(), 4800);
    assert_eq!(lowest_surface(&grains), Some(0.0));
    // 4800 π/6 / (0.0503 · 100) = 499.66.
    let top = highest_surface(&grains).unwrap();
    assert!(top > 497.0 && top < 499.67, "{top}");
    for grain in &grains {
        assert_eq!(grain.velocity, Vector::<3>::new(0.0, 0.0, -2.5));
        assert_eq!(
            (grain.diameter, grain.mass, grain.mode),
            (1.0, 1.0, Mode::Falling)
        );
        for axis in 0..2 {
            assert!((0.0..10.0).contains(&grain.position[axis]));
        }
    }
    assert!(least_gap(&grains, &rain.lengths, lateral(true)) > 0.0);
    // As dense below as above: χ² over 20 slabs has 19 degrees of freedom, and
    // 50 is exceeded once in 7000 times.
    for axis in 0..3 {
        let length = if axis == 2 { top } else { 10.0 };
        let mut slabs = [0.0; 20];
        for grain in &grains {
            slabs[((20.0 * grain.position[axis] / length) as usize).min(19)] += 1.0;
        }
        let chi: f64 = slabs
            .iter()
            .map(|n| (n - 240.0) * (n - 240.0) / 240.0)
            .sum();
        assert!(chi < 50.0, "axis {axis}: {chi}");
    }
}

#[test]
fn a_rain_has_its_density_whatever_the_sizes() {
    fn check<const D: usize>(sizes: Sizes, fraction: f64, periodic: bool) {
        let mut origin = Vector::<D>::repeat(-2.0);
        origin[D - 1] = 3.3;
        let rain = Rain::<D> {
            count: 600,
            sizes,
            packing_fraction: fraction,
            lengths: Vector::repeat(6.0),
            origin,
            periodic: [periodic; D],
            ..Rain::default()
        };
        let grains = rain.grains(&mut seeded(5)).unwrap();
        assert_eq!(grains.len(), 600);
        let bottom = lowest_surface(&grains).unwrap();
        assert!((bottom - 3.3).abs() < 1e-15);
        assert!(least_gap(&grains, &rain.lengths, lateral(periodic)) > 0.0);
        let area = 6.0_f64.powi(D as i32 - 1);
        let height = highest_surface(&grains).unwrap() - bottom;
        let found = volume(&grains) / (area * height);
        // A hair denser than asked for, since the column is cut to its grains.
        assert!(found >= fraction && found < 1.05 * fraction, "{found}");
        for grain in &grains {
            let mass = grain.diameter.powi(D as i32);
            assert!((grain.mass / mass - 1.0).abs() < 1e-15);
            for axis in 0..D - 1 {
                let inset = if periodic { 0.0 } else { grain.radius() };
                assert!(grain.position[axis] >= -2.0 + inset);
                assert!(grain.position[axis] <= 4.0 - inset);
            }
        }
    }
    for periodic in [true, false] {
        check::<3>(Sizes::default(), 0.2, periodic);
        check::<3>(BIMODAL, 0.15, periodic);
        check::<3>(
            Sizes::LogNormal {
                median: 0.8,
                spread: 0.2,
            },
            0.1,
            periodic,
        );
        check::<2>(BIMODAL, 0.35, periodic);
        check::<2>(
            Sizes::Uniform {
                least: 0.3,
                most: 2.0,
            },
            0.1,
            periodic,
        );
    }
}

#[test]
fn impossible_rains_are_refused() {
    let refuse = |change: fn(&mut Rain<3>)| {
        let mut rain = Rain::<3> {
            count: 500,
            ..Rain::default()
        };
        change(&mut rain);
        rain.grains(&mut seeded(1)).unwrap_err()
    };
    let narrow = refuse(|rain| rain.lengths[0] = 1.9);
    assert!(
        matches!(narrow, SetupError::PeriodTooShort { axis: 0, .. }),
        "{narrow}"
    );
    let polydisperse = refuse(|rain| {
        rain.sizes = BIMODAL;
        rain.lengths[1] = 2.7;
    });
    assert!(matches!(
        polydisperse,
        SetupError::PeriodTooShort { axis: 1, .. }
    ));
    let walls = refuse(|rain| {
        rain.periodic[0] = false;
        rain.lengths[0] = 0.9;
    });
    assert!(matches!(
        walls,
        SetupError::Parameter {
            field: "length",
            ..
        }
    ));
    let dense = refuse(|rain| rain.packing_fraction = 0.5);
    assert!(
        matches!(dense, SetupError::NoRoom { wanted: 500, .. }),
        "{dense}"
    );
    let slow = refuse(|rain| rain.fall_speed = 0.0);
    assert!(matches!(
        slow,
        SetupError::Parameter {
            field: "fall_speed",
            ..
        }
    ));
    let nowhere = refuse(|rain| rain.origin[2] = f64::NAN);
    assert!(matches!(
        nowhere,
        SetupError::Parameter {
            field: "origin",
            ..
        }
    ));
}
