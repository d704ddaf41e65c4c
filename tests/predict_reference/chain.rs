//! The derivative chain: contacts in double-double, by another algorithm. Zeros of f
//! and f′ are bracketed between the zeros of their derivatives; the contact is the
//! left end of the first stretch on which f is not positive and f′ is negative.

use grainfall::Vector;
use grainfall::predict::{DoubleDouble, Real, Relative};

pub(crate) type Wide = DoubleDouble;

pub(crate) fn wide(x: f64) -> Wide {
    Wide::from_f64(x)
}

/// A polynomial, lowest coefficient first.
#[derive(Clone, Debug)]
pub(crate) struct Chain(Vec<Wide>);

impl Chain {
    pub(crate) fn value(&self, t: Wide) -> Wide {
        self.0.iter().rev().fold(Wide::ZERO, |sum, c| sum * t + *c)
    }

    pub(crate) fn derivative(&self) -> Chain {
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
pub(crate) struct Reference {
    pub(crate) f: Chain,
    /// Zeros of f′: lowest and highest points.
    turns: Vec<Wide>,
    pub(crate) contact: Option<Wide>,
}

impl Reference {
    pub(crate) fn new<const D: usize>(relative: &Relative<D>, touching: bool) -> Self {
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
    pub(crate) fn lowest(&self, from: Wide, to: Option<Wide>) -> Wide {
        let inside = |t: &&Wide| **t > from && to.is_none_or(|to| **t < to);
        let mut lowest = self.f.value(from);
        for t in self.turns.iter().filter(inside) {
            lowest = lowest.at_most(self.f.value(*t));
        }
        lowest.at_most(self.f.value(to.unwrap_or(from.times(4.0) + wide(1.0e3))))
    }
}
