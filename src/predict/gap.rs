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
            offset: (second.start() - first.start()) + approach.shift,
            velocity: second.start_velocity() - first.start_velocity(),
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
    /// r² + σ²: what c₀ is the difference of. Where positions have been shifted
    /// by a period s, s²/64 more, for the rounding of the shifted difference.
    pub place_scale: N,
    /// v² + γ², likewise for the terms in t².
    pub motion_scale: N,
}

/// What a polynomial is lowered by, and a slope has to exceed, to be certain:
/// so many roundings u of the sizes that it is made of. The proof in the book
/// needs 105; the largest error seen is below 4.
pub const CERTAIN: f64 = 128.0;

/// The exact motion of one grain as another sees it, or its leading digits.
struct Exact<N, const D: usize> {
    offset: [N; D],
    velocity: [N; D],
    acceleration: [N; D],
    distance: N,
    growth: N,
}

/// Products of components, summed in the order of the axes.
#[inline]
fn dot<N: Real, const D: usize>(a: &[N; D], b: &[N; D]) -> N {
    let mut sum = N::ZERO;
    for axis in 0..D {
        sum = sum + a[axis] * b[axis];
    }
    sum
}

impl<N: Real, const D: usize> Exact<N, D> {
    #[inline]
    fn of(relative: &Relative<D>) -> Self {
        let wide = |v: &Vector<D>| std::array::from_fn(|axis| N::from_f64(v[axis]));
        Exact {
            offset: wide(&relative.offset),
            velocity: wide(&relative.velocity),
            acceleration: wide(&relative.acceleration),
            distance: N::from_f64(relative.distance),
            growth: N::from_f64(relative.growth),
        }
    }

    #[inline]
    fn gap(&self, accelerated: bool) -> GapPolynomial<N> {
        let (r, v, a) = (&self.offset, &self.velocity, &self.acceleration);
        let (distance, growth) = (self.distance, self.growth);
        let (r_r, v_v) = (dot(r, r), dot(v, v));
        let (place, motion) = (distance * distance, growth * growth);
        let c1 = dot(r, v) - distance * growth;
        let mut coefficients = [r_r - place, c1 + c1, v_v - motion, N::ZERO, N::ZERO];
        if accelerated {
            let [_, _, c2, c3, c4] = &mut coefficients;
            *c2 = *c2 + dot(r, a);
            *c3 = dot(v, a);
            *c4 = dot(a, a).times(0.25);
        }
        GapPolynomial {
            coefficients,
            place_scale: r_r + place,
            motion_scale: v_v + motion,
        }
    }
}

impl<N: Real> GapPolynomial<N> {
    /// The gap of two grains that move so.
    #[inline]
    #[must_use]
    pub fn new<const D: usize>(relative: &Relative<D>) -> Self {
        Exact::of(relative).gap(true)
    }

    /// The same for two grains of equal acceleration: c₃ = c₄ = 0.
    #[inline]
    #[must_use]
    pub fn without_acceleration<const D: usize>(relative: &Relative<D>) -> Self {
        Exact::of(relative).gap(false)
    }

    /// The gap of two flights, their differences taken in this arithmetic too.
    #[must_use]
    pub fn between<const D: usize, F: PolynomialFlight<D>>(approach: &Approach<D, F>) -> Self {
        let difference = |to: &Vector<D>, from: &Vector<D>| {
            std::array::from_fn(|axis| N::from_f64(to[axis]) - N::from_f64(from[axis]))
        };
        let (first, second) = (&approach.first, &approach.second);
        let mut offset: [N; D] = difference(&second.start(), &first.start());
        for (along, &shift) in offset.iter_mut().zip(approach.shift.iter()) {
            *along = *along + N::from_f64(shift);
        }
        let acceleration = if F::ACCELERATES {
            difference(&second.acceleration(), &first.acceleration())
        } else {
            [N::ZERO; D]
        };
        let accelerated = acceleration.iter().any(|a| *a != N::ZERO);
        let exact = Exact {
            offset,
            velocity: difference(&second.start_velocity(), &first.start_velocity()),
            acceleration,
            distance: N::from_f64(approach.distance),
            growth: N::from_f64(approach.growth),
        };
        exact.gap(accelerated)
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

    /// S(t) = σ² + r² + t² (v² + γ² + c₄ t²), in d²: the size of what f(t) is
    /// made of.
    #[inline]
    #[must_use]
    pub fn size(&self, t: N) -> N {
        let t2 = t * t;
        self.place_scale + t2 * (self.motion_scale + self.coefficients[4] * t2)
    }

    /// A gap at which a root counts as found: 4 u S(t), in d².
    #[inline]
    #[must_use]
    pub fn rounding(&self, t: N) -> N {
        self.size(t).times(4.0 * N::UNIT_ROUNDOFF)
    }

    /// f − [`CERTAIN`] u S, a polynomial again: it lies below the gap of the
    /// exact inputs at all times t ≥ 0, whatever rounding there was in its
    /// coefficients and will be in evaluating it.
    #[inline]
    #[must_use]
    pub fn lowered(&self) -> Self {
        let [c0, c1, c2, c3, c4] = self.coefficients;
        let unit = CERTAIN * N::UNIT_ROUNDOFF;
        GapPolynomial {
            coefficients: [
                c0 - self.place_scale.times(unit),
                c1,
                c2 - self.motion_scale.times(unit),
                c3,
                c4 - c4.times(unit),
            ],
            ..*self
        }
    }

    /// What c₁ and c₂ may be wrong by, where they stand alone: [`CERTAIN`] u times
    /// |r| |v| and v² + |r| |a|.
    #[inline]
    #[must_use]
    pub fn margins(&self) -> [N; 2] {
        let unit = CERTAIN * N::UNIT_ROUNDOFF;
        let place = self.place_scale.sqrt();
        let bend = self.coefficients[4].sqrt();
        [
            (place * self.motion_scale.sqrt()).times(unit),
            (self.motion_scale + (place * bend).times(2.0)).times(unit),
        ]
    }

    /// True only if this polynomial is positive up to `horizon`, found without a
    /// root or a quotient. Asked of the [lowered](Self::lowered) one, it is
    /// certain that there is no contact till then. Most neighbours end here.
    #[inline]
    #[must_use]
    pub fn is_clear(&self, horizon: N) -> bool {
        let zero = N::ZERO;
        let [c0, c1, c2, c3, c4] = self.coefficients;
        // Written so that NaN decides nothing.
        let apart = c0 > zero;
        if !apart {
            return false;
        }
        // No term ever decreases.
        if c1 >= zero && c2 >= zero && c3 >= zero {
            return true;
        }
        // Every falling term at its worst. With an infinite horizon this and
        // what follows are infinite or NaN, and decide nothing.
        let least = c0
            + horizon
                * (c1.at_most(zero) + horizon * (c2.at_most(zero) + horizon * c3.at_most(zero)));
        if least > zero {
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
        a > zero && (c1 >= zero || c1 * c1 < a.times(4.0) * c0)
    }
}
