use crate::model::{Flight, PolynomialFlight};
use crate::particle::Vector;

/// Motion at constant velocity: x + v t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight<const D: usize> {
    /// Centre at the start, in d.
    pub position: Vector<D>,
    /// Velocity, in √(gd).
    pub velocity: Vector<D>,
}

impl<const D: usize> Flight<D> for Straight<D> {
    #[inline]
    fn position(&self, after: f64) -> Vector<D> {
        self.position + self.velocity * after
    }

    #[inline]
    fn velocity(&self, _after: f64) -> Vector<D> {
        self.velocity
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
        Straight {
            position: self.position(after),
            velocity: self.velocity,
        }
    }

    #[inline]
    fn speed_bound(&self, _within: f64) -> f64 {
        self.velocity.norm_squared().sqrt()
    }

    #[inline]
    fn stays_within(&self, place: &Vector<D>, distance: f64) -> Option<f64> {
        let from = self.position - place;
        let left = distance * distance - from.norm_squared();
        let outward = from.dot(&self.velocity);
        let squared = self.velocity.norm_squared();
        // Also if any of it is NaN.
        let inside = left > 0.0;
        if !inside {
            return Some(0.0);
        }
        let root = (outward * outward + squared * left).sqrt();
        let time = if outward > 0.0 {
            left / (root + outward)
        } else {
            (root - outward) / squared
        };
        Some(time * (1.0 - 1.0e-12))
    }

    #[inline]
    fn is_at_rest(&self) -> bool {
        self.velocity == Vector::<D>::zeros()
    }
}

impl<const D: usize> PolynomialFlight<D> for Straight<D> {
    const ACCELERATES: bool = false;

    #[inline]
    fn acceleration(&self) -> Vector<D> {
        Vector::<D>::zeros()
    }
}

/// Motion at constant acceleration: x + v t + a t²/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parabola<const D: usize> {
    /// Centre at the start, in d.
    pub position: Vector<D>,
    /// Velocity at the start, in √(gd).
    pub velocity: Vector<D>,
    /// Acceleration, in g.
    pub acceleration: Vector<D>,
}

impl<const D: usize> Flight<D> for Parabola<D> {
    #[inline]
    fn position(&self, after: f64) -> Vector<D> {
        self.position + (self.velocity + self.acceleration * (0.5 * after)) * after
    }

    #[inline]
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

    #[inline]
    fn advanced(&self, after: f64) -> Self {
        Parabola {
            position: self.position(after),
            velocity: self.velocity(after),
            acceleration: self.acceleration,
        }
    }

    #[inline]
    fn speed_bound(&self, within: f64) -> f64 {
        self.velocity.norm_squared().sqrt() + self.acceleration.norm_squared().sqrt() * within
    }

    #[inline]
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
