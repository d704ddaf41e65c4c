use crate::dynamics::Straight;
use crate::model::{Dynamics, GravityCourse, Motion};
use crate::particle::Vector;
use crate::time::Time;

/// No force: every grain flies straight on, whatever its mode; a static grain
/// with a velocity is carried along at that velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct ForceFree;

impl<const D: usize> Dynamics<D> for ForceFree {
    type Flight = Straight<D>;

    fn flight(&self, motion: &Motion<D>, _since: Time) -> Straight<D> {
        Straight {
            position: motion.position,
            velocity: motion.velocity,
        }
    }

    fn gravity(&self, _time: Time) -> Vector<D> {
        Vector::zeros()
    }

    fn gravity_course(&self) -> GravityCourse {
        GravityCourse::Constant
    }
}
