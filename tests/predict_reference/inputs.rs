//! Inputs of predictors: of the kinds that simulations and bad luck produce, and nastier ones.

use grainfall::Vector;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::Approach;
use grainfall::predict::Relative;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

pub(crate) fn uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

/// 10 to a uniform power.
pub(crate) fn magnitude(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    libm::exp10(uniform(rng, low, high))
}

pub(crate) fn direction<const D: usize>(rng: &mut impl Rng) -> Vector<D> {
    loop {
        let v = Vector::<D>::from_fn(|_, _| uniform(rng, -1.0, 1.0));
        let size = v.norm();
        if size > 0.1 && size < 1.0 {
            return v / size;
        }
    }
}

/// A unit vector across another.
pub(crate) fn across<const D: usize>(normal: &Vector<D>, rng: &mut impl Rng) -> Vector<D> {
    loop {
        let v = direction::<D>(rng);
        let v = v - normal * normal.dot(&v);
        if v.norm() > 0.1 {
            break v / v.norm();
        }
    }
}

pub(crate) const KINDS: usize = 8;

/// An input of one of the kinds that simulations and bad luck produce.
pub(crate) fn input<const D: usize>(kind: usize, rng: &mut ChaCha8Rng) -> (Relative<D>, bool) {
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

pub(crate) fn parabolas<const D: usize>(
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

/// Moves a pair to some place in a box, the second by a period.
fn displaced<const D: usize>(
    approach: Approach<D, Parabola<D>>,
    rng: &mut ChaCha8Rng,
) -> Approach<D, Parabola<D>> {
    let mut moved = approach;
    let size = magnitude(rng, 0.0, 3.0);
    let base = direction::<D>(rng) * size;
    let drift = direction::<D>(rng) * magnitude(rng, -3.0, 1.0);
    if rng.random::<f64>() < 0.7 {
        moved.shift[0] = if rng.random() { size } else { -size };
    }
    for flight in [&mut moved.first, &mut moved.second] {
        flight.position += base;
        flight.velocity += drift;
    }
    moved.second.position -= moved.shift;
    moved
}

pub(crate) const MORE_KINDS: usize = KINDS + 6;

/// One of the inputs of the other tests, or a nastier one.
pub(crate) fn nasty<const D: usize>(kind: usize, rng: &mut ChaCha8Rng) -> Approach<D, Parabola<D>> {
    let up = Vector::<D>::from_fn(|axis, _| if axis + 1 == D { 1.0 } else { 0.0 });
    let plain = |relative: &Relative<D>, touching| parabolas(relative, touching, f64::INFINITY);
    if kind < KINDS {
        let (relative, touching) = input::<D>(kind, rng);
        return plain(&relative, touching);
    }
    match kind - KINDS {
        // Far from the origin, through a periodic side.
        0 => {
            let (relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            displaced(plain(&relative, touching), rng)
        }
        // Huge and tiny speeds.
        1 => {
            let (mut relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            let factor = magnitude(rng, -24.0, 24.0);
            relative.velocity *= factor;
            relative.growth *= factor;
            if rng.random() {
                relative.acceleration *= factor;
            }
            plain(&relative, touching)
        }
        // A double root: the distance is the closest approach, to a few digits.
        2 => {
            let (mut relative, _) = input::<D>(2, rng);
            let (r, v, a) = (relative.offset, relative.velocity, relative.acceleration);
            let place = |t: f64| (r + (v + a * (0.5 * t)) * t).norm();
            let (mut low, mut high) = (0.0, 6.0);
            for _ in 0..200 {
                let (one, two) = (low + (high - low) * 0.45, low + (high - low) * 0.55);
                if place(one) < place(two) {
                    high = two;
                } else {
                    low = one;
                }
            }
            relative.distance = place(low);
            for _ in 0..rng.random_range(0..5) {
                relative.distance = if rng.random() {
                    relative.distance.next_up()
                } else {
                    relative.distance.next_down()
                };
            }
            plain(&relative, false)
        }
        // Near a root of order four: over the top with the curvature of the grain.
        3 => {
            let distance = uniform(rng, 0.5, 1.5);
            let normal = direction::<D>(rng);
            let sideways = across(&normal, rng);
            let mut small =
                |low, high| magnitude(rng, low, high) * if rng.random() { 1.0 } else { -1.0 };
            let speed = distance.sqrt() * (1.0 + small(-17.0, -4.0));
            let relative = Relative {
                offset: normal * (distance * (1.0 + small(-18.0, -8.0))),
                velocity: sideways * speed + normal * small(-18.0, -6.0),
                acceleration: -normal,
                distance,
                growth: 0.0,
            };
            plain(&relative, rng.random())
        }
        // Round numbers: exact ties, grazes and contacts at whole times.
        4 => {
            let mut whole = |n: i32| f64::from(rng.random_range(-n..=n));
            let mut vector = |n: i32| Vector::<D>::from_fn(|_, _| whole(n) / 4.0);
            let relative = Relative {
                offset: vector(12),
                velocity: vector(8),
                acceleration: vector(3),
                distance: 1.25,
                growth: 0.0,
            };
            plain(&relative, rng.random::<f64>() < 0.3)
        }
        // Nearly the same acceleration.
        _ => {
            let (mut relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            relative.acceleration = direction::<D>(rng) * magnitude(rng, -18.0, -3.0);
            if rng.random() {
                relative.velocity = up * magnitude(rng, -6.0, 0.0);
            }
            plain(&relative, touching)
        }
    }
}

pub(crate) fn straight<const D: usize>(
    approach: &Approach<D, Parabola<D>>,
) -> Approach<D, Straight<D>> {
    let of = |flight: &Parabola<D>| Straight {
        position: flight.position,
        velocity: flight.velocity,
    };
    Approach {
        first: of(&approach.first),
        second: of(&approach.second),
        shift: approach.shift,
        distance: approach.distance,
        growth: approach.growth,
        touching: approach.touching,
        horizon: approach.horizon,
    }
}
