//! How far ahead there is certainly no contact of two grains, in plain `f64`.
//!
//! Everything is asked of polynomials that lie below the exact ones, so that
//! rounding can only make a contact seem too early, never too late or absent:
//! where f ≤ 0 and falls, what lies below is ≤ 0 too. Where a sign is not
//! certain the question is left to wider arithmetic.

use super::descent::{Descent, by_minorants, cubic_descent, first_root, quartic_descent};
use super::gap::GapPolynomial;

/// What plain `f64` can say for certain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lead {
    /// No contact up to the horizon.
    Never,
    /// A contact now.
    Now,
    /// No contact before this time; next to it there may be one.
    Until(f64),
    /// A sign is within rounding.
    Unsure,
}

impl From<Descent<f64>> for Lead {
    #[inline]
    fn from(descent: Descent<f64>) -> Self {
        match descent {
            Descent::Never => Lead::Never,
            Descent::At(time) => Lead::Until(time),
            Descent::NotBefore(_) => Lead::Unsure,
        }
    }
}

#[inline]
fn within(time: f64, horizon: f64) -> Lead {
    if time < f64::INFINITY && time <= horizon {
        Lead::Until(time)
    } else {
        Lead::Never
    }
}

/// What certainly comes before the first contact.
#[inline]
pub(super) fn lead(
    gap: &GapPolynomial<f64>,
    low: &GapPolynomial<f64>,
    touching: bool,
    bent: bool,
    horizon: f64,
) -> Lead {
    let [c0, c1, c2, ..] = low.coefficients;
    if touching {
        return after_contact(gap, low, bent, horizon);
    }
    if c0 > 0.0 {
        return if bent {
            quartic_descent(low, false, horizon).into()
        } else {
            within(first_root(c0, c1, c2), horizon)
        };
    }
    // At a gap of nothing, whether it closes is all that matters.
    if c1 < 0.0 {
        return Lead::Until(0.0);
    }
    overlapping(gap, low, horizon)
}

/// f(0) = 0 by definition: the first fall of q = f/t.
fn after_contact(
    gap: &GapPolynomial<f64>,
    low: &GapPolynomial<f64>,
    bent: bool,
    horizon: f64,
) -> Lead {
    let [_, c1, c2, c3, _] = gap.coefficients;
    let c4 = low.coefficients[4];
    let [e1, e2] = gap.margins();
    if c1 < -e1 {
        return Lead::Now;
    }
    // Not certain of NaN either.
    let opening = c1 >= e1;
    if !opening {
        return Lead::Unsure;
    }
    if bent {
        cubic_descent([c1 - e1, c2 - e2, c3, c4], horizon).into()
    } else {
        within(first_root(c1 - e1, c2 - e2, 0.0), horizon)
    }
}

/// f(0) ≤ 0, but for rounding, and opening: nothing happens until f′ falls
/// through zero. If they have come apart by then, f has to fall as well.
fn overlapping(gap: &GapPolynomial<f64>, low: &GapPolynomial<f64>, horizon: f64) -> Lead {
    let [_, c1, c2, c3, _] = gap.coefficients;
    let c4 = low.coefficients[4];
    let [e1, e2] = gap.margins();
    let opening = c1 >= e1;
    if !opening {
        return Lead::Unsure;
    }
    let slope = [c1 - e1, 2.0 * (c2 - e2), 3.0 * c3, 4.0 * c4];
    match cubic_descent(slope, horizon) {
        Descent::Never => Lead::Never,
        Descent::At(turn) if low.value(turn) > 0.0 => by_minorants(low, turn, horizon).into(),
        _ => Lead::Unsure,
    }
}
