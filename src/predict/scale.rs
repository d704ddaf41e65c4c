//! Inputs so large or small that squares overflow or vanish.

use super::double_double::DoubleDouble;
use super::gap::{GapPolynomial, Relative};
use crate::model::Forecast;
use crate::particle::Vector;

/// Sizes between this and its inverse are safe to square twice.
const LARGE: f64 = 1.0e70;
/// Below this, in the units of the motion, an acceleration is as good as none.
const NO_ACCELERATION: f64 = 1.0e-70;

/// Whether products of these coefficients might overflow or vanish.
#[inline]
pub(super) fn is_extreme(gap: &GapPolynomial<f64>, accelerated: bool) -> bool {
    let [.., c4] = gap.coefficients;
    let (place, motion) = (gap.place_scale, gap.motion_scale);
    // Written so that NaN counts as extreme.
    let usual = place < LARGE
        && place > 1.0 / LARGE
        && motion < LARGE
        && c4 < LARGE
        && if accelerated {
            c4 > 1.0 / LARGE
        } else {
            motion > 1.0 / LARGE
        };
    !usual
}

/// n such that 2ⁿ ≤ |x| < 2ⁿ⁺¹; a number far below any other for 0.
fn exponent(x: f64) -> i32 {
    if x == 0.0 { -100_000 } else { libm::ilogb(x) }
}

fn scaled<const D: usize>(v: &Vector<D>, power: i32) -> Vector<D> {
    v.map(|x| libm::scalbn(x, power))
}

/// The same contact in units in which the grains are of size 1 and meet, if at
/// all, after a time of about 1. Powers of two: nothing is rounded.
#[cold]
#[inline(never)]
pub(super) fn first_contact<const D: usize>(
    relative: &Relative<D>,
    touching: bool,
    horizon: f64,
) -> Forecast {
    let length = exponent(relative.offset.amax().max(relative.distance));
    let speed = exponent(relative.velocity.amax().max(relative.growth.abs())) - length;
    let acceleration = exponent(relative.acceleration.amax()) - length;
    // Infinite or NaN, of no extent, or not moving.
    if !(-2000..2000).contains(&length) || speed.max(acceleration) < -50_000 {
        return Forecast::Never;
    }
    let time = (-speed).min(-acceleration.div_euclid(2));
    let mut units = Relative {
        offset: scaled(&relative.offset, -length),
        velocity: scaled(&relative.velocity, time - length),
        acceleration: scaled(&relative.acceleration, 2 * time - length),
        distance: libm::scalbn(relative.distance, -length),
        growth: libm::scalbn(relative.growth, time - length),
    };
    let horizon = libm::scalbn(horizon, -time);
    if units.acceleration.amax() < NO_ACCELERATION {
        units.acceleration = Vector::zeros();
    }
    let descent = super::first_contact::<DoubleDouble, D>(&units, touching, horizon.next_up());
    let descent = super::rounded(descent);
    let back = |after: f64| libm::scalbn(after, time);
    match super::forecast(descent) {
        // Later than any number can say.
        Forecast::Contact(after) | Forecast::AskAgain(after) if back(after).is_infinite() => {
            Forecast::Never
        }
        Forecast::Contact(after) => Forecast::Contact(back(after)),
        Forecast::AskAgain(after) => Forecast::AskAgain(back(after).max(f64::MIN_POSITIVE)),
        Forecast::Never => Forecast::Never,
    }
}
