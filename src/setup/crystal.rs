//! A crystal of moving spheres.

use std::f64::consts::{PI, SQRT_2};

use rand_chacha::ChaCha8Rng;

use crate::error::SetupError;
use crate::particle::{Mode, Particle, Vector};
use crate::setup::require;
use crate::setup::velocities::thermal;

/// Centres of one face-centred cubic cell, in its edges. They lie a quarter
/// inside, so that none is on a face.
const PLACES: [[f64; 3]; 4] = [
    [0.25, 0.25, 0.25],
    [0.75, 0.75, 0.25],
    [0.75, 0.25, 0.75],
    [0.25, 0.75, 0.75],
];

/// More cells along an edge would hold more grains than there are ids.
const MOST_CELLS: usize = 1000;

/// Equal spheres of diameter 1 on a face-centred cubic lattice that fills a
/// periodic cube, with thermal velocities: the usual start of an elastic gas
/// whose cost is measured, for it can be made at any density and size at once.
///
/// Below φ = 0.494 it melts; above, it may stay a crystal for ever.
///
/// ```
/// use grainfall::setup::{Crystal, seeded};
///
/// let crystal = Crystal { cells: 7, packing_fraction: 0.3, ..Crystal::default() };
/// let (grains, edges) = crystal.grains(&mut seeded(1))?;
/// assert_eq!(grains.len(), 1372);
/// assert!((edges[0] - 13.38).abs() < 0.01);
/// # Ok::<(), grainfall::SetupError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Crystal {
    /// Cells along each edge, k: there are 4 k³ grains.
    pub cells: usize,
    /// Volume of the grains over volume of the box; less than π/√18 = 0.7405.
    pub packing_fraction: f64,
    /// Kinetic temperature ⟨m v²⟩/3, in mgd.
    pub temperature: f64,
}

impl Default for Crystal {
    /// 4 · 6³ = 864 grains at φ = 0.3 and temperature 1.
    fn default() -> Self {
        Crystal {
            cells: 6,
            packing_fraction: 0.3,
            temperature: 1.0,
        }
    }
}

impl Crystal {
    /// The k for which 4 k³ is this many, if there is one.
    #[must_use]
    pub fn cells_of(count: usize) -> Option<usize> {
        (1..=MOST_CELLS).find(|&cells| grains_in(cells) == count)
    }

    /// The numbers of grains nearest to `count`, from below and from above, that
    /// fill whole cells; `count` twice, if it does.
    #[must_use]
    pub fn counts_around(count: usize) -> (usize, usize) {
        let full = (1..=MOST_CELLS).map(grains_in);
        let below = full.clone().take_while(|&full| full <= count).last();
        let above = full.clone().find(|&full| full >= count);
        (
            below.unwrap_or(grains_in(1)),
            above.unwrap_or(grains_in(MOST_CELLS)),
        )
    }

    /// The grains, all [`Mode::Normal`], cell by cell, and the edges of the box,
    /// in d, whose lower corner is the origin.
    ///
    /// Velocities are Maxwellian with zero total momentum and, up to rounding,
    /// exactly the wanted temperature.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, or the box is narrower than two
    /// diameters.
    pub fn grains(
        &self,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Vec<Particle<3>>, Vector<3>), SetupError> {
        require(
            (1..=MOST_CELLS).contains(&self.cells),
            "cells",
            self.cells as f64,
            "1 to 1000 is allowed",
        )?;
        require(
            self.packing_fraction > 0.0 && self.packing_fraction < PI / (3.0 * SQRT_2),
            "packing_fraction",
            self.packing_fraction,
            "more than 0 and less than π/√18 = 0.7405, where the grains touch, is allowed",
        )?;
        require(
            self.temperature >= 0.0 && self.temperature.is_finite(),
            "temperature",
            self.temperature,
            "0 or more is allowed",
        )?;
        // Four spheres of volume π/6 a cell.
        let cell = libm::cbrt(4.0 * PI / 6.0 / self.packing_fraction);
        let edge = cell * self.cells as f64;
        if edge < 2.0 {
            return Err(SetupError::PeriodTooShort {
                axis: 0,
                length: edge,
                least: 2.0,
            });
        }
        let count = grains_in(self.cells);
        let masses = vec![1.0; count];
        let velocities = thermal::<3>(&masses, self.temperature, rng);
        drop(masses);
        let grains = velocities
            .into_iter()
            .enumerate()
            .map(|(index, velocity)| {
                let (place, corner) = (PLACES[index % 4], index / 4);
                let corner = [
                    corner / (self.cells * self.cells),
                    corner / self.cells % self.cells,
                    corner % self.cells,
                ];
                Particle {
                    position: Vector::from_fn(|axis, _| (corner[axis] as f64 + place[axis]) * cell),
                    velocity,
                    diameter: 1.0,
                    mass: 1.0,
                    mode: Mode::Normal,
                }
            })
            .collect();
        Ok((grains, Vector::repeat(edge)))
    }
}

/// Grains in a cube of so many cells along each edge.
fn grains_in(cells: usize) -> usize {
    4 * cells * cells * cells
}
