use crate::error::SetupError;
use crate::model::{Dynamics, GravityCourse, Motion};
use crate::particle::Vector;
use crate::time::Time;

/// Any dynamics with diameters that grow at a constant rate: Lubachevsky &
/// Stillinger 1990, doi:10.1007/BF01025983.
#[derive(Clone, Copy, Debug)]
pub struct Growing<Y> {
    inner: Y,
    rate: f64,
}

impl<Y> Growing<Y> {
    /// Diameters grow by `rate` times their value at t = 0 per unit of time.
    #[must_use]
    pub fn new(inner: Y, rate: f64) -> Self {
        Growing { inner, rate }
    }
}

impl<const D: usize, Y: Dynamics<D>> Dynamics<D> for Growing<Y> {
    type Flight = Y::Flight;

    const GROWS: bool = true;

    const DRIVES: bool = Y::DRIVES;

    fn flight(&self, motion: &Motion<D>, since: Time) -> Y::Flight {
        self.inner.flight(motion, since)
    }

    fn gravity(&self, time: Time) -> Vector<D> {
        self.inner.gravity(time)
    }

    fn ground_velocity(&self, position: &Vector<D>, time: Time) -> Vector<D> {
        self.inner.ground_velocity(position, time)
    }

    fn gravity_course(&self) -> GravityCourse {
        self.inner.gravity_course()
    }

    fn validate(&self) -> Result<(), SetupError> {
        if !(self.rate >= 0.0 && self.rate.is_finite()) {
            return Err(SetupError::Parameter {
                field: "growth rate",
                value: self.rate,
                allowed: "0 or more is allowed",
            });
        }
        self.inner.validate()
    }

    fn growth_rate(&self) -> f64 {
        self.rate
    }
}
