use crate::dynamics::trochoid::{Pull, Trochoid};
use crate::error::SetupError;
use crate::model::{Dynamics, GravityCourse, Motion};
use crate::particle::{Mode, Vector};
use crate::time::Time;

/// Gravity of constant size whose direction turns at a constant rate: a drum
/// seen from the drum (the paper's section 4), without the centrifugal and the
/// Coriolis force, which the paper neglects.
///
/// Normal grains fly on trochoids, falling ones straight on, static ones are at
/// rest or keep their velocity. It turns continuously, or
/// [in steps](TurningGravity::in_steps).
#[derive(Clone, Copy, Debug)]
pub struct TurningGravity<const D: usize> {
    gravity: Vector<D>,
    rate: f64,
    plane: [usize; 2],
    step: Option<f64>,
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
            step: None,
        }
    }

    /// The same in steps: gravity is constant for `step` √(d/g), then turns at once
    /// by as much as it would have in that time. With ever shorter steps
    /// trajectories tend to those of continuous gravity, at first order.
    #[must_use]
    pub fn in_steps(mut self, step: f64) -> Self {
        self.step = Some(step);
        self
    }

    /// The angle that gravity has turned by at `time`, in radians.
    fn angle(&self, time: Time) -> f64 {
        match self.step {
            None => self.rate * time.units(),
            Some(step) => self.rate * step * time.multiples_reached(step),
        }
    }

    /// When gravity turns next, counted from `since`; positive.
    fn next_step(&self, since: Time) -> f64 {
        let Some(step) = self.step else {
            return f64::INFINITY;
        };
        let next = Time::from_units((since.multiples_reached(step) + 1.0) * step) - since;
        if next > 0.0 { next } else { step }
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
        let nothing = Vector::zeros();
        let (pull, steady, turning) = match (motion.mode, self.step) {
            (Mode::Normal, None) => (Pull::Gravity, self.steady(), self.turning(since)),
            (Mode::Normal, Some(_)) => (Pull::Steps, self.gravity(since), nothing),
            (Mode::Falling | Mode::Frozen | Mode::Fixed, _) => (Pull::Nothing, nothing, nothing),
        };
        let steps = pull == Pull::Steps;
        Trochoid {
            position: motion.position,
            velocity: motion.velocity,
            steady,
            turning,
            rate: self.rate,
            plane: self.plane.map(|axis| axis as u8),
            pull,
            next_step: if steps {
                self.next_step(since)
            } else {
                f64::INFINITY
            },
            step: self.step.unwrap_or(f64::INFINITY),
        }
    }

    fn gravity(&self, time: Time) -> Vector<D> {
        self.steady() + self.turning(time)
    }

    fn gravity_course(&self) -> GravityCourse {
        let (rate, plane) = (self.rate, self.plane);
        match self.step {
            None => GravityCourse::Turning { rate, plane },
            Some(step) => GravityCourse::Stepped { rate, plane, step },
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        if let Some(step) = self.step
            && !(1.0e-9..=1.0e9).contains(&step)
        {
            return Err(SetupError::Parameter {
                field: "step",
                value: step,
                allowed: "1e-9 … 1e9 is allowed",
            });
        }
        check_turning(&self.gravity, self.rate, self.plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Flight;
    use crate::particle::ParticleId;

    #[test]
    fn at_the_instant_of_a_step_it_has_been_made() {
        let gravity = Vector::<2>::new(0.0, -1.0);
        for step in [0.1, 0.02, 0.3, 0.7] {
            let dynamics = TurningGravity::new(gravity, 0.5, [0, 1]).in_steps(step);
            for count in 1..3000 {
                let time = Time::from_units(f64::from(count) * step);
                let (sin, cos) = libm::sincos(0.5 * step * f64::from(count));
                let turned = Vector::<2>::new(sin, -cos);
                assert!((dynamics.gravity(time) - turned).norm() < 1.0e-12);
                let motion = Motion {
                    id: ParticleId(0),
                    position: Vector::zeros(),
                    velocity: Vector::zeros(),
                    mode: Mode::Normal,
                };
                let flight = dynamics.flight(&motion, time);
                assert!((flight.velocity(0.5 * step) - turned * (0.5 * step)).norm() < 1.0e-12);
                assert!((flight.next_step - step).abs() < 1.0e-9);
            }
        }
    }
}
