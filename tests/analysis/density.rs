//! Profiles, maps and free surfaces.

use std::f64::consts::{PI, SQRT_2};

use grainfall::analysis::{
    Bins, Container, ball_volume, fraction_map, fraction_profile, line_fit, slab_fraction,
    surface_of_grains, surface_of_map,
};
use grainfall::{Particle, Vector};
use proptest::prelude::*;

use crate::{fcc, near};

#[test]
fn a_crystal_is_equally_dense_in_every_period() {
    let (grains, container) = fcc(4, true);
    let close = PI / (3.0 * SQRT_2);
    let length = 4.0 * SQRT_2;
    for axis in 0..3 {
        // Bins of one period of the stacking; the lattice repeats after √2.
        let bins = Bins::new(0.3, 0.3 + length, 4).unwrap();
        for found in fraction_profile(&grains, &container, axis, &bins).unwrap() {
            near(found, close, 1.0e-13);
        }
    }
    for axes in [[0, 2], [2, 0], [1, 2], [0, 1]] {
        let across = Bins::new(-1.0, length - 1.0, 4).unwrap();
        let up = Bins::new(0.2, 0.2 + 2.0 * SQRT_2, 2).unwrap();
        let found = fraction_map(&grains, &container, axes, &across, &up).unwrap();
        assert_eq!(found.len(), 8);
        for found in found {
            near(found, close, 1.0e-12);
        }
    }
}

#[test]
fn the_profile_is_that_of_single_slabs() {
    let (grains, container) = fcc(3, false);
    let bins = Bins::new(-1.0, 4.0, 13).unwrap();
    let profile = fraction_profile(&grains, &container, 2, &bins).unwrap();
    let area = container.cross_section(2);
    for (bin, found) in profile.iter().enumerate() {
        let known = slab_fraction(&grains, area, bins.edge(bin), bins.edge(bin + 1));
        near(*found, known, 1.0e-14);
    }
}

#[test]
fn axes_that_are_not_there_are_refused() {
    let (grains, container) = fcc(2, true);
    let bins = Bins::new(0.0, 1.0, 2).unwrap();
    let error = fraction_profile(&grains, &container, 3, &bins).unwrap_err();
    assert!(error.to_string().contains("axis 3"), "{error}");
    assert!(fraction_map(&grains, &container, [0, 3], &bins, &bins).is_err());
    assert!(fraction_map(&grains, &container, [1, 1], &bins, &bins).is_err());
}

/// Volumes in all slabs, and in all columns, of one ball anywhere.
fn parts<const D: usize>(
    place: [f64; D],
    diameter: f64,
    periodic: [bool; D],
    counts: [usize; 2],
) -> (f64, f64) {
    let lengths = Vector::<D>::from_fn(|axis, _| 3.0 + axis as f64);
    let container = Container::new(Vector::repeat(-1.5), lengths, periodic).unwrap();
    let mut ball = Particle::fixed(Vector::from(place)).with_diameter(diameter);
    let bins = [0, D - 1].map(|axis| {
        let (low, high) = container.faces(axis);
        if !periodic[axis] {
            // Wholly inside.
            let (low, high) = (low + ball.radius(), high - ball.radius());
            ball.position[axis] = ball.position[axis].clamp(low, high);
        }
        Bins::new(low, high, counts[usize::from(axis > 0)]).unwrap()
    });
    let slabs = fraction_profile(&[ball], &container, D - 1, &bins[1]).unwrap();
    let slab = bins[1].width() * container.cross_section(D - 1);
    let columns = fraction_map(&[ball], &container, [0, D - 1], &bins[0], &bins[1]).unwrap();
    let depth = if D == 3 { lengths[1] } else { 1.0 };
    let column = bins[0].width() * bins[1].width() * depth;
    (
        slabs.iter().sum::<f64>() * slab,
        columns.iter().sum::<f64>() * column,
    )
}

proptest! {
    #[test]
    fn the_parts_of_a_ball_are_the_whole(
        place in prop::array::uniform3(-9.0..9.0f64),
        diameter in 0.1..2.9f64,
        periodic in any::<[bool; 3]>(),
        counts in prop::array::uniform2(1usize..40),
    ) {
        let (slabs, columns) = parts::<3>(place, diameter, periodic, counts);
        let whole = ball_volume::<3>(0.5 * diameter);
        prop_assert!((slabs - whole).abs() < 1.0e-12, "{} {}", slabs, whole);
        prop_assert!((columns - whole).abs() < 1.0e-12, "{} {}", columns, whole);
        let flat = [place[0], place[2]];
        let (slabs, columns) = parts::<2>(flat, diameter, [periodic[0], periodic[2]], counts);
        let whole = ball_volume::<2>(0.5 * diameter);
        prop_assert!((slabs - whole).abs() < 1.0e-12, "{} {}", slabs, whole);
        prop_assert!((columns - whole).abs() < 1.0e-12, "{} {}", columns, whole);
    }
}

#[test]
fn a_slope_of_grains_has_its_angle() {
    // Disks in a row that rises by 30°, and one that flies above.
    let slope = (PI / 6.0).tan();
    let mut grains: Vec<Particle<2>> = (0..40)
        .map(|i| 0.5 * f64::from(i) + 0.25)
        .map(|x| Particle::frozen(Vector::<2>::new(x, 2.0 + slope * x)))
        .collect();
    grains.push(Particle::new(
        Vector::<2>::new(3.0, 30.0),
        Vector::<2>::zeros(),
    ));
    let bins = Bins::new(0.0, 20.0, 40).unwrap();
    let surface = surface_of_grains(&grains, 0, 1, &bins, |grain| grain.mode.is_static()).unwrap();
    let fit = line_fit(&surface, None).unwrap();
    near(fit.angle().0, 30.0, 1.0e-10);
    near(fit.intercept, 2.5, 1.0e-12);
    assert!(fit.angle().1 < 1.0e-10);
}

#[test]
fn a_map_that_fades_has_the_surface_where_it_fades() {
    // φ falls linearly from 0.6 at the line y = 3 + x/4 to 0 one unit above.
    let across = Bins::new(0.0, 8.0, 32).unwrap();
    let up = Bins::new(0.0, 8.0, 64).unwrap();
    let mut values = Vec::new();
    for y in up.centres() {
        for x in across.centres() {
            values.push((0.6 * (1.0 - (y - 3.0 - 0.25 * x))).clamp(0.0, 0.6));
        }
    }
    let surface = surface_of_map(&values, &across, &up, 0.3).unwrap();
    for [x, height] in &surface {
        near(*height, 3.5 + 0.25 * x, 1.0e-12);
    }
    near(line_fit(&surface, None).unwrap().slope, 0.25, 1.0e-12);
    // Nowhere reached; everywhere reached, up to the highest cell.
    let nothing = surface_of_map(&values, &across, &up, 0.7).unwrap();
    assert!(nothing.iter().all(|point| point[1].is_nan()));
    let full = surface_of_map(&vec![0.6; values.len()], &across, &up, 0.3).unwrap();
    assert!(full.iter().all(|point| point[1].is_nan()));
    assert!(surface_of_map(&values[1..], &across, &up, 0.3).is_err());
}
