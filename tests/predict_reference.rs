//! Contacts of pairs against an independent algorithm in double-double: the
//! derivative chain. Zeros of f and f′ are bracketed between the zeros of their
//! derivatives; the contact is the left end of the first stretch on which f is
//! not positive and f′ is negative.

#[path = "common/certified.rs"]
mod certified;
#[path = "common/exact.rs"]
mod exact;

use grainfall::Vector;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{Approach, Forecast, PolynomialFlight, Predictor};
use grainfall::predict::{
    Descent, DoubleDouble, GapPolynomial, Polynomial, Real, Relative, first_contact,
};
use proptest::prelude::*;
use proptest::test_runner::Config;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

type Wide = DoubleDouble;

fn wide(x: f64) -> Wide {
    Wide::from_f64(x)
}

/// A polynomial, lowest coefficient first.
#[derive(Clone, Debug)]
struct Chain(Vec<Wide>);

impl Chain {
    fn value(&self, t: Wide) -> Wide {
        self.0.iter().rev().fold(Wide::ZERO, |sum, c| sum * t + *c)
    }

    fn derivative(&self) -> Chain {
        let rest = self.0.iter().enumerate().skip(1);
        Chain(rest.map(|(k, c)| c.times(k as f64)).collect())
    }

    /// Beyond this there is no zero (Cauchy), or nothing if it is constant.
    fn last_zero_before(&self) -> Wide {
        let degree = self.0.iter().rposition(|c| *c != Wide::ZERO).unwrap_or(0);
        let lead = self.0[degree].abs();
        // Fujiwara's bound in a form that survives a small leading coefficient.
        let mut bound = 0.0f64;
        for k in 0..degree {
            let ratio = (self.0[k].abs() / lead).to_f64();
            bound = bound.max(libm::pow(ratio, 1.0 / (degree - k) as f64));
        }
        wide(2.0 * bound)
    }

    /// Places in (0, end) where the sign changes, in order.
    fn zeros(&self, end: Wide) -> Vec<Wide> {
        if self.0.len() < 2 || end <= Wide::ZERO {
            return Vec::new();
        }
        let mut ends = vec![Wide::ZERO];
        ends.extend(self.derivative().zeros(end));
        ends.push(end);
        let mut zeros = Vec::new();
        for pair in ends.windows(2) {
            let (low, high) = (self.value(pair[0]), self.value(pair[1]));
            if (low < Wide::ZERO) != (high < Wide::ZERO) {
                zeros.push(self.bracketed(pair[0], pair[1]));
            }
        }
        zeros
    }

    /// Safeguarded Newton on a monotone stretch with a change of sign.
    fn bracketed(&self, mut low: Wide, mut high: Wide) -> Wide {
        let slope = self.derivative();
        let rising = self.value(low) < Wide::ZERO;
        let mut t = (low + high).times(0.5);
        for _ in 0..400 {
            let value = self.value(t);
            if (value < Wide::ZERO) == rising {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / slope.value(t);
            let next = if newton > low && newton < high {
                newton
            } else {
                // Halve the exponent's range first, or tiny zeros take for ever.
                let product = low * high;
                if low > Wide::ZERO && high > low.times(4.0) && product > Wide::ZERO {
                    product.sqrt()
                } else if low == Wide::ZERO && high > wide(1.0e-60) {
                    high.times(1.0e-3)
                } else {
                    (low + high).times(0.5)
                }
            };
            if (next - t).abs() <= next.abs().times(1.0e-30) {
                return next;
            }
            t = next;
        }
        t
    }
}

/// What the chain says of one approach.
struct Reference {
    f: Chain,
    /// Zeros of f′: lowest and highest points.
    turns: Vec<Wide>,
    contact: Option<Wide>,
}

impl Reference {
    fn new<const D: usize>(relative: &Relative<D>, touching: bool) -> Self {
        let dot = |a: &Vector<D>, b: &Vector<D>| {
            (0..D).fold(Wide::ZERO, |sum, k| sum + wide(a[k]) * wide(b[k]))
        };
        let (r, v, a) = (&relative.offset, &relative.velocity, &relative.acceleration);
        let (sigma, gamma) = (wide(relative.distance), wide(relative.growth));
        let c0 = dot(r, r) - sigma * sigma;
        let c1 = (dot(r, v) - sigma * gamma).times(2.0);
        let c2 = dot(v, v) - gamma * gamma + dot(r, a);
        let mut f = vec![c0, c1, c2, dot(v, a), dot(a, a).times(0.25)];
        if touching {
            f[0] = Wide::ZERO;
        }
        while f.len() > 1 && f.last() == Some(&Wide::ZERO) {
            f.pop();
        }
        let f = Chain(f);
        let slope = f.derivative();
        let end = f
            .last_zero_before()
            .at_least(slope.last_zero_before())
            .times(1.5);
        // With c₀ divided out, the zeros of f beyond t = 0 are those of q.
        let divided = Chain(if touching {
            f.0[1..].to_vec()
        } else {
            f.0.clone()
        });
        let turns = slope.zeros(end);
        let mut marks = divided.zeros(end);
        marks.extend(turns.iter().copied());
        marks.push(Wide::ZERO);
        marks.sort_by(|x, y| x.partial_cmp(y).unwrap());
        marks.push(marks.last().unwrap().times(2.0) + wide(1.0));
        let mut contact = None;
        for pair in marks.windows(2) {
            if pair[0] == pair[1] {
                continue;
            }
            let middle = (pair[0] + pair[1]).times(0.5);
            if divided.value(middle) <= Wide::ZERO && slope.value(middle) < Wide::ZERO {
                contact = Some(pair[0]);
                break;
            }
        }
        Reference { f, turns, contact }
    }

    /// Lowest f between two times.
    fn lowest(&self, from: Wide, to: Option<Wide>) -> Wide {
        let inside = |t: &&Wide| **t > from && to.is_none_or(|to| **t < to);
        let mut lowest = self.f.value(from);
        for t in self.turns.iter().filter(inside) {
            lowest = lowest.at_most(self.f.value(*t));
        }
        lowest.at_most(self.f.value(to.unwrap_or(from.times(4.0) + wide(1.0e3))))
    }
}

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

fn uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

/// 10 to a uniform power.
fn magnitude(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    libm::exp10(uniform(rng, low, high))
}

fn direction<const D: usize>(rng: &mut impl Rng) -> Vector<D> {
    loop {
        let v = Vector::<D>::from_fn(|_, _| uniform(rng, -1.0, 1.0));
        let size = v.norm();
        if size > 0.1 && size < 1.0 {
            return v / size;
        }
    }
}

/// A unit vector across another.
fn across<const D: usize>(normal: &Vector<D>, rng: &mut impl Rng) -> Vector<D> {
    loop {
        let v = direction::<D>(rng);
        let v = v - normal * normal.dot(&v);
        if v.norm() > 0.1 {
            break v / v.norm();
        }
    }
}

/// An input of one of the kinds that simulations and bad luck produce.
fn input<const D: usize>(kind: usize, rng: &mut ChaCha8Rng) -> (Relative<D>, bool) {
    let up = Vector::<D>::from_fn(|axis, _| if axis + 1 == D { 1.0 } else { 0.0 });
    let distance = uniform(rng, 0.5, 1.5);
    let normal = direction::<D>(rng);
    let mut relative = Relative {
        offset: normal * distance,
        velocity: direction::<D>(rng) * magnitude(rng, -4.0, 0.5),
        acceleration: up,
        distance,
        growth: 0.0,
    };
    let mut touching = false;
    match kind {
        // An ordinary neighbour.
        0 => relative.offset += normal * uniform(rng, 0.0, 1.0),
        // Anything.
        1 => {
            relative.offset *= 1.0 + magnitude(rng, -16.0, 0.0);
            relative.velocity = direction::<D>(rng) * magnitude(rng, -9.0, 3.0);
        }
        // A graze: the path passes a point at contact distance, tangentially
        // but for a hair.
        2 => {
            let t = magnitude(rng, -3.0, 0.5);
            let hair = magnitude(rng, -17.0, -10.0) * if rng.random() { 1.0 } else { -1.0 };
            let speed = across(&normal, rng) * magnitude(rng, -1.0, 0.5);
            let at = normal * (distance * (1.0 + hair));
            relative.velocity = speed - up * t;
            relative.offset = at - speed * t + up * (0.5 * t * t);
        }
        // Just collided.
        3 => {
            touching = true;
            relative.velocity = normal * magnitude(rng, -12.0, -1.0)
                + across(&normal, rng) * magnitude(rng, -6.0, 0.3);
        }
        // Touching with somebody else's collision just past.
        4 => {
            let hair = magnitude(rng, -18.0, -14.5) * if rng.random() { 1.0 } else { -1.0 };
            relative.offset *= 1.0 + hair;
            let sign = if rng.random() { 1.0 } else { -1.0 };
            relative.velocity = normal * (sign * magnitude(rng, -18.0, -2.0))
                + across(&normal, rng) * magnitude(rng, -6.0, 0.3);
        }
        // Overlapping, by up to a lot.
        5 => {
            relative.offset *= 1.0 - magnitude(rng, -12.0, -0.5);
            relative.velocity = direction::<D>(rng) * magnitude(rng, -3.0, 1.0);
        }
        // Growing.
        6 => {
            relative.offset *= 1.0 + magnitude(rng, -8.0, 0.5);
            relative.growth = uniform(rng, 0.0, 0.5);
            touching = rng.random::<f64>() < 0.2;
        }
        // Far and fast.
        _ => {
            relative.offset *= magnitude(rng, 0.5, 3.0);
            let aim = direction::<D>(rng) * 0.9 - relative.offset;
            let t = magnitude(rng, -1.0, 2.0);
            relative.velocity = aim / t - up * (0.5 * t);
        }
    }
    if rng.random::<f64>() < 0.25 {
        relative.acceleration = Vector::zeros();
    } else if rng.random::<f64>() < 0.2 {
        relative.acceleration = direction::<D>(rng) * magnitude(rng, -3.0, 2.0);
    }
    (relative, touching)
}

const KINDS: usize = 8;

fn parabolas<const D: usize>(
    relative: &Relative<D>,
    touching: bool,
    horizon: f64,
) -> Approach<D, Parabola<D>> {
    Approach {
        first: Parabola {
            position: Vector::zeros(),
            velocity: Vector::zeros(),
            acceleration: Vector::zeros(),
        },
        second: Parabola {
            position: relative.offset,
            velocity: relative.velocity,
            acceleration: relative.acceleration,
        },
        shift: Vector::zeros(),
        distance: relative.distance,
        growth: relative.growth,
        touching,
        horizon,
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
        let straight = |flight: &Parabola<D>| Straight {
            position: flight.position,
            velocity: flight.velocity,
        };
        let straight = Approach {
            first: straight(&approach.first),
            second: straight(&approach.second),
            shift: approach.shift,
            distance: approach.distance,
            growth: approach.growth,
            touching,
            horizon: approach.horizon,
        };
        assert_eq!(contact(&straight), answer);
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
