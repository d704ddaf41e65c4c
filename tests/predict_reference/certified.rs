//! Answers of the predictor against exact integers.

use crate::exact::Exact;
use crate::inputs::{MORE_KINDS, across, direction, magnitude, nasty, straight, uniform};
use crate::judge::{Case, Tally, check, judge};
use grainfall::boundary::Plane;
use grainfall::dynamics::Parabola;
use grainfall::model::{Encounter, Forecast, Predictor};
use grainfall::predict::{Polynomial, Relative};
use grainfall::{Time, Vector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Pairs of one kind, from the generator's stream of that number.
pub(crate) fn pairs<const D: usize>(kind: usize, seed: u64, count: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(kind as u64);
    let mut tally = Tally::default();
    for _ in 0..count {
        let approach = nasty::<D>(kind, &mut rng);
        let horizon = magnitude(&mut rng, -6.0, 3.0);
        let relative = Relative::of(&approach);
        if relative.acceleration == Vector::<D>::zeros() && rng.random() {
            check(&straight(&approach), horizon, &mut tally);
        } else {
            check(&approach, horizon, &mut tally);
        }
    }
    tally
}

/// Flat walls, across an axis or aslant.
pub(crate) fn walls<const D: usize>(seed: u64, count: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut tally = Tally::default();
    let rng = &mut rng;
    for _ in 0..count {
        tally.inputs += 1;
        let mut normal = direction::<D>(rng);
        if rng.random::<f64>() < 0.7 {
            normal = Vector::zeros();
            normal[rng.random_range(0..D)] = if rng.random() { 1.0 } else { -1.0 };
        }
        let offset = uniform(rng, -1.0, 1.0) * magnitude(rng, -1.0, 3.0);
        let radius = uniform(rng, 0.25, 1.0);
        let growth = if rng.random::<f64>() < 0.2 {
            uniform(rng, 0.0, 0.5)
        } else {
            0.0
        };
        let gap = if rng.random() {
            uniform(rng, 0.0, 2.0)
        } else {
            magnitude(rng, -18.0, 1.0)
        };
        let gap = if rng.random::<f64>() < 0.15 {
            -gap
        } else {
            gap
        };
        let mut velocity = direction::<D>(rng) * magnitude(rng, -9.0, 2.0);
        let mut acceleration = direction::<D>(rng);
        match rng.random_range(0..4) {
            0 => acceleration = Vector::zeros(),
            // Away from the wall, turning round at it but for a hair.
            1 => {
                acceleration = normal * uniform(rng, 0.5, 1.5);
                let pull = acceleration.norm();
                let hair = 1.0 + uniform(rng, -4.0, 4.0) * f64::EPSILON;
                velocity -=
                    normal * (velocity.dot(&normal) + (2.0 * gap.abs() * pull).sqrt() * hair);
            }
            2 => acceleration = -normal * magnitude(rng, -3.0, 1.0),
            _ => {}
        }
        let place = across(&normal, rng) * magnitude(rng, -1.0, 3.0);
        let flight = Parabola {
            position: normal * (offset + radius + gap) + place,
            velocity,
            acceleration,
        };
        let wall = Plane {
            normal,
            offset,
            restitution: 1.0,
        };
        let touching = rng.random::<f64>() < 0.2;
        let exact = Exact::plane(&flight, &normal, [offset, radius, growth], touching);
        let scales = [
            flight.position.norm() + offset.abs() + radius,
            velocity.norm() + growth,
            acceleration.norm(),
        ];
        let slope = |t: f64| normal.dot(&(velocity + acceleration * t)) - growth;
        for horizon in [f64::INFINITY, magnitude(rng, -6.0, 3.0)] {
            let encounter = Encounter {
                flight,
                wall: &wall,
                since: Time::ZERO,
                radius,
                growth,
                touching,
                horizon,
            };
            let answer = match Polynomial.wall(&encounter) {
                Forecast::Never => None,
                Forecast::Contact(time) => Some(time),
                Forecast::AskAgain(_) => panic!("a flat wall can always be settled"),
            };
            let case = Case {
                exact: &exact,
                size: |t: f64| {
                    let size = scales[0] + t * (scales[1] + t * scales[2]);
                    [size, slope(t), 0.5 * scales[2]]
                },
                // A gap of lengths, not of squares.
                sigma: 0.5,
                horizon,
                last: 1.0e12,
            };
            judge(&case, answer, &mut tally, &|| {
                format!("{flight:?} {wall:?} {radius} {growth} {touching} {horizon}: {answer:?}")
            });
        }
    }
    tally
}

/// So many of every kind in two and three dimensions, and of walls.
fn all(seed: u64, each: u64) {
    let mut total = Tally::default();
    let show = |name: &str, tally: &Tally| {
        println!(
            "{name:>12} {:>9} contacts {:>9} wide {:>7.3} % ties {:>6} gap {:.2e} ulp(σ), beyond time {:.1e}, late {:.1} ulp(t), wide {:.2}",
            tally.inputs,
            tally.contacts,
            100.0 * tally.wide as f64 / tally.inputs as f64,
            tally.ties,
            tally.gap,
            tally.gap_beyond_time,
            tally.late,
            tally.late_wide
        );
    };
    for kind in 0..MORE_KINDS {
        let mut tally = pairs::<3>(kind, seed, each);
        tally.add(&pairs::<2>(kind, seed, each / 2));
        show(&format!("kind {kind}"), &tally);
        total.add(&tally);
    }
    let mut tally = walls::<3>(seed, each);
    tally.add(&walls::<2>(seed, each));
    show("walls", &tally);
    total.add(&tally);
    show("all", &total);
}

#[test]
fn no_contact_is_missed_in_exact_integers() {
    all(1, 3000);
}

/// cargo test --release --test predict_reference -- --ignored --nocapture
#[test]
#[ignore = "ten million inputs take many minutes"]
fn no_contact_is_missed_in_ten_million() {
    all(2, 450_000);
}
