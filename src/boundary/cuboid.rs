use crate::boundary::Plane;
use crate::error::{SetupError, require};
use crate::model::{Boundary, Period};
use crate::particle::Vector;

/// What bounds one axis of a [`Cuboid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// The axis closes on itself.
    Periodic {
        /// Lower face of the primary cell, in d.
        origin: f64,
        /// Length of the period, in d.
        length: f64,
    },
    /// A wall below, above, or both.
    Walls {
        /// Where the lower wall stands, in d, if there is one.
        low: Option<f64>,
        /// Where the upper wall stands, in d, if there is one.
        high: Option<f64>,
        /// Coefficient of restitution of both, in 0 … 1.
        restitution: f64,
    },
    /// Nothing: grains may go as far as they like.
    Open,
}

impl Side {
    /// A period from 0 to `length`, in d.
    #[must_use]
    pub fn periodic(length: f64) -> Self {
        Side::Periodic {
            origin: 0.0,
            length,
        }
    }

    /// A wall below at `low`, in d, and none above.
    #[must_use]
    pub fn floor(low: f64, restitution: f64) -> Self {
        Side::Walls {
            low: Some(low),
            high: None,
            restitution,
        }
    }
}

/// A box: each axis is periodic, walled or open.
///
/// Walls are numbered axis by axis, the lower before the upper, leaving out
/// those that are not there.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuboid<const D: usize> {
    periods: [Option<Period>; D],
    walls: Vec<Plane<D>>,
}

impl<const D: usize> Cuboid<D> {
    /// A box with these sides.
    ///
    /// # Errors
    ///
    /// When a period is not positive, walls are out of order, a restitution is
    /// outside 0 … 1, or anything is not a number.
    pub fn new(sides: [Side; D]) -> Result<Self, SetupError> {
        let mut periods = [None; D];
        let mut walls = Vec::new();
        for (axis, side) in sides.into_iter().enumerate() {
            match side {
                Side::Open => {}
                Side::Periodic { origin, length } => {
                    require(
                        origin.is_finite(),
                        "origin",
                        origin,
                        "a finite number is allowed",
                    )?;
                    let positive = length.is_finite() && length > 0.0;
                    require(positive, "length", length, "a positive number is allowed")?;
                    periods[axis] = Some(Period { origin, length });
                }
                Side::Walls {
                    low,
                    high,
                    restitution,
                } => {
                    let in_range = (0.0..=1.0).contains(&restitution);
                    require(in_range, "restitution", restitution, "0 … 1 is allowed")?;
                    for (place, up) in [(low, 1.0), (high, -1.0)] {
                        let Some(place) = place else { continue };
                        require(
                            place.is_finite(),
                            "wall",
                            place,
                            "a finite number is allowed",
                        )?;
                        let mut normal = Vector::zeros();
                        normal[axis] = up;
                        walls.push(Plane {
                            normal,
                            offset: up * place,
                            restitution,
                        });
                    }
                    if let (Some(low), Some(high)) = (low, high) {
                        require(
                            low < high,
                            "high",
                            high,
                            "the upper wall has to lie above the lower",
                        )?;
                    }
                }
            }
        }
        Ok(Cuboid { periods, walls })
    }

    /// No periods and no walls.
    #[must_use]
    pub fn open() -> Self {
        Cuboid {
            periods: [None; D],
            walls: Vec::new(),
        }
    }
}

impl<const D: usize> Boundary<D> for Cuboid<D> {
    type Wall = Plane<D>;

    #[inline]
    fn period(&self, axis: usize) -> Option<Period> {
        self.periods[axis]
    }

    #[inline]
    fn walls(&self) -> &[Plane<D>] {
        &self.walls
    }
}
