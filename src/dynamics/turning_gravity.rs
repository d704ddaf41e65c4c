use crate::dynamics::trochoid::{Pull, Trochoid};
use crate::error::SetupError;
use crate::model::{Dynamics, Motion};
use crate::particle::{Mode, Vector};
use crate::time::Time;

/// Gravity of constant size whose direction turns at a constant rate: a drum
/// seen from the drum (the paper's section 4), without the centrifugal and the
/// Coriolis force, which the paper neglects.
///
/// Normal grains fly on trochoids, falling ones straight on, static ones are at
/// rest or keep their velocity. It turns continuously; there are no steps.
#[derive(Clone, Copy, Debug)]
pub struct TurningGravity<const D: usize> {
    gravity: Vector<D>,
    rate: f64,
    plane: [usize; 2],
}

impl<const D: usize> TurningGravity<D> {
    /// Gravity that is `gravity`, in g, at t = 0, and turns in the plane of two
    /// axes from the first towards the second, by `rate` √(g/d), radians per unit
    /// of time. A component of gravity along a third axis stays what it is.
    #[must_use]
    pub fn new(gravity: Vector<D>, rate: f64, plane: [usize; 2]) -> Self {
        TurningGravity {
            gravity,
            rate,
            plane,
        }
    }

    /// The angle that gravity has turned by at `time`, in radians.
    fn angle(&self, time: Time) -> f64 {
        self.rate * time.units()
    }

    /// The part that turns, at `time`.
    fn turning(&self, time: Time) -> Vector<D> {
        let [from, to] = self.plane;
        let (sin, cos) = libm::sincos(self.angle(time));
        let (x, y) = (self.gravity[from], self.gravity[to]);
        let mut turned = Vector::zeros();
        turned[from] = x * cos - y * sin;
        turned[to] = x * sin + y * cos;
        turned
    }

    /// The part that does not.
    fn steady(&self) -> Vector<D> {
        let mut steady = self.gravity;
        for axis in self.plane {
            steady[axis] = 0.0;
        }
        steady
    }
}

/// Refuses what a rate, a plane or gravity may not be.
pub(super) fn check_turning<const D: usize>(
    gravity: &Vector<D>,
    rate: f64,
    plane: [usize; 2],
) -> Result<(), SetupError> {
    let refuse = |field, value, allowed| {
        Err(SetupError::Parameter {
            field,
            value,
            allowed,
        })
    };
    for &component in gravity.iter() {
        let size = component.abs();
        if component != 0.0 && !(1.0e-9..=1.0e9).contains(&size) {
            let allowed = "components of size 1e-9 … 1e9, or 0, are allowed";
            return refuse("gravity", component, allowed);
        }
    }
    if !(1.0e-9..=1.0e9).contains(&rate.abs()) {
        let allowed = "1e-9 … 1e9, of either sign, is allowed";
        return refuse("angular velocity", rate, allowed);
    }
    let [from, to] = plane;
    if from >= D || to >= D || from == to {
        let allowed = "two different axes are allowed";
        return refuse("plane", from.max(to) as f64, allowed);
    }
    Ok(())
}

impl<const D: usize> Dynamics<D> for TurningGravity<D> {
    type Flight = Trochoid<D>;

    const DRIVES: bool = true;

    #[inline]
    fn flight(&self, motion: &Motion<D>, since: Time) -> Trochoid<D> {
        let falls = motion.mode == Mode::Normal;
        Trochoid {
            position: motion.position,
            velocity: motion.velocity,
            steady: if falls {
                self.steady()
            } else {
                Vector::zeros()
            },
            turning: if falls {
                self.turning(since)
            } else {
                Vector::zeros()
            },
            rate: self.rate,
            plane: self.plane.map(|axis| axis as u8),
            pull: if falls { Pull::Gravity } else { Pull::Nothing },
        }
    }

    fn gravity(&self, time: Time) -> Vector<D> {
        self.steady() + self.turning(time)
    }

    fn validate(&self) -> Result<(), SetupError> {
        check_turning(&self.gravity, self.rate, self.plane)
    }
}
