//! Contacts of pairs against an independent algorithm in double-double, the
//! derivative chain, and against exact integers.

mod certified;
mod chain;
mod exact;
mod inputs;
mod judge;
mod search;

use crate::chain::{Reference, Wide, wide};
use crate::inputs::{KINDS, input, magnitude, parabolas, straight, uniform};
use grainfall::Vector;
use grainfall::model::{Approach, Forecast, PolynomialFlight, Predictor};
use grainfall::predict::{Descent, GapPolynomial, Polynomial, Real, Relative, first_contact};
use proptest::prelude::*;
use proptest::test_runner::Config;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// In units of [`GapPolynomial::rounding`], 4u times the size of what f is made of.
const TOLERANCE: f64 = 2.0;

/// Panics if `answer` misses a contact deeper, or reports one with a gap wider,
/// than rounding.
fn check<const D: usize>(relative: &Relative<D>, touching: bool, answer: Option<f64>) {
    let reference = Reference::new(relative, touching);
    let gap = GapPolynomial::<f64>::new(relative);
    let tolerance = |t: f64| wide(TOLERANCE * gap.rounding(t));
    let context = || {
        format!(
            "{relative:?} touching {touching}: answer {answer:?}, reference {:?}",
            reference.contact
        )
    };
    match (answer, reference.contact) {
        (None, None) => {}
        (answer, Some(contact)) if answer.is_none_or(|t| wide(t) >= contact) => {
            let depth = reference.f.value(contact) - reference.lowest(contact, answer.map(wide));
            let until = answer.unwrap_or(contact.to_f64());
            assert!(
                depth <= tolerance(until),
                "missed by {depth:?}: {}",
                context()
            );
        }
        (Some(t), _) => {
            // Earlier than the reference: within rounding of zero, and not opening
            // by more than rounding allows at a graze.
            let at = wide(t);
            let value = reference.f.value(at);
            assert!(value <= tolerance(t), "false by {value:?}: {}", context());
            let slope = reference.f.derivative().value(at).to_f64();
            let bend = gap.half_curvature(t).abs() + gap.motion_scale;
            let limit = (4.0 * tolerance(t).to_f64() * bend).sqrt();
            assert!(slope <= limit, "opening by {slope}: {}", context());
        }
        (None, Some(_)) => unreachable!(),
    }
}

fn contact<const D: usize, F: PolynomialFlight<D>>(approach: &Approach<D, F>) -> Option<f64> {
    match Polynomial.pair(approach) {
        Forecast::Never => None,
        Forecast::Contact(time) => {
            assert!((0.0..f64::INFINITY).contains(&time), "{time}");
            Some(time)
        }
        Forecast::AskAgain(_) => panic!("a pair can always be settled"),
    }
}

fn all_about<const D: usize>(kind: usize, seed: u64) {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let (relative, touching) = input::<D>(kind, rng);
    let approach = parabolas(&relative, touching, f64::INFINITY);
    let answer = contact(&approach);
    check(&relative, touching, answer);

    // The horizon changes no bits, and hides no contact within it.
    let mut horizons = vec![magnitude(rng, -6.0, 3.0), 1.0];
    if let Some(time) = answer {
        let before = contact(&Approach {
            horizon: time.next_down().max(0.0),
            ..approach
        });
        assert!(before.is_none_or(|t| t.to_bits() == time.to_bits()));
        horizons.extend([time, time.next_up(), 2.0 * time, time * 1.001, time * 100.0]);
    }
    for horizon in horizons {
        let within = contact(&Approach {
            horizon,
            ..approach
        });
        match (within, answer) {
            (Some(t), Some(time)) => assert_eq!(t.to_bits(), time.to_bits()),
            (None, Some(time)) => assert!(time > horizon, "{relative:?} lost {time} in {horizon}"),
            (Some(_), None) => panic!("{relative:?}: found only within {horizon}"),
            (None, None) => {}
        }
    }

    // Nor does it matter who is called the first.
    let shift = Vector::<D>::from_fn(|_, _| uniform(rng, -10.0, 10.0));
    let shifted = Approach { shift, ..approach };
    let swapped = Approach {
        first: shifted.second,
        second: shifted.first,
        shift: -shift,
        ..shifted
    };
    assert_eq!(contact(&shifted), contact(&swapped));

    // Flights that cannot accelerate go another way to the same bits.
    if relative.acceleration == Vector::<D>::zeros() {
        assert_eq!(contact(&straight(&approach)), answer);
    }
}

proptest! {
    #![proptest_config(Config { cases: 60_000, failure_persistence: None, ..Config::default() })]

    #[test]
    fn contacts_agree_with_the_derivative_chain(kind in 0..KINDS, seed: u64) {
        all_about::<3>(kind, seed);
    }

    #[test]
    fn so_they_do_in_two_dimensions(kind in 0..KINDS, seed: u64) {
        all_about::<2>(kind, seed);
    }
}

proptest! {
    #![proptest_config(Config { cases: 4000, failure_persistence: None, ..Config::default() })]

    /// The same lines in double-double find the same contact.
    #[test]
    fn the_wide_solver_is_as_good_as_its_arithmetic(kind in 0..KINDS, seed: u64) {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let (relative, touching) = input::<3>(kind, rng);
        let reference = Reference::new(&relative, touching);
        let found = first_contact::<Wide, 3>(&relative, touching, f64::INFINITY);
        match (found, reference.contact) {
            (Descent::At(t), Some(contact)) => {
                // The same gap to 1e-29, and the same one of its zeros.
                let error = (reference.f.value(t) - reference.f.value(contact)).abs();
                let limit = GapPolynomial::<Wide>::new(&relative).rounding(t).times(2.0);
                prop_assert!(error <= limit, "{error:?} > {limit:?}: {relative:?}");
                let apart = (t - contact).abs().to_f64();
                prop_assert!(apart <= 1.0e-11 * (1.0 + contact.to_f64()), "{apart}: {relative:?}");
            }
            (Descent::Never, None) => {}
            other => prop_assert!(false, "{other:?} of {relative:?}, touching {touching}"),
        }
    }
}
