use crate::dynamics::trochoid::{Pull, Trochoid};
use crate::dynamics::turning_gravity::check_turning;
use crate::error::SetupError;
use crate::model::{Dynamics, GravityCourse, Motion};
use crate::particle::{Mode, Vector};
use crate::time::Time;

/// Constant gravity over ground that turns about an axis: a drum that truly
/// turns. Fixed and frozen grains are carried along on circles, normal ones fly
/// on parabolas; so centrifugal and Coriolis effects are there by themselves.
///
/// What counts as being at rest at x, for sleep criteria and thresholds, is the
/// velocity of the ground there, Ω × (x − c).
#[derive(Clone, Copy, Debug)]
pub struct TurningGround<const D: usize> {
    gravity: Vector<D>,
    rate: f64,
    plane: [usize; 2],
    centre: Vector<D>,
}

impl<const D: usize> TurningGround<D> {
    /// Ground that turns about `centre`, in d, in the plane of two axes from the
    /// first towards the second, by `rate` √(g/d), radians per unit of time.
    /// Gravity is in g.
    #[must_use]
    pub fn new(gravity: Vector<D>, rate: f64, plane: [usize; 2], centre: Vector<D>) -> Self {
        TurningGround {
            gravity,
            rate,
            plane,
            centre,
        }
    }

    /// From the axis to a point, in d.
    fn radius(&self, position: &Vector<D>) -> Vector<D> {
        let mut radius = Vector::zeros();
        for axis in self.plane {
            radius[axis] = position[axis] - self.centre[axis];
        }
        radius
    }
}

impl<const D: usize> Dynamics<D> for TurningGround<D> {
    type Flight = Trochoid<D>;

    const DRIVES: bool = true;

    #[inline]
    fn flight(&self, motion: &Motion<D>, since: Time) -> Trochoid<D> {
        let nothing = Vector::zeros();
        let (pull, velocity, steady, turning) = match motion.mode {
            Mode::Normal => (Pull::Gravity, motion.velocity, self.gravity, nothing),
            Mode::Falling => (Pull::Nothing, motion.velocity, nothing, nothing),
            Mode::Frozen | Mode::Fixed => {
                let radius = self.radius(&motion.position);
                let inwards = radius * -(self.rate * self.rate);
                let carried = self.ground_velocity(&motion.position, since);
                (Pull::Ground, carried, nothing, inwards)
            }
        };
        Trochoid {
            position: motion.position,
            velocity,
            steady,
            turning,
            rate: self.rate,
            plane: self.plane.map(|axis| axis as u8),
            pull,
            next_step: f64::INFINITY,
            step: f64::INFINITY,
        }
    }

    fn gravity(&self, _time: Time) -> Vector<D> {
        self.gravity
    }

    fn ground_velocity(&self, position: &Vector<D>, _time: Time) -> Vector<D> {
        let [from, to] = self.plane;
        let radius = self.radius(position);
        let mut velocity = Vector::zeros();
        velocity[from] = -self.rate * radius[to];
        velocity[to] = self.rate * radius[from];
        velocity
    }

    /// Seen from the ground, gravity turns the other way.
    fn gravity_course(&self) -> GravityCourse {
        GravityCourse::Turning {
            rate: -self.rate,
            plane: self.plane,
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        check_turning(&self.gravity, self.rate, self.plane)
    }
}
