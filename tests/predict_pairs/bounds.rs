//! Bounds on contacts are not later than the contacts.

use crate::numbers::{Numbers, meeting};
use grainfall::Vector;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{
    Approach, Crowd, Encounter, Forecast, LANES, Nook, PolynomialFlight, Predictor, Resting, Wall,
};
use grainfall::predict::{Descent, DoubleDouble, Polynomial, Real, Relative, first_contact};
use proptest::prelude::*;

/// A predictor that says no more about bounds than the trait provides.
struct Provided;

impl<const D: usize, F: PolynomialFlight<D>> Predictor<D, F> for Provided {
    fn pair(&self, approach: &Approach<D, F>) -> Forecast {
        Polynomial.pair(approach)
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast {
        Polynomial.wall(encounter)
    }
}

/// First contact of two grains, by wide arithmetic; infinity if it could not
/// tell and would have to be asked again.
fn contact<const D: usize>(relative: &Relative<D>, touching: bool) -> f64 {
    match first_contact::<DoubleDouble, D>(relative, touching, f64::INFINITY) {
        Descent::At(time) => time.to_f64(),
        Descent::Never | Descent::NotBefore(_) => f64::INFINITY,
    }
}

/// What a bound is asked with and must not be later than.
fn horizon(numbers: &mut Numbers, time: f64) -> f64 {
    match numbers.pick(5) {
        0 => f64::INFINITY,
        1 => time,
        2 => time * 0.9,
        3 => time * (1.0 + 1.0e-12),
        _ => time + numbers.small(-8.0) * 20.0,
    }
}

fn check(bounds: [f64; LANES], contacts: [f64; LANES], horizon: f64, what: &str) {
    for (bound, contact) in bounds.into_iter().zip(contacts) {
        assert!(
            contact > horizon || bound <= contact,
            "{what}: not before {bound:e}, but {contact:e}, up to {horizon:e}"
        );
    }
}

/// Four grains that fly, seen by one, at once and with no rounding of places.
fn flying<const D: usize, F: PolynomialFlight<D>>(
    numbers: &mut Numbers,
    make: impl Fn(Vector<D>, Vector<D>, Vector<D>) -> F,
) {
    let growth = if numbers.coin() {
        0.0
    } else {
        numbers.small(-6.0)
    };
    let own = make(Vector::zeros(), numbers.vector(), numbers.vector());
    let mut others = [own; LANES];
    let (mut contacts, mut distances, mut time) = ([0.0; LANES], [0.0; LANES], 0.0);
    for lane in 0..LANES {
        let pull = match numbers.pick(3) {
            _ if !F::ACCELERATES => Vector::zeros(),
            0 => Vector::zeros(),
            1 => numbers.direction::<D>() * numbers.small(-18.0),
            _ => numbers.direction(),
        };
        let (relative, at) = meeting::<D>(numbers, pull, growth);
        others[lane] = make(
            relative.offset,
            own.start_velocity() + relative.velocity,
            own.acceleration() + relative.acceleration,
        );
        let relative = Relative::of(&Approach {
            first: own,
            second: others[lane],
            shift: Vector::zeros(),
            distance: relative.distance,
            growth: relative.distance * growth,
            touching: false,
            horizon: f64::INFINITY,
        });
        contacts[lane] = contact(&relative, false);
        distances[lane] = relative.distance;
        time = at;
    }
    let crowd = Crowd {
        after: [0.0; LANES],
        shifts: None,
        distances,
        growth,
        blur: 0.0,
        horizon: horizon(numbers, time),
    };
    let ask = |lane: usize| others[lane];
    let solved = Polynomial.not_before(&own, ask, &crowd);
    check(solved, contacts, crowd.horizon, "flying, solved");
    let provided = Provided.not_before(&own, ask, &crowd);
    check(provided, contacts, crowd.horizon, "flying, provided");
}

/// Four grains at rest and one that flies.
fn resting<const D: usize, F: PolynomialFlight<D>>(
    numbers: &mut Numbers,
    make: impl Fn(Vector<D>, Vector<D>, Vector<D>) -> F,
) {
    let growth = if numbers.coin() {
        0.0
    } else {
        numbers.small(-6.0)
    };
    let pull = if F::ACCELERATES && numbers.pick(3) > 0 {
        -numbers.direction::<D>()
    } else {
        Vector::zeros()
    };
    // The four have to meet one and the same flight.
    let (one, time) = meeting::<D>(numbers, pull, growth);
    let own = make(Vector::zeros(), -one.velocity, -one.acceleration);
    let mut resting = Resting {
        places: [[0.0; LANES]; D],
        distances: [one.distance; LANES],
    };
    let mut contacts = [0.0; LANES];
    for (lane, meets) in contacts.iter_mut().enumerate() {
        let mut relative = one;
        if lane > 0 {
            relative.offset += numbers.vector::<D>() * numbers.small(-16.0);
        }
        for axis in 0..D {
            resting.places[axis][lane] = relative.offset[axis];
        }
        relative.growth = one.distance * growth;
        *meets = contact(&relative, false);
    }
    let nook = Nook {
        own: &own,
        place: Vector::zeros(),
        resting: &resting,
        scale: 1.0,
        growth,
        blur: 0.0,
        horizon: horizon(numbers, time),
    };
    let solved = Polynomial.not_before_resting(&nook);
    check(solved, contacts, nook.horizon, "resting, solved");
    let provided = Provided.not_before_resting(&nook);
    check(provided, contacts, nook.horizon, "resting, provided");
}

/// As the engine asks: flights that began at different times, far from the
/// origin and through a period, and two that have just left each other.
fn blurred<const D: usize, F: PolynomialFlight<D>>(
    numbers: &mut Numbers,
    make: impl Fn(Vector<D>, Vector<D>, Vector<D>) -> F,
) {
    let far = libm::exp10(2.5 * (1.0 + numbers.next()));
    let pull = |numbers: &mut Numbers| match (F::ACCELERATES, numbers.pick(2)) {
        (true, 0) => -numbers.direction::<D>(),
        _ => Vector::zeros(),
    };
    // Since a while ago.
    let long = 16.0;
    let after: [f64; LANES] = std::array::from_fn(|_| long * 0.5 * (1.0 + numbers.next()));
    let ago = long * 0.5 * (1.0 + numbers.next());
    let own = make(numbers.vector::<D>() * far, numbers.vector(), pull(numbers));
    let here = own.advanced(ago);
    let shifts: [Vector<D>; LANES] = std::array::from_fn(|_| numbers.vector::<D>() * far);
    let touching = numbers.coin();
    let mut others = [own; LANES];
    let (mut contacts, mut distances, mut time) = ([0.0; LANES], [0.0; LANES], 0.0);
    let span = |flight: &F| flight.start().amax() + flight.speed_bound(long) * long;
    let mut blur = span(&own);
    for lane in 0..LANES {
        let pull = pull(numbers) - own.acceleration();
        let (mut relative, at) = meeting::<D>(numbers, pull, 0.0);
        if touching {
            relative.offset = relative.offset.normalize() * relative.distance;
        }
        let now = make(
            here.start() + relative.offset - shifts[lane],
            here.start_velocity() + relative.velocity,
            own.acceleration() + relative.acceleration,
        );
        others[lane] = now.advanced(-after[lane]);
        blur = blur.max(span(&others[lane]));
        // Counted from the later of the two, as a contact is.
        let (first, second, back) = if touching {
            // From now on, both.
            (here, others[lane].advanced(after[lane]), 0.0)
        } else if ago < after[lane] {
            (own, others[lane].advanced(after[lane] - ago), ago)
        } else {
            (own.advanced(ago - after[lane]), others[lane], after[lane])
        };
        let forecast = Polynomial.pair(&Approach {
            first,
            second,
            shift: shifts[lane],
            distance: relative.distance,
            growth: 0.0,
            touching,
            horizon: f64::INFINITY,
        });
        contacts[lane] = match forecast {
            Forecast::Contact(time) if time >= back => time - back,
            // Earlier than now: they are where they are by construction.
            _ => f64::INFINITY,
        };
        distances[lane] = relative.distance;
        time = at;
    }
    let crowd = Crowd {
        after,
        shifts: Some(shifts),
        distances,
        growth: 0.0,
        blur: 32.0 * f64::EPSILON * blur,
        horizon: horizon(numbers, time),
    };
    let ask = |lane: usize| others[lane];
    // The difference of the two times is rounded as well.
    let later = contacts.map(|time| time + 1.0e-14 * long);
    let solved = Polynomial.not_before(&here, ask, &crowd);
    check(solved, later, crowd.horizon, "blurred, solved");
    let provided = Provided.not_before(&here, ask, &crowd);
    check(provided, later, crowd.horizon, "blurred, provided");
}

fn bounds_hold<const D: usize>(numbers: &mut Numbers) {
    let straight = |position, velocity, _| Straight::<D> { position, velocity };
    let parabola = |position, velocity, acceleration| Parabola::<D> {
        position,
        velocity,
        acceleration,
    };
    flying(numbers, straight);
    flying(numbers, parabola);
    resting(numbers, straight);
    resting(numbers, parabola);
    blurred(numbers, straight);
    blurred(numbers, parabola);
}

/// A grain that has just left one at rest, at all speeds and on all sides.
fn returns_hold<const D: usize>(numbers: &mut Numbers) {
    let mut scale = |least: f64, most: f64| {
        let part = 0.5 * (1.0 + numbers.next());
        libm::exp10(least + part * (most - least))
    };
    let (fast, along, pulled) = (scale(-9.0, 3.0), scale(-12.0, 0.0), scale(-3.0, 3.0));
    let mut vector = || Vector::<D>::from_fn(|_, _| numbers.next());
    let normal = vector().normalize();
    let distance = 1.0 + 1.0e-13 * vector()[0];
    let mut velocity = vector() * fast;
    // Away, often by a hair.
    velocity += normal * (-velocity.dot(&normal) - fast * along);
    let own = Parabola {
        position: Vector::<D>::zeros(),
        velocity,
        acceleration: vector() * pulled,
    };
    let place = normal * distance;
    let rest = Parabola {
        position: place,
        velocity: Vector::<D>::zeros(),
        acceleration: Vector::<D>::zeros(),
    };
    let forecast = Polynomial.pair(&Approach {
        first: own,
        second: rest,
        shift: Vector::<D>::zeros(),
        distance: 1.0,
        growth: 0.0,
        touching: true,
        horizon: f64::INFINITY,
    });
    let bound = Polynomial.not_back_before(&own, &place);
    let contact = match forecast {
        Forecast::Never => f64::INFINITY,
        Forecast::Contact(time) | Forecast::AskAgain(time) => time,
    };
    assert!(bound <= contact, "{bound} > {contact}: {own:?} {place:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// A bound that is later than the contact is a collision that is missed.
    #[test]
    fn no_bound_is_later_than_the_contact(seed in any::<u64>()) {
        let mut numbers = Numbers(seed);
        bounds_hold::<1>(&mut numbers);
        bounds_hold::<2>(&mut numbers);
        bounds_hold::<3>(&mut numbers);
        bounds_hold::<5>(&mut numbers);
    }

    /// Nobody is back before the time up to which it is said to be away.
    #[test]
    fn nobody_is_back_too_early(seed in any::<u64>()) {
        let mut numbers = Numbers(seed);
        for _ in 0..20 {
            returns_hold::<1>(&mut numbers);
            returns_hold::<2>(&mut numbers);
            returns_hold::<3>(&mut numbers);
        }
    }
}
