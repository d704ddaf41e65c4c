//! Which grains certainly do not come first: a lower bound of the times at which
//! a grain meets a few others, for all of them at once and without a branch.
//!
//! The gap is f(t) = c₀ + 2 b t + c₂ t² + c₃ t³ + c₄ t⁴ with c₄ ≥ 0. Up to the
//! horizon T the last two terms are at least t² times
//! max(−c₃²/(4 c₄), T min(c₃, 0)), so f lies above a parabola, and the parabola's
//! first root is not later than that of f. Everything that rounding may have
//! done is taken off c₀: at a contact no term is larger than the sizes that it
//! is made of, see the book, page "Prediction, certified".

use wide::f64x4;

use crate::model::{Crowd, LANES, Nook, PolynomialFlight};
use crate::particle::Vector;

/// Rounding of all terms together, over their sizes: 128 u.
const ROUND: f64 = 64.0 * f64::EPSILON;
/// Farther ahead, in √(d/g), a difference of accelerations makes terms so large
/// that nothing is said.
const FAR: f64 = 8.0;
/// Instead of no difference of accelerations at all.
const TINY: f64 = f64::MIN_POSITIVE;

/// How far ahead something is said: up to the horizon, but not too far.
#[inline(always)]
fn near(horizon: f64, curved: bool) -> f64 {
    if curved { horizon.min(FAR) } else { horizon }
}

/// At least as small as c₃ t + c₄ t² gets up to `near`; `bent` is 4 c₄.
#[inline(always)]
fn bend(c3: f64x4, bent: f64x4, near: f64) -> f64x4 {
    let vertex = -(c3 * c3) / (bent + TINY);
    let straight = c3.fast_min(f64x4::ZERO) * near;
    vertex.fast_max(straight) * (1.0 + ROUND)
}

/// The first root of c₀ + 2 b t + a t², or something earlier; infinity if there
/// is none, zero if c₀ is not positive.
#[inline(always)]
fn first_root(c0: f64x4, b: f64x4, a: f64x4) -> f64x4 {
    let discriminant = b * b * (1.0 + ROUND) - a * c0;
    let root = discriminant.fast_max(f64x4::ZERO).sqrt();
    let closing = b.simd_lt(f64x4::ZERO);
    // One form cancels where the other does not.
    let above = closing.bitselect(c0, b + root);
    let below = closing.bitselect(root - b, -a);
    let some = closing.bitselect(discriminant, below - f64x4::splat(TINY));
    let time = above / below * (1.0 - ROUND);
    let time = some
        .simd_lt(f64x4::ZERO)
        .bitselect(f64x4::splat(f64::INFINITY), time);
    // Not certain of NaN either.
    c0.simd_gt(f64x4::ZERO) & time
}

/// Four gaps, as sums over the axes.
struct Gaps {
    /// r², r·v, v².
    squared: f64x4,
    b: f64x4,
    a: f64x4,
    /// r·a, v·a, a²; zeros if nothing accelerates.
    fall: f64x4,
    c3: f64x4,
    bent: f64x4,
    /// Distances of the centres at contact.
    distance: f64x4,
}

impl Gaps {
    /// When they are closed at the earliest.
    #[inline(always)]
    fn closed(self, accelerates: bool, growth: f64, horizon: f64) -> [f64; LANES] {
        let near = near(horizon, accelerates || growth != 0.0);
        let near_squared = near * near;
        let contact = self.distance * self.distance;
        let mut size = self.squared * 9.0 + contact * 4.0;
        let (mut b, mut a) = (self.b, self.a);
        if accelerates {
            size += self.bent * (4.0 * near_squared * near_squared);
            a += self.fall + bend(self.c3, self.bent, near);
        }
        if growth != 0.0 {
            let growth = self.distance * growth;
            size += growth * growth * (16.0 * near_squared);
            b -= self.distance * growth;
            a -= growth * growth;
        }
        let time = first_root(self.squared - contact - size * ROUND, b, a);
        up_to(time, near, horizon)
    }
}

/// What is said of times up to `near` alone.
#[inline(always)]
fn up_to(time: f64x4, near: f64, horizon: f64) -> [f64; LANES] {
    let time = if near < horizon {
        time.fast_min(f64x4::splat(near))
    } else {
        time
    };
    time.to_array()
}

/// Lower bounds of the times of contact with grains that fly.
#[inline(always)]
pub(super) fn not_before<const D: usize, F: PolynomialFlight<D>>(
    own: &F,
    other: impl Fn(usize) -> F,
    crowd: &Crowd<D>,
) -> [f64; LANES] {
    let here: Vector<D> = own.start();
    let speed: Vector<D> = own.start_velocity();
    let pull: Vector<D> = own.acceleration();
    let none = [[0.0; LANES]; D];
    let (mut positions, mut velocities, mut accelerations) = (none, none, none);
    for lane in 0..LANES {
        let flight = other(lane);
        let (x, v, a) = (
            flight.start(),
            flight.start_velocity(),
            flight.acceleration(),
        );
        for axis in 0..D {
            positions[axis][lane] = x[axis];
            velocities[axis][lane] = v[axis];
            if F::ACCELERATES {
                accelerations[axis][lane] = a[axis];
            }
        }
    }
    if let Some(shifts) = &crowd.shifts {
        for (lane, shift) in shifts.iter().enumerate() {
            for axis in 0..D {
                positions[axis][lane] += shift[axis];
            }
        }
    }
    let after = f64x4::new(crowd.after);
    let (mut squared, mut b, mut a) = (f64x4::ZERO, f64x4::ZERO, f64x4::ZERO);
    let (mut fall, mut c3, mut bent) = (f64x4::ZERO, f64x4::ZERO, f64x4::ZERO);
    for axis in 0..D {
        let mut velocity = f64x4::new(velocities[axis]);
        let mut mean = velocity;
        let mut acceleration = f64x4::ZERO;
        if F::ACCELERATES {
            acceleration = f64x4::new(accelerations[axis]);
            let gained = acceleration * after;
            mean += gained * 0.5;
            velocity += gained;
            acceleration -= pull[axis];
        }
        let apart = f64x4::new(positions[axis]) + mean * after - here[axis];
        velocity -= speed[axis];
        squared = apart.mul_add(apart, squared);
        b = apart.mul_add(velocity, b);
        a = velocity.mul_add(velocity, a);
        if F::ACCELERATES {
            fall = apart.mul_add(acceleration, fall);
            c3 = velocity.mul_add(acceleration, c3);
            bent = acceleration.mul_add(acceleration, bent);
        }
    }
    let gaps = Gaps {
        squared,
        b,
        a,
        fall,
        c3,
        bent,
        distance: f64x4::new(crowd.distances) + crowd.blur,
    };
    gaps.closed(F::ACCELERATES, crowd.growth, crowd.horizon)
}

/// The same for grains at rest: the motion is that of the one grain, so most
/// of it is common.
#[inline(always)]
pub(super) fn not_before_resting<const D: usize, F: PolynomialFlight<D>>(
    nook: &Nook<'_, D, F>,
) -> [f64; LANES] {
    let velocity: Vector<D> = nook.own.start_velocity();
    let acceleration: Vector<D> = nook.own.acceleration();
    let (mut squared, mut b, mut fall) = (f64x4::ZERO, f64x4::ZERO, f64x4::ZERO);
    for axis in 0..D {
        let apart = f64x4::new(nook.resting.places[axis]) - nook.place[axis];
        squared = apart.mul_add(apart, squared);
        b = apart.mul_neg_add(f64x4::splat(velocity[axis]), b);
        if F::ACCELERATES {
            fall = apart.mul_neg_add(f64x4::splat(acceleration[axis]), fall);
        }
    }
    let gaps = Gaps {
        squared,
        b,
        a: f64x4::splat(velocity.norm_squared()),
        fall,
        c3: f64x4::splat(velocity.dot(&acceleration)),
        bent: f64x4::splat(acceleration.norm_squared()),
        distance: f64x4::new(nook.resting.distances) * nook.scale + nook.blur,
    };
    gaps.closed(F::ACCELERATES, nook.growth, nook.horizon)
}

/// Instead of a rounding of the few products in a return.
const DOUBT: f64 = 1.0e-12;

/// A lower bound of the time at which a grain comes back to one at rest that it
/// has just left. The gap is t times 2 b + a t + c₃ t² + c₄ t³, and the last two
/// terms are at least −t c₃²/(4 c₄) at all times.
#[inline]
pub(super) fn not_back_before<const D: usize, F: PolynomialFlight<D>>(
    own: &F,
    place: &Vector<D>,
) -> f64 {
    let velocity: Vector<D> = own.start_velocity();
    let (far, fast) = (place.norm_squared(), velocity.norm_squared());
    // |r| |v| ≤ (r² + v²)/2, but for units: what is small beside one of them is
    // not certain.
    let parting = -place.dot(&velocity) - DOUBT * (far * fast).sqrt();
    let certain = parting > 0.0;
    if !certain {
        return 0.0;
    }
    if !F::ACCELERATES {
        return f64::INFINITY;
    }
    let pull: Vector<D> = own.acceleration();
    let (pulled, along) = (pull.norm_squared(), velocity.dot(&pull));
    let bend = along * along / (pulled + TINY);
    let size = fast + (far * pulled).sqrt() + bend;
    let falling = place.dot(&pull) + bend - fast + DOUBT * size;
    if falling > 0.0 {
        2.0 * parting / falling * (1.0 - DOUBT)
    } else {
        f64::INFINITY
    }
}
