//! When flights meet: the built-in predictor for polynomial flights.
//!
//! [`Polynomial`] answers for flights at constant acceleration, all of them
//! different if need be: the squared distance of two grains is then a
//! polynomial of degree four at most, quadratic if they accelerate alike. The
//! event-driven method goes back to Alder & Wainwright 1959,
//! doi:10.1063/1.1730376; what "first contact" means under rounding follows
//! Bannerman, Strobl, Formella & Pöschel 2014, doi:10.1007/s40571-014-0021-8.
//!
//! - A contact is the first time the gap is zero **and closing**. An overlap
//!   that closes is a contact at once; one that opens is none, until the grains
//!   close again.
//! - After a collision the gap is zero by definition, whatever rounding says:
//!   that root is divided out, and what is left has one degree less.
//! - The bits of an answer depend on the two flights alone: not on the horizon,
//!   nor on which grain is called the first.
//! - A gap within rounding of zero, about 10⁻¹⁵ d², may be judged either way.
//!
//! The solvers are generic over the arithmetic: with [`DoubleDouble`] the same
//! lines give 30 digits.

mod descent;
mod double_double;
mod gap;
mod real;
mod scale;
mod wall;

pub use descent::{Descent, cubic_descent, quadratic_descent, quartic_descent};
pub use double_double::DoubleDouble;
pub use gap::{GapPolynomial, Relative};
pub use real::Real;

use crate::model::{Approach, Encounter, Forecast, PolynomialFlight, Predictor, Shape, Wall};
use crate::particle::Vector;

/// Predicts contacts of flights whose positions are polynomials of time, of
/// degree two at most, with each other and with any wall.
///
/// ```
/// use grainfall::dynamics::Parabola;
/// use grainfall::model::{Approach, Forecast, Predictor};
/// use grainfall::predict::Polynomial;
/// use grainfall::Vector;
///
/// let rest = Parabola {
///     position: Vector::<3>::zeros(),
///     velocity: Vector::<3>::zeros(),
///     acceleration: Vector::<3>::zeros(),
/// };
/// let dropped = Parabola {
///     position: Vector::<3>::new(0.0, 0.0, 1.5),
///     acceleration: Vector::<3>::new(0.0, 0.0, -1.0),
///     ..rest
/// };
/// let forecast = Polynomial.pair(&Approach {
///     first: dropped,
///     second: rest,
///     shift: Vector::<3>::zeros(),
///     distance: 1.0,
///     growth: 0.0,
///     touching: false,
///     horizon: f64::INFINITY,
/// });
/// let Forecast::Contact(time) = forecast else { panic!() };
/// assert!((time - 1.0).abs() < 1.0e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Polynomial;

impl<const D: usize, F: PolynomialFlight<D>> Predictor<D, F> for Polynomial {
    #[inline]
    fn pair(&self, approach: &Approach<D, F>) -> Forecast {
        let Approach {
            touching, horizon, ..
        } = *approach;
        let relative = Relative::of(approach);
        let bent = F::ACCELERATES && relative.acceleration != Vector::<D>::zeros();
        let gap = if bent {
            GapPolynomial::new(&relative)
        } else {
            GapPolynomial::without_acceleration(&relative)
        };
        if !touching && gap.is_clear(horizon) {
            return Forecast::Never;
        }
        if bent {
            settle_quartic(&relative, &gap, touching, horizon)
        } else {
            settle_quadratic(&relative, &gap, touching, horizon)
        }
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast {
        match encounter.wall.shape() {
            Shape::Plane { normal, offset } => wall::plane(encounter, &normal, offset),
            Shape::General {
                curvature,
                speed,
                acceleration,
            } => wall::general(encounter, curvature, speed, acceleration),
        }
    }
}

/// First contact of two grains in any arithmetic: what [`Polynomial`] answers,
/// before it is rounded.
///
/// Sizes that are fit for `f64` at most (10⁻⁷⁰ … 10⁷⁰) are expected; `Polynomial`
/// itself takes any.
pub fn first_contact<N: Real, const D: usize>(
    relative: &Relative<D>,
    touching: bool,
    horizon: f64,
) -> Descent<N> {
    let horizon = N::from_f64(horizon);
    if relative.acceleration == Vector::<D>::zeros() {
        let gap = GapPolynomial::without_acceleration(relative);
        let [c0, c1, c2, ..] = gap.coefficients;
        quadratic_descent([c0, c1, c2], touching, horizon)
    } else {
        quartic_descent(&GapPolynomial::new(relative), touching, horizon)
    }
}

#[inline(never)]
fn settle_quartic<const D: usize>(
    relative: &Relative<D>,
    gap: &GapPolynomial<f64>,
    touching: bool,
    horizon: f64,
) -> Forecast {
    if scale::is_extreme(gap, true) {
        return scale::first_contact(relative, touching, horizon);
    }
    forecast(quartic_descent(gap, touching, horizon))
}

#[inline]
fn settle_quadratic<const D: usize>(
    relative: &Relative<D>,
    gap: &GapPolynomial<f64>,
    touching: bool,
    horizon: f64,
) -> Forecast {
    if scale::is_extreme(gap, false) {
        return scale::first_contact(relative, touching, horizon);
    }
    let [c0, c1, c2, ..] = gap.coefficients;
    forecast(quadratic_descent([c0, c1, c2], touching, horizon))
}

#[inline]
fn forecast(descent: Descent<f64>) -> Forecast {
    match descent {
        Descent::Never => Forecast::Never,
        Descent::At(time) => Forecast::Contact(time),
        // Only a positive time is progress; nothing of the kind has been seen.
        Descent::NotBefore(time) if time > 0.0 => Forecast::AskAgain(time),
        Descent::NotBefore(_) => Forecast::Contact(0.0),
    }
}
