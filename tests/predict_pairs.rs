//! Contacts of pairs that can be worked out by hand, and inputs at the edge of
//! what a number can hold.

use grainfall::Vector;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{
    Approach, Crowd, Encounter, Forecast, LANES, Nook, PolynomialFlight, Predictor, Resting, Wall,
};
use grainfall::predict::{Descent, DoubleDouble, Polynomial, Real, Relative, first_contact};
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

/// A sequence of numbers between -1 and 1 from a seed.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        // Splitmix.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector<const D: usize>(&mut self) -> Vector<D> {
        Vector::<D>::from_fn(|_, _| self.next())
    }

    fn pick(&mut self, of: usize) -> usize {
        ((self.next() + 1.0) * 0.5 * of as f64) as usize
    }

    fn coin(&mut self) -> bool {
        self.next() > 0.0
    }

    /// Between 10^least and 1.
    fn small(&mut self, least: f64) -> f64 {
        libm::exp10(least * 0.5 * (1.0 + self.next()))
    }

    fn direction<const D: usize>(&mut self) -> Vector<D> {
        loop {
            let v = self.vector::<D>();
            if v.norm() > 0.1 {
                return v.normalize();
            }
        }
    }
}

/// Two grains: how the second moves as the first sees it, and when about they
/// meet. Most meet, or graze, or touch already; a few miss.
fn meeting<const D: usize>(
    numbers: &mut Numbers,
    pull: Vector<D>,
    growth: f64,
) -> (Relative<D>, f64) {
    let distance = match numbers.pick(4) {
        0 => 0.05 + 0.01 * numbers.next(),
        1 => 20.0,
        _ => 1.0,
    };
    let growth = growth * distance;
    let time = match numbers.pick(6) {
        0 => 0.0,
        1 => numbers.small(-16.0),
        2 => 30.0 * numbers.small(-2.0),
        _ => numbers.small(-4.0),
    };
    let normal: Vector<D> = numbers.direction();
    let mut along: Vector<D> = numbers.vector();
    along *= match numbers.pick(4) {
        0 => 100.0 * numbers.small(-14.0),
        _ => 2.0,
    };
    let closing = match numbers.pick(4) {
        0 => 0.0,
        1 => numbers.small(-16.0),
        2 => -numbers.small(-16.0),
        _ => numbers.next(),
    };
    let then = along - normal * (normal.dot(&along) + closing - growth);
    let gap = match numbers.pick(3) {
        0 => distance * 1.0e-4 * numbers.next() * numbers.small(-13.0),
        _ => 0.0,
    };
    let velocity = then - pull * time;
    let place = normal * (distance + growth * time + gap);
    let relative = Relative {
        offset: place - velocity * time - pull * (0.5 * time * time),
        velocity,
        acceleration: pull,
        distance,
        growth,
    };
    (relative, time)
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
