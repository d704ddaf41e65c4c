//! Pairs, contacts and fabric of crystals, gases and single grains.

use std::f64::consts::SQRT_2;

use grainfall::analysis::{
    Bins, Container, ball_volume, contacts, coordination, fabric, radial_distribution,
};
use grainfall::setup::seeded;
use grainfall::{Particle, Vector};
use rand::RngExt;

use crate::{fcc, near};

/// Neighbours of a grain in each bin, from g(r).
fn neighbours<const D: usize>(
    grains: &[Particle<D>],
    container: &Container<D>,
    bins: &Bins,
) -> Vec<f64> {
    let found = radial_distribution(grains, container, [None; D], bins).unwrap();
    let shell =
        |bin: usize| ball_volume::<D>(bins.edge(bin + 1)) - ball_volume::<D>(bins.edge(bin));
    let values = found.values.iter().enumerate();
    values
        .map(|(bin, g)| g * found.density * shell(bin))
        .collect()
}

#[test]
fn shells_of_a_face_centred_cubic_crystal() {
    // 12 neighbours at 1, 6 at √2, 24 at √3, 12 at 2: one shell a bin.
    let known = [0.0, 12.0, 6.0, 24.0, 12.0];
    for periodic in [true, false] {
        let (grains, container) = fcc(6, periodic);
        let edges = [0.9, 1.2, 1.6, 1.9, 2.2];
        let mut from = 0.0;
        for (to, known) in edges.into_iter().zip(known) {
            let bins = Bins::new(from, to, 1).unwrap();
            near(neighbours(&grains, &container, &bins)[0], known, 1.0e-12);
            from = to;
        }
    }
}

#[test]
fn a_square_lattice_has_four_neighbours_and_four_more() {
    let grains: Vec<Particle<2>> = (0..100)
        .map(|i| Particle::fixed(Vector::<2>::new(f64::from(i % 10), f64::from(i / 10))))
        .collect();
    let container = Container::new(Vector::zeros(), Vector::repeat(10.0), [true; 2]).unwrap();
    let bins = Bins::new(0.5, 1.7, 2).unwrap();
    let found = neighbours(&grains, &container, &bins);
    near(found[0], 4.0, 1.0e-12);
    near(found[1], 4.0, 1.0e-12);
}

#[test]
fn an_ideal_gas_has_no_order() {
    let mut random = seeded(3);
    let grains: Vec<Particle<3>> = (0..4000)
        .map(|_| Particle::fixed(Vector::from_fn(|_, _| 10.0 * random.random::<f64>())))
        .collect();
    for periodic in [[true; 3], [true, false, true], [false; 3]] {
        let container = Container::new(Vector::zeros(), Vector::repeat(10.0), periodic).unwrap();
        let bins = Bins::new(0.5, 2.5, 10).unwrap();
        let found = radial_distribution(&grains, &container, [None; 3], &bins).unwrap();
        for (bin, g) in found.values.iter().enumerate() {
            // Pairs are counted from both ends where both are inside.
            let shell = ball_volume::<3>(bins.edge(bin + 1)) - ball_volume::<3>(bins.edge(bin));
            let pairs = 0.5 * found.centres as f64 * found.density * shell;
            let density_error = 1.0 / (found.centres as f64).sqrt();
            near(*g, 1.0, 4.5 / pairs.sqrt() + 4.0 * density_error);
        }
    }
}

#[test]
fn distances_beyond_what_is_known_are_refused() {
    let (grains, container) = fcc(3, true);
    let bins = Bins::new(0.0, 2.2, 10).unwrap();
    let error = radial_distribution(&grains, &container, [None; 3], &bins).unwrap_err();
    assert!(
        error.to_string().contains("half of the shortest period"),
        "{error}"
    );
    let (grains, container) = fcc(3, false);
    let error = radial_distribution(&grains, &container, [None; 3], &bins).unwrap_err();
    assert!(error.to_string().contains("half of the extent"), "{error}");
}

#[test]
fn twelve_touch_each_sphere_of_a_close_packing() {
    let (mut grains, container) = fcc(4, true);
    let counted = vec![true; grains.len()];
    let touching = contacts(&grains, &container, 1.0e-9).unwrap();
    assert_eq!(touching.len(), 6 * grains.len());
    let found = coordination(&touching, &counted, 1.0e-9, 4);
    assert_eq!(
        (found.mean, found.rattlers, found.mean_without_rattlers),
        (12.0, 0, 12.0)
    );
    let isotropic = fabric(&touching).unwrap();
    near(isotropic.anisotropy, 0.0, 1.0e-14);
    near(isotropic.tensor.trace(), 1.0, 1.0e-14);
    // Spheres that are smaller by ε leave gaps of ε.
    for grain in &mut grains {
        grain.diameter -= 1.0e-4;
    }
    assert_eq!(contacts(&grains, &container, 0.99e-4).unwrap().len(), 0);
    let near_contacts = contacts(&grains, &container, 1.01e-4).unwrap();
    assert_eq!(near_contacts.len(), touching.len());
    assert_eq!(coordination(&near_contacts, &counted, 0.99e-4, 4).mean, 0.0);
    // The next neighbours are √2 away.
    assert_eq!(
        contacts(&grains, &container, SQRT_2 - 0.9).unwrap().len(),
        9 * grains.len()
    );
}

#[test]
fn rattlers_take_others_with_them() {
    // Disks: two fixed ones carry a third, on which a fourth stands alone; a
    // fifth flies.
    let up = 0.75_f64.sqrt();
    let places = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.5, up],
        [0.5, up + 1.0],
        [4.0, 4.0],
    ];
    let mut grains = places.map(|place| Particle::frozen(Vector::<2>::from(place)));
    grains[0] = Particle::fixed(grains[0].position);
    grains[1] = Particle::fixed(grains[1].position);
    let counted = [false, false, true, true, true];
    let container = Container::new(Vector::zeros(), Vector::repeat(9.0), [false; 2]).unwrap();
    let touching = contacts(&grains, &container, 1.0e-9).unwrap();
    // The two fixed ones touch each other as well.
    assert_eq!(touching.len(), 4);
    let found = coordination(&touching, &counted, 1.0e-9, 2);
    assert_eq!((found.grains, found.rattlers), (3, 2));
    near(found.mean, 4.0 / 3.0, 1.0e-15);
    assert_eq!(found.mean_without_rattlers, 2.0);
    // Without the one on top, the middle one has two contacts left: fewer than
    // three.
    let found = coordination(&touching, &counted, 1.0e-9, 3);
    assert_eq!(found.rattlers, 3);
    assert!(found.mean_without_rattlers.is_nan());
}

#[test]
fn a_pillar_has_a_vertical_fabric() {
    let grains: Vec<Particle<3>> = (0..5)
        .map(|z| Particle::frozen(Vector::<3>::new(0.0, 0.0, f64::from(z))))
        .collect();
    let container = Container::new(Vector::zeros(), Vector::repeat(9.0), [false; 3]).unwrap();
    let touching = contacts(&grains, &container, 1.0e-9).unwrap();
    let found = fabric(&touching).unwrap();
    near(found.anisotropy, 1.0, 1.0e-15);
    assert_eq!(found.tensor[(2, 2)], 1.0);
    assert_eq!(found.principal, Vector::<3>::new(0.0, 0.0, 1.0));
    assert_eq!(found.eigenvalues, Vector::<3>::new(1.0, 0.0, 0.0));
    assert!(fabric::<3>(&[]).is_none());
}

#[test]
fn a_stretched_lattice_has_the_fabric_of_its_bonds() {
    // Disks in rows: bonds at 0°, ±60°; without the horizontal ones F is
    // diagonal with cos² 60° and sin² 60°.
    let bonds = [60.0_f64, 120.0].map(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        [Vector::<2>::zeros(), Vector::<2>::new(cos, sin)]
    });
    let container = Container::new(Vector::zeros(), Vector::repeat(9.0), [false; 2]).unwrap();
    let all: Vec<_> = bonds
        .iter()
        .flat_map(|ends| {
            let grains = ends.map(Particle::frozen);
            contacts(&grains, &container, 1.0e-9).unwrap()
        })
        .collect();
    let found = fabric(&all).unwrap();
    near(found.tensor[(0, 0)], 0.25, 1.0e-15);
    near(found.tensor[(1, 1)], 0.75, 1.0e-15);
    near(found.tensor[(0, 1)], 0.0, 1.0e-15);
    // √2 ‖F − I/2‖ = √2 · √(2/16).
    near(found.anisotropy, 0.5, 1.0e-15);
    near(found.principal[1], 1.0, 1.0e-12);
}
