//! One grain at a time.

use rand_chacha::ChaCha8Rng;

use crate::error::SetupError;
use crate::particle::{Mode, Particle, Vector};
use crate::setup::region::Region;
use crate::setup::{Sizes, mass_of, require};

/// Grains that are dropped one by one, each when the last is at rest (the end
/// of the paper's section 3; Visscher & Bolsterli 1972, doi:10.1038/239504a0).
///
/// It says where the next one starts; whoever drives the simulation inserts it
/// and runs until all sleep:
///
/// ```no_run
/// # use grainfall::{Particle, SetupError, Vector};
/// # use grainfall::setup::{OneByOne, seeded};
/// # fn insert_and_run_until_all_sleep(_: Particle<3>) -> Vec<Particle<3>> { vec![] }
/// # let mut heap: Vec<Particle<3>> = vec![Particle::fixed(Vector::<3>::zeros())];
/// let source = OneByOne::<3>::default();
/// let mut rng = seeded(1);
/// for _ in 0..1200 {
///     let top = grainfall::analysis::highest_surface(&heap).unwrap_or(0.0);
///     heap = insert_and_run_until_all_sleep(source.grain(top, &mut rng)?);
/// }
/// # Ok::<(), SetupError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OneByOne<const D: usize> {
    /// Diameters of the grains.
    pub sizes: Sizes,
    /// How far above the heap's highest surface the new grain's lowest point
    /// starts, in d; 2 by default.
    pub clearance: f64,
    /// How fast they fall, in √(gd); 2.5 in the paper's rain.
    pub fall_speed: f64,
    /// Lateral lengths, in d; the last entry is not used.
    pub lengths: Vector<D>,
    /// Lower lateral corner, in d; the last entry is not used.
    pub origin: Vector<D>,
    /// Which lateral axes are periodic; between the walls of the others grains
    /// start inside. The last entry is not used.
    pub periodic: [bool; D],
}

impl<const D: usize> Default for OneByOne<D> {
    /// Equal grains, 2 d above the top, falling at 2.5 √(gd) on a periodic base
    /// of 10 d × 10 d.
    fn default() -> Self {
        OneByOne {
            sizes: Sizes::default(),
            clearance: 2.0,
            fall_speed: 2.5,
            lengths: Vector::repeat(10.0),
            origin: Vector::zeros(),
            periodic: [true; D],
        }
    }
}

impl<const D: usize> OneByOne<D> {
    /// The next grain, [`Mode::Falling`], at a uniform lateral place above
    /// `top`, the highest surface of the heap, in d.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range or a period is shorter than two of the
    /// largest diameters.
    pub fn grain(&self, top: f64, rng: &mut ChaCha8Rng) -> Result<Particle<D>, SetupError> {
        let sizes = self.sizes.validated()?;
        require(top.is_finite(), "top", top, "a finite number is allowed")?;
        require(
            self.clearance >= 0.0 && self.clearance.is_finite(),
            "clearance",
            self.clearance,
            "0 or more is allowed",
        )?;
        require(
            self.fall_speed > 0.0 && self.fall_speed.is_finite(),
            "fall_speed",
            self.fall_speed,
            "a positive number is allowed",
        )?;
        let region = Region {
            origin: self.origin,
            lengths: self.lengths,
            periodic: self.periodic,
        }
        .validated(D - 1, sizes.largest())?;

        let diameter = sizes.sample(rng);
        let mut position = Vector::<D>::zeros();
        for axis in 0..D - 1 {
            position[axis] = region.random_coordinate(axis, 0.5 * diameter, rng);
        }
        position[D - 1] = top + self.clearance + 0.5 * diameter;
        let mut velocity = Vector::<D>::zeros();
        velocity[D - 1] = -self.fall_speed;
        Ok(Particle {
            position,
            velocity,
            diameter,
            mass: mass_of::<D>(diameter),
            mode: Mode::Falling,
        })
    }
}
