//! The last digits of a contact time.
//!
//! Next to the root of a gap all its digits cancel. So the gap there is
//! computed with twice the digits, from the flights themselves, and Newton's
//! method takes the time from a certain lower bound to the root.

use super::double_double::{Pair, pair_product, pair_sum, two_product, two_sum};
use super::gap::{CERTAIN, GapPolynomial};
use crate::model::{Approach, PolynomialFlight};

/// Newton steps; each is at least ten times smaller than the one before.
const MOST_STEPS: usize = 16;
/// What is left of a step may change the time by an eighth of its last digit.
const LAST_DIGIT: f64 = 0.125 * f64::EPSILON;

/// The gap at a time as high and low digits: f, or if they have just collided
/// f/t with f(0) counted as zero.
#[inline]
fn residual<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
    bent: bool,
    t: f64,
) -> f64 {
    let (first, second) = (&approach.first, &approach.second);
    let (from, to) = (first.position(0.0), second.position(0.0));
    let (before, after) = (first.velocity(0.0), second.velocity(0.0));
    let (distance, growth, touching) = (approach.distance, approach.growth, approach.touching);
    let mut total: Pair = (0.0, 0.0);
    for axis in 0..D {
        let difference = two_sum(to[axis], -from[axis]);
        let place = pair_sum(difference, (approach.shift[axis], 0.0));
        // Mean velocity up to t.
        let mut speed = two_sum(after[axis], -before[axis]);
        if bent {
            let pull = two_sum(second.acceleration()[axis], -first.acceleration()[axis]);
            let gained = two_product(0.5 * t, pull.0);
            speed = pair_sum(speed, (gained.0, gained.1 + 0.5 * t * pull.1));
        }
        let way = two_product(t, speed.0);
        let way = (way.0, way.1 + t * speed.1);
        let term = if touching {
            let sum = pair_sum((2.0 * place.0, 2.0 * place.1), way);
            pair_product(speed, sum)
        } else {
            let sum = pair_sum(place, way);
            pair_product(sum, sum)
        };
        total = pair_sum(total, term);
    }
    let contact = if growth == 0.0 {
        if touching {
            (0.0, 0.0)
        } else {
            two_product(distance, distance)
        }
    } else if touching {
        let sum = pair_sum(two_product(growth, t), (2.0 * distance, 0.0));
        pair_product((growth, 0.0), sum)
    } else {
        let sum = pair_sum(two_product(growth, t), (distance, 0.0));
        pair_product(sum, sum)
    };
    let rest = pair_sum(total, (-contact.0, -contact.1));
    rest.0 + rest.1
}

/// The root next to `from`, up to which the gap is certainly positive and where
/// it is nearly zero; nothing if it is not certain that there is one, and that
/// it is the next.
///
/// It is if over twice the Newton step the slope can't change by more than a
/// quarter: then f falls all the way, and the step ends within a tenth of itself
/// of the only root.
#[inline]
pub(super) fn refine<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
    gap: &GapPolynomial<f64>,
    bent: bool,
    from: f64,
) -> Option<f64> {
    let [_, _, c2, c3, c4] = gap.coefficients;
    let touching = approach.touching;
    let mut t = from;
    let unit = CERTAIN * 0.5 * f64::EPSILON;
    let margin = if touching {
        let [e1, e2] = gap.margins();
        e1 + t * (e2 + unit * c4 * t * t)
    } else {
        unit * gap.size(t)
    };
    for _ in 0..MOST_STEPS {
        let value = residual(approach, bent, t);
        let slope = if touching {
            c2 + t * (2.0 * c3 + t * (3.0 * c4))
        } else {
            gap.slope(t)
        };
        let falling = slope < 0.0;
        if !falling {
            return None;
        }
        if t == 0.0 && value <= 0.0 {
            // A contact that began at or before the start.
            let bend = gap.motion_scale + c2.abs();
            let certain = slope * slope >= 16.0 * margin * bend;
            return certain.then_some(0.0);
        }
        let step = value / -slope;
        let reach = step.abs().max(margin / -slope);
        let end = t + 2.0 * reach;
        let bend = if touching {
            c3.abs() + 3.0 * c4 * end
        } else {
            gap.motion_scale + c2.abs() + end * (3.0 * c3.abs() + 6.0 * c4 * end)
        };
        let certain = 16.0 * reach * bend <= -slope;
        if !certain || (touching && reach > t / 4096.0) {
            return None;
        }
        let next = t + step;
        // Of the slope's digits at least 12 are right after a collision, 26 else.
        let doubt = if touching { 1.0 / 4096.0 } else { 1.5e-8 };
        let rest = step.abs() * (step.abs() * bend / -slope + doubt);
        if next == t || rest <= LAST_DIGIT * next {
            return (next >= 0.0).then_some(next);
        }
        t = next;
    }
    None
}
