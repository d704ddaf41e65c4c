//! Grains and walls.

use super::descent::{first_root, quadratic_descent};
use super::{DoubleDouble, Real, forecast, rounded};
use crate::model::{Encounter, Flight, Forecast, PolynomialFlight, Shape, Wall};
use crate::particle::Vector;

/// Steps before a curved wall's question is put off.
const MOST_STEPS: usize = 100;
/// What the gap to a flat wall is lowered by, in roundings u of its terms: twice
/// the most that sums, products and the quotient of the root can be wrong by.
const PLANE_CERTAIN: f64 = 32.0;
/// Sizes below this are safe to multiply.
const LARGE: f64 = 1.0e140;
/// No two instants that can be named are farther apart, in √(d/g).
const LATEST: f64 = 2.0e10;
/// Rounding of a distance, relative to the numbers it is computed from.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A flat wall at rest: the gap is a polynomial of degree two.
///
/// What `f64` makes of it is lowered by more than its rounding. If even so there
/// is no contact up to the horizon, there is none; else the gap is solved again
/// with twice the digits.
#[inline]
pub(super) fn plane<const D: usize, F: PolynomialFlight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    normal: &Vector<D>,
    offset: f64,
) -> Forecast {
    let flight = &encounter.flight;
    let (touching, horizon) = (encounter.touching, encounter.horizon);
    let (position, velocity) = (flight.position(0.0), flight.velocity(0.0));
    let unit = PLANE_CERTAIN * 0.5 * f64::EPSILON;
    let (along, size) = both(normal, &position);
    let e0 = unit * (size + offset.abs() + encounter.radius);
    let c0 = along - offset - encounter.radius - e0;
    let (along, size) = both(normal, &velocity);
    let e1 = unit * (size + encounter.growth.abs());
    let c1 = along - encounter.growth - e1;
    let c2 = if F::ACCELERATES {
        let (along, size) = both(normal, &flight.acceleration());
        0.5 * along - unit * size
    } else {
        0.0
    };
    // An overflow decides nothing.
    let usual = c0.abs() < LARGE && c1.abs() < LARGE && c2.abs() < LARGE;
    // After a collision the gap is zero and divided out. What begins within
    // rounding of the wall is left to the wide arithmetic.
    if usual && (touching || c0 > 0.0) {
        let root = if !touching {
            first_root(c0, c1, c2)
        } else if c1 < 0.0 {
            0.0
        } else {
            first_root(c1, c2, 0.0)
        };
        if root > horizon || root == f64::INFINITY {
            return Forecast::Never;
        }
    }
    settle_plane(encounter, normal, offset)
}

/// n · x and the sum of the sizes of its terms.
#[inline]
fn both<const D: usize>(n: &Vector<D>, x: &Vector<D>) -> (f64, f64) {
    let (mut sum, mut size) = (0.0, 0.0);
    for axis in 0..D {
        let term = n[axis] * x[axis];
        sum += term;
        size += term.abs();
    }
    (sum, size)
}

fn settle_plane<const D: usize, F: PolynomialFlight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    normal: &Vector<D>,
    offset: f64,
) -> Forecast {
    let flight = &encounter.flight;
    let wide = DoubleDouble::from_f64;
    let along = |x: &Vector<D>| {
        let mut sum = DoubleDouble::ZERO;
        for axis in 0..D {
            // Most walls stand across an axis.
            if normal[axis] != 0.0 {
                sum = sum + wide(normal[axis]) * wide(x[axis]);
            }
        }
        sum
    };
    let c0 = along(&flight.position(0.0)) - wide(offset) - wide(encounter.radius);
    let c1 = along(&flight.velocity(0.0)) - wide(encounter.growth);
    let c2 = if F::ACCELERATES {
        along(&flight.acceleration()).times(0.5)
    } else {
        DoubleDouble::ZERO
    };
    let horizon = wide(encounter.horizon.next_up());
    let forecast = forecast(rounded(quadratic_descent(
        [c0, c1, c2],
        encounter.touching,
        horizon,
    )));
    match forecast {
        // Numbers so large that products overflow.
        Forecast::Contact(time) if !time.is_finite() => Forecast::Never,
        other => other,
    }
}

/// First contact of a grain with a wall of any form, found from its distance alone:
/// for predictors of one's own, whatever the flights are.
///
/// `acceleration`, in g, bounds that of the flight from its start up to the horizon.
/// No contact is passed over if that bound, those of [`Wall::shape`] and, to 8 ε
/// (|x| + |φ| + R), the wall's distances φ are right.
pub fn wall_by_distance<const D: usize, F: Flight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    acceleration: f64,
) -> Forecast {
    match encounter.wall.shape() {
        Shape::Plane { .. } => general(encounter, acceleration, 0.0, 0.0, 0.0),
        Shape::General {
            curvature,
            speed,
            acceleration: of_wall,
        } => general(encounter, acceleration, curvature, speed, of_wall),
    }
}

/// Any wall, from its distance alone, and any flight whose acceleration has a bound.
///
/// Far from it a grain cannot touch before it has covered the gap. Near it the
/// gap φ obeys φ″ ≥ −B, with B from the wall's curvature and the accelerations, and
/// φ + φ′ s − B s²/2 lies below it. The longer of the two steps is taken; neither
/// passes a contact, if the wall's distances are right to [`ROUNDING`]: φ counts
/// as less by as much. Contact is where it is twice that or less, and closing.
fn general<const D: usize, F: Flight<D>, W: Wall<D>>(
    encounter: &Encounter<'_, D, F, W>,
    acceleration: f64,
    curvature: f64,
    wall_speed: f64,
    wall_acceleration: f64,
) -> Forecast {
    let Encounter {
        flight,
        wall,
        since,
        growth,
        horizon,
        ..
    } = *encounter;
    let mut t = 0.0;
    for count in 0..MOST_STEPS {
        let (position, velocity, now) = (flight.position(t), flight.velocity(t), since + t);
        let radius = encounter.radius + growth * t;
        let distance = wall.distance(&position, now);
        if distance.is_nan() {
            return Forecast::Never;
        }
        let normal = wall.normal(&position, now);
        let opening = normal.dot(&(velocity - wall.velocity(&position, now))) - growth;
        let rounding = ROUNDING * (position.norm_squared().sqrt() + distance.abs() + radius);
        let gap = if count == 0 && encounter.touching {
            0.0
        } else {
            distance - radius
        };
        if gap <= 2.0 * rounding && opening < 0.0 {
            return Forecast::Contact(t);
        }
        // So much there is of it at least.
        let sure = gap - rounding;
        let speed = velocity.norm_squared().sqrt() + wall_speed;
        let mut advance = covered(sure, speed + growth.max(0.0), acceleration);
        // The curvature is known out to one diameter; beyond 1 d it may grow
        // inwards like that of parallel surfaces.
        let known = encounter.radius.max(0.5) * 2.0;
        let sharper = 1.0 - curvature * (known - 1.0);
        if distance < known && (sharper > 0.5 || gap <= rounding) {
            let margin = known - distance;
            // Within it the grain is no faster than that.
            let fastest_squared = speed * speed + 2.0 * acceleration * margin;
            let bound =
                acceleration + wall_acceleration + curvature / sharper.max(0.5) * fastest_squared;
            let step = minorant_step(gap, opening, bound, rounding, radius / speed);
            advance = advance.max(step.min(covered(margin, speed, acceleration)));
        }
        t += advance;
        // Nor is there one where numbers end.
        if t.is_nan() || t > LATEST || t > horizon {
            return Forecast::Never;
        }
    }
    Forecast::AskAgain(t.max(f64::MIN_POSITIVE))
}

/// The time in which something of this speed and acceleration covers a length.
fn covered(length: f64, speed: f64, acceleration: f64) -> f64 {
    if length > 0.0 {
        2.0 * length / (speed + (speed * speed + 2.0 * acceleration * length).sqrt())
    } else {
        0.0
    }
}

/// A step that passes no contact if φ″ ≥ −`bound`. `pass` is the time in which
/// the grain moves by its radius.
fn minorant_step(gap: f64, opening: f64, bound: f64, rounding: f64, pass: f64) -> f64 {
    if !bound.is_finite() {
        // A corner: get away from it if it touches.
        return if gap <= rounding { 1.0e-6 * pass } else { 0.0 };
    }
    if opening < 0.0 {
        return first_root(gap - rounding, opening, -0.5 * bound);
    }
    // Over a time so short that curvature changes the gap by less than its
    // rounding, an opening gap stays open.
    let least = (rounding / bound).sqrt();
    let step = if gap < -rounding {
        // Overlapping and opening: up to where it might begin to close.
        opening / bound
    } else {
        first_root((gap - rounding).max(0.0), opening, -0.5 * bound)
    };
    step.max(least)
}
