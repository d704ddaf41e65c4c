//! When flights under accelerations that turn meet.
//!
//! The gap f(t) = |r + v t + G(t)|² − (σ + γ t)² is no polynomial now, but its
//! fourth derivative has a lower bound 2M, so that
//!
//! f(t) ≥ f + f′ t + h t² + h′ t³/3 + M t⁴/12 , h = f″/2 ,
//!
//! as long as M holds: a gap polynomial of degree four that lies below the gap,
//! and its derivative below the slope. So the searches of [`Polynomial`](super::Polynomial) do for
//! this one too: where they find no contact there is none, and where they find
//! one there is none before. The rest is found by laying such a polynomial anew
//! there. The proof is in the book, page "Prediction, certified".

mod course;
mod flat;
mod last_digits;

use super::descent::{Descent, quadratic_descent, quartic_descent};
use super::lead::{self, Lead};
use super::{
    DoubleDouble, GapPolynomial, Real, Relative, forecast, screen, wall, wall_by_distance,
};
use crate::model::{
    Approach, Crowd, Encounter, Flight, Forecast, LANES, Nook, PolynomialFlight, Predictor, Shape,
    TurningFlight, Wall,
};
use crate::particle::Vector;
use course::Course;

/// Polynomials that are laid before a question is put off.
const MOST_STEPS: usize = 256;
/// A step so much shorter than the time is the last: the next would change no
/// digit of it.
const LAST_STEP: f64 = f64::EPSILON / 1024.0;
/// An angle up to which the series of a turn are short.
const FARTHEST: f64 = 2.0;
/// How far ahead bounds are told, one after the other, in √(d/g).
const STAGES: [f64; 2] = [1.0 / 16.0, 1.0];
/// Covers the rounding of a few operations.
const ROUND: f64 = 1.0e-12;

/// Predicts contacts of flights under a constant acceleration and one that
/// turns: gravity that turns, or grains that are carried on circles.
///
/// Two grains under the same gravity fly straight as seen from each other,
/// whatever gravity does, and are answered for by [`Polynomial`](super::Polynomial).
///
/// What is promised is what [`Polynomial`](super::Polynomial) promises; see there. Walls are known
/// by their distance alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turning;

/// A flight at constant acceleration, in the place of one that turns: as others see
/// it, or up to a deviation. (Predictors name no dynamics, so not theirs.)
#[derive(Clone, Copy, Debug)]
struct Parabola<const D: usize> {
    position: Vector<D>,
    velocity: Vector<D>,
    acceleration: Vector<D>,
}

impl<const D: usize> Parabola<D> {
    /// With the acceleration at the start.
    fn tangent<F: TurningFlight<D>>(flight: &F) -> Self {
        Parabola {
            position: flight.start(),
            velocity: flight.start_velocity(),
            acceleration: flight.steady() + flight.turning(),
        }
    }

    fn straight<F: TurningFlight<D>>(flight: &F) -> Self {
        Parabola {
            position: flight.start(),
            velocity: flight.start_velocity(),
            acceleration: Vector::zeros(),
        }
    }
}

impl<const D: usize> Flight<D> for Parabola<D> {
    fn position(&self, after: f64) -> Vector<D> {
        self.position + (self.velocity + self.acceleration * (0.5 * after)) * after
    }

    fn velocity(&self, after: f64) -> Vector<D> {
        self.velocity + self.acceleration * after
    }

    #[inline]
    fn start(&self) -> Vector<D> {
        self.position
    }

    #[inline]
    fn start_velocity(&self) -> Vector<D> {
        self.velocity
    }

    fn advanced(&self, after: f64) -> Self {
        Parabola {
            position: self.position(after),
            velocity: self.velocity(after),
            ..*self
        }
    }

    fn speed_bound(&self, within: f64) -> f64 {
        self.velocity.norm_squared().sqrt() + self.acceleration.norm_squared().sqrt() * within
    }

    fn is_at_rest(&self) -> bool {
        self.velocity == Vector::<D>::zeros() && self.acceleration == Vector::<D>::zeros()
    }
}

impl<const D: usize> PolynomialFlight<D> for Parabola<D> {
    const ACCELERATES: bool = true;

    #[inline]
    fn acceleration(&self) -> Vector<D> {
        self.acceleration
    }
}

impl<const D: usize, F: TurningFlight<D>> Predictor<D, F> for Turning {
    fn pair(&self, approach: &Approach<D, F>) -> Forecast {
        let Approach { first, second, .. } = approach;
        if first.accelerates_like(second) {
            return straight(approach);
        }
        let until = first.changes_after().min(second.changes_after());
        if approach.horizon <= until {
            return bent(approach);
        }
        let near = Approach {
            horizon: until,
            ..*approach
        };
        match bent(&near) {
            Forecast::Contact(time) if time <= until => Forecast::Contact(time),
            Forecast::AskAgain(time) if time < until => Forecast::AskAgain(time),
            _ if drift_apart(approach) => Forecast::Never,
            _ => Forecast::AskAgain(until),
        }
    }

    fn not_before(&self, own: &F, other: impl Fn(usize) -> F, crowd: &Crowd<D>) -> [f64; LANES] {
        let others: [F; LANES] =
            std::array::from_fn(|lane| other(lane).advanced(crowd.after[lane]));
        let mut turn: f64 = 0.0;
        let mut until = own.changes_after();
        let parabolas = others.each_ref().map(|flight| {
            let mut parabola = Parabola::tangent(flight);
            if own.accelerates_like(flight) {
                // Not even by rounding is there a difference.
                parabola.acceleration = own.steady() + own.turning();
            } else {
                turn = turn.max(jerk(own) + jerk(flight));
                until = until.min(flight.changes_after());
            }
            parabola
        });
        let least = crowd
            .distances
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        in_stages(crowd.horizon, until, turn, least, |horizon, growth| {
            let near = Crowd {
                after: [0.0; LANES],
                growth: crowd.growth + growth,
                horizon,
                ..*crowd
            };
            screen::not_before(&Parabola::tangent(own), |lane| parabolas[lane], &near)
        })
    }

    fn not_before_resting(&self, nook: &Nook<'_, D, F>) -> [f64; LANES] {
        let own = Parabola::tangent(nook.own);
        // Lanes without anybody have no distance.
        let distances = nook.resting.distances.iter().filter(|&&d| d > 0.0);
        let least = distances.copied().fold(f64::INFINITY, f64::min) * nook.scale;
        let until = nook.own.changes_after();
        in_stages(
            nook.horizon,
            until,
            jerk(nook.own),
            least,
            |horizon, growth| {
                screen::not_before_resting(&Nook {
                    own: &own,
                    place: nook.place,
                    resting: nook.resting,
                    scale: nook.scale,
                    growth: nook.growth + growth,
                    blur: nook.blur,
                    horizon,
                })
            },
        )
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast {
        let flight = &encounter.flight;
        let own = flight.steady().norm_squared().sqrt() + flight.turning().norm_squared().sqrt();
        match encounter.wall.shape() {
            Shape::Plane { normal, offset } => {
                if flat::drifts_away(encounter, &normal, offset) {
                    Forecast::Never
                } else if flight.turning() == Vector::<D>::zeros() {
                    let until = flight.changes_after();
                    let horizon = encounter.horizon.min(until);
                    let bent = encounter_of(encounter, Parabola::tangent(flight), horizon);
                    match wall::plane(&bent, &normal, offset) {
                        Forecast::Contact(time) if time <= until => Forecast::Contact(time),
                        _ if until < encounter.horizon => Forecast::AskAgain(until),
                        other => other,
                    }
                } else {
                    wall_by_distance(encounter, own)
                }
            }
            Shape::General { .. } => wall_by_distance(encounter, own),
        }
    }
}

/// The same encounter of another flight, or with another horizon.
fn encounter_of<'a, const D: usize, F, G, W>(
    encounter: &Encounter<'a, D, F, W>,
    flight: G,
    horizon: f64,
) -> Encounter<'a, D, G, W> {
    Encounter {
        flight,
        wall: encounter.wall,
        since: encounter.since,
        radius: encounter.radius,
        growth: encounter.growth,
        touching: encounter.touching,
        horizon,
    }
}

/// |p| Ω, how fast an acceleration may change, in g √(g/d).
fn jerk<const D: usize, F: TurningFlight<D>>(flight: &F) -> f64 {
    flight.turning().norm_squared().sqrt() * flight.rate().abs()
}

/// Bounds for parabolas that touch at the start serve for flights that turn away
/// from them: by j t³/6 at most, j being the jerk, so up to a time T by less than
/// (j T²/6) t, which is as if the grains grew so fast. They are told for short
/// times first, for which they are sharp.
fn in_stages(
    horizon: f64,
    until: f64,
    turn: f64,
    least_distance: f64,
    bounds: impl Fn(f64, f64) -> [f64; LANES],
) -> [f64; LANES] {
    let mut times = [0.0; LANES];
    let mut reached = 0.0;
    for stage in STAGES.map(|stage| stage.min(until)) {
        let ahead = horizon.min(stage);
        let growth = turn * ahead * ahead / (6.0 * least_distance) * (1.0 + ROUND);
        let found = bounds(ahead, growth);
        for (time, found) in times.iter_mut().zip(found) {
            // Who does not come before the end of a stage is asked for in the next.
            if *time >= reached {
                *time = found.max(*time);
                if stage < horizon {
                    *time = time.min(stage);
                }
            }
        }
        reached = stage;
        if stage >= horizon || times.iter().all(|&time| time < stage) {
            break;
        }
    }
    times
}

/// First contact of two flights that are straight as seen from each other.
fn straight<const D: usize, F: TurningFlight<D>>(approach: &Approach<D, F>) -> Forecast {
    let (forecast, _) = super::pair(&Approach {
        first: Parabola::straight(&approach.first),
        second: Parabola::straight(&approach.second),
        shift: approach.shift,
        distance: approach.distance,
        growth: approach.growth,
        touching: approach.touching,
        horizon: approach.horizon,
    });
    forecast
}

/// True if there certainly is no contact at all, for what goes round also drifts,
/// and that comes nowhere near.
fn drift_apart<const D: usize, F: TurningFlight<D>>(approach: &Approach<D, F>) -> bool {
    let (first, second) = (&approach.first, &approach.second);
    let (one, other) = (first.drift(), second.drift());
    let circle = (one.radius + other.radius) * (1.0 + ROUND);
    if !circle.is_finite() {
        return false;
    }
    let drift = GapPolynomial::<f64>::new(&Relative {
        offset: second.start() - first.start() + approach.shift,
        velocity: other.velocity - one.velocity,
        acceleration: other.acceleration - one.acceleration,
        distance: (approach.distance + circle) * (1.0 + ROUND),
        growth: approach.growth,
    })
    .lowered();
    let [c0, c1, c2, _, c4] = drift.coefficients;
    let next = if c4 > 0.0 {
        quartic_descent(&drift, false, f64::INFINITY)
    } else {
        quadratic_descent([c0, c1, c2], false, f64::INFINITY)
    };
    c0 > 0.0 && next == Descent::Never
}

/// First contact of two flights whose accelerations differ.
fn bent<const D: usize, F: TurningFlight<D>>(approach: &Approach<D, F>) -> Forecast {
    let course = Course::<f64, D>::of(approach);
    if course.is_straight() {
        return straight(approach);
    }
    let mut now = 0.0;
    for _ in 0..MOST_STEPS {
        let (mut gap, valid) = course.below(now);
        gap.place_scale += approach.shift.norm_squared() / 64.0;
        let low = gap.lowered();
        let touching = approach.touching && now == 0.0;
        let ahead = valid.min(approach.horizon - now);
        if touching || !low.is_clear(ahead) {
            match lead::lead(&gap, &low, touching, true, ahead) {
                Lead::Never => {}
                Lead::Now => return Forecast::Contact(0.0),
                Lead::Until(time) => {
                    let from = now + time;
                    return match last_digits::refine(approach, &course, from) {
                        Some(contact) => Forecast::Contact(contact),
                        None => wide(approach, from),
                    };
                }
                Lead::Unsure => return wide(approach, now),
            }
        }
        let whole_turns_ahead = now == 0.0 && approach.horizon > FARTHEST / course.rate();
        now += valid;
        if now > approach.horizon || (whole_turns_ahead && drift_apart(approach)) {
            return Forecast::Never;
        }
        if now * course.rate() > FARTHEST {
            break;
        }
    }
    Forecast::AskAgain(now)
}

/// The same question in double-double, from a time on up to which there
/// certainly is no contact.
#[cold]
#[inline(never)]
fn wide<const D: usize, F: TurningFlight<D>>(approach: &Approach<D, F>, from: f64) -> Forecast {
    // A contact that only rounds to the horizon is not hidden by it.
    let horizon = approach.horizon.next_up();
    forecast(march(approach, from, horizon))
}

/// The first contact after `from`, by laying polynomials below the gap again and
/// again: each time at the root of the last, which converges at fourth order.
fn march<const D: usize, F: TurningFlight<D>>(
    approach: &Approach<D, F>,
    from: f64,
    horizon: f64,
) -> Descent<f64> {
    let course = Course::<DoubleDouble, D>::of(approach);
    let mut now = DoubleDouble::from_f64(from);
    let mut first = true;
    for _ in 0..MOST_STEPS {
        if now.to_f64() * approach.first.rate().abs() > FARTHEST {
            break;
        }
        let (gap, valid) = course.below(now);
        let touching = approach.touching && first && from == 0.0;
        first = false;
        match quartic_descent(&gap, touching, DoubleDouble::from_f64(valid)) {
            Descent::At(step) => {
                now = now + step;
                if step <= now.times(LAST_STEP) {
                    return Descent::At(now.to_f64());
                }
            }
            Descent::Never => now = now + DoubleDouble::from_f64(valid),
            Descent::NotBefore(step) => now = now + step,
        }
        if now.to_f64() > horizon {
            return Descent::Never;
        }
    }
    Descent::NotBefore(now.to_f64())
}

#[cfg(test)]
mod tests;
