//! Contacts of pairs that can be worked out by hand, and inputs at the edge of
//! what a number can hold.

use grainfall::Vector;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{Approach, Forecast, PolynomialFlight, Predictor};
use grainfall::predict::Polynomial;
use proptest::prelude::*;

fn at_rest(position: Vector<3>) -> Parabola<3> {
    Parabola {
        position,
        velocity: Vector::<3>::zeros(),
        acceleration: Vector::<3>::zeros(),
    }
}

fn thrown(position: [f64; 3], velocity: [f64; 3]) -> Parabola<3> {
    Parabola {
        position: position.into(),
        velocity: velocity.into(),
        acceleration: -Vector::<3>::z(),
    }
}

fn meet<F: PolynomialFlight<3>>(first: F, second: F, touching: bool) -> Forecast {
    Polynomial.pair(&approach(first, second, touching))
}

fn approach<F: PolynomialFlight<3>>(first: F, second: F, touching: bool) -> Approach<3, F> {
    Approach {
        first,
        second,
        shift: Vector::<3>::zeros(),
        distance: 1.0,
        growth: 0.0,
        touching,
        horizon: f64::INFINITY,
    }
}

fn time(forecast: Forecast) -> f64 {
    let Forecast::Contact(time) = forecast else {
        panic!("{forecast:?}")
    };
    time
}

#[test]
fn head_on_in_free_flight() {
    let left = Straight {
        position: Vector::<3>::new(0.0, 0.0, 0.0),
        velocity: Vector::<3>::new(1.0, 0.0, 0.0),
    };
    let right = Straight {
        position: Vector::<3>::new(5.0, 0.0, 0.0),
        velocity: Vector::<3>::new(-1.0, 0.0, 0.0),
    };
    assert_eq!(meet(left, right, false), Forecast::Contact(2.0));
    // Through the periodic boundary: the image at −5 flies away.
    let image = Approach {
        shift: Vector::<3>::new(-10.0, 0.0, 0.0),
        ..approach(left, right, false)
    };
    assert_eq!(Polynomial.pair(&image), Forecast::Never);
    // Two that fall together meet as if they did not fall.
    let fall = |flight: Straight<3>| Parabola {
        position: flight.position,
        velocity: flight.velocity,
        acceleration: -Vector::<3>::z(),
    };
    assert_eq!(meet(fall(left), fall(right), false), Forecast::Contact(2.0));
    // Growth shortens the way: 5 − 2 t = 1 + t/2.
    let growing = Approach {
        growth: 0.5,
        ..approach(left, right, false)
    };
    assert!((time(Polynomial.pair(&growing)) - 1.6).abs() < 1.0e-15);
}

#[test]
fn dropped_on_a_grain_at_rest() {
    let rest = at_rest(Vector::<3>::zeros());
    let dropped = thrown([0.0, 0.0, 3.0], [0.0, 0.0, 0.0]);
    assert!((time(meet(dropped, rest, false)) - 2.0).abs() < 1.0e-15);
    // Thrown past it sideways: at height −t²/2 + 3 it is 2 away.
    let past = thrown([2.0, 0.0, 3.0], [0.0, 0.0, 0.0]);
    assert_eq!(meet(past, rest, false), Forecast::Never);
    // Falling away, from below.
    let below = thrown([0.0, 0.0, -1.5], [0.0, 0.0, 0.0]);
    assert_eq!(meet(below, rest, false), Forecast::Never);
    // Thrown up from below and not reaching; then reaching.
    let below = |speed: f64| thrown([0.0, 0.0, -1.5], [0.0, 0.0, speed]);
    assert_eq!(meet(below(0.99), rest, false), Forecast::Never);
    assert!((time(meet(below(1.25), rest, false)) - 0.5).abs() < 1.0e-14);
}

#[test]
fn bouncing_on_top_of_a_grain_at_rest() {
    // Straight up at speed u: back after 2u, however slow it is and whatever
    // rounding did to the gap.
    let rest = at_rest(Vector::<3>::zeros());
    for speed in [0.5, 1.0e-4, 1.0e-9, 1.0e-18, 1.0e-60] {
        for height in [1.0, 1.0 - 2.0e-16, 1.0 + 4.0e-16] {
            let up = thrown([0.0, 0.0, height], [0.0, 0.0, speed]);
            let found = time(meet(up, rest, true));
            assert!((found / (2.0 * speed) - 1.0).abs() < 1.0e-15, "{found}");
        }
    }
    // Not just collided, but overlapping by rounding and opening: the same.
    let up = thrown([0.0, 0.0, 1.0 - 2.0e-16], [0.0, 0.0, 1.0e-4]);
    assert!((time(meet(up, rest, false)) / 2.0e-4 - 1.0).abs() < 1.0e-7);
    // Closing and touching: at once.
    let down = thrown([0.0, 0.0, 1.0 + 2.0e-16], [0.0, 0.0, -1.0e-18]);
    assert_eq!(meet(down, rest, true), Forecast::Contact(0.0));
    // At rest on top, touching: gravity closes it at once.
    let on_top = thrown([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]);
    assert_eq!(meet(on_top, rest, true), Forecast::Contact(0.0));
    // Hanging below, touching: it falls off.
    let hanging = thrown([0.0, 0.0, -1.0], [0.0, 0.0, 0.0]);
    assert_eq!(meet(hanging, rest, true), Forecast::Never);
}

#[test]
fn overlaps_that_open_are_left_alone() {
    let rest = Straight {
        position: Vector::<3>::zeros(),
        velocity: Vector::<3>::zeros(),
    };
    let inside = |speed: f64| Straight {
        position: Vector::<3>::new(1.0 - 1.0e-3, 0.0, 0.0),
        velocity: Vector::<3>::new(speed, 0.0, 0.0),
    };
    assert_eq!(meet(rest, inside(1.0), false), Forecast::Never);
    assert_eq!(meet(rest, inside(-1.0e-9), false), Forecast::Contact(0.0));
    assert_eq!(meet(rest, inside(0.0), false), Forecast::Never);
}

#[test]
fn those_that_do_not_move_apart_or_together_never_meet() {
    let one = thrown([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]);
    let other = thrown([1.5, 0.0, 0.0], [1.0, 2.0, 3.0]);
    for touching in [false, true] {
        assert_eq!(meet(one, other, touching), Forecast::Never);
        assert_eq!(meet(one, one, touching), Forecast::Never);
    }
}

#[test]
fn the_slowest_and_the_fastest_arrive_on_time() {
    for power in [-300, -160, -100, -20, 0, 9, 100, 160, 290] {
        let speed = libm::exp10(f64::from(power));
        let flying = Straight {
            position: Vector::<3>::new(3.0, 0.5, 0.0),
            velocity: Vector::<3>::new(-speed, 0.0, 0.0),
        };
        let rest = Straight {
            position: Vector::<3>::zeros(),
            velocity: Vector::<3>::zeros(),
        };
        let expected = (3.0 - 0.75f64.sqrt()) / speed;
        let found = time(meet(flying, rest, false));
        assert!(
            (found / expected - 1.0).abs() < 1.0e-14,
            "{found:e} {expected:e}"
        );
        // In a field as strong as the grain is fast.
        let bent = |flight: Straight<3>, g: f64| Parabola {
            position: flight.position,
            velocity: flight.velocity,
            acceleration: Vector::<3>::new(0.0, -g, 0.0),
        };
        let g = 1.0e-9 * speed * speed;
        if g > 0.0 && g < f64::INFINITY {
            let found = time(meet(bent(flying, g), bent(rest, 0.0), false));
            assert!(
                (found / expected - 1.0).abs() < 1.0e-8,
                "{found:e} {expected:e}"
            );
        }
    }
}

/// Any finite number, large and small ones as likely as others.
fn extreme() -> impl Strategy<Value = f64> {
    let power = prop_oneof![-320.0f64..308.0, -20.0f64..20.0, -1.0f64..1.0];
    prop_oneof![
        4 => (power, prop::bool::ANY).prop_map(|(p, minus)| {
            let size = libm::exp10(p);
            if minus { -size } else { size }
        }),
        1 => Just(0.0),
        1 => Just(1.0),
        1 => Just(-1.0),
    ]
}

fn extreme_vector() -> impl Strategy<Value = Vector<3>> {
    prop::array::uniform3(extreme()).prop_map(Vector::<3>::from)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Nothing makes it loop, panic or answer with what is not a time.
    #[test]
    fn every_finite_input_has_an_answer(
        position in extreme_vector(),
        velocity in extreme_vector(),
        acceleration in extreme_vector(),
        flags in 0usize..64,
        distance in extreme(),
        growth in extreme(),
        horizon in extreme(),
    ) {
        let has = |bit: usize| flags & (1 << bit) != 0;
        let ask = Approach {
            first: at_rest(Vector::<3>::zeros()),
            second: Parabola {
                position: if has(4) { position.map(|x| x.clamp(-2.0, 2.0)) } else { position },
                velocity,
                acceleration: if has(3) { -Vector::<3>::z() } else { acceleration },
            },
            shift: Vector::<3>::zeros(),
            distance: if has(0) { 1.0 } else { distance.abs() },
            growth: if has(1) { 0.0 } else { growth },
            touching: has(5),
            horizon: if has(2) { f64::INFINITY } else { horizon.abs() },
        };
        match Polynomial.pair(&ask) {
            Forecast::Never => {}
            Forecast::Contact(t) => prop_assert!((0.0..f64::INFINITY).contains(&t), "{t} {ask:?}"),
            Forecast::AskAgain(t) => prop_assert!(t > 0.0 && t < f64::INFINITY, "again {t} {ask:?}"),
        }
    }
}
