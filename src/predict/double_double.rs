use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::f64x4;

use super::Real;

/// A number as the unevaluated sum of two `f64`, about 32 decimal digits.
///
/// Sums and products after Dekker 1971, doi:10.1007/BF01397083: the error of a
/// product is exact, so every machine gives the same bits. Relative error of
/// an operation below 2⁻¹⁰⁰; products are right while their parts neither
/// overflow nor vanish, that is for sizes of 10⁻¹⁴⁰ … 10¹⁴⁰.
///
/// ```
/// use grainfall::predict::{DoubleDouble, Real};
///
/// let third = DoubleDouble::from_f64(1.0) / DoubleDouble::from_f64(3.0);
/// let rest = third * DoubleDouble::from_f64(3.0) - DoubleDouble::from_f64(1.0);
/// assert!(rest.abs() < DoubleDouble::from_f64(1.0e-31));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    /// The nearest `f64`; ordered first, so the derived comparison is the
    /// comparison of numbers.
    high: f64,
    /// What is left, at most half a last digit of `high`.
    low: f64,
}

/// Numbers whose rounding errors can be caught: one, or one on each lane.
pub(super) trait Exact:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// a · b − product, for the rounded product of a and b; exact. A fused
    /// multiplication gives the same digits as Dekker's 17 operations, and is
    /// used where the build's target has one.
    fn product_error(a: Self, b: Self, product: Self) -> Self;
}

#[cfg(target_feature = "fma")]
impl Exact for f64 {
    #[inline(always)]
    fn product_error(a: f64, b: f64, product: f64) -> f64 {
        a.mul_add(b, -product)
    }
}

#[cfg(target_feature = "fma")]
impl Exact for f64x4 {
    #[inline(always)]
    fn product_error(a: f64x4, b: f64x4, product: f64x4) -> f64x4 {
        a.mul_sub(b, product)
    }
}

#[cfg(not(target_feature = "fma"))]
impl Exact for f64 {
    #[inline(always)]
    fn product_error(a: f64, b: f64, product: f64) -> f64 {
        dekker(a, b, product, 134_217_729.0)
    }
}

#[cfg(not(target_feature = "fma"))]
impl Exact for f64x4 {
    #[inline(always)]
    fn product_error(a: f64x4, b: f64x4, product: f64x4) -> f64x4 {
        dekker(a, b, product, f64x4::splat(134_217_729.0))
    }
}

/// The error of a product from the upper 26 digits of its factors and the rests.
#[cfg(not(target_feature = "fma"))]
#[inline(always)]
fn dekker<N: Exact>(a: N, b: N, product: N, splitter: N) -> N {
    let split = |x: N| {
        let shifted = splitter * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// a + b exactly.
#[inline(always)]
pub(super) fn two_sum<N: Exact>(a: N, b: N) -> (N, N) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// a + b exactly, if |a| ≥ |b|.
#[inline]
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a · b exactly.
#[inline(always)]
pub(super) fn two_product<N: Exact>(a: N, b: N) -> (N, N) {
    let product = a * b;
    (product, N::product_error(a, b, product))
}

/// a² exactly.
#[inline(always)]
pub(super) fn two_square<N: Exact>(a: N) -> (N, N) {
    two_product(a, a)
}

impl DoubleDouble {
    /// Normalised sum; infinities keep a rest of 0, or they would become NaN.
    #[inline]
    fn renormalised(high: f64, low: f64) -> Self {
        if !high.is_finite() {
            return DoubleDouble { high, low: 0.0 };
        }
        let (high, low) = quick_two_sum(high, low);
        DoubleDouble { high, low }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.high, other.high);
        if !high.is_finite() {
            return Self::from_f64(high);
        }
        let (low, low_error) = two_sum(self.low, other.low);
        let (high, error) = quick_two_sum(high, high_error + low);
        Self::renormalised(high, error + low_error)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        DoubleDouble {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        if !high.is_finite() {
            return Self::from_f64(high);
        }
        Self::renormalised(
            high,
            error + (self.high * other.low + self.low * other.high),
        )
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    /// Long division: three digits in base 2⁵³.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() || other.high.is_infinite() {
            return Self::from_f64(first);
        }
        let rest = self - other * Self::from_f64(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from_f64(second);
        let third = rest.high / other.high;
        let (high, low) = quick_two_sum(first, second);
        Self::renormalised(high, low) + Self::from_f64(third)
    }
}

impl Real for DoubleDouble {
    const ZERO: Self = DoubleDouble {
        high: 0.0,
        low: 0.0,
    };
    const INFINITY: Self = DoubleDouble {
        high: f64::INFINITY,
        low: 0.0,
    };
    // 2⁻¹⁰⁰.
    const UNIT_ROUNDOFF: f64 = 7.888_609_052_210_118e-31;

    #[inline]
    fn from_f64(value: f64) -> Self {
        DoubleDouble {
            high: value,
            low: 0.0,
        }
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.high
    }

    /// One Newton step from the root of the leading part, which is right to 53
    /// digits.
    #[inline]
    fn sqrt(self) -> Self {
        if self.high <= 0.0 || self.high.is_infinite() {
            return Self::from_f64(self.high.sqrt());
        }
        let root = Self::from_f64(self.high.sqrt());
        let rest = self - root * root;
        root + Self::from_f64(rest.high / (2.0 * root.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The number as an integer multiple of 2⁻²⁰⁰ would need big integers; exact
    /// integers below 2¹⁰⁶ are enough to catch a wrong digit.
    fn from_integer(value: i128) -> DoubleDouble {
        let high = value as f64;
        let low = (value - high as i128) as f64;
        DoubleDouble::renormalised(high, low)
    }

    fn to_integer(value: DoubleDouble) -> i128 {
        value.high as i128 + value.low as i128
    }

    proptest! {
        #[test]
        fn sums_of_integers_are_exact(a in -(1i128 << 104)..1i128 << 104, b in -(1i128 << 104)..1i128 << 104) {
            prop_assert_eq!(to_integer(from_integer(a) + from_integer(b)), a + b);
            prop_assert_eq!(to_integer(from_integer(a) - from_integer(b)), a - b);
        }

        #[test]
        fn products_of_integers_are_exact(a in -(1i128 << 50)..1i128 << 50, b in -(1i128 << 54)..1i128 << 54) {
            prop_assert_eq!(to_integer(from_integer(a) * from_integer(b)), a * b);
        }

        #[test]
        fn quotients_and_roots_undo_products(a in 1i128..1i128 << 50, b in 1i128..1i128 << 52) {
            let (a, b) = (from_integer(a), from_integer(b));
            let ratio = a / b;
            let bound = a.times(DoubleDouble::UNIT_ROUNDOFF);
            prop_assert!((ratio * b - a).abs() <= bound);
            let root = ratio.sqrt();
            prop_assert!((root * root - ratio).abs() <= ratio.times(4.0 * DoubleDouble::UNIT_ROUNDOFF));
        }
    }

    #[test]
    fn infinity_compares_and_survives() {
        let one = DoubleDouble::from_f64(1.0);
        assert!(one < DoubleDouble::INFINITY);
        assert_eq!(one + DoubleDouble::INFINITY, DoubleDouble::INFINITY);
        assert_eq!(one / DoubleDouble::ZERO, DoubleDouble::INFINITY);
        assert_eq!(one / DoubleDouble::INFINITY, DoubleDouble::ZERO);
    }
}
