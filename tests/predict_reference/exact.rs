//! Contacts in exact integers: whether a gap polynomial with dyadic coefficients
//! is zero or less and falling anywhere in an interval. Nothing here rounds, and
//! nothing is shared with the predictor.
//!
//! On an interval f is written in Bernstein's form. If all five coefficients are
//! positive so is f; if they never decrease neither does f; either way there is
//! no contact. If an end of the interval is one, there is. Else it is halved.

use grainfall::Vector;
use grainfall::model::{Approach, PolynomialFlight};
use num_bigint::{BigInt, Sign};

/// Halvings before a tie is called one: far below any distance of roots that
/// polynomials of such coefficients can have, but for double ones.
const MOST_HALVINGS: u32 = 300;

/// A number as an integer times a power of two.
fn parts(x: f64) -> (i64, i64) {
    assert!(x.is_finite());
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = if exponent == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, exponent - 1075)
    };
    let zeros = i64::from(mantissa.trailing_zeros().min(52));
    let sign = if x < 0.0 { -1 } else { 1 };
    if mantissa == 0 {
        (0, 0)
    } else {
        (sign * (mantissa >> zeros), exponent + zeros)
    }
}

fn at_scale(x: f64, scale: i64) -> BigInt {
    let (mantissa, exponent) = parts(x);
    if mantissa == 0 {
        return BigInt::ZERO;
    }
    BigInt::from(mantissa) << usize::try_from(exponent + scale).expect("a common scale")
}

/// 2ⁿ, the least that makes all these numbers integers when multiplied by it.
fn scale_of(numbers: impl IntoIterator<Item = f64>) -> i64 {
    numbers
        .into_iter()
        .filter(|x| *x != 0.0)
        .map(|x| -parts(x).1)
        .max()
        .unwrap_or(0)
}

/// A polynomial of degree four: coefficients times 2 to the `scale`.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    coefficients: [BigInt; 5],
    scale: i64,
}

/// What holds of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Certainly no contact.
    Free,
    /// Certainly one.
    Contact,
    /// Too close to call: a double root to hundreds of digits.
    Tie,
}

impl Exact {
    /// These coefficients, the first plus another number.
    pub(crate) fn of_coefficients(c: [f64; 5], lift: f64) -> Self {
        let scale = scale_of(c.into_iter().chain([lift]));
        let mut coefficients = c.map(|c| at_scale(c, scale));
        coefficients[0] += at_scale(lift, scale);
        Exact {
            coefficients,
            scale,
        }
    }

    /// The squared gap of two flights; f(0) is zero by definition if they touch.
    pub(crate) fn pair<const D: usize, F: PolynomialFlight<D>>(approach: &Approach<D, F>) -> Self {
        let Approach { first, second, .. } = approach;
        let vectors = [
            first.position(0.0),
            second.position(0.0),
            approach.shift,
            first.velocity(0.0),
            second.velocity(0.0),
            first.acceleration(),
            second.acceleration(),
        ];
        let numbers = vectors.iter().flat_map(|v| v.iter().copied());
        let scale = scale_of(numbers.chain([approach.distance, approach.growth]));
        let [x1, x2, s, v1, v2, a1, a2] =
            vectors.map(|v| v.iter().map(|x| at_scale(*x, scale)).collect::<Vec<_>>());
        let difference = |to: &[BigInt], from: &[BigInt]| {
            to.iter().zip(from).map(|(t, f)| t - f).collect::<Vec<_>>()
        };
        let r: Vec<_> = difference(&x2, &x1)
            .iter()
            .zip(&s)
            .map(|(x, s)| x + s)
            .collect();
        let (v, a) = (difference(&v2, &v1), difference(&a2, &a1));
        let dot = |x: &[BigInt], y: &[BigInt]| x.iter().zip(y).map(|(x, y)| x * y).sum::<BigInt>();
        let (sigma, gamma) = (
            at_scale(approach.distance, scale),
            at_scale(approach.growth, scale),
        );
        // Four times f, for the quarter in the last one.
        let c0 = if approach.touching {
            BigInt::ZERO
        } else {
            (dot(&r, &r) - &sigma * &sigma) << 2
        };
        let coefficients = [
            c0,
            (dot(&r, &v) - &sigma * &gamma) << 3,
            (dot(&v, &v) - &gamma * &gamma + dot(&r, &a)) << 2,
            dot(&v, &a) << 2,
            dot(&a, &a),
        ];
        Exact {
            coefficients,
            scale: 2 * scale + 2,
        }
    }

    /// The gap to a plane.
    pub(crate) fn plane<const D: usize, F: PolynomialFlight<D>>(
        flight: &F,
        normal: &Vector<D>,
        [offset, radius, growth]: [f64; 3],
        touching: bool,
    ) -> Self {
        let vectors = [
            *normal,
            flight.position(0.0),
            flight.velocity(0.0),
            flight.acceleration(),
        ];
        let numbers = vectors.iter().flat_map(|v| v.iter().copied());
        let scale = scale_of(numbers.chain([offset, radius, growth])).max(0);
        let whole = |x: f64| at_scale(x, scale);
        let along = |v: &Vector<D>| {
            let terms = normal.iter().zip(v.iter());
            terms.map(|(n, x)| whole(*n) * whole(*x)).sum::<BigInt>()
        };
        let single = |x: f64| whole(x) << usize::try_from(scale).expect("not negative");
        let c0 = if touching {
            BigInt::ZERO
        } else {
            (along(&vectors[1]) - single(offset) - single(radius)) << 1
        };
        let coefficients = [
            c0,
            (along(&vectors[2]) - single(growth)) << 1,
            along(&vectors[3]),
            BigInt::ZERO,
            BigInt::ZERO,
        ];
        Exact {
            coefficients,
            scale: 2 * scale + 1,
        }
    }

    /// f at a time, rounded; exact until then.
    pub(crate) fn value(&self, t: f64) -> f64 {
        let (mantissa, exponent) = parts(t);
        let (mantissa, down) = if exponent > 0 {
            (BigInt::from(mantissa) << exponent as usize, 0)
        } else {
            (BigInt::from(mantissa), -exponent)
        };
        // c₀ D⁴ + c₁ D³ m + …, D = 2^down.
        let mut sum = BigInt::ZERO;
        for (k, c) in self.coefficients.iter().enumerate().rev() {
            sum = sum * &mantissa + (c << ((4 - k) * down as usize));
        }
        to_f64(&sum, -(self.scale + 4 * down))
    }

    /// Whether there is a contact in `[0, end]`.
    pub(crate) fn contact_until(&self, end: f64) -> Verdict {
        let (mantissa, exponent) = parts(end);
        let mut power = BigInt::from(1);
        let least = (4 * exponent).min(0);
        // f(end · x) as a polynomial of x.
        let g: Vec<BigInt> = (0i64..5)
            .map(|k| {
                let shift = usize::try_from(k * exponent - least).expect("not negative");
                let term = (&self.coefficients[k as usize] * &power) << shift;
                power = &power * mantissa;
                term
            })
            .collect();
        let bernstein = [
            &g[0] * 12,
            &g[0] * 12 + &g[1] * 3,
            &g[0] * 12 + &g[1] * 6 + &g[2] * 2,
            &g[0] * 12 + &g[1] * 9 + &g[2] * 6 + &g[3] * 3,
            (&g[0] + &g[1] + &g[2] + &g[3] + &g[4]) * 12,
        ];
        judge(bernstein)
    }
}

fn to_f64(whole: &BigInt, power: i64) -> f64 {
    let bits = whole.bits() as i64;
    let cut = (bits - 64).max(0);
    let head = whole >> cut as usize;
    let head = i128::try_from(head).expect("64 bits") as f64;
    // In two steps, so that it may vanish gradually.
    let total = (cut + power).clamp(-4000, 4000) as i32;
    libm::scalbn(libm::scalbn(head, total / 2), total - total / 2)
}

fn judge(whole: [BigInt; 5]) -> Verdict {
    let mut tie = false;
    let mut open = vec![(whole, 0)];
    while let Some((b, depth)) = open.pop() {
        let steps = |k: usize| b[k + 1].cmp(&b[k]);
        if b.iter().all(|b| b.sign() == Sign::Plus) || (0..4).all(|k| steps(k).is_ge()) {
            continue;
        }
        let begins = b[0].sign() != Sign::Plus && steps(0).is_lt();
        let ends = b[4].sign() != Sign::Plus && steps(3).is_lt();
        if begins || ends {
            return Verdict::Contact;
        }
        if depth == MOST_HALVINGS {
            tie = true;
            continue;
        }
        // De Casteljau's scheme, all times sixteen instead of halved.
        let (mut row, mut left, mut right) = (b.to_vec(), Vec::new(), Vec::new());
        for level in 0..5usize {
            left.push(&row[0] << (4 - level));
            right.push(&row[row.len() - 1] << (4 - level));
            row = row.windows(2).map(|pair| &pair[0] + &pair[1]).collect();
        }
        right.reverse();
        for half in [right, left] {
            open.push((half.try_into().expect("five"), depth + 1));
        }
    }
    if tie { Verdict::Tie } else { Verdict::Free }
}
