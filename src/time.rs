//! Absolute time that keeps its precision however long a run lasts.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Length of a tick, 2⁻³⁰ √(d/g).
const TICK: f64 = 1.0 / (1u64 << 30) as f64;
/// Ticks in a unit of time.
const TICKS_PER_UNIT: f64 = (1u64 << 30) as f64;
/// Binary digits kept below the tick.
const REST_BITS: u32 = 52;
/// Binary digits kept below one unit of time.
const FRACTION_BITS: u32 = 82;
/// Decimal digits that tell any two times apart.
const DECIMALS: usize = 25;

/// An instant, in √(d/g).
///
/// A time is a whole multiple of 2⁻⁸² (about 2·10⁻²⁵) between ±8·10⁹, held as
/// a count of ticks of 2⁻³⁰ and a remainder in `[0, 2⁻³⁰)`. Sums and
/// differences are those of a fixed-point number: they do not depend on how
/// far from zero the clock stands, so a system started after 10⁹ units of quiet
/// runs through the same events, bit for bit, as one started at 0; and a
/// micro-bounce of 10⁻¹² is known to twelve digits at any hour.
///
/// ```
/// use grainfall::Time;
///
/// let late = Time::from_units(1.0e9);
/// assert_eq!((late + 1.0e-12) - late, (Time::ZERO + 1.0e-12) - Time::ZERO);
/// assert!(late + 1.0e-12 > late);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written")]
pub struct Time {
    ticks: i64,
    rest: f64,
}

/// A time as it stands in a file, which may say anything.
#[derive(Deserialize)]
struct Written {
    ticks: i64,
    rest: f64,
}

impl TryFrom<Written> for Time {
    type Error = &'static str;

    fn try_from(Written { ticks, rest }: Written) -> Result<Self, Self::Error> {
        let quanta = rest * (1u128 << FRACTION_BITS) as f64;
        let is_whole = quanta.is_sign_positive() && quanta == libm::floor(quanta);
        if !is_whole || rest >= TICK || (ticks == i64::MAX && rest > 0.0) {
            return Err("no instant: the rest of a tick is out of range");
        }
        Ok(Time { ticks, rest })
    }
}

impl Time {
    /// The start of the clock.
    pub const ZERO: Time = Time {
        ticks: 0,
        rest: 0.0,
    };
    /// Later than every instant: the time of what never happens.
    pub const NEVER: Time = Time {
        ticks: i64::MAX,
        rest: 0.0,
    };
    /// The latest instant that can be named, about 8.59·10⁹.
    pub const LAST: Time = Time {
        ticks: i64::MAX - 1,
        rest: 0.0,
    };

    /// The earliest instant that can be named, about -8.59·10⁹.
    pub const FIRST: Time = Time {
        ticks: i64::MIN,
        rest: 0.0,
    };

    /// The instant `units` √(d/g) from the start of the clock.
    #[must_use]
    pub fn from_units(units: f64) -> Self {
        Time::ZERO + units
    }

    /// The nearest `f64`, in √(d/g); it loses digits, so it is for people and plots.
    #[must_use]
    pub fn units(self) -> f64 {
        if self == Time::NEVER {
            return f64::INFINITY;
        }
        self.ticks as f64 * TICK + self.rest
    }

    /// False for [`Time::NEVER`] alone.
    #[must_use]
    #[inline]
    pub fn is_finite(self) -> bool {
        // No other instant has so many ticks.
        self.ticks != i64::MAX
    }

    /// The two words of the fixed-point number, for hashing.
    #[must_use]
    pub fn to_bits(self) -> [u64; 2] {
        [self.ticks as u64, self.rest.to_bits()]
    }

    /// `self - earlier` for two instants that come, and are less than 2⁶³ ticks
    /// apart.
    #[inline]
    pub(crate) fn since(self, earlier: Time) -> f64 {
        self.ticks.wrapping_sub(earlier.ticks) as f64 * TICK + (self.rest - earlier.rest)
    }

    /// How many multiples of `step` √(d/g), which is above 0, have been reached since
    /// the start of the clock: the n-th one from the instant `from_units(n * step)` on, for
    /// which the quotient of the two alone may be too small, or from one that is earlier by
    /// no more than the rounding of that quotient.
    #[must_use]
    pub fn multiples_reached(self, step: f64) -> f64 {
        let passed = libm::floor(self.units() / step);
        if Time::from_units((passed + 1.0) * step) <= self {
            passed + 1.0
        } else {
            passed
        }
    }

    /// The earlier of two instants.
    #[must_use]
    #[inline]
    pub fn min(self, other: Time) -> Time {
        if other < self { other } else { self }
    }

    /// The later of two instants.
    #[must_use]
    #[inline]
    pub fn max(self, other: Time) -> Time {
        if other > self { other } else { self }
    }

    /// The whole number of 2⁻⁸² units since the start of the clock.
    fn quanta(self) -> i128 {
        let below = self.rest * (1u128 << FRACTION_BITS) as f64;
        (i128::from(self.ticks) << REST_BITS) + below as i128
    }

    fn from_quanta(quanta: i128) -> Option<Self> {
        let ticks = i64::try_from(quanta >> REST_BITS).ok()?;
        let below = quanta & ((1i128 << REST_BITS) - 1);
        Some(Time {
            ticks,
            rest: below as f64 / (1u128 << FRACTION_BITS) as f64,
        })
    }
}

impl std::ops::Add<f64> for Time {
    type Output = Time;

    /// The instant `after` √(d/g) later; [`Time::NEVER`] if that lies beyond
    /// [`Time::LAST`] or `after` is not a number.
    #[inline]
    fn add(self, after: f64) -> Time {
        let sum = self.rest + after;
        let scaled = sum * TICKS_PER_UNIT;
        // Beyond this the count of ticks could not be added.
        if scaled.is_nan() || scaled.abs() >= 9.0e18 || !self.is_finite() {
            return Time::NEVER;
        }
        let mut whole = scaled as i64;
        // Exact: both are multiples of the sum's last digit.
        let mut rest = sum - whole as f64 * TICK;
        if rest < 0.0 {
            rest += TICK;
            whole -= 1;
        }
        // Rounds to a multiple of 2⁻⁸².
        rest = (rest + TICK) - TICK;
        if rest >= TICK {
            rest -= TICK;
            whole += 1;
        }
        match self.ticks.checked_add(whole) {
            Some(ticks) if ticks < i64::MAX => Time { ticks, rest },
            _ => Time::NEVER,
        }
    }
}

impl std::ops::Sub for Time {
    type Output = f64;

    /// The time from `earlier` to `self`, in √(d/g); infinite if `self` is
    /// [`Time::NEVER`].
    #[inline]
    fn sub(self, earlier: Time) -> f64 {
        if !self.is_finite() {
            return f64::INFINITY;
        }
        let ticks = match self.ticks.checked_sub(earlier.ticks) {
            Some(ticks) => ticks as f64,
            None => self.ticks as f64 - earlier.ticks as f64,
        };
        ticks * TICK + (self.rest - earlier.rest)
    }
}

impl Eq for Time {}

impl Ord for Time {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        // Rests are not negative: their bits are in their order.
        let (rest, other_rest) = (self.rest.to_bits(), other.rest.to_bits());
        (self.ticks, rest).cmp(&(other.ticks, other_rest))
    }
}

impl PartialOrd for Time {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }

    #[inline]
    fn lt(&self, other: &Self) -> bool {
        self.ticks < other.ticks || (self.ticks == other.ticks && self.rest < other.rest)
    }

    #[inline]
    fn le(&self, other: &Self) -> bool {
        self.ticks < other.ticks || (self.ticks == other.ticks && self.rest <= other.rest)
    }

    #[inline]
    fn gt(&self, other: &Self) -> bool {
        other < self
    }

    #[inline]
    fn ge(&self, other: &Self) -> bool {
        other <= self
    }
}

impl fmt::Display for Time {
    /// Without a precision: the decimal digits that name this instant and no
    /// other, and that [`Time::from_str`] reads back. With one: that many
    /// decimals of the nearest `f64`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Time::NEVER {
            return f.write_str("never");
        }
        if let Some(precision) = f.precision() {
            return write!(f, "{:.*}", precision, self.units());
        }
        let quanta = self.quanta();
        let sign = if quanta < 0 { "-" } else { "" };
        let size = quanta.unsigned_abs();
        let mask = (1u128 << FRACTION_BITS) - 1;
        let mut whole = size >> FRACTION_BITS;
        let mut fraction = size & mask;
        let mut digits = [0u8; DECIMALS];
        for digit in &mut digits {
            fraction *= 10;
            *digit = (fraction >> FRACTION_BITS) as u8;
            fraction &= mask;
        }
        if fraction >> (FRACTION_BITS - 1) == 1 {
            // Round the last digit up and carry.
            let mut carry = true;
            for digit in digits.iter_mut().rev() {
                if *digit < 9 {
                    *digit += 1;
                    carry = false;
                    break;
                }
                *digit = 0;
            }
            whole += u128::from(carry);
        }
        let kept = DECIMALS - digits.iter().rev().take_while(|&&d| d == 0).count();
        write!(f, "{sign}{whole}")?;
        if kept > 0 {
            f.write_str(".")?;
            for digit in &digits[..kept] {
                write!(f, "{digit}")?;
            }
        }
        Ok(())
    }
}

/// A text that names no instant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a time: a decimal number between -8.5e9 and 8.5e9 is")]
pub struct ParseTimeError(String);

impl FromStr for Time {
    type Err = ParseTimeError;

    /// Reads what [`Display`](fmt::Display) writes; the nearest instant
    /// otherwise.
    ///
    /// # Errors
    ///
    /// When the text is not a plain decimal number in range.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ParseTimeError(text.to_owned());
        if text == "never" {
            return Ok(Time::NEVER);
        }
        let (negative, body) = match text.strip_prefix('-') {
            Some(body) => (true, body),
            None => (false, text),
        };
        let (whole, decimals) = body.split_once('.').unwrap_or((body, ""));
        let all_digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
        if whole.is_empty() || !all_digits(whole) || !all_digits(decimals) {
            return Err(wrong());
        }
        let whole: u64 = whole.parse().map_err(|_| wrong())?;
        if whole >= 1 << 33 {
            return Err(wrong());
        }
        // From the last digit backwards: f ← (f + digit) / 10, with 40 guard bits.
        let mut fraction: u128 = 0;
        for byte in decimals.bytes().take(30).collect::<Vec<_>>().iter().rev() {
            fraction = ((u128::from(byte - b'0') << 122) / 10) + fraction / 10;
        }
        let fraction = (fraction + (1 << 39)) >> 40;
        let size = ((u128::from(whole) << FRACTION_BITS) + fraction) as i128;
        Time::from_quanta(if negative { -size } else { size }).ok_or_else(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_instants_are_read() {
        for time in [Time::FIRST, Time::ZERO + 1.0e-20, Time::LAST, Time::NEVER] {
            let text = serde_json::to_string(&time).unwrap();
            assert_eq!(serde_json::from_str::<Time>(&text).unwrap(), time);
        }
        let never = i64::MAX;
        for (ticks, rest) in [
            (0, "-0.0"),
            (0, "1e-30"),
            (0, "1.0"),
            (0, "9.313225746154785e-10"),
            (never, "1e-10"),
        ] {
            let text = format!("{{\"ticks\":{ticks},\"rest\":{rest}}}");
            assert!(serde_json::from_str::<Time>(&text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_late_clock_counts_like_an_early_one() {
        let steps = [1.0e-12, 0.3, 7.25e-9, 1.0 / 3.0, 2.5e-17, 123.456];
        let (mut early, mut late) = (Time::ZERO, Time::from_units(1.0e9));
        let start = late;
        for step in steps {
            early = early + step;
            late = late + step;
            assert_eq!((early - Time::ZERO).to_bits(), (late - start).to_bits());
        }
    }

    #[test]
    fn a_micro_bounce_keeps_its_digits() {
        let start = Time::from_units(1.0e9);
        let step = 1.234_567_890_123e-12;
        let measured = (start + step) - start;
        assert!((measured / step - 1.0).abs() < 1.0e-12);
    }

    #[test]
    fn beyond_the_clock_is_never() {
        assert_eq!(Time::ZERO + 1.0e11, Time::NEVER);
        assert_eq!(Time::ZERO + f64::NAN, Time::NEVER);
        assert_eq!(Time::NEVER + 1.0, Time::NEVER);
        assert!(Time::LAST < Time::NEVER);
        assert_eq!(Time::NEVER - Time::ZERO, f64::INFINITY);
    }

    #[test]
    fn the_longest_time_is_no_negative_one() {
        assert_eq!(Time::LAST - Time::FIRST, 1.0 / TICK * 16.0);
        assert_eq!(Time::FIRST - Time::LAST, -1.0 / TICK * 16.0);
    }

    /// 43 · 0.1 / 0.1 is less than 43 in `f64`.
    #[test]
    fn a_multiple_is_reached_at_its_instant() {
        for step in [0.1, 0.02, 0.3, 0.7] {
            for count in (1..3000).map(f64::from) {
                let instant = Time::from_units(count * step);
                assert_eq!(instant.multiples_reached(step), count);
                assert_eq!((instant + -1.0e-6).multiples_reached(step), count - 1.0);
            }
        }
    }

    #[test]
    fn digits_are_plain() {
        assert_eq!(Time::from_units(1.5).to_string(), "1.5");
        assert_eq!(Time::from_units(-0.25).to_string(), "-0.25");
        assert_eq!(Time::from_units(3.0).to_string(), "3");
        assert!("1e5".parse::<Time>().is_err());
        assert!("".parse::<Time>().is_err());
        assert!("9999999999".parse::<Time>().is_err());
    }

    proptest! {
        #[test]
        fn text_comes_back(units in -1.0e9..1.0e9f64, more in 0.0..1.0f64, tiny in 0.0..1.0e-9f64) {
            let time = Time::from_units(units) + more + tiny;
            prop_assert_eq!(time.to_string().parse::<Time>().unwrap(), time);
        }

        #[test]
        fn sums_and_differences_agree(units in -1.0e9..1.0e9f64, step in 0.0..1.0e3f64) {
            let start = Time::from_units(units);
            let end = start + step;
            prop_assert!(end >= start);
            prop_assert!(((end - start) - step).abs() <= 2.1e-25 + step * f64::EPSILON);
            prop_assert_eq!(start + (end - start), end);
        }
    }
}
