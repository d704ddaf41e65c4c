use crate::model::{Shape, Wall};
use crate::particle::Vector;
use crate::time::Time;

/// A flat wall at rest: grains are where `normal · x > offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<const D: usize> {
    /// Unit normal, into the free side.
    pub normal: Vector<D>,
    /// Distance of the plane from the origin along the normal, in d.
    pub offset: f64,
    /// Coefficient of restitution, in 0 … 1.
    pub restitution: f64,
}

impl<const D: usize> Wall<D> for Plane<D> {
    fn distance(&self, position: &Vector<D>, _time: Time) -> f64 {
        self.normal.dot(position) - self.offset
    }

    fn normal(&self, _position: &Vector<D>, _time: Time) -> Vector<D> {
        self.normal
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn shape(&self) -> Shape<D> {
        Shape::Plane {
            normal: self.normal,
            offset: self.offset,
        }
    }
}
