//! What is measured on grains: volumes in slabs and columns, packing fractions,
//! pairs and contacts, velocities, surfaces, displacements. And what theory
//! knows: equations of state, kinetic theory.
//!
//! All of it takes lists of [`Particle`](crate::Particle), as a simulation's
//! snapshot or a file's frame gives them, and a [`Container`] where periods or
//! cross-sections matter. Lengths are in d, speeds in √(gd). The last axis is
//! "up".
//!
//! Stress needs the collisions between two snapshots: [`StressMeter`] is an
//! observer, to be shown a run. Others are in [`observe`](crate::observe), such as
//! the one of forces on walls and bases.
//!
//! ```
//! use grainfall::analysis::{Bins, Container, contacts, coordination, fraction_profile};
//! use grainfall::{Particle, Vector};
//!
//! # fn main() -> Result<(), grainfall::analysis::AnalysisError> {
//! // A simple cubic crystal of 4 × 4 × 4 touching spheres, periodic in x and y.
//! let places = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]);
//! let grains: Vec<Particle<3>> = places
//!     .map(|place| Particle::frozen(Vector::from(place.map(f64::from))))
//!     .collect();
//! let container = Container::new(
//!     Vector::from([0.0, 0.0, -0.5]),
//!     Vector::from([4.0, 4.0, 4.0]),
//!     [true, true, false],
//! )?;
//! let layers = fraction_profile(&grains, &container, 2, &Bins::new(-0.5, 3.5, 4)?)?;
//! assert!(layers.iter().all(|layer| (layer - std::f64::consts::PI / 6.0).abs() < 1e-12));
//! // Two neighbours along each axis; grains at the top and the bottom lack one.
//! let touching = contacts(&grains, &container, 1e-6)?;
//! let found = coordination(&touching, &[true; 64], 1e-6, 4);
//! assert_eq!((found.mean, found.rattlers), (5.5, 0));
//! # Ok(())
//! # }
//! ```

mod ball;
mod bins;
mod blocking;
mod column;
mod contacts;
mod container;
mod displacement;
mod equation_of_state;
mod error;
mod fabric;
mod fit;
mod fractions;
pub mod kinetic_theory;
mod packing;
mod pairs;
#[cfg(test)]
mod quadrature;
mod radial;
mod stress;
mod surface;
mod velocities;

pub use ball::{ball_slab_volume, ball_volume};
pub use bins::Bins;
pub use blocking::{Mean, blocked_mean};
pub use column::ball_column_volume;
pub use contacts::{Contact, Coordination, contacts, coordination};
pub use container::Container;
pub use displacement::{MeanSquare, Paths};
pub use equation_of_state::{
    carnahan_starling, contact_value, henderson, kolafa_labik_malijevsky, periodic_correction,
    virial_disks, virial_spheres,
};
pub use error::AnalysisError;
pub use fabric::{Fabric, fabric};
pub use fit::{LineFit, line_fit};
pub use fractions::{fraction_map, fraction_profile};
pub use packing::{SlabFraction, highest_surface, lowest_surface, packing_fraction, slab_fraction};
pub use pairs::for_each_pair;
pub use radial::{RadialDistribution, radial_distribution};
pub use stress::{Stress, StressMeter};
pub use surface::{surface_of_grains, surface_of_map};
pub use velocities::{BinnedMotion, Probe, Profile, binned_motion};
