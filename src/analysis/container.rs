//! The space that grains lie in.

use crate::analysis::AnalysisError;
use crate::model::Boundary;
use crate::particle::{Particle, Vector};

/// A box with sides along the axes: what periodic images and cross-sections are
/// counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Container<const D: usize> {
    /// Lower corner, in d.
    pub origin: Vector<D>,
    /// Lengths of the sides, in d.
    pub lengths: Vector<D>,
    /// Which axes are periodic.
    pub periodic: [bool; D],
}

impl<const D: usize> Container<D> {
    /// A box.
    ///
    /// # Errors
    ///
    /// Unless the corner is finite and every length finite and above 0.
    pub fn new(
        origin: Vector<D>,
        lengths: Vector<D>,
        periodic: [bool; D],
    ) -> Result<Self, AnalysisError> {
        let check = |field, value: f64, fine: bool, allowed| match fine && value.is_finite() {
            true => Ok(()),
            false => Err(AnalysisError::Parameter {
                field,
                value,
                allowed,
            }),
        };
        for axis in 0..D {
            let allowed = "a finite number is allowed";
            check("a corner of the box", origin[axis], true, allowed)?;
            let length = lengths[axis];
            let allowed = "a finite number greater than 0 is allowed";
            check("a length of the box", length, length > 0.0, allowed)?;
        }
        Ok(Container {
            origin,
            lengths,
            periodic,
        })
    }

    /// The box of a simulation: its periods, and along the other axes from the
    /// lowest to the highest surface of any grain.
    ///
    /// # Errors
    ///
    /// When an axis is not periodic and no grain is there, or one is not at a
    /// finite place.
    pub fn around(
        boundary: &impl Boundary<D>,
        particles: &[Particle<D>],
    ) -> Result<Self, AnalysisError> {
        let mut container = Container {
            origin: Vector::zeros(),
            lengths: Vector::zeros(),
            periodic: std::array::from_fn(|axis| boundary.period(axis).is_some()),
        };
        for axis in 0..D {
            let (low, length) = match boundary.period(axis) {
                Some(period) => (period.origin, period.length),
                None => {
                    let ends = particles.iter().map(|grain| {
                        let (centre, radius) = (grain.position[axis], grain.radius());
                        (centre - radius, centre + radius)
                    });
                    let (low, high) = ends
                        .reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
                        .ok_or(AnalysisError::Nothing("grains"))?;
                    (low, high - low)
                }
            };
            container.origin[axis] = low;
            container.lengths[axis] = length;
        }
        Container::new(container.origin, container.lengths, container.periodic)
    }

    /// From one place to the nearest image of another, in d.
    #[must_use]
    pub fn separation(&self, from: &Vector<D>, to: &Vector<D>) -> Vector<D> {
        let mut way = to - from;
        for axis in 0..D {
            if self.periodic[axis] {
                way[axis] -= libm::rint(way[axis] / self.lengths[axis]) * self.lengths[axis];
            }
        }
        way
    }

    /// Its volume, in d^D.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.lengths.product()
    }

    /// Its extent across an axis, in d^(D−1).
    #[must_use]
    pub fn cross_section(&self, axis: usize) -> f64 {
        (0..D)
            .filter(|other| *other != axis)
            .map(|other| self.lengths[other])
            .product()
    }

    /// Its two faces across an axis, in d.
    #[must_use]
    pub fn faces(&self, axis: usize) -> (f64, f64) {
        (self.origin[axis], self.origin[axis] + self.lengths[axis])
    }

    /// By how much the images of something that reaches from `low` to `high` along
    /// an axis are shifted, as far as they reach into `from` … `to`: 0 alone where
    /// the axis is not periodic.
    pub(super) fn shifts(
        &self,
        axis: usize,
        (low, high): (f64, f64),
        (from, to): (f64, f64),
    ) -> impl Iterator<Item = f64> + use<D> {
        let length = self.lengths[axis];
        let (first, last) = if self.periodic[axis] {
            let turns = |way: f64| (way / length).clamp(-1.0e6, 1.0e6);
            (
                turns(from - high).floor() as i64,
                turns(to - low).ceil() as i64,
            )
        } else {
            (0, 0)
        };
        (first..=last).map(move |turns| turns as f64 * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::{Cuboid, Side};

    #[test]
    fn the_box_of_a_boundary_and_its_grains() {
        let boundary = Cuboid::new([Side::periodic(4.0), Side::Open]).unwrap();
        let grain = |y| Particle::<2>::fixed(Vector::<2>::new(1.0, y));
        let found = Container::around(&boundary, &[grain(3.0), grain(-1.0)]).unwrap();
        assert_eq!((found.faces(0), found.faces(1)), ((0.0, 4.0), (-1.5, 3.5)));
        assert_eq!((found.volume(), found.cross_section(1)), (20.0, 4.0));
        assert_eq!(found.periodic, [true, false]);
        assert!(Container::around(&boundary, &[]).is_err());
        let way = found.separation(&Vector::<2>::new(0.5, 0.0), &Vector::<2>::new(3.75, 9.0));
        assert_eq!(way, Vector::<2>::new(-0.75, 9.0));
    }

    #[test]
    fn lengths_are_above_0() {
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let lengths = Vector::<2>::new(1.0, length);
            let error = Container::new(Vector::<2>::zeros(), lengths, [false; 2]).unwrap_err();
            assert!(error.to_string().contains("a length of the box"), "{error}");
        }
    }
}
