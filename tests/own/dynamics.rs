//! What holds of `examples/own_dynamics.rs`, of which this is a part.

use super::*;
use grainfall::model::Occurrence;

/// Two opposite charges, side by side: the gap r₀ − σ closes as (a₂ − a₁) t²/2,
/// and the pair falls as one.
fn meet<const D: usize>() {
    let mut places = [Vector::repeat(11.0); 2];
    (places[0][0], places[1][0]) = (2.0, 5.0);
    let grains = places.map(|place| Particle::new(place, Vector::zeros()));
    let dynamics = Charged {
        gravity: along(D - 1, -1.0),
        pulls: vec![along(0, 0.3), along(0, -0.3)],
    };
    let mut pair = in_a_box(dynamics, Polynomial, grains.to_vec()).unwrap();
    let mut first = None;
    pair.run(&Limits::events(1), &mut |event: &Occurrence<D>| {
        first = Some(*event);
    });
    let event = first.unwrap();
    let wanted = (2.0 * 2.0 / 0.6_f64).sqrt();
    assert!((event.time.units() - wanted).abs() < 1.0e-15);
    assert!((event.impact_speed - 0.6 * wanted).abs() < 1.0e-14);
    assert!((event.velocity[D - 1] + wanted).abs() < 1.0e-14);
    // The field's work is charge times way, 0.3 · 1 d for each of the two.
    let ledger = pair.energy_ledger();
    assert!((ledger.field - 0.6).abs() < 1.0e-13, "{ledger:?}");
    assert!(ledger.relative_error().abs() < 1.0e-14);
}

#[test]
fn opposite_charges_meet_when_they_should() {
    meet::<2>();
    meet::<3>();
}

/// v = τ (1 − e^(−t/τ)) and h = τ t − τ v, solved for t by halving.
#[test]
fn a_grain_sinks_as_by_hand() {
    for time in [100.0, 1.0, 0.1] {
        let drag = Drag { time };
        let speed = |t: f64| -time * libm::expm1(-t / time);
        let (mut early, mut late) = (0.0, 1000.0);
        for _ in 0..200 {
            let middle = 0.5 * (early + late);
            if time * middle - time * speed(middle) < 10.0 {
                early = middle;
            } else {
                late = middle;
            }
        }
        let wanted = speed(early);
        assert!((sunk::<2>(drag, 10.0).unwrap() / wanted - 1.0).abs() < 1.0e-13);
        assert!((sunk::<3>(drag, 10.0).unwrap() / wanted - 1.0).abs() < 1.0e-13);
    }
}

fn is_whole<const D: usize>() {
    let mut grains = lattice::<D>();
    // Some to collide with that do not move, and a little bustle.
    for (site, grain) in grains.iter_mut().enumerate() {
        grain.velocity = Vector::from_fn(|axis, _| ((site * 7 + axis * 3) % 11) as f64 - 5.0);
        if site % 5 == 0 {
            *grain = Particle::fixed(grain.position);
        }
    }
    let drag = Drag { time: 1.0 };
    let mut simulation = in_a_box(drag, WithDrag, grains).unwrap();
    for events in 1..=8 {
        simulation.run(&Limits::events(250 * events), &mut ());
        let audit = simulation.audit();
        assert_eq!(audit.missed, []);
        assert!(audit.deepest < 1.0e-12, "{:e}", audit.deepest);
    }
    assert!(
        simulation.max_overlap() < 1.0e-12,
        "{:e}",
        simulation.max_overlap()
    );
    let counts = *simulation.counts();
    assert!(counts.pair > 20 && counts.frozen > 20, "{counts:?}");
    let ledger = simulation.energy_ledger();
    assert!(ledger.relative_error().abs() < 1.0e-12, "{ledger:?}");
}

#[test]
fn nobody_is_missed_and_no_energy_lost_in_a_fluid() {
    is_whole::<2>();
    is_whole::<3>();
}
