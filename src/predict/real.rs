use std::ops::{Add, Div, Mul, Neg, Sub};

/// The arithmetic that the root finders need.
///
/// A run uses `f64`; [`DoubleDouble`](super::DoubleDouble) runs the same lines
/// with twice the digits.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// Larger than every number.
    const INFINITY: Self;
    /// Bound on the relative error of one operation.
    const UNIT_ROUNDOFF: f64;

    /// The same number; exact.
    fn from_f64(value: f64) -> Self;

    /// The nearest `f64`.
    fn to_f64(self) -> f64;

    /// Square root of a number that is not negative.
    fn sqrt(self) -> Self;

    /// Absolute value.
    #[inline]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The larger of two.
    #[inline]
    fn at_least(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// The smaller of two.
    #[inline]
    fn at_most(self, other: Self) -> Self {
        if self > other { other } else { self }
    }

    /// `self` times a small number that `f64` holds exactly.
    #[inline]
    fn times(self, factor: f64) -> Self {
        self * Self::from_f64(factor)
    }
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const INFINITY: f64 = f64::INFINITY;
    const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

    #[inline]
    fn from_f64(value: f64) -> f64 {
        value
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline]
    fn sqrt(self) -> f64 {
        // Correctly rounded on every machine (IEEE 754), unlike the functions
        // that have to come from libm.
        f64::sqrt(self)
    }
}
