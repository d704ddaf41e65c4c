//! Where a generator may put grains.

use rand_chacha::ChaCha8Rng;

use crate::error::SetupError;
use crate::particle::Vector;
use crate::setup::random::uniform;
use crate::setup::require;

/// A box, each axis of which is periodic or bounded by walls that grains may
/// touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region<const D: usize> {
    /// Lower corner, in d.
    pub(super) origin: Vector<D>,
    /// Edges, in d.
    pub(super) lengths: Vector<D>,
    /// Which axes close on themselves.
    pub(super) periodic: [bool; D],
}

impl<const D: usize> Region<D> {
    /// The same region, if grains up to this diameter fit into its first `axes`
    /// axes.
    pub(super) fn validated(self, axes: usize, largest: f64) -> Result<Self, SetupError> {
        for axis in 0..D {
            let origin = self.origin[axis];
            require(
                origin.is_finite(),
                "origin",
                origin,
                "a finite number is allowed",
            )?;
        }
        for axis in 0..axes {
            let length = self.lengths[axis];
            require(
                length.is_finite() && length > 0.0,
                "length",
                length,
                "a positive number is allowed",
            )?;
            if self.periodic[axis] {
                let least = 2.0 * largest;
                if length < least {
                    return Err(SetupError::PeriodTooShort {
                        axis,
                        length,
                        least,
                    });
                }
            } else {
                require(
                    length >= largest,
                    "length",
                    length,
                    "between walls at least the largest diameter is allowed",
                )?;
            }
        }
        Ok(self)
    }

    /// The extent of the first D − 1 axes, in d^(D−1).
    pub(super) fn lateral_area(&self) -> f64 {
        (0..D - 1).fold(1.0, |area, axis| area * self.lengths[axis])
    }

    /// The extent of all axes, in d^D.
    pub(super) fn volume(&self) -> f64 {
        self.lateral_area() * self.lengths[D - 1]
    }

    /// A coordinate, uniform where the centre of a grain of this radius may be.
    pub(super) fn random_coordinate(&self, axis: usize, radius: f64, rng: &mut ChaCha8Rng) -> f64 {
        let share = uniform(rng);
        if self.periodic[axis] {
            self.origin[axis] + self.lengths[axis] * share
        } else {
            // Rounding must not push a grain through the wall it may touch.
            let low = self.origin[axis] + radius;
            let high = self.origin[axis] + self.lengths[axis] - radius;
            (low + (high - low) * share).min(high).max(low)
        }
    }

    /// The square of the distance of two points, nearest images, in d².
    pub(super) fn distance_squared(&self, a: &Vector<D>, b: &Vector<D>) -> f64 {
        let mut sum = 0.0;
        for axis in 0..D {
            let mut difference = a[axis] - b[axis];
            if self.periodic[axis] {
                let length = self.lengths[axis];
                difference -= length * libm::rint(difference / length);
            }
            sum += difference * difference;
        }
        sum
    }
}
