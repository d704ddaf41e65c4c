//! What observers add up on the way.

use crate::common::{close, free, heavy, periodic_laterally, rain_on_base, rule, until};
use grainfall::boundary::Side;
use grainfall::collide::Restitution;
use grainfall::engine::{Guards, Settings, Simulation};
use grainfall::observe::{CollisionalTransfer, Displacements};
use grainfall::policy::{Never, SlowDescent};
use grainfall::setup::Sizes;
use grainfall::{Particle, Time, Vector};

#[test]
fn transfer_is_distance_times_momentum() {
    // Diameters 1 and 2, masses 1 and 8, elastic: 1.5 times 2 · 8/9 · 2.5.
    let grains = vec![
        Particle::new(Vector::<3>::new(19.5, 7.0, 3.0), Vector::<3>::x() * 2.0),
        Particle::new(Vector::<3>::new(2.0, 7.0, 3.0), Vector::<3>::x() * -0.5)
            .with_diameter(2.0)
            .with_mass(8.0),
    ];
    let energy: f64 = grains.iter().map(Particle::kinetic_energy).sum();
    let model = free(Restitution::elastic(), [Side::periodic(20.0); 3]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let mut transfer = CollisionalTransfer::new(Time::ZERO);
    simulation.run(&until(2.0), &mut transfer);
    assert_eq!(transfer.collisions(), 1);
    let virial = 1.5 * 2.0 * 8.0 / 9.0 * 2.5;
    close(transfer.virial(), virial, 1.0e-14, "virial");
    let pressure = (2.0 * energy + 0.5 * virial) / (3.0 * 8000.0);
    let found = transfer.pressure::<3>(simulation.time(), energy, 8000.0);
    close(found / pressure, 1.0, 1.0e-14, "pressure");
}

#[test]
fn displacements_go_on_through_periodic_faces() {
    let grains = vec![
        Particle::new(Vector::<2>::new(1.0, 7.0), Vector::<2>::new(3.0, -1.0)),
        Particle::new(Vector::<2>::new(1.0, 3.0), Vector::<2>::new(-2.0, 0.0)),
    ];
    let model = heavy(
        rule(0.0),
        Never,
        [Side::periodic(5.0), Side::floor(0.0, 0.8)],
    );
    let mut simulation = Simulation::new(model, grains.clone()).unwrap();
    let mut displacements = Displacements::new(Time::ZERO, &grains);
    simulation.run(&until(1.0), &mut displacements);
    // Nothing but gravity so far.
    let found = displacements.at(simulation.time(), &simulation.snapshot());
    let wanted = [Vector::<2>::new(3.0, -1.5), Vector::<2>::new(-2.0, -0.5)];
    for (found, wanted) in found.iter().zip(&wanted) {
        close((found - wanted).norm(), 0.0, 1.0e-14, "free fall");
    }
}

#[test]
fn displacements_lead_from_start_to_end_whatever_happens() {
    // Falling grains, hits, sleep and wake.
    let width = 5.0;
    let grains = rain_on_base::<3>(3, 60, width, Sizes::default());
    let policy = SlowDescent::default();
    let model = heavy(rule(1.0e-3), policy, periodic_laterally(width));
    let settings = Settings {
        guards: Guards::none(),
        ..Settings::default()
    };
    let mut simulation = Simulation::with_settings(model, grains, settings).unwrap();
    let start = simulation.snapshot();
    let mut displacements = Displacements::new(simulation.time(), &start);
    simulation.run(&until(12.0), &mut displacements);
    assert!(simulation.counts().sleep > 20 && simulation.counts().wake > 0);
    let end = simulation.snapshot();
    let found = displacements.at(simulation.time(), &end);
    let mut crossed = 0;
    for ((from, to), found) in start.iter().zip(&end).zip(&found) {
        let direct = to.position - from.position;
        close(found[2], direct[2], 1.0e-9, "height");
        for axis in 0..2 {
            let periods = (found[axis] - direct[axis]) / width;
            close(periods, periods.round(), 1.0e-9, "whole periods");
            crossed += usize::from(periods.round() != 0.0);
        }
    }
    assert!(crossed > 0, "nothing has crossed a face");
}
