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
//! - No contact is missed and none is late by more than the last digit of its
//!   time; the numbers of the flights count as exact. Plain `f64` searches with a
//!   polynomial that lies below the exact one. What is then within rounding is
//!   resolved in [`DoubleDouble`] by the same lines: the solvers are generic over
//!   the arithmetic. The bound and its proof are in the book, page "Prediction,
//!   certified".

mod descent;
mod double_double;
mod gap;
mod lead;
mod real;
mod refine;
mod scale;
mod screen;
mod turning;
mod wall;

pub use descent::{Descent, cubic_descent, quadratic_descent, quartic_descent};
pub use double_double::DoubleDouble;
pub use gap::{CERTAIN, GapPolynomial, Relative};
pub use real::Real;
pub use turning::Turning;
pub use wall::wall_by_distance;

use crate::model::{
    Approach, Crowd, Encounter, Forecast, LANES, Nook, PolynomialFlight, Predictor, Shape, Wall,
};
use crate::particle::Vector;
use lead::Lead;

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
        pair(approach).0
    }

    #[inline]
    fn not_before(&self, own: &F, other: impl Fn(usize) -> F, crowd: &Crowd<D>) -> [f64; LANES] {
        screen::not_before(own, other, crowd)
    }

    #[inline]
    fn not_back_before(&self, own: &F, place: &Vector<D>) -> f64 {
        screen::not_back_before(own, place)
    }

    #[inline]
    fn frame(&self, flight: &F) -> Option<Vector<D>> {
        Some(if F::ACCELERATES {
            flight.acceleration()
        } else {
            Vector::<D>::zeros()
        })
    }

    #[inline]
    fn not_before_resting(&self, nook: &Nook<'_, D, F>) -> [f64; LANES] {
        screen::not_before_resting(nook)
    }

    #[inline]
    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast {
        match encounter.wall.shape() {
            Shape::Plane { normal, offset } => wall::plane(encounter, &normal, offset),
            Shape::General { .. } => {
                let own = encounter.flight.acceleration().norm_squared().sqrt();
                wall_by_distance(encounter, own)
            }
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
    let gap = if relative.acceleration == Vector::<D>::zeros() {
        GapPolynomial::without_acceleration(relative)
    } else {
        GapPolynomial::new(relative)
    };
    descent(&gap, touching, N::from_f64(horizon))
}

fn descent<N: Real>(gap: &GapPolynomial<N>, touching: bool, horizon: N) -> Descent<N> {
    let [c0, c1, c2, _, c4] = gap.coefficients;
    if c4 > N::ZERO {
        quartic_descent(gap, touching, horizon)
    } else {
        quadratic_descent([c0, c1, c2], touching, horizon)
    }
}

/// By which arithmetic an answer was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// `f64` was certain.
    Plain,
    /// It was not: a sign was within rounding.
    Wide,
}

/// What [`Polynomial`] answers for two grains, and which arithmetic was needed.
#[inline]
pub fn pair<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
) -> (Forecast, Arithmetic) {
    let Approach {
        touching, horizon, ..
    } = *approach;
    let relative = Relative::of(approach);
    let bent = F::ACCELERATES && relative.acceleration != Vector::<D>::zeros();
    let mut gap = if bent {
        GapPolynomial::new(&relative)
    } else {
        GapPolynomial::without_acceleration(&relative)
    };
    gap.place_scale += approach.shift.norm_squared() / 64.0;
    if scale::is_extreme(&gap, bent) {
        let forecast = scale::first_contact(&relative, touching, horizon);
        return (forecast, Arithmetic::Wide);
    }
    let low = gap.lowered();
    if !touching && low.is_clear(horizon) {
        return (Forecast::Never, Arithmetic::Plain);
    }
    settle(approach, &gap, &low, bent)
}

#[inline(never)]
fn settle<const D: usize, F: PolynomialFlight<D>>(
    approach: &Approach<D, F>,
    gap: &GapPolynomial<f64>,
    low: &GapPolynomial<f64>,
    bent: bool,
) -> (Forecast, Arithmetic) {
    let forecast = match lead::lead(gap, low, approach.touching, bent, approach.horizon) {
        Lead::Never => Forecast::Never,
        Lead::Now => Forecast::Contact(0.0),
        Lead::Until(time) => match refine::refine(approach, gap, bent, time) {
            Some(contact) => Forecast::Contact(contact),
            None => return (settle_wide(approach), Arithmetic::Wide),
        },
        Lead::Unsure => return (settle_wide(approach), Arithmetic::Wide),
    };
    (forecast, Arithmetic::Plain)
}

/// The same question in double-double.
#[cold]
#[inline(never)]
fn settle_wide<const D: usize, F: PolynomialFlight<D>>(approach: &Approach<D, F>) -> Forecast {
    let gap = GapPolynomial::<DoubleDouble>::between(approach);
    // A contact that only rounds to the horizon is not hidden by it.
    let horizon = approach.horizon.next_up();
    forecast(rounded(descent(
        &gap,
        approach.touching,
        DoubleDouble::from_f64(horizon),
    )))
}

fn rounded(descent: Descent<DoubleDouble>) -> Descent<f64> {
    match descent {
        Descent::Never => Descent::Never,
        Descent::At(time) => Descent::At(time.to_f64()),
        Descent::NotBefore(time) => Descent::NotBefore(time.to_f64()),
    }
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
