use crate::dynamics::Parabola;
use crate::error::SetupError;
use crate::model::{Dynamics, GravityCourse, Motion};
use crate::particle::{Mode, Vector};
use crate::time::Time;

/// Constant gravity (the paper's section 2): normal grains fly on parabolas,
/// falling ones straight on; static grains keep their velocity, which is zero
/// for frozen ones and may be anything for fixed ones.
#[derive(Clone, Copy, Debug)]
pub struct UniformGravity<const D: usize> {
    gravity: Vector<D>,
}

impl<const D: usize> UniformGravity<D> {
    /// Gravity with these components, in g.
    #[must_use]
    pub fn new(gravity: Vector<D>) -> Self {
        UniformGravity { gravity }
    }

    /// Unit gravity down the last axis.
    #[must_use]
    pub fn down() -> Self {
        let mut gravity = Vector::zeros();
        gravity[D - 1] = -1.0;
        UniformGravity { gravity }
    }
}

impl<const D: usize> Dynamics<D> for UniformGravity<D> {
    type Flight = Parabola<D>;

    fn flight(&self, motion: &Motion<D>, _since: Time) -> Parabola<D> {
        Parabola {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: match motion.mode {
                Mode::Normal => self.gravity,
                Mode::Falling | Mode::Frozen | Mode::Fixed => Vector::zeros(),
            },
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self.gravity.iter().find(|g| g.is_nan() || g.abs() > 1.0e9) {
            None => Ok(()),
            Some(&value) => Err(SetupError::Parameter {
                field: "gravity",
                value,
                allowed: "components between -1e9 and 1e9 are allowed",
            }),
        }
    }

    fn gravity(&self, _time: Time) -> Vector<D> {
        self.gravity
    }

    fn gravity_course(&self) -> GravityCourse {
        GravityCourse::Constant
    }
}
