//! Where the world ends: periods and walls.

use crate::error::SetupError;
use crate::particle::Vector;
use crate::time::Time;

/// A period along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// Lower face of the primary cell, in d.
    pub origin: f64,
    /// Length of the period, in d.
    pub length: f64,
}

/// What a predictor may know of a wall's form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<const D: usize> {
    /// At rest and flat: the points with `normal · x = offset`.
    Plane {
        /// Unit normal, into the free side.
        normal: Vector<D>,
        /// Distance of the plane from the origin along the normal, in d.
        offset: f64,
    },
    /// Anything else: contact is found from [`Wall::distance`] alone, by steps
    /// that these bounds make safe.
    General {
        /// Largest principal curvature, in 1/d, of the surfaces of equal
        /// distance out to one diameter from the wall.
        curvature: f64,
        /// Bound on the speed of the wall along its normal, in √(gd).
        speed: f64,
        /// Bound on the acceleration of the wall along its normal, in g.
        acceleration: f64,
    },
}

/// A wall, known by the distance of points from it.
///
/// `examples/own_shaken_floor.rs` shows how to write one.
pub trait Wall<const D: usize> {
    /// Signed distance of a point from the wall, in d; positive where grains
    /// may be.
    fn distance(&self, position: &Vector<D>, time: Time) -> f64;

    /// Unit vector along which [`distance`](Wall::distance) grows fastest.
    fn normal(&self, position: &Vector<D>, time: Time) -> Vector<D>;

    /// Velocity of the wall's surface at the point next to `position`, in √(gd).
    fn velocity(&self, _position: &Vector<D>, _time: Time) -> Vector<D> {
        Vector::zeros()
    }

    /// Coefficient of restitution, in 0 … 1.
    fn restitution(&self) -> f64;

    /// What a predictor may know of the form.
    fn shape(&self) -> Shape<D>;
}

/// Where the world ends along each axis.
///
/// `examples/own_boundary.rs` shows how to write one.
///
/// The generic type names are: `D` the dimension.
pub trait Boundary<const D: usize> {
    /// The type of the walls.
    type Wall: Wall<D>;

    /// The period along `axis`, if there is one.
    fn period(&self, axis: usize) -> Option<Period>;

    /// The walls; [`WallId`](crate::WallId) counts along this list, which never changes.
    fn walls(&self) -> &[Self::Wall];

    /// Refuses parameters that are out of range; asked once, before a
    /// simulation starts.
    ///
    /// # Errors
    ///
    /// [`SetupError`] with the parameter, its value and what is allowed.
    fn validate(&self) -> Result<(), SetupError> {
        Ok(())
    }

    /// The vector from `from` to the nearest periodic image of `to`, in d.
    fn displacement(&self, from: &Vector<D>, to: &Vector<D>) -> Vector<D> {
        let mut difference = to - from;
        for axis in 0..D {
            if let Some(period) = self.period(axis) {
                let turns = libm::rint(difference[axis] / period.length);
                difference[axis] -= turns * period.length;
            }
        }
        difference
    }

    /// The image of `position` in the primary cell, `origin ≤ x < origin + length`.
    fn wrapped(&self, position: &Vector<D>) -> Vector<D> {
        let mut wrapped = *position;
        for axis in 0..D {
            if let Some(period) = self.period(axis) {
                let turns = libm::floor((wrapped[axis] - period.origin) / period.length);
                wrapped[axis] -= turns * period.length;
                if wrapped[axis] >= period.origin + period.length {
                    wrapped[axis] = period.origin;
                }
            }
        }
        wrapped
    }
}
