//! Flights under an acceleration that turns.

use crate::model::{Flight, TurningFlight};
use crate::particle::Vector;

/// What accelerates a grain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pull {
    /// Nothing.
    Nothing,
    /// Gravity.
    Gravity,
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
    fn accelerates_like(&self, other: &Self) -> bool {
        // Two that are carried along accelerate differently.
        self.pull == other.pull && self.pull != Pull::Ground
    }
}
