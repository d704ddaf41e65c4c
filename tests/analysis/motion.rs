//! Velocities, temperatures and displacements.

use grainfall::analysis::{Bins, Container, Paths, Probe, Profile, binned_motion, blocked_mean};
use grainfall::setup::seeded;
use grainfall::{Particle, Time, Vector};
use rand::RngExt;

use crate::near;

/// Grains in uniform shear v_x = γ z, 20 a unit of height, evenly.
fn shear(rate: f64) -> Vec<Particle<3>> {
    (0..200)
        .map(|i| 0.05 * (f64::from(i) + 0.5))
        .map(|z| {
            let place = Vector::<3>::new(0.0, 0.0, z);
            Particle::new(place, Vector::<3>::new(rate * z, 0.0, -1.0))
        })
        .collect()
}

#[test]
fn uniform_shear_has_a_linear_profile() {
    let (rate, width) = (0.3, 2.0);
    let probe = Probe::<3>::new(2, Bins::new(0.0, 10.0, 5).unwrap()).unwrap();
    let found = binned_motion(&shear(rate), &probe, |_| Vector::zeros(), |_| true);
    assert_eq!(found.counts, [40; 5]);
    for (bin, velocity) in found.velocities.iter().enumerate() {
        near(velocity[0], rate * probe.bins.centre(bin), 1.0e-13);
        assert_eq!((velocity[1], velocity[2]), (0.0, -1.0));
        // What is left in a bin is its gradient: γ² w² (1 − 1/n²)/12 is the mean
        // square of n evenly spaced values.
        let spread = (rate * width).powi(2) * (1.0 - 1.0 / 1600.0) / 12.0;
        near(found.temperatures[bin], spread * 40.0 / 39.0 / 3.0, 1.0e-13);
    }
    // In a frame that is sheared as well, nothing moves.
    let ground = |grain: &Particle<3>| Vector::<3>::new(rate * grain.position[2], 0.0, -1.0);
    let still = binned_motion(&shear(rate), &probe, ground, |_| true);
    assert!(
        still
            .velocities
            .iter()
            .all(|velocity| velocity.norm_squared() == 0.0)
    );
    assert!(
        still
            .temperatures
            .iter()
            .all(|temperature| *temperature == 0.0)
    );
}

#[test]
fn only_the_slab_counts() {
    let grains = shear(1.0);
    let bins = Bins::new(-1.0, 1.0, 1).unwrap();
    let probe = Probe::<3>::new(0, bins)
        .unwrap()
        .within(2, 3.0, 5.0)
        .unwrap();
    let found = binned_motion(&grains, &probe, |_| Vector::zeros(), |_| true);
    assert_eq!(found.counts, [40]);
    near(found.velocities[0][0], 4.0, 1.0e-13);
    let none = binned_motion(&grains, &probe, |_| Vector::zeros(), |_| false);
    assert!(none.counts == [0] && none.velocities[0][0].is_nan() && none.temperatures[0].is_nan());
    assert!(Probe::<3>::new(3, bins).is_err());
    assert!(
        Probe::<3>::new(0, bins)
            .unwrap()
            .within(3, 0.0, 1.0)
            .is_err()
    );
}

#[test]
fn two_grains_a_bin_have_the_right_temperature_on_the_average() {
    // Velocity components uniform in ±√(3T/m): a variance of T/m. The bias of
    // the mean would make it half as much for two grains.
    let (bins, temperature) = (20_000, 0.7);
    let mut random = seeded(11);
    let mut grains = Vec::new();
    for bin in 0..bins {
        for mass in [1.0, 3.0_f64] {
            let reach = (3.0 * temperature / mass).sqrt();
            let velocity =
                Vector::<2>::from_fn(|_, _| 5.0 + reach * (2.0 * random.random::<f64>() - 1.0));
            let place = Vector::<2>::new(bin as f64 + 0.5, 0.0);
            grains.push(Particle::new(place, velocity).with_mass(mass));
        }
    }
    let probe = Probe::<2>::new(0, Bins::new(0.0, bins as f64, bins).unwrap()).unwrap();
    let found = binned_motion(&grains, &probe, |_| Vector::zeros(), |_| true);
    let mean = blocked_mean(&found.temperatures);
    assert!(mean.error < 0.01 * temperature);
    near(mean.value, temperature, 4.0 * mean.error);
}

#[test]
fn profiles_are_means_over_frames() {
    let bins = Bins::new(0.0, 2.0, 2).unwrap();
    let frames: [&[f64]; 3] = [&[1.0, f64::NAN], &[2.0, 5.0], &[3.0, f64::NAN]];
    let found = Profile::of_frames(&bins, frames);
    assert_eq!((found.means[0].value, found.means[0].count), (2.0, 3));
    near(found.means[0].error, (1.0 / 3.0_f64).sqrt(), 1.0e-15);
    assert_eq!((found.means[1].value, found.means[1].count), (5.0, 1));
    assert_eq!(found.points(), [[0.5, 2.0], [1.5, 5.0]]);
}

/// Grains that fly straight through a periodic square of length 4, seen at these
/// times.
fn flights(times: &[f64]) -> Paths<2> {
    let container = Container::new(Vector::zeros(), Vector::repeat(4.0), [true, false]).unwrap();
    let mut paths = Paths::new(container);
    let velocities = [[1.5, 0.0], [-0.5, 2.0], [0.0, 0.0]];
    for &time in times {
        let grains = velocities.map(|velocity| {
            let way = Vector::<2>::from(velocity) * time;
            let place = Vector::<2>::new((1.0 + way[0]).rem_euclid(4.0), way[1]);
            Particle::new(place, Vector::from(velocity))
        });
        paths.push(Time::from_units(time), &grains).unwrap();
    }
    paths
}

#[test]
fn free_flight_comes_as_far_as_it_should() {
    let paths = flights(&[0.0, 1.0, 2.0, 3.0, 4.0]);
    let way = paths.displacement(4, 0).unwrap();
    near(way[0], 6.0, 1.0e-12);
    near(paths.longest_step(), 1.5 / 4.0, 1.0e-12);
    let curve = paths.mean_square(|grain| grain != 2);
    assert_eq!(curve.len(), 4);
    for (point, lapse) in curve.iter().zip([1.0, 2.0, 3.0, 4.0]) {
        assert_eq!((point.lapse, point.origins), (lapse, 5 - lapse as usize));
        // ⟨v²⟩ = (2.25 + 4.25)/2.
        near(point.value, 3.25 * lapse * lapse, 1.0e-11);
    }
    // Frames that are not equally far apart: from the first alone.
    let uneven = flights(&[1.0, 1.5, 2.75]).mean_square(|grain| grain == 0);
    assert!(uneven.iter().all(|point| point.origins == 1));
    near(uneven[1].value, 2.25 * 1.75 * 1.75, 1.0e-11);
}

#[test]
fn frames_with_other_grains_are_refused() {
    let mut paths = flights(&[0.0, 1.0]);
    let error = paths.push(Time::from_units(2.0), &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "frame 2 has 0 grains, the first has 3; a displacement needs the same ones"
    );
}
