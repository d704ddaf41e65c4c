//! The search itself, before anything is refined.

use crate::exact::{Exact, Verdict};
use crate::inputs::magnitude;
use grainfall::predict::{Descent, GapPolynomial, quartic_descent};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A quartic that comes down to a double root, or nearly, and then falls at
/// another: what a search loses that takes the sign of rounding for the truth.
fn two_dips(rng: &mut ChaCha8Rng) -> GapPolynomial<f64> {
    let mut times = [0.0; 3].map(|_| magnitude(rng, -2.0, 1.0));
    times.sort_by(f64::total_cmp);
    let [graze, hit, out] = times;
    let lift = match rng.random_range(0..4) {
        0 => 0.0,
        1 => magnitude(rng, -18.0, -12.0),
        2 => -magnitude(rng, -18.0, -12.0),
        _ => magnitude(rng, -12.0, 0.0),
    };
    // ((t − graze)² + lift) (t − hit) (t − out), times something.
    let first = [graze * graze + lift, -2.0 * graze, 1.0];
    let second = [hit * out, -(hit + out), 1.0];
    let mut c = [0.0; 5];
    for (i, a) in first.iter().enumerate() {
        for (j, b) in second.iter().enumerate() {
            c[i + j] += a * b;
        }
    }
    let strength = magnitude(rng, -2.0, 2.0);
    let c = c.map(|c| c * strength);
    // Sizes of which such coefficients can be made.
    let motion = (c[3] * c[3] / (4.0 * c[4])).max(c[2].abs());
    GapPolynomial {
        coefficients: c,
        place_scale: c[0].abs().max(c[1] * c[1] / (4.0 * motion)),
        motion_scale: motion,
    }
}

/// The search itself, before anything is refined: f of a margin more has no
/// contact up to the time found.
#[test]
fn the_search_passes_no_contact() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut found = 0;
    for _ in 0..40_000 {
        let gap = two_dips(&mut rng);
        let horizon = magnitude(&mut rng, -1.0, 3.0);
        let (end, answer) = match quartic_descent(&gap, false, horizon) {
            Descent::Never => (horizon, None),
            Descent::At(time) => (time, Some(time)),
            // Asked again with more digits.
            Descent::NotBefore(time) => (time, None),
        };
        let lifted = |by: f64| Exact::of_coefficients(gap.coefficients, by * gap.rounding(end));
        let context = || format!("{answer:?} within {horizon} of {gap:?}");
        assert_ne!(
            lifted(4.0).contact_until(end),
            Verdict::Contact,
            "passed one: {}",
            context()
        );
        if let Some(time) = answer {
            found += 1;
            assert!(lifted(-4.0).value(time) <= 0.0, "not there: {}", context());
        }
    }
    assert!(found > 20_000, "{found}");
}
