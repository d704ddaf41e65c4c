//! The motion of one grain as another sees it, and polynomials below their gap.

use crate::model::{Approach, TurningFlight};
use crate::particle::Vector;
use crate::predict::{GapPolynomial, Real};

/// Terms of the series of a turn; for angles up to 2 the last is below 10⁻³⁵.
const MOST_TERMS: u32 = 20;
/// A polynomial holds for a turn by this angle at most.
const TURN: f64 = 0.25;
/// Covers the rounding of bounds.
const ROUND: f64 = 1.0e-9;

/// r + v t + s t²/2 + [p (1 − cos Ωt) + p⟂ (Ωt − sin Ωt)]/Ω², and the distance at
/// contact, σ + γ t.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<N, const D: usize> {
    offset: [N; D],
    velocity: [N; D],
    steady: [N; D],
    turning: [N; D],
    distance: N,
    growth: N,
    /// f(0) counts as zero.
    touching: bool,
    rate: f64,
    plane: [usize; 2],
    /// |s| and |p|.
    steady_size: f64,
    turning_size: f64,
}

/// Where it is at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<N, const D: usize> {
    pub(super) offset: [N; D],
    pub(super) velocity: [N; D],
    /// The mean velocity up to there.
    mean: [N; D],
    acceleration: [N; D],
    /// The rate at which that changes.
    jerk: [N; D],
}

#[inline]
fn dot<N: Real, const D: usize>(a: &[N; D], b: &[N; D]) -> N {
    let mut sum = N::ZERO;
    for axis in 0..D {
        sum = sum + a[axis] * b[axis];
    }
    sum
}

fn size<N: Real, const D: usize>(vector: &[N; D]) -> f64 {
    dot(vector, vector).to_f64().sqrt()
}

/// (1 − cos x)/x² and (x − sin x)/x³ for y = x².
fn turn<N: Real>(y: N) -> [N; 2] {
    let mut sums = [N::from_f64(0.5), N::from_f64(1.0) / N::from_f64(6.0)];
    if y == N::ZERO {
        return sums;
    }
    let mut terms = sums;
    for k in 1..MOST_TERMS {
        for (place, (sum, term)) in sums.iter_mut().zip(&mut terms).enumerate() {
            let low = 2.0 * f64::from(k) + place as f64;
            *term = -(*term * y) / N::from_f64((low + 1.0) * (low + 2.0));
            *sum = *sum + *term;
        }
        if terms[0].abs() <= sums[0].times(0.01 * N::UNIT_ROUNDOFF) {
            break;
        }
    }
    sums
}

impl<N: Real, const D: usize> Course<N, D> {
    pub(super) fn of<F: TurningFlight<D>>(approach: &Approach<D, F>) -> Self {
        let difference = |to: &Vector<D>, from: &Vector<D>| -> [N; D] {
            std::array::from_fn(|axis| N::from_f64(to[axis]) - N::from_f64(from[axis]))
        };
        let (first, second) = (&approach.first, &approach.second);
        let mut offset = difference(&second.start(), &first.start());
        for (along, &shift) in offset.iter_mut().zip(approach.shift.iter()) {
            *along = *along + N::from_f64(shift);
        }
        let steady = difference(&second.steady(), &first.steady());
        let turning = difference(&second.turning(), &first.turning());
        Course {
            offset,
            velocity: difference(&second.start_velocity(), &first.start_velocity()),
            steady_size: size(&steady),
            turning_size: size(&turning),
            steady,
            turning,
            distance: N::from_f64(approach.distance),
            touching: approach.touching,
            growth: N::from_f64(approach.growth),
            rate: first.rate(),
            plane: first.plane(),
        }
    }

    /// True if nothing accelerates.
    pub(super) fn is_straight(&self) -> bool {
        self.steady_size == 0.0 && self.turning_size == 0.0
    }

    /// |Ω|.
    pub(super) fn rate(&self) -> f64 {
        self.rate.abs()
    }

    /// A bound on the acceleration.
    pub(super) fn acceleration_bound(&self) -> f64 {
        (self.steady_size + self.turning_size) * (1.0 + ROUND)
    }

    /// |p| Ω.
    pub(super) fn jerk_bound(&self) -> f64 {
        self.turning_size * self.rate.abs() * (1.0 + ROUND)
    }

    /// p, a quarter turn on.
    pub(super) fn quarter(&self, vector: &[N; D]) -> [N; D] {
        let [from, to] = self.plane;
        let mut turned = [N::ZERO; D];
        turned[from] = -vector[to];
        turned[to] = vector[from];
        turned
    }

    pub(super) fn at(&self, time: N) -> Place<N, D> {
        let x = time.times(self.rate);
        let y = x * x;
        let [a, b] = turn(y);
        let one = N::from_f64(1.0);
        let (cos, sin_over) = (one - y * a, one - y * b);
        let across = self.quarter(&self.turning);
        let mut place = Place {
            offset: self.offset,
            velocity: self.velocity,
            mean: self.velocity,
            acceleration: self.steady,
            jerk: [N::ZERO; D],
        };
        let mut turned = [N::ZERO; D];
        for axis in 0..D {
            let (s, p, q) = (self.steady[axis], self.turning[axis], across[axis]);
            let bend = s.times(0.5) + p * a + q * (x * b);
            let gained = s + p * sin_over + q * (x * a);
            place.mean[axis] = self.velocity[axis] + time * bend;
            place.offset[axis] = place.offset[axis] + time * place.mean[axis];
            place.velocity[axis] = place.velocity[axis] + time * gained;
            turned[axis] = p * cos + q * (x * sin_over);
            place.acceleration[axis] = place.acceleration[axis] + turned[axis];
        }
        place.jerk = self.quarter(&turned).map(|part| part.times(self.rate));
        place
    }

    /// f′ at a place, t after the start.
    pub(super) fn slope(&self, place: &Place<N, D>, time: N) -> N {
        let distance = self.distance + self.growth * time;
        (dot(&place.offset, &place.velocity) - distance * self.growth).times(2.0)
    }

    /// f at a place, t after the start: if f(0) counts as zero, without the
    /// digits that would cancel.
    fn gap(&self, place: &Place<N, D>, time: N) -> N {
        let distance = self.distance + self.growth * time;
        if self.touching {
            let mean = &place.mean;
            let covered = dot(&self.offset, mean).times(2.0) + time * dot(mean, mean);
            time * (covered - self.growth * (self.distance + distance))
        } else {
            dot(&place.offset, &place.offset) - distance * distance
        }
    }

    /// A polynomial of the time after `now` that lies below the gap, and whose
    /// derivative lies below the slope, for as long as is said: with the
    /// coefficients f, f′, h = f″/2, h′/3 and M/12 or something that together is
    /// less, M being a bound on h″ = 3a² + 4 v·a′ + r·a″.
    pub(super) fn below(&self, now: N) -> (GapPolynomial<N>, f64) {
        let place = self.at(now);
        let distance = self.distance + self.growth * now;
        let (r, v, a) = (&place.offset, &place.velocity, &place.acceleration);
        let (r_r, v_v) = (dot(r, r), dot(v, v));
        let contact = distance * distance;
        let growth = self.growth * self.growth;
        let (far, speed) = (r_r.to_f64().sqrt(), v_v.to_f64().sqrt());
        let most = self.acceleration_bound();
        // As long as it takes a throw to come down, if that is not too long.
        let fall = (2.0 * (far + distance.to_f64()) / most).sqrt();
        let valid = (TURN / self.rate.abs()).min(2.0 * (speed / most + fall));
        let fastest = speed + most * valid;
        let farthest = far + fastest * valid;
        let least = (self.turning_size - self.steady_size).abs() * (1.0 - ROUND);
        let turn = self.jerk_bound();
        let negative = 4.0 * fastest * turn + farthest * turn * self.rate.abs();
        let bound = 3.0 * least * least - negative * (1.0 + ROUND);
        // The searches want a fourth coefficient that is positive: what it is
        // too large by, the third is too small by, and by a third more, so that the
        // slope, too, stays below.
        let quartic = (bound / 12.0).max(most * most / 16.0);
        let lent = (quartic - bound / 12.0) * (valid * (4.0 / 3.0)) * (1.0 + ROUND);
        let third = dot(v, a).times(3.0) + dot(r, &place.jerk);
        let cubic = third / N::from_f64(3.0) - N::from_f64(lent);
        let c1 = (dot(r, v) - distance * self.growth).times(2.0);
        let half_curvature = v_v + dot(r, a) - growth;
        // Where it is now is itself the sum of what it has covered since.
        let since = now.to_f64();
        let way = since * (size(&self.velocity) + since * most);
        let here = size(&self.offset) + way;
        let gained = most * (since + valid);
        let gap = GapPolynomial {
            coefficients: [
                self.gap(&place, now),
                c1,
                half_curvature,
                cubic,
                N::from_f64(quartic),
            ],
            place_scale: r_r + contact + N::from_f64(here * here),
            motion_scale: v_v + growth + N::from_f64(gained * gained + lent * valid),
        };
        (gap, valid)
    }
}

impl<const D: usize> Course<f64, D> {
    /// How far the mean velocity up to a time is from that of the parabola with
    /// the first acceleration, and how wrong that may be, in √(gd).
    pub(super) fn correction(&self, time: f64) -> ([f64; D], f64) {
        let x = time * self.rate;
        let y = x * x;
        // (1 − cos x)/x² − 1/2, and (x − sin x)/x².
        let mut term = -y / 24.0;
        let mut cosine = term;
        for k in 2..MOST_TERMS {
            let low = 2.0 * f64::from(k) + 1.0;
            term *= -y / (low * (low + 1.0));
            cosine += term;
            if term.abs() <= cosine.abs() * f64::EPSILON {
                break;
            }
        }
        let [_, b] = turn(y);
        let across = self.quarter(&self.turning);
        let part = |axis: usize| time * (self.turning[axis] * cosine + across[axis] * (x * b));
        let size = time * self.turning_size * (y / 24.0 + x.abs() / 6.0);
        (std::array::from_fn(part), 8.0 * f64::EPSILON * size)
    }
}
