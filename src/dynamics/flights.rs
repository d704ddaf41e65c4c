use crate::model::{Exit, Flight, PolynomialFlight};
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
    fn advanced(&self, after: f64) -> Self {
        Straight {
            position: self.position(after),
            velocity: self.velocity,
        }
    }

    #[inline]
    fn exit(&self, axis: usize, low: f64, high: f64, from: f64) -> Option<Exit> {
        line_exit(self.position[axis], self.velocity[axis], low, high, from)
    }

    #[inline]
    fn speed_bound(&self, _within: f64) -> f64 {
        self.velocity.norm()
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
    fn advanced(&self, after: f64) -> Self {
        Parabola {
            position: self.position(after),
            velocity: self.velocity(after),
            acceleration: self.acceleration,
        }
    }

    #[inline]
    fn exit(&self, axis: usize, low: f64, high: f64, from: f64) -> Option<Exit> {
        let (x, v, a) = (
            self.position[axis],
            self.velocity[axis],
            self.acceleration[axis],
        );
        if a == 0.0 {
            line_exit(x, v, low, high, from)
        } else if a < 0.0 {
            Some(thrown_exit(x, v, -a, low, high, from))
        } else {
            // Upside down.
            let exit = thrown_exit(-x, -v, a, -high, -low, from);
            Some(Exit {
                after: exit.after,
                upward: !exit.upward,
            })
        }
    }

    #[inline]
    fn speed_bound(&self, within: f64) -> f64 {
        self.velocity.norm() + self.acceleration.norm() * within
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

/// Exit of x + v t.
#[inline]
fn line_exit(x: f64, v: f64, low: f64, high: f64, from: f64) -> Option<Exit> {
    if v == 0.0 {
        return None;
    }
    let upward = v > 0.0;
    let face = if upward { high } else { low };
    if face.is_infinite() {
        return None;
    }
    let after = (face - x) / v;
    Some(Exit {
        after: after.max(from),
        upward,
    })
}

/// Exit of x + v t − g t²/2 with g > 0. It always comes back down, so there is
/// always one, at infinity if there is no lower face.
fn thrown_exit(x: f64, v: f64, g: f64, low: f64, high: f64, from: f64) -> Exit {
    // Still on the way up: through the upper face, if the apex lies beyond it.
    if v - g * from > 0.0 && high.is_finite() {
        let climb = high - x;
        let discriminant = v * v - 2.0 * g * climb;
        if discriminant >= 0.0 {
            let after = if climb <= 0.0 {
                from
            } else {
                2.0 * climb / (v + discriminant.sqrt())
            };
            return Exit {
                after: after.max(from),
                upward: true,
            };
        }
    }
    if low.is_infinite() {
        return Exit {
            after: f64::INFINITY,
            upward: false,
        };
    }
    let drop = x - low;
    let discriminant = (v * v + 2.0 * g * drop).max(0.0);
    let after = if v > 0.0 {
        (v + discriminant.sqrt()) / g
    } else {
        // drop / ((√Δ − v)/2): no cancellation; 0/0 is an exit at once.
        let sum = discriminant.sqrt() - v;
        if sum > 0.0 { 2.0 * drop / sum } else { 0.0 }
    };
    Exit {
        after: after.max(from),
        upward: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thrown(height: f64, speed: f64) -> Parabola<1> {
        Parabola {
            position: Vector::<1>::new(height),
            velocity: Vector::<1>::new(speed),
            acceleration: Vector::<1>::new(-1.0),
        }
    }

    #[test]
    fn a_thrown_grain_leaves_upwards_then_downwards() {
        let flight = thrown(0.5, 2.0);
        let up = flight.exit(0, 0.0, 1.0, 0.0).unwrap();
        assert!(up.upward);
        assert!((flight.position(up.after)[0] - 1.0).abs() < 1e-15);
        // In the slab above it turns round and comes back through the floor.
        let down = flight.exit(0, 1.0, 10.0, up.after).unwrap();
        assert!(!down.upward);
        assert!((flight.position(down.after)[0] - 1.0).abs() < 1e-14);
        assert!(flight.velocity(down.after)[0] < 0.0);
        // Back in the first slab, now only the lower face is ahead.
        let out = flight.exit(0, 0.0, 1.0, down.after).unwrap();
        assert!(!out.upward && out.after > down.after);
        assert!(flight.position(out.after)[0].abs() < 1e-14);
    }

    #[test]
    fn a_slab_without_a_floor_is_never_left() {
        let exit = thrown(0.5, 0.0)
            .exit(0, f64::NEG_INFINITY, 1.0, 0.0)
            .unwrap();
        assert!(exit.after.is_infinite());
    }

    #[test]
    fn upside_down_is_the_mirror_image() {
        let up = Parabola {
            position: Vector::<1>::new(-0.5),
            velocity: Vector::<1>::new(-2.0),
            acceleration: Vector::<1>::new(1.0),
        };
        let a = up.exit(0, -1.0, 0.0, 0.0).unwrap();
        let b = thrown(0.5, 2.0).exit(0, 0.0, 1.0, 0.0).unwrap();
        assert_eq!(a.after, b.after);
        assert!(!a.upward && b.upward);
    }

    #[test]
    fn outside_by_rounding_and_moving_in_is_inside() {
        let flight = Straight {
            position: Vector::<1>::new(-1.0e-17),
            velocity: Vector::<1>::new(1.0),
        };
        let exit = flight.exit(0, 0.0, 1.0, 0.0).unwrap();
        assert!(exit.upward && (exit.after - 1.0).abs() < 1e-15);
    }
}
