//! Contacts with walls: flat ones, and a round container known to the
//! predictor by its distance alone.

use grainfall::boundary::Plane;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{Encounter, Forecast, PolynomialFlight, Predictor, Shape, Wall};
use grainfall::predict::Polynomial;
use grainfall::{Time, Vector};
use proptest::prelude::*;

/// The inside of a ball, its centre moving at constant velocity.
#[derive(Clone, Copy)]
struct Bowl {
    size: f64,
    drift: Vector<3>,
}

impl Bowl {
    fn still(size: f64) -> Self {
        Bowl {
            size,
            drift: Vector::<3>::zeros(),
        }
    }

    fn seen_from_centre(&self, position: &Vector<3>, time: Time) -> Vector<3> {
        position - self.drift * time.units()
    }
}

impl Wall<3> for Bowl {
    fn distance(&self, position: &Vector<3>, time: Time) -> f64 {
        self.size - self.seen_from_centre(position, time).norm()
    }

    fn normal(&self, position: &Vector<3>, time: Time) -> Vector<3> {
        let inward = -self.seen_from_centre(position, time);
        if inward.norm() > 0.0 {
            inward / inward.norm()
        } else {
            Vector::<3>::z()
        }
    }

    fn velocity(&self, _position: &Vector<3>, _time: Time) -> Vector<3> {
        self.drift
    }

    fn restitution(&self) -> f64 {
        1.0
    }

    fn shape(&self) -> Shape<3> {
        Shape::General {
            curvature: 1.0 / (self.size - 1.0),
            speed: self.drift.norm(),
            acceleration: 0.0,
        }
    }
}

fn encounter<F: PolynomialFlight<3>, W: Wall<3>>(
    flight: F,
    wall: &W,
    touching: bool,
) -> Encounter<'_, 3, F, W> {
    Encounter {
        flight,
        wall,
        since: Time::ZERO,
        radius: 0.5,
        growth: 0.0,
        touching,
        horizon: f64::INFINITY,
    }
}

/// The contact, asking again from where the predictor left off, and how often.
fn patient<F: PolynomialFlight<3>, W: Wall<3> + Copy>(
    mut encounter: Encounter<'_, 3, F, W>,
) -> (Option<f64>, u32) {
    let mut passed = 0.0;
    for asked in 0..50 {
        match Polynomial.wall(&encounter) {
            Forecast::Never => return (None, asked),
            Forecast::Contact(t) => {
                assert!(t >= 0.0 && t.is_finite());
                return (Some(passed + t), asked);
            }
            Forecast::AskAgain(t) => {
                assert!(t > 0.0 && t.is_finite());
                passed += t;
                encounter.flight = encounter.flight.advanced(t);
                encounter.since = encounter.since + t;
                encounter.radius += encounter.growth * t;
                encounter.horizon -= t;
                encounter.touching = false;
            }
        }
    }
    panic!("never settled");
}

fn vector(range: f64) -> impl Strategy<Value = Vector<3>> {
    prop::array::uniform3(-range..range).prop_map(Vector::<3>::from)
}

fn floor() -> Plane<3> {
    Plane {
        normal: Vector::<3>::z(),
        offset: 2.0,
        restitution: 0.5,
    }
}

fn parabola(position: Vector<3>, velocity: Vector<3>) -> Parabola<3> {
    Parabola {
        position,
        velocity,
        acceleration: -Vector::<3>::z(),
    }
}

#[test]
fn a_grain_falls_to_the_floor_and_bounces() {
    let floor = floor();
    let high = parabola(Vector::<3>::new(3.0, 4.0, 4.5), Vector::<3>::zeros());
    assert_eq!(
        Polynomial.wall(&encounter(high, &floor, false)),
        Forecast::Contact(2.0)
    );
    // Leaving at speed u it is back after 2u, whatever rounding did to its height.
    for speed in [1.0, 1.0e-8, 1.0e-150] {
        for height in [2.5, 2.5 - 1.0e-15, 2.5 + 1.0e-15] {
            let up = parabola(
                Vector::<3>::new(3.0, 4.0, height),
                Vector::<3>::new(1.0, 0.0, speed),
            );
            assert_eq!(
                Polynomial.wall(&encounter(up, &floor, true)),
                Forecast::Contact(2.0 * speed)
            );
        }
    }
    let into = parabola(
        Vector::<3>::new(0.0, 0.0, 2.5 + 1.0e-15),
        Vector::<3>::new(0.0, 0.0, -1.0e-3),
    );
    assert_eq!(
        Polynomial.wall(&encounter(into, &floor, true)),
        Forecast::Contact(0.0)
    );
}

#[test]
fn a_grain_slightly_in_the_floor_leaves_and_returns() {
    let floor = floor();
    let low = Vector::<3>::new(0.0, 0.0, 2.5 - 1.0e-6);
    // Fast enough to come out: contact when it comes back.
    let out = parabola(low, Vector::<3>::new(0.0, 0.0, 1.0));
    let Forecast::Contact(time) = Polynomial.wall(&encounter(out, &floor, false)) else {
        panic!()
    };
    let expected = 1.0 + (1.0f64 - 2.0e-6).sqrt();
    assert!((time - expected).abs() < 1.0e-12);
    // Too slow: contact when it turns round.
    let stuck = parabola(low, Vector::<3>::new(0.0, 0.0, 1.0e-4));
    assert_eq!(
        Polynomial.wall(&encounter(stuck, &floor, false)),
        Forecast::Contact(1.0e-4)
    );
}

#[test]
fn a_growing_grain_meets_a_wall_it_does_not_fly_to() {
    let floor = floor();
    let flight = Straight {
        position: Vector::<3>::new(0.0, 0.0, 3.0),
        velocity: Vector::<3>::new(1.0, 0.0, 0.25),
    };
    let away = encounter(flight, &floor, false);
    assert_eq!(Polynomial.wall(&away), Forecast::Never);
    let growing = Encounter {
        growth: 0.5,
        ..away
    };
    assert_eq!(Polynomial.wall(&growing), Forecast::Contact(2.0));
    assert_eq!(
        Polynomial.wall(&Encounter {
            horizon: 1.5,
            ..growing
        }),
        Forecast::Never
    );
}

#[test]
fn nothing_at_rest_ever_meets_a_wall() {
    let bowl = Bowl::still(10.0);
    for z in [0.0, 5.0, -9.5, 9.7] {
        let flight = Straight {
            position: Vector::<3>::new(0.0, 0.0, z),
            velocity: Vector::<3>::zeros(),
        };
        assert_eq!(
            Polynomial.wall(&encounter(flight, &bowl, false)),
            Forecast::Never
        );
        assert_eq!(
            Polynomial.wall(&encounter(flight, &floor(), false)),
            Forecast::Never
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Straight paths in a ball end on its surface after the rest of the chord.
    #[test]
    fn chords_of_a_ball(
        position in vector(5.0),
        velocity in vector(3.0),
        drift in vector(1.0),
        moves: bool,
    ) {
        let drift = if moves { drift } else { Vector::<3>::zeros() };
        let bowl = Bowl { size: 10.0, drift };
        let flight = Straight { position, velocity };
        let (found, asked) = patient(encounter(flight, &bowl, false));
        let relative = velocity - drift;
        // Far from the wall only speeds are known: slow approaches take many steps.
        prop_assume!(relative.norm() > 0.2 * (velocity.norm() + drift.norm()));
        let (b, c) = (position.dot(&relative), position.norm_squared() - 9.5 * 9.5);
        let root = (b * b - relative.norm_squared() * c).sqrt();
        let expected = (root - b) / relative.norm_squared();
        let time = found.unwrap();
        prop_assert!((time - expected).abs() < 1.0e-12 * (1.0 + expected), "{time} {expected}");
        prop_assert!(asked <= 1, "{asked}");
    }

    /// So do those that have just bounced, along however flat a chord.
    #[test]
    fn chords_from_the_surface(
        place in vector(1.0),
        tangent in vector(1.0),
        slope in -6.0f64..0.0,
        hair in -1.0e-15f64..1.0e-15,
        touching: bool,
    ) {
        prop_assume!(place.norm() > 0.1);
        let inward = -place.normalize();
        let tangent = tangent - inward * inward.dot(&tangent);
        prop_assume!(tangent.norm() > 0.1);
        let slope = libm::exp10(slope);
        let velocity = tangent.normalize() + inward * slope;
        let bowl = Bowl::still(10.0);
        let flight = Straight { position: inward * -(9.5 * (1.0 + hair)), velocity };
        let (found, asked) = patient(encounter(flight, &bowl, touching));
        let expected = 2.0 * 9.5 * slope / velocity.norm_squared();
        let time = found.unwrap();
        // Gap at the contact; its time is worse by the slope.
        let gap = 9.5 - flight_position(&flight, time).norm();
        prop_assert!(gap.abs() < 1.0e-13, "gap {gap:e}, {time} {expected}");
        prop_assert!((time - expected).abs() < 1.0e-13 / slope, "{time} {expected}");
        prop_assert!(asked <= 1, "{asked}");
    }

    /// Parabolas: the gap at the answer is zero and closing, and there is none
    /// before it, as a fine walk along the path shows.
    #[test]
    fn parabolas_in_a_ball(
        position in vector(5.4),
        velocity in vector(3.0),
        size in 10.0f64..12.0,
        horizon in 0.1f64..10.0,
    ) {
        let bowl = Bowl::still(size);
        let flight = parabola(position, velocity);
        let ask = encounter(flight, &bowl, false);
        let (found, asked) = patient(ask);
        prop_assert!(asked <= 1);
        let time = found.unwrap();
        let gap = |t: f64| size - 0.5 - flight_position(&flight, t).norm();
        prop_assert!(gap(time).abs() < 1.0e-13, "gap {:e}", gap(time));
        prop_assert!(gap(time + 1.0e-5) < 1.0e-9);
        for step in 0..300 {
            let t = time * f64::from(step) / 300.0;
            prop_assert!(gap(t) > -1.0e-13, "inside the wall at {t} of {time}");
        }
        if asked == 0 {
            let within = Polynomial.wall(&Encounter { horizon, ..ask });
            if time <= horizon {
                prop_assert_eq!(within, Forecast::Contact(time));
            } else {
                prop_assert!(within == Forecast::Never || within == Forecast::Contact(time));
            }
        }
    }

    /// Flat walls again, but known by their distance alone.
    #[test]
    fn a_plane_by_steps_is_a_plane_in_closed_form(
        position in vector(4.0),
        velocity in vector(3.0),
        growth in 0.0f64..0.3,
        touching: bool,
    ) {
        #[derive(Clone, Copy)]
        struct Disguised(Plane<3>);
        impl Wall<3> for Disguised {
            fn distance(&self, position: &Vector<3>, time: Time) -> f64 {
                self.0.distance(position, time)
            }
            fn normal(&self, position: &Vector<3>, time: Time) -> Vector<3> {
                self.0.normal(position, time)
            }
            fn restitution(&self) -> f64 {
                1.0
            }
            fn shape(&self) -> Shape<3> {
                Shape::General { curvature: 0.0, speed: 0.0, acceleration: 0.0 }
            }
        }
        let mut position = position;
        position.z = if touching { 2.5 } else { position.z + 6.5 };
        let flight = parabola(position, velocity);
        let floor = floor();
        let flat = Encounter { growth, ..encounter(flight, &floor, touching) };
        let disguise = Disguised(floor);
        let stepped = Encounter { growth, ..encounter(flight, &disguise, touching) };
        let Forecast::Contact(expected) = Polynomial.wall(&flat) else { panic!() };
        let (found, asked) = patient(stepped);
        prop_assert!((found.unwrap() - expected).abs() < 1.0e-11, "{found:?} {expected}");
        prop_assert!(asked <= 1, "{asked}");
    }
}

fn flight_position<F: PolynomialFlight<3>>(flight: &F, t: f64) -> Vector<3> {
    flight.position(t)
}
