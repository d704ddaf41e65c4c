//! The last digits of a contact time.
//!
//! Next to the root of a gap all its digits cancel. So the gap there is
//! computed with twice the digits, from the flights themselves, and Newton's
//! method takes the time from a certain lower bound to the root.

use wide::f64x4;

use super::double_double::{two_product, two_square, two_sum};
use super::gap::{CERTAIN, GapPolynomial};
use crate::model::{Approach, PolynomialFlight};
use crate::particle::Vector;

/// Newton steps; each is at least ten times smaller than the one before.
const MOST_STEPS: usize = 16;
/// What is left of a step may change the time by an eighth of its last digit.
const LAST_DIGIT: f64 = 0.125 * f64::EPSILON;

/// A sum of many terms of which the leading ones cancel: exact leading digits,
/// everything else in one number.
#[derive(Clone, Copy)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    #[inline]
    fn add(&mut self, (high, low): (f64, f64)) {
        let (sum, error) = two_sum(self.high, high);
        self.high = sum;
        self.low += error + low;
    }
}

/// Components along up to four axes from `first` on, zeros beyond the last.
#[inline(always)]
fn some<const D: usize>(v: &Vector<D>, first: usize) -> f64x4 {
    f64x4::new(std::array::from_fn(|lane| {
        if first + lane < D {
            v[first + lane]
        } else {
            0.0
        }
    }))
}

/// The gap at a time: f, or if they have just collided f/t with f(0) counted as
/// zero. Right to 2⁻⁹⁸ of its size. All axes are worked at together, and added
/// up in their order.
#[inline]
fn residual<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
    bent: bool,
    t: f64,
) -> f64 {
    let (first, second) = (&approach.first, &approach.second);
    let (distance, growth, touching) = (approach.distance, approach.growth, approach.touching);
    let wide = f64x4::splat;
    let mut total = Sum {
        high: 0.0,
        low: 0.0,
    };
    for from in (0..D).step_by(4) {
        // Leading digits in each first part, what they leave in the second.
        let (apart, rest) = two_sum(some(&second.start(), from), -some(&first.start(), from));
        let (place, place_rest) = two_sum(apart, some(&approach.shift, from));
        // The rest may be of digits far above those of so short a sum.
        let (place, place_rest) = two_sum(place, place_rest + rest);
        // Mean velocity up to t.
        let (mut speed, mut speed_rest) = two_sum(
            some(&second.start_velocity(), from),
            -some(&first.start_velocity(), from),
        );
        if bent {
            let (pull, rest) = two_sum(
                some(&second.acceleration(), from),
                -some(&first.acceleration(), from),
            );
            let (gained, gained_rest) = two_product(wide(0.5 * t), pull);
            let (sum, sum_rest) = two_sum(speed, gained);
            speed = sum;
            speed_rest += sum_rest + gained_rest + wide(0.5 * t) * rest;
        }
        let (way, mut way_rest) = two_product(wide(t), speed);
        way_rest += wide(t) * speed_rest;
        let (terms, rests) = if touching {
            let (sum, rest) = two_sum(wide(2.0) * place, way);
            let rest = rest + (wide(2.0) * place_rest + way_rest);
            let (product, error) = two_product(speed, sum);
            (product, error + (speed * rest + speed_rest * sum))
        } else {
            let (sum, rest) = two_sum(place, way);
            let rest = rest + (place_rest + way_rest);
            let (square, error) = two_square(sum);
            (square, error + wide(2.0) * sum * rest)
        };
        let (terms, rests) = (terms.to_array(), rests.to_array());
        for (lane, term) in terms.into_iter().enumerate().take(D - from) {
            total.add((term, rests[lane]));
        }
    }
    if growth == 0.0 {
        if !touching {
            let (square, error) = two_square(distance);
            total.add((-square, -error));
        }
    } else {
        let (grown, grown_rest) = two_product(growth, t);
        if touching {
            let (sum, rest) = two_sum(grown, 2.0 * distance);
            let (product, error) = two_product(growth, sum);
            total.add((-product, -error - growth * (rest + grown_rest)));
        } else {
            let (sum, rest) = two_sum(grown, distance);
            let (square, error) = two_square(sum);
            total.add((-square, -error - 2.0 * sum * (rest + grown_rest)));
        }
    }
    total.high + total.low
}

/// The root next to `from`, up to which the gap is certainly positive and where
/// it is nearly zero; nothing if it is not certain that there is one, and that
/// it is the next.
///
/// It is if over twice the way to it the slope can't change by more than a
/// quarter: then f falls all the way to the only root.
#[inline]
pub(super) fn refine<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
    gap: &GapPolynomial<f64>,
    bent: bool,
    from: f64,
) -> Option<f64> {
    let [_, _, c2, c3, c4] = gap.coefficients;
    let touching = approach.touching;
    let unit = CERTAIN * 0.5 * f64::EPSILON;
    let margin = if touching {
        let [e1, e2] = gap.margins();
        e1 + from * (e2 + unit * c4 * from * from)
    } else {
        unit * gap.size(from)
    };
    let slope_at = |t: f64| {
        if touching {
            c2 + t * (2.0 * c3 + t * (3.0 * c4))
        } else {
            gap.slope(t)
        }
    };
    // Of the slope's digits at least 12 are right after a collision, 26 else.
    let doubt = if touching { 1.0 / 4096.0 } else { 1.5e-8 };
    let mut t = from;
    let mut slope = slope_at(t);
    for count in 0..MOST_STEPS {
        let falling = slope < 0.0;
        if !falling {
            return None;
        }
        if count == 0 && from > 0.0 {
            // Where the lowered gap is zero this one is about as large as the
            // margin.
            t += margin / -slope;
        }
        let value = residual(approach, bent, t);
        if t == 0.0 && value <= 0.0 {
            // A contact that began at or before the start.
            let bend = gap.motion_scale + c2.abs();
            let certain = slope * slope >= 16.0 * margin * bend;
            return certain.then_some(0.0);
        }
        let step = value / -slope;
        let reach = (t - from) + step.abs().max(margin / -slope);
        let end = from + 2.0 * reach;
        let bend = if touching {
            c3.abs() + 3.0 * c4 * end
        } else {
            gap.motion_scale + c2.abs() + end * (3.0 * c3.abs() + 6.0 * c4 * end)
        };
        let certain = 16.0 * reach * bend <= -slope;
        if !certain || (touching && reach > from / 4096.0) {
            return None;
        }
        let next = t + step;
        // The slope may be that of `from`.
        let rest = step.abs() * (2.0 * reach * bend / -slope + doubt);
        if next == t || rest <= LAST_DIGIT * next {
            return (next >= 0.0).then_some(next);
        }
        t = next;
        slope = slope_at(t);
    }
    None
}
