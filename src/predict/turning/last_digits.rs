//! The last digits of a contact time: the gap of the parabola with twice the
//! digits, and what the turn adds in plain ones, for that is small.

use super::course::Course;
use crate::model::{Approach, TurningFlight};
use crate::particle::Vector;
use crate::predict::double_double::{two_product, two_square, two_sum};
use crate::predict::gap::CERTAIN;

/// Newton steps; each is at least ten times smaller than the one before.
const MOST_STEPS: usize = 16;
/// What is left of a step may change the time by an eighth of its last digit.
const LAST_DIGIT: f64 = 0.125 * f64::EPSILON;

/// A number and a small rest.
type Pair = (f64, f64);

/// A sum that keeps what rounding takes from it.
#[derive(Default)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    fn add(&mut self, (high, low): Pair) {
        let (sum, error) = two_sum(self.high, high);
        self.high = sum;
        self.low += error + low;
    }

    fn value(&self) -> f64 {
        self.high + self.low
    }

    fn pair(&self) -> Pair {
        two_sum(self.high, self.low)
    }
}

/// to − from.
fn difference(to: f64, from: f64) -> Pair {
    two_sum(to, -from)
}

/// The exact sum of two of these, but for the last digit of the rest.
fn sum(a: Pair, b: Pair) -> Pair {
    let mut sum = Sum {
        high: a.0,
        low: a.1,
    };
    sum.add(b);
    sum.pair()
}

fn times(factor: f64, a: Pair) -> Pair {
    let (high, error) = two_product(factor, a.0);
    (high, error + factor * a.1)
}

fn product(a: Pair, b: Pair) -> Pair {
    let (high, error) = two_product(a.0, b.0);
    (high, error + (a.0 * b.1 + a.1 * b.0))
}

/// The gap at a time: f, or if they have just collided f/t with f(0) counted as
/// zero; and how wrong it may be because of the turn.
fn residual<const D: usize, F: TurningFlight<D>>(
    approach: &Approach<D, F>,
    course: &Course<f64, D>,
    t: f64,
) -> (f64, f64) {
    let (first, second) = (&approach.first, &approach.second);
    let (touching, growth, distance) = (approach.touching, approach.growth, approach.distance);
    let (correction, doubt) = course.correction(t);
    let of = |v: &Vector<D>, w: &Vector<D>, axis: usize| difference(v[axis], w[axis]);
    let starts = (second.start(), first.start());
    let velocities = (second.start_velocity(), first.start_velocity());
    let steadies = (second.steady(), first.steady());
    let turnings = (second.turning(), first.turning());
    let mut total = Sum::default();
    let mut farthest: f64 = 0.0;
    for (axis, &turn) in correction.iter().enumerate() {
        let place = sum(of(&starts.0, &starts.1, axis), (approach.shift[axis], 0.0));
        let pull = sum(
            of(&steadies.0, &steadies.1, axis),
            of(&turnings.0, &turnings.1, axis),
        );
        let mean = sum(of(&velocities.0, &velocities.1, axis), times(0.5 * t, pull));
        let mean = sum(mean, (turn, 0.0));
        let way = times(t, mean);
        if touching {
            let both = sum((2.0 * place.0, 2.0 * place.1), way);
            total.add(product(mean, both));
            farthest = farthest.max(both.0.abs());
        } else {
            let there = sum(place, way);
            let (square, error) = two_square(there.0);
            total.add((square, error + 2.0 * there.0 * there.1));
            farthest = farthest.max(there.0.abs());
        }
    }
    let grown = times(t, (growth, 0.0));
    if touching {
        let both = sum(grown, (2.0 * distance, 0.0));
        let (high, low) = times(growth, both);
        total.add((-high, -low));
    } else {
        let there = sum(grown, (distance, 0.0));
        let (square, error) = two_square(there.0);
        total.add((-square, -error - 2.0 * there.0 * there.1));
    }
    let reach = D as f64 * farthest;
    let doubt = if touching {
        reach * doubt
    } else {
        2.0 * reach * doubt * t
    };
    (total.value(), doubt)
}

/// The root next to `from`, up to which the gap is certainly positive and where
/// it is nearly zero; nothing if it is not certain that there is one, that it is
/// the next, and where.
///
/// It is if over twice the way to it the slope can't change by more than a
/// quarter: then f falls all the way to the only root.
pub(super) fn refine<const D: usize, F: TurningFlight<D>>(
    approach: &Approach<D, F>,
    course: &Course<f64, D>,
    from: f64,
) -> Option<f64> {
    let touching = approach.touching;
    if touching && from == 0.0 {
        return None;
    }
    let most = course.acceleration_bound();
    let length = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = CERTAIN * 0.5 * f64::EPSILON;
    let mut t = from;
    for _ in 0..MOST_STEPS {
        let place = course.at(t);
        let slope = course.slope(&place, t);
        let (far, speed) = (length(&place.offset), length(&place.velocity));
        let (value, doubt) = residual(approach, course, t);
        let falling = slope < 0.0;
        if !falling {
            return None;
        }
        // Of the slope's own rounding.
        if -slope < 4096.0 * unit * far * (speed + most * t) {
            return None;
        }
        let (slope, bend) = if touching {
            // q = f/t: q′ is f′/t where f is zero, and so is q″ but for q′/t.
            let steep = slope / t;
            (steep, (speed * speed + far * most) / t + -steep / t)
        } else {
            (slope, speed * speed + far * most)
        };
        if t == 0.0 && value <= 0.0 {
            // A contact that began at or before the start.
            let margin = unit * (far * far + approach.distance * approach.distance);
            let certain = slope * slope >= 16.0 * margin * (bend + approach.growth.abs());
            return certain.then_some(0.0);
        }
        let step = value / -slope;
        let reach = (t - from).abs() + step.abs();
        let fastest = speed + 2.0 * reach * most;
        let more = fastest * fastest + (far + 2.0 * reach * fastest) * most;
        let bend = bend.max(if touching { more / t } else { more });
        let bend = bend + approach.growth * approach.growth / if touching { t } else { 1.0 };
        let certain = 16.0 * reach * bend <= -slope;
        if !certain || (touching && reach > from / 4096.0) {
            return None;
        }
        let next = t + step;
        // The turn may not blur the last digit.
        if doubt > LAST_DIGIT * next * -slope {
            return None;
        }
        let rest = step.abs() * (2.0 * reach * bend / -slope + 1.0 / 4096.0);
        if next == t || rest <= LAST_DIGIT * next {
            return (next >= 0.0).then_some(next);
        }
        t = next;
    }
    None
}
