//! A column of grains that fall at constant velocity.

use rand_chacha::ChaCha8Rng;

use crate::analysis::ball_volume;
use crate::error::SetupError;
use crate::particle::{Mode, Particle, Vector};
use crate::setup::insertion::insert;
use crate::setup::region::Region;
use crate::setup::{Sizes, mass_of, require};

/// A homogeneous rain (the paper's section 3): grains at random places of a
/// column that do not overlap, all falling at the same constant velocity.
///
/// The height of the column follows from the volume of the grains that are
/// drawn, the lateral lengths and the packing fraction. Then the column is
/// lowered until its lowest grain's surface lies at `origin[D - 1]`, which for
/// a rain on a base is the base's highest surface: so the first grain lands at
/// about t = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Rain<const D: usize> {
    /// How many grains; 4800 in the paper.
    pub count: usize,
    /// Their diameters.
    pub sizes: Sizes,
    /// Volume of the grains over volume of the column. Random insertion manages
    /// about 0.3 in three dimensions and 0.45 in two.
    pub packing_fraction: f64,
    /// How fast they fall, in √(gd); 2.5 in the paper.
    pub fall_speed: f64,
    /// Lateral lengths, in d; the last entry is not used.
    pub lengths: Vector<D>,
    /// Lower lateral corner and, last, the height of the lowest surface, in d.
    pub origin: Vector<D>,
    /// Which lateral axes are periodic; between the walls of the others grains
    /// stay inside. The last entry is not used.
    pub periodic: [bool; D],
}

impl<const D: usize> Default for Rain<D> {
    /// The paper's: 4800 equal grains at φ = 0.0503 over a periodic base of
    /// 10 d × 10 d, which makes a column 500 d high.
    fn default() -> Self {
        Rain {
            count: 4800,
            sizes: Sizes::default(),
            packing_fraction: 0.0503,
            fall_speed: 2.5,
            lengths: Vector::repeat(10.0),
            origin: Vector::zeros(),
            periodic: [true; D],
        }
    }
}

impl<const D: usize> Rain<D> {
    /// The grains, all [`Mode::Falling`], in the order their sizes were drawn.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, a period is shorter than two of the
    /// largest diameters, or the column is too dense for random insertion.
    pub fn grains(&self, rng: &mut ChaCha8Rng) -> Result<Vec<Particle<D>>, SetupError> {
        let sizes = self.sizes.validated()?;
        require(
            self.packing_fraction > 0.0 && self.packing_fraction < 1.0,
            "packing_fraction",
            self.packing_fraction,
            "more than 0 and less than 1 is allowed",
        )?;
        require(
            self.fall_speed > 0.0 && self.fall_speed.is_finite(),
            "fall_speed",
            self.fall_speed,
            "a positive number is allowed",
        )?;
        let mut region = Region {
            origin: self.origin,
            lengths: self.lengths,
            periodic: self.periodic,
        }
        .validated(D - 1, sizes.largest())?;

        let diameters: Vec<f64> = (0..self.count).map(|_| sizes.sample(rng)).collect();
        let volume: f64 = diameters.iter().map(|&d| ball_volume::<D>(0.5 * d)).sum();
        let height = volume / (self.packing_fraction * region.lateral_area());
        // A column of very few grains may be lower than one of them.
        let tallest = diameters.iter().copied().fold(0.0, f64::max);
        region.origin[D - 1] = 0.0;
        region.lengths[D - 1] = height.max(tallest);
        region.periodic[D - 1] = false;
        let places = insert(&region, &diameters, rng)?;

        let lowest = places
            .iter()
            .zip(&diameters)
            .map(|(place, diameter)| place[D - 1] - 0.5 * diameter)
            .fold(f64::INFINITY, f64::min);
        let mut velocity = Vector::<D>::zeros();
        velocity[D - 1] = -self.fall_speed;
        Ok(places
            .into_iter()
            .zip(diameters)
            .map(|(mut position, diameter)| {
                let radius = 0.5 * diameter;
                // In this order the lowest is exactly where it is wanted.
                let above = (position[D - 1] - radius) - lowest;
                position[D - 1] = self.origin[D - 1] + radius + above;
                Particle {
                    position,
                    velocity,
                    diameter,
                    mass: mass_of::<D>(diameter),
                    mode: Mode::Falling,
                }
            })
            .collect())
    }
}
