use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::dynamics::{Trochoid, TurningGravity, TurningGround};
use crate::model::{Dynamics, Motion};
use crate::particle::{Mode, ParticleId};
use crate::time::Time;

type Question = Approach<3, Trochoid<3>>;

fn vector(random: &mut ChaCha8Rng, size: f64) -> Vector<3> {
    Vector::<3>::from_fn(|_, _| size * random.random_range(-1.0..1.0))
}

fn motion(position: Vector<3>, velocity: Vector<3>, mode: Mode) -> Motion<3> {
    Motion {
        id: ParticleId(0),
        position,
        velocity,
        mode,
    }
}

/// A flying grain and a static one, near it; gravity turns, or the ground.
fn question(random: &mut ChaCha8Rng) -> Question {
    let speed = libm::pow(10.0, random.random_range(-7.0..1.0));
    let gap = libm::pow(10.0, random.random_range(-12.0..0.5));
    let touching = random.random_bool(0.3);
    let rate = 0.5 * libm::pow(10.0, random.random_range(-3.0..0.0));
    let since = Time::from_units(random.random_range(0.0..100.0));
    let place = vector(random, 10.0);
    let direction = vector(random, 1.0).normalize();
    let velocity = vector(random, speed);
    let distance = if touching { 1.0 } else { 1.0 + gap };
    let other = place + direction * distance;
    let gravity = vector(random, 1.0);
    let (first, second) = if random.random_bool(0.5) {
        let dynamics = TurningGravity::new(gravity, rate, [0, 2]);
        (
            dynamics.flight(&motion(place, velocity, Mode::Normal), since),
            dynamics.flight(&motion(other, Vector::<3>::zeros(), Mode::Fixed), since),
        )
    } else {
        let dynamics = TurningGround::new(gravity, rate, [0, 2], vector(random, 5.0));
        let velocity = velocity + dynamics.ground_velocity(&other, since);
        (
            dynamics.flight(&motion(place, velocity, Mode::Normal), since),
            dynamics.flight(&motion(other, Vector::<3>::zeros(), Mode::Frozen), since),
        )
    };
    let apart = (second.start() - first.start()).norm();
    Approach {
        first,
        second,
        shift: Vector::<3>::zeros(),
        distance: if touching { apart } else { 1.0 },
        growth: 0.0,
        touching,
        horizon: 3.0,
    }
}

/// The gap as the flights themselves have it.
fn gap(question: &Question, time: f64) -> f64 {
    let apart = question.second.position(time) - question.first.position(time);
    apart.norm() - question.distance
}

#[test]
fn the_quick_way_and_double_double_agree() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut contacts, mut none, mut worst) = (0, 0, 0.0_f64);
    for case in 0..60_000 {
        let question = question(&mut random);
        let quick = bent(&question);
        let wide = march(&question, 0.0, question.horizon);
        match (quick, wide) {
            (Forecast::Never, Descent::Never) => none += 1,
            (Forecast::Contact(quick), Descent::At(wide)) => {
                contacts += 1;
                let digits = (quick - wide).abs() / (f64::EPSILON * wide + 1.0e-25);
                worst = worst.max(digits);
                assert!(
                    digits <= 1.0,
                    "case {case}: {quick} and {wide}: {question:?}"
                );
            }
            // Found, but behind the horizon.
            (Forecast::Contact(time), Descent::Never) | (Forecast::Never, Descent::At(time)) => {
                assert!(
                    time >= question.horizon,
                    "case {case}: {quick:?}, {wide:?}: {question:?}"
                );
            }
            other => panic!("case {case}: {other:?}: {question:?}"),
        }
    }
    println!("{contacts} contacts, {none} without, last digits off by {worst}");
    assert!(contacts > 20_000 && none > 5_000);
}

#[test]
fn no_contact_is_passed() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut contacts = 0;
    for case in 0..3_000 {
        let question = question(&mut random);
        let until = match Turning.pair(&question) {
            Forecast::Contact(time) => {
                contacts += 1;
                let there = gap(&question, time);
                assert!(
                    there.abs() < 1.0e-13,
                    "case {case}: a gap of {there} at {time}"
                );
                time
            }
            Forecast::Never => question.horizon,
            Forecast::AskAgain(time) => time,
        };
        for step in 1..2_000 {
            let time = until * f64::from(step) / 2_000.0;
            let there = gap(&question, time);
            assert!(
                there > -1.0e-13,
                "case {case}: {there} at {time} before {until}"
            );
        }
    }
    assert!(contacts > 1_000, "{contacts}");
}

#[test]
fn bounds_are_not_later_than_contacts() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut contacts, mut close) = (0, 0);
    for case in 0..20_000 {
        let mut question = question(&mut random);
        question.touching = false;
        let Forecast::Contact(time) = Turning.pair(&question) else {
            continue;
        };
        contacts += 1;
        let crowd = Crowd {
            after: [0.0; LANES],
            shifts: None,
            distances: [question.distance; LANES],
            growth: 0.0,
            blur: 1.0e-13,
            horizon: question.horizon,
        };
        let bounds = Turning.not_before(&question.first, |_| question.second, &crowd);
        assert!(
            bounds[0] <= time,
            "case {case}: {} but {time}: {question:?}",
            bounds[0]
        );
        close += u32::from(bounds[0] > 0.5 * time.min(STAGES[1]));
        if question.second.is_at_rest() {
            let places = std::array::from_fn(|axis| [question.second.start()[axis]; LANES]);
            let resting = crate::model::Resting {
                places,
                distances: [question.distance; LANES],
            };
            let nook = Nook {
                own: &question.first,
                place: question.first.start(),
                resting: &resting,
                scale: 1.0,
                growth: 0.0,
                blur: 1.0e-13,
                horizon: question.horizon,
            };
            let bounds = Turning.not_before_resting(&nook);
            assert!(bounds[0] <= time, "case {case}: {} but {time}", bounds[0]);
        }
    }
    // They are of use, too.
    println!("{contacts} contacts, {close} of them with bounds later than half of the time");
    assert!(contacts > 2_000 && 2 * close > contacts);
}

/// Grains that overlap, open and close again without having come apart meet when
/// they begin to close.
#[test]
fn overlaps_meet_when_they_begin_to_close() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut contacts = 0;
    for case in 0..20_000 {
        let mut question = question(&mut random);
        question.touching = false;
        question.distance = 1.0;
        let rate = libm::pow(10.0, random.random_range(-2.0..0.7));
        let dynamics = TurningGravity::new(vector(&mut random, 1.5), rate, [0, 2]);
        let direction = vector(&mut random, 1.0).normalize();
        let place = direction * random.random_range(0.6..0.99);
        let velocity =
            direction * libm::pow(10.0, random.random_range(-3.0..0.0)) + vector(&mut random, 0.3);
        question.first = dynamics.flight(&motion(place, velocity, Mode::Normal), Time::ZERO);
        let still = motion(Vector::<3>::zeros(), Vector::<3>::zeros(), Mode::Fixed);
        question.second = dynamics.flight(&still, Time::ZERO);
        let slope = |time: f64| {
            let first: Vector<3> = question.first.position(time);
            let velocity: Vector<3> = question.first.velocity(time);
            first.dot(&velocity)
        };
        let Forecast::Contact(time) = Turning.pair(&question) else {
            continue;
        };
        if slope(0.0) <= 0.0 || gap(&question, time) > -1.0e-9 {
            continue;
        }
        contacts += 1;
        assert!(slope(time).abs() < 1.0e-12, "case {case}: {}", slope(time));
        for step in 1..100 {
            let before = time * f64::from(step) / 100.0;
            assert!(
                slope(before) > 0.0,
                "case {case}: closes at {before}, not {time}"
            );
        }
    }
    assert!(contacts > 2_000, "{contacts}");
}

/// How far ahead is asked for changes no bit of what is found, nor whether.
#[test]
fn answers_do_not_depend_on_the_horizon() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut contacts = 0;
    for case in 0..20_000 {
        let mut question = question(&mut random);
        question.growth = if random.random_bool(0.3) { 0.05 } else { 0.0 };
        question.shift = Vector::<3>::new(0.0, 0.0, 0.0);
        question.horizon = f64::INFINITY;
        let Forecast::Contact(time) = Turning.pair(&question) else {
            continue;
        };
        contacts += 1;
        for longer in [1.0, 1.0 + 1.0e-15, 1.0 + 1.0e-9, 1.1, 2.0, 30.0] {
            question.horizon = time * longer;
            let found = Turning.pair(&question);
            assert_eq!(found, Forecast::Contact(time), "case {case}, {longer}");
        }
    }
    assert!(contacts > 5_000, "{contacts}");
}
