//! The first time at which a polynomial falls through zero.
//!
//! Everything rests on one inequality. If h = f″/2 is at least m from t on, then
//! f(t + s) ≥ f(t) + f′(t) s + m s², and before the first root of the right side
//! there is none of f. Steps to that root, the *minorant's*, never pass a contact;
//! near a simple root they converge quadratically or better, because m tends to h.
//! Nothing here counts crossings, so rounding of f(0) cannot turn the answer over.
//!
//! Iterates, trust lengths and starting points come from the coefficients alone.
//! The horizon only ends a search early, and only at an iterate that the answer
//! cannot precede: the bits of an answer do not depend on it.

use super::Real;
use super::gap::GapPolynomial;

/// More steps than any input has been seen to need (fewer than 64, at a graze).
const MOST_STEPS: usize = 256;

/// When a function first falls through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Descent<N> {
    /// Not up to the horizon.
    Never,
    /// Then.
    At(N),
    /// Not before this time; after many steps it is still unknown when.
    NotBefore(N),
}

/// First s ≥ 0 at which value + slope·s + half_curvature·s² falls to zero,
/// infinity if it does not; value ≥ 0.
#[inline]
pub(super) fn first_root<N: Real>(value: N, slope: N, half_curvature: N) -> N {
    let b = slope.times(0.5);
    let discriminant = b * b - half_curvature * value;
    if slope < N::ZERO {
        // This form and the other one cancel at opposite signs of the slope.
        let divisor = if discriminant >= N::ZERO {
            discriminant.sqrt() - b
        } else {
            N::ZERO
        };
        if divisor > N::ZERO {
            value / divisor
        } else {
            N::INFINITY
        }
    } else if half_curvature < N::ZERO {
        (b + discriminant.sqrt()) / -half_curvature
    } else {
        N::INFINITY
    }
}

/// False for what is no time at all, whatever the horizon.
#[inline]
fn is_within<N: Real>(time: N, horizon: N) -> bool {
    time < N::INFINITY && time <= horizon
}

#[inline]
fn up_to<N: Real>(time: N, horizon: N) -> Descent<N> {
    if is_within(time, horizon) {
        Descent::At(time)
    } else {
        Descent::Never
    }
}

/// First t ≥ 0 at which c₀ + c₁ t + c₂ t² is zero or less and falling. If
/// `touching`, c₀ counts as exactly zero and is divided out.
#[inline]
pub fn quadratic_descent<N: Real>([c0, c1, c2]: [N; 3], touching: bool, horizon: N) -> Descent<N> {
    let zero = N::ZERO;
    let time = if !touching && c0 > zero {
        first_root(c0, c1, c2)
    } else if c1 < zero {
        zero
    } else if c2 >= zero {
        N::INFINITY
    } else if touching {
        c1 / -c2
    } else {
        // Overlapping and opening. If it does not come apart before it closes
        // again, contact is when it begins to close.
        let turn = c1.times(0.5) / -c2;
        if c0 + turn * c1.times(0.5) <= zero {
            turn
        } else {
            let b = c1.times(0.5);
            let discriminant = (b * b - c2 * c0).at_least(zero);
            (b + discriminant.sqrt()) / -c2
        }
    };
    up_to(time, horizon)
}

/// First t ≥ 0 at which q₀ + q₁ t + q₂ t² + q₃ t³ falls from zero or more to
/// less; q₀ ≥ 0, q₃ ≥ 0.
///
/// Because q₃ ≥ 0 the curvature never decreases: the Taylor parabola itself is
/// a minorant, and its remainder is exactly q₃ s³.
pub fn cubic_descent<N: Real>([q0, q1, q2, q3]: [N; 4], horizon: N) -> Descent<N> {
    let zero = N::ZERO;
    let (mut t, mut value, mut slope, mut half_curvature) = (zero, q0, q1, q2);
    for _ in 0..MOST_STEPS {
        if value < zero {
            if slope < zero {
                return up_to(t, horizon);
            }
            // Rounding: the steps so far have shown that it is not negative.
            value = zero;
        }
        let step = first_root(value, slope, half_curvature);
        let next = t + step;
        if !is_within(next, horizon) {
            return Descent::Never;
        }
        let rounding = (q0.abs() + next * (q1.abs() + next * (q2.abs() + next * q3)))
            .times(4.0 * N::UNIT_ROUNDOFF);
        if next == t || step * step * step * q3 <= rounding {
            return Descent::At(next);
        }
        t = next;
        value = q0 + t * (q1 + t * (q2 + t * q3));
        slope = q1 + t * (q2.times(2.0) + t * q3.times(3.0));
        half_curvature = q2 + t * q3.times(3.0);
    }
    Descent::NotBefore(t)
}

/// First t ≥ 0 at which the gap is zero or less and falling; c₄ > 0. If
/// `touching`, c₀ counts as exactly zero and is divided out.
pub fn quartic_descent<N: Real>(gap: &GapPolynomial<N>, touching: bool, horizon: N) -> Descent<N> {
    let [c0, c1, c2, c3, c4] = gap.coefficients;
    if !touching && c0 > N::ZERO {
        return from_apart(gap, horizon);
    }
    if c1 < N::ZERO {
        return up_to(N::ZERO, horizon);
    }
    if touching {
        return cubic_descent([c1, c2, c3, c4], horizon);
    }
    // Overlapping and opening: nothing happens until f′ falls through zero. If
    // they have not come apart by then, that is the contact.
    let slope = [c1, c2.times(2.0), c3.times(3.0), c4.times(4.0)];
    match cubic_descent(slope, horizon) {
        Descent::At(turn) if gap.value(turn) > N::ZERO => by_minorants(gap, turn, horizon),
        other => other,
    }
}

/// f(0) > 0. Nearly always f is concave as far as it matters: then it crosses
/// zero exactly once, and Newton's method is the cheapest way there.
#[inline]
fn from_apart<N: Real>(gap: &GapPolynomial<N>, horizon: N) -> Descent<N> {
    let [c0, c1, c2, c3, _] = gap.coefficients;
    let zero = N::ZERO;
    let guess = first_root(c0, c1, c2);
    // With c₃ ≥ 0 the parabola lies below f for ever.
    let from = if c3 >= zero {
        if !is_within(guess, horizon) {
            return Descent::Never;
        }
        guess
    } else {
        zero
    };
    if c2 <= zero && guess < N::INFINITY {
        let end = guess.times(1.5);
        if gap.half_curvature(end) <= zero && gap.value(end) <= zero {
            return up_to(concave_root(gap, from, guess, end), horizon);
        }
    }
    by_minorants(gap, from, horizon)
}

/// The root in `[low, high]` of a concave f with f(low) ≥ 0 ≥ f(high), by
/// Chebyshev's cubic refinement of Newton's method, kept inside the bracket.
#[inline]
fn concave_root<N: Real>(gap: &GapPolynomial<N>, low: N, guess: N, high: N) -> N {
    let [_, _, _, c3, c4] = gap.coefficients;
    let (mut low, mut high, mut t) = (low, high, guess);
    for _ in 0..MOST_STEPS {
        let (value, slope) = (gap.value(t), gap.slope(t));
        if value > N::ZERO {
            low = low.at_least(t);
        } else {
            high = high.at_most(t);
        }
        let inverse = N::from_f64(-1.0) / slope;
        let newton = value * inverse;
        let bend = gap.half_curvature(t) * newton * inverse;
        let step = newton * (N::from_f64(1.0) + bend);
        let next = t + step;
        let inside = slope < N::ZERO && next >= low && next <= high;
        let rounding = gap.rounding(t);
        if !inside {
            if value.abs() <= rounding {
                return t;
            }
            let middle = low + (high - low).times(0.5);
            if middle == t {
                return t;
            }
            t = middle;
            continue;
        }
        // |f(next)| by Taylor's formula, in which most terms cancel.
        let size = step.abs();
        let rest = value.abs() * bend * bend * (N::from_f64(2.0) + bend.abs())
            + size * size * size * ((c3 + t * c4.times(4.0)).abs() + size * c4);
        if rest <= rounding || next == t {
            return next;
        }
        t = next;
    }
    t
}

/// Minorant steps from `from`, up to which there is no contact and where f ≥ 0.
pub(super) fn by_minorants<N: Real>(gap: &GapPolynomial<N>, from: N, horizon: N) -> Descent<N> {
    let zero = N::ZERO;
    let [_, _, _, c3, c4] = gap.coefficients;
    // Where h is least.
    let apex = if c3 < zero { c3 / c4.times(-4.0) } else { zero };
    let least = gap.half_curvature(apex);
    let mut t = from;
    for _ in 0..MOST_STEPS {
        let (mut value, slope) = (gap.value(t), gap.slope(t));
        let half_curvature = gap.half_curvature(t);
        if slope < zero {
            if value <= gap.rounding(t) {
                if value < zero {
                    return up_to(t, horizon);
                }
                let rest = first_root(value, slope, half_curvature);
                return up_to(if rest < N::INFINITY { t + rest } else { t }, horizon);
            }
        } else if value < zero {
            // Rounding: the steps so far have shown that it is not negative.
            // Left so, the minorant would seem to have no root.
            value = zero;
        }
        let step = if slope < zero {
            let (root, trust, bound) = if t >= apex {
                let root = first_root(value, slope, half_curvature);
                (root, N::INFINITY, half_curvature)
            } else {
                trusted_step(gap, t, [value, slope, half_curvature], apex, least)
            };
            let step = root.at_most(trust);
            // What f can be at the root of the minorant, by Taylor's formula.
            let rest = (half_curvature - bound).abs()
                + step * ((c3 + t * c4.times(4.0)).at_least(zero) + step * c4);
            if root <= trust && step * step * rest <= gap.rounding(t) {
                return up_to(t + step, horizon);
            }
            step
        } else if t >= apex {
            first_root(value, slope, half_curvature)
        } else if least >= zero {
            N::INFINITY
        } else {
            if half_curvature > zero {
                // f′ cannot fall before h does.
                let bend = apex - (least / c4.times(-6.0)).sqrt();
                if bend > t {
                    if bend > horizon {
                        return Descent::Never;
                    }
                    t = bend;
                    continue;
                }
            }
            first_root(value, slope, least)
        };
        let next = t + step;
        if !is_within(next, horizon) {
            return Descent::Never;
        }
        if next == t {
            return Descent::At(t);
        }
        t = next;
    }
    Descent::NotBefore(t)
}

/// The minorant before the apex, where h still decreases: its root, the length
/// over which it is trusted to lie below f, and the bound on h over that length.
#[inline]
fn trusted_step<N: Real>(
    gap: &GapPolynomial<N>,
    t: N,
    [value, slope, half_curvature]: [N; 3],
    apex: N,
    least: N,
) -> (N, N, N) {
    let trust = if half_curvature >= N::ZERO {
        // No parabola with this slope has its first root further away.
        value.times(2.0) / -slope
    } else {
        first_root(value, slope, half_curvature).times(2.0)
    };
    let end = t + trust;
    let bound = if end >= apex {
        least
    } else {
        gap.half_curvature(end)
    };
    (first_root(value, slope, bound), trust, bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the top of an arch that rises from zero to zero, rounding may put f
    /// below: a minorant through such a value has no root at all.
    #[test]
    fn a_search_from_the_top_of_an_arch_finds_the_fall() {
        let mut below = 0;
        for step in 1..400 {
            let top = 0.1 * f64::from(step);
            // a (t − top)⁴ − (t − top)².
            let a = 1.0e-3 / (top * top);
            let gap = GapPolynomial {
                coefficients: [
                    a * top * top * top * top - top * top,
                    2.0 * top - 4.0 * a * top * top * top,
                    6.0 * a * top * top - 1.0,
                    -4.0 * a * top,
                    a,
                ],
                place_scale: top * top,
                motion_scale: 1.0,
            };
            below += usize::from(gap.value(top) < 0.0 && gap.slope(top) >= 0.0);
            let Descent::At(time) = by_minorants(&gap, top, f64::INFINITY) else {
                panic!("no fall from {top}");
            };
            assert!((time - top).abs() < 1.0e-6 * top, "{time} for {top}");
        }
        assert!(below > 20, "rounding has put only {below} of them below");
    }
}
