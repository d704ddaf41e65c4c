//! The gap between two grains as a polynomial of time.

use super::Real;
use crate::model::{Approach, PolynomialFlight};
use crate::particle::Vector;

/// The motion of one grain as another sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative<const D: usize> {
    /// From the one centre to the other at the start, in d.
    pub offset: Vector<D>,
    /// Relative velocity at the start, in √(gd).
    pub velocity: Vector<D>,
    /// Relative acceleration, in g.
    pub acceleration: Vector<D>,
    /// Distance of the centres at contact, at the start; in d.
    pub distance: f64,
    /// How fast that distance grows, in √(gd).
    pub growth: f64,
}

impl<const D: usize> Relative<D> {
    /// The second grain as the first sees it. Swapping the two and reversing
    /// the shift only turns every sign.
    #[inline]
    #[must_use]
    pub fn of<F: PolynomialFlight<D>>(approach: &Approach<D, F>) -> Self {
        let (first, second) = (&approach.first, &approach.second);
        Relative {
            // In this order it is odd under the swap, to the last bit.
            offset: (second.position(0.0) - first.position(0.0)) + approach.shift,
            velocity: second.velocity(0.0) - first.velocity(0.0),
            acceleration: if F::ACCELERATES {
                second.acceleration() - first.acceleration()
            } else {
                Vector::zeros()
            },
            distance: approach.distance,
            growth: approach.growth,
        }
    }
}

/// f(t) = |r + v t + a t²/2|² − (σ + γ t)² = c₀ + c₁ t + c₂ t² + c₃ t³ + c₄ t⁴,
/// in d²; positive when the grains are apart.
///
/// c₄ = a²/4 is never negative: everything that the root finders conclude about
/// all later times rests on that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapPolynomial<N> {
    /// c₀ … c₄.
    pub coefficients: [N; 5],
    /// r² + σ²: what c₀ is the difference of.
    pub place_scale: N,
    /// v² + γ², likewise for the terms in t².
    pub motion_scale: N,
}

/// Products of components, summed in the order of the axes.
#[inline]
fn dot<N: Real, const D: usize>(a: &Vector<D>, b: &Vector<D>) -> N {
    let mut sum = N::ZERO;
    for axis in 0..D {
        sum = sum + N::from_f64(a[axis]) * N::from_f64(b[axis]);
    }
    sum
}

impl<N: Real> GapPolynomial<N> {
    /// The gap of two grains that move so.
    #[inline]
    #[must_use]
    pub fn new<const D: usize>(relative: &Relative<D>) -> Self {
        let Relative {
            offset: r,
            velocity: v,
            acceleration: a,
            ..
        } = relative;
        let mut gap = Self::without_acceleration(relative);
        let [_, _, c2, c3, c4] = &mut gap.coefficients;
        *c2 = *c2 + dot(r, a);
        *c3 = dot(v, a);
        *c4 = dot::<N, D>(a, a).times(0.25);
        gap
    }

    /// The same for two grains of equal acceleration: c₃ = c₄ = 0.
    #[inline]
    #[must_use]
    pub fn without_acceleration<const D: usize>(relative: &Relative<D>) -> Self {
        let (r, v) = (&relative.offset, &relative.velocity);
        let distance = N::from_f64(relative.distance);
        let growth = N::from_f64(relative.growth);
        let (r_r, v_v) = (dot::<N, D>(r, r), dot::<N, D>(v, v));
        let (place, motion) = (distance * distance, growth * growth);
        let c1 = dot::<N, D>(r, v) - distance * growth;
        GapPolynomial {
            coefficients: [r_r - place, c1 + c1, v_v - motion, N::ZERO, N::ZERO],
            place_scale: r_r + place,
            motion_scale: v_v + motion,
        }
    }

    /// f(t).
    #[inline]
    #[must_use]
    pub fn value(&self, t: N) -> N {
        let [c0, c1, c2, c3, c4] = self.coefficients;
        c0 + t * (c1 + t * (c2 + t * (c3 + t * c4)))
    }

    /// f′(t).
    #[inline]
    #[must_use]
    pub fn slope(&self, t: N) -> N {
        let [_, c1, c2, c3, c4] = self.coefficients;
        c1 + t * (c2.times(2.0) + t * (c3.times(3.0) + t * c4.times(4.0)))
    }

    /// f″(t)/2.
    #[inline]
    #[must_use]
    pub fn half_curvature(&self, t: N) -> N {
        let [_, _, c2, c3, c4] = self.coefficients;
        c2 + t * (c3.times(3.0) + t * c4.times(6.0))
    }

    /// Rounding in [`value`](Self::value) and in the coefficients themselves, in
    /// d²: 4 u (σ² + r² + t² (v² + γ² + c₄ t²)).
    #[inline]
    #[must_use]
    pub fn rounding(&self, t: N) -> N {
        let c4 = self.coefficients[4];
        let t2 = t * t;
        (self.place_scale + t2 * (self.motion_scale + c4 * t2)).times(4.0 * N::UNIT_ROUNDOFF)
    }

    /// True only if there is certainly no contact up to `horizon`, found without
    /// a root or a quotient. Most neighbours end here.
    ///
    /// The margin is 16 times the rounding at the horizon. It is what keeps an
    /// answer from depending on the horizon: at a contact the solvers return, f
    /// is far smaller than that.
    #[inline]
    #[must_use]
    pub fn is_clear(&self, horizon: N) -> bool {
        let zero = N::ZERO;
        let [c0, c1, c2, c3, c4] = self.coefficients;
        // No term ever decreases: they never close, wherever they stand.
        if c1 >= zero && c2 >= zero && c3 >= zero {
            return true;
        }
        let margin = self.rounding(horizon).times(16.0);
        // Every falling term at its worst. With an infinite horizon this and
        // what follows are infinite or NaN, and decide nothing.
        let least = c0
            + horizon
                * (c1.at_most(zero) + horizon * (c2.at_most(zero) + horizon * c3.at_most(zero)));
        if least > margin {
            return true;
        }
        // f ≥ c₀ + c₁ t + A t², A = c₂ + min (c₃ t + c₄ t²) or something smaller.
        let bend = if c3 >= zero {
            zero
        } else if (c4 + c4) * horizon <= -c3 {
            horizon * (c3 + horizon * c4)
        } else {
            horizon * c3.times(0.5)
        };
        let a = c2 + bend;
        let room = c0 - margin;
        a > zero && room > zero && (c1 >= zero || c1 * c1 < a.times(4.0) * room)
    }
}
