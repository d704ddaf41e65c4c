//! Flights under an acceleration that turns.

use crate::model::{Drift, Flight, TurningFlight};
use crate::particle::Vector;

/// What accelerates a grain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pull {
    /// Nothing.
    Nothing,
    /// Gravity that turns continuously.
    Gravity,
    /// Gravity that turns in steps.
    Steps,
    /// The ground that carries it along.
    Ground,
}

/// Motion under a constant acceleration and one that turns in a plane:
///
/// x(t) = x₀ + v t + s t²/2 + [p (1 − cos Ωt) + p⟂ (Ωt − sin Ωt)]/Ω²,
///
/// a trochoid, if s is zero, as a point of a rolling wheel describes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trochoid<const D: usize> {
    pub(super) position: Vector<D>,
    pub(super) velocity: Vector<D>,
    /// s, in g.
    pub(super) steady: Vector<D>,
    /// p, in g.
    pub(super) turning: Vector<D>,
    /// Ω, in √(g/d).
    pub(super) rate: f64,
    /// Turns from the one axis to the other.
    pub(super) plane: [u8; 2],
    pub(super) pull: Pull,
    /// With steps: when the next one is, and how long they are, in √(d/g).
    pub(super) next_step: f64,
    pub(super) step: f64,
}

/// Below this angle the series need six terms.
const SMALL: f64 = 0.25;
/// Below this one fourteen.
const MEDIUM: f64 = 2.0;

/// What an acceleration has done after it has turned by the angle x.
#[derive(Clone, Copy, Debug)]
struct Turn {
    x: f64,
    /// (1 − cos x)/x².
    a: f64,
    /// (x − sin x)/x³.
    b: f64,
}

/// Σ (−y)ᵏ / ((2k + n)!/n!), k < terms: the series of (1 − cos x)/x² (times two)
/// for n = 2 and of (x − sin x)/x³ (times six) for n = 3.
#[inline]
fn series(y: f64, n: f64, terms: u32) -> f64 {
    let mut sum = 1.0;
    for k in (1..terms).rev() {
        let low = n + 2.0 * f64::from(k);
        sum = 1.0 - y * sum / (low * (low - 1.0));
    }
    sum
}

impl Turn {
    #[inline]
    fn by(x: f64) -> Self {
        let y = x * x;
        let size = x.abs();
        if size > MEDIUM {
            let half = libm::sin(0.5 * x);
            Turn {
                x,
                a: 2.0 * half * half / y,
                b: (x - libm::sin(x)) / (y * x),
            }
        } else {
            let terms = if size > SMALL { 14 } else { 6 };
            Turn {
                x,
                a: series(y, 2.0, terms) / 2.0,
                b: series(y, 3.0, terms) / 6.0,
            }
        }
    }

    #[inline]
    fn cos(&self) -> f64 {
        1.0 - self.x * self.x * self.a
    }

    #[inline]
    fn sin(&self) -> f64 {
        self.x * (1.0 - self.x * self.x * self.b)
    }
}

impl<const D: usize> Trochoid<D> {
    /// A vector of the plane, a quarter turn on; what stands across is left out.
    #[inline]
    fn quarter(&self, vector: &Vector<D>) -> Vector<D> {
        let [from, to] = self.plane();
        let mut turned = Vector::zeros();
        turned[from] = -vector[to];
        turned[to] = vector[from];
        turned
    }

    /// With gravity that turns in steps: the same counted from the last step before
    /// `after`, and what is left of the time.
    fn stepped(&self, after: f64) -> (Self, f64) {
        let mut flight = *self;
        let mut left = after;
        while left >= flight.next_step {
            let time = flight.next_step;
            left -= time;
            flight.position += (flight.velocity + flight.steady * (0.5 * time)) * time;
            flight.velocity += flight.steady * time;
            let turn = Turn::by(flight.rate * flight.step);
            flight.steady = flight.turned_along(&flight.steady, &turn);
            flight.next_step = flight.step;
        }
        (flight, left)
    }

    /// From the axis to a grain that is carried along, in d.
    #[inline]
    fn radius(&self) -> Vector<D> {
        self.turning / -(self.rate * self.rate)
    }

    /// A vector of the plane after a turn.
    #[inline]
    fn turned(&self, vector: &Vector<D>, turn: &Turn) -> Vector<D> {
        vector * turn.cos() + self.quarter(vector) * turn.sin()
    }

    /// `vector`, turned only as far as it lies in the plane.
    fn turned_along(&self, vector: &Vector<D>, turn: &Turn) -> Vector<D> {
        let mut result = *vector;
        let turned = self.turned(vector, turn);
        for axis in self.plane() {
            result[axis] = turned[axis];
        }
        result
    }
}

impl<const D: usize> Flight<D> for Trochoid<D> {
    #[inline]
    fn position(&self, after: f64) -> Vector<D> {
        match self.pull {
            Pull::Nothing => self.position + self.velocity * after,
            Pull::Gravity => {
                let turn = Turn::by(self.rate * after);
                let bend = self.steady * 0.5
                    + self.turning * turn.a
                    + self.quarter(&self.turning) * (turn.x * turn.b);
                self.position + (self.velocity + bend * after) * after
            }
            Pull::Steps => {
                let (flight, after) = self.stepped(after);
                flight.position + (flight.velocity + flight.steady * (0.5 * after)) * after
            }
            Pull::Ground => {
                // Round the axis, so that nothing grows with the number of turns.
                let turn = Turn::by(self.rate * after);
                let radius = self.radius();
                let along = radius * (-turn.x * turn.x * turn.a);
                self.position + along + self.quarter(&radius) * turn.sin()
            }
        }
    }

    #[inline]
    fn velocity(&self, after: f64) -> Vector<D> {
        match self.pull {
            Pull::Nothing => self.velocity,
            Pull::Gravity => {
                let turn = Turn::by(self.rate * after);
                let mean = self.steady
                    + self.turning * (1.0 - turn.x * turn.x * turn.b)
                    + self.quarter(&self.turning) * (turn.x * turn.a);
                self.velocity + mean * after
            }
            Pull::Steps => {
                let (flight, after) = self.stepped(after);
                flight.velocity + flight.steady * after
            }
            Pull::Ground => self.turned_along(&self.velocity, &Turn::by(self.rate * after)),
        }
    }

    #[inline]
    fn start(&self) -> Vector<D> {
        self.position
    }

    #[inline]
    fn start_velocity(&self) -> Vector<D> {
        self.velocity
    }

    #[inline]
    fn advanced(&self, after: f64) -> Self {
        let turning = match self.pull {
            Pull::Nothing => self.turning,
            Pull::Steps => {
                let (flight, left) = self.stepped(after);
                return Trochoid {
                    position: flight.position
                        + (flight.velocity + flight.steady * (0.5 * left)) * left,
                    velocity: flight.velocity + flight.steady * left,
                    next_step: flight.next_step - left,
                    ..flight
                };
            }
            Pull::Gravity | Pull::Ground => {
                self.turned(&self.turning, &Turn::by(self.rate * after))
            }
        };
        Trochoid {
            position: self.position(after),
            velocity: self.velocity(after),
            turning,
            ..*self
        }
    }

    #[inline]
    fn speed_bound(&self, within: f64) -> f64 {
        let speed = self.velocity.norm_squared().sqrt();
        match self.pull {
            Pull::Nothing => speed,
            // Rounding of the velocity as it turns.
            Pull::Ground => speed * (1.0 + 1.0e-12),
            Pull::Steps => speed + self.steady.norm_squared().sqrt() * within,
            Pull::Gravity => {
                // What turns gives no more speed than in half a turn.
                let longest = (2.0 / self.rate.abs()).min(within);
                let steady = self.steady.norm_squared().sqrt();
                let turning = self.turning.norm_squared().sqrt();
                speed + steady * within + turning * longest
            }
        }
    }

    #[inline]
    fn is_at_rest(&self) -> bool {
        self.pull == Pull::Nothing && self.velocity == Vector::<D>::zeros()
    }
}

impl<const D: usize> TurningFlight<D> for Trochoid<D> {
    #[inline]
    fn steady(&self) -> Vector<D> {
        self.steady
    }

    #[inline]
    fn turning(&self) -> Vector<D> {
        self.turning
    }

    #[inline]
    fn rate(&self) -> f64 {
        self.rate
    }

    #[inline]
    fn plane(&self) -> [usize; 2] {
        self.plane.map(usize::from)
    }

    #[inline]
    fn changes_after(&self) -> f64 {
        match self.pull {
            Pull::Steps => self.next_step,
            Pull::Nothing | Pull::Gravity | Pull::Ground => f64::INFINITY,
        }
    }

    fn drift(&self) -> Drift<D> {
        let nothing = Vector::zeros();
        let (velocity, acceleration, radius) = match self.pull {
            Pull::Nothing => (self.velocity, nothing, 0.0),
            Pull::Ground => (nothing, nothing, 2.0 * self.radius().norm_squared().sqrt()),
            Pull::Gravity => {
                let across = self.quarter(&self.turning) / self.rate;
                let circle = self.turning.norm_squared().sqrt() / (self.rate * self.rate);
                (self.velocity + across, self.steady, 2.0 * circle)
            }
            Pull::Steps => {
                // A geometric series of velocities, each turned by θ = Ω step: its
                // mean, and how far partial sums get from it.
                let mut across = self.steady;
                let mut flat = self.steady;
                for axis in self.plane() {
                    across[axis] = 0.0;
                }
                flat -= across;
                let half = Turn::by(0.5 * self.rate * self.step);
                let chord = 2.0 * half.sin();
                let size = flat.norm_squared().sqrt();
                let mean = self.quarter(&self.turned(&flat, &half)) * (self.step / chord);
                let gained = flat * self.next_step + mean;
                let wave = size * self.step;
                let swing = wave / chord.abs();
                let offset = gained.norm_squared().sqrt() + 2.0 * wave;
                let radius = self.step * (2.0 * (swing + wave) / chord.abs() + swing + offset);
                // Steps of whole turns are no turns at all.
                let known = chord.abs() > 1.0e-9;
                let radius = if known { radius } else { f64::INFINITY };
                (self.velocity + gained, across, radius)
            }
        };
        Drift {
            velocity,
            acceleration,
            radius,
        }
    }

    #[inline]
    fn accelerates_like(&self, other: &Self) -> bool {
        // Two that are carried along accelerate differently.
        self.pull == other.pull && self.pull != Pull::Ground
    }
}
