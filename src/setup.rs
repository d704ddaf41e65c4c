//! Initial states: a rain, a gas, a crystal, a rough base, a drum, grains one by one.
//!
//! Every generator holds parameters, draws from a [`ChaCha8Rng`] that the
//! caller seeds, and returns grains ready for a simulation: none overlap, not
//! even across periodic faces. The same seed gives the same bits everywhere.
//! The last axis is "up"; the others are lateral. A grain of diameter σ has the
//! mass σ^D, so that σ = 1 has m = 1 and all have the same density.
//!
//! ```
//! use grainfall::setup::{Rain, Sizes, seeded};
//! use grainfall::Vector;
//!
//! let rain = Rain::<3> {
//!     count: 50,
//!     lengths: Vector::<3>::new(5.0, 5.0, 0.0),
//!     ..Rain::default()
//! };
//! let grains = rain.grains(&mut seeded(1))?;
//! assert_eq!(grains.len(), 50);
//! # Ok::<(), grainfall::SetupError>(())
//! ```

mod base;
mod crystal;
mod drum;
mod gas;
mod growth;
mod insertion;
mod jam;
mod one_by_one;
mod order;
mod rain;
mod random;
mod region;
mod sizes;
mod velocities;

pub use base::Base;
pub use crystal::Crystal;
pub use drum::Drum;
pub use gas::Gas;
pub use jam::{Jam, Jammed};
pub use one_by_one::OneByOne;
pub use order::sort_in_space;
pub use rain::Rain;
pub use rand_chacha::ChaCha8Rng;
pub use random::seeded;
pub use sizes::Sizes;

use crate::error::require;

/// Mass of a grain of this diameter in `D` dimensions, in m: σ^D.
fn mass_of<const D: usize>(diameter: f64) -> f64 {
    (0..D).fold(1.0, |mass, _| mass * diameter)
}
