//! A gas of grains in a periodic box.

use rand_chacha::ChaCha8Rng;

use crate::analysis::ball_volume;
use crate::error::SetupError;
use crate::particle::{Mode, Particle, Vector};
use crate::setup::growth::{Failure, packed};
use crate::setup::region::Region;
use crate::setup::velocities::thermal;
use crate::setup::{Sizes, mass_of, require};

/// A disordered gas in a box that is periodic along every axis.
///
/// Dilute gases are made by random insertion, dense ones from a dilute gas of
/// small grains that grow while they move (Lubachevsky & Stillinger 1990,
/// doi:10.1007/BF01025983). Equal grains get to about φ = 0.62 in three
/// dimensions and, partly crystalline from 0.7, 0.8 in two.
#[derive(Clone, Debug, PartialEq)]
pub struct Gas<const D: usize> {
    /// How many grains.
    pub count: usize,
    /// Their diameters.
    pub sizes: Sizes,
    /// Volume of the grains over volume of the box.
    pub packing_fraction: f64,
    /// Kinetic temperature ⟨m v²⟩/D, in mgd.
    pub temperature: f64,
    /// Proportions of the box's edges; all ones for a cube.
    pub aspect: Vector<D>,
}

impl<const D: usize> Default for Gas<D> {
    /// 1000 equal grains at φ = 0.3 and temperature 1 in a cube.
    fn default() -> Self {
        Gas {
            count: 1000,
            sizes: Sizes::default(),
            packing_fraction: 0.3,
            temperature: 1.0,
            aspect: Vector::repeat(1.0),
        }
    }
}

impl<const D: usize> Gas<D> {
    /// The grains, all [`Mode::Normal`], and the edges of the box, in d, whose
    /// lower corner is the origin.
    ///
    /// Velocities are Maxwellian with zero total momentum and, up to rounding,
    /// exactly the wanted temperature.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, the box is narrower than two of the
    /// largest diameters, or the grains jam before they are as dense as wanted.
    pub fn grains(
        &self,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Vec<Particle<D>>, Vector<D>), SetupError> {
        let sizes = self.sizes.validated()?;
        require(
            self.packing_fraction > 0.0 && self.packing_fraction < 1.0,
            "packing_fraction",
            self.packing_fraction,
            "more than 0 and less than 1 is allowed",
        )?;
        require(
            self.temperature >= 0.0 && self.temperature.is_finite(),
            "temperature",
            self.temperature,
            "0 or more is allowed",
        )?;
        let least_count = if self.temperature > 0.0 { 2 } else { 1 };
        require(
            self.count >= least_count,
            "count",
            self.count as f64,
            "at least 1 is allowed, and at least 2 for a temperature without a total momentum",
        )?;
        let mut product = 1.0;
        for &edge in self.aspect.iter() {
            require(
                edge > 0.0 && edge.is_finite(),
                "aspect",
                edge,
                "a positive number is allowed",
            )?;
            product *= edge;
        }

        let diameters: Vec<f64> = (0..self.count).map(|_| sizes.sample(rng)).collect();
        let solid: f64 = diameters.iter().map(|&d| ball_volume::<D>(0.5 * d)).sum();
        let edge = libm::pow(solid / (self.packing_fraction * product), 1.0 / D as f64);
        let lengths = self.aspect * edge;
        let region = Region {
            origin: Vector::zeros(),
            lengths,
            periodic: [true; D],
        }
        .validated(D, sizes.largest())?;
        let places = packed(&region, &diameters, rng).map_err(|failure| match failure {
            Failure::Setup(error) => error,
            Failure::Jammed => SetupError::Parameter {
                field: "packing_fraction",
                value: self.packing_fraction,
                allowed: "less than where random packings of these sizes jam is allowed",
            },
        })?;

        let masses: Vec<f64> = diameters.iter().map(|&d| mass_of::<D>(d)).collect();
        let velocities = thermal::<D>(&masses, self.temperature, rng);
        let grains = (0..self.count)
            .map(|i| Particle {
                position: places[i],
                velocity: velocities[i],
                diameter: diameters[i],
                mass: masses[i],
                mode: Mode::Normal,
            })
            .collect();
        Ok((grains, lengths))
    }
}
