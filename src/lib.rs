//! Event-driven simulation of dense granular matter.
//!
//! Grains are smooth hard spheres (or disks) that fly, collide and lose energy.
//! Where they come to rest the plain model breaks down: collisions follow each
//! other ever faster and never end. Here a slow grain on a support falls asleep
//! instead, and a sleeping one wakes when it is hit hard enough or loses its
//! support. This is the model of J. S. González, D. Risso and R. Soto, *Extended
//! event driven molecular dynamics for simulating dense granular matter*; the
//! book in `book/` states it formula by formula.
//!
//! A ball bounces on a floor until it sleeps:
//!
//! ```
//! use grainfall::boundary::{Cuboid, Side};
//! use grainfall::collide::Restitution;
//! use grainfall::dynamics::UniformGravity;
//! use grainfall::engine::{Limits, Simulation, StopReason};
//! use grainfall::model::Parts;
//! use grainfall::policy::SlowDescent;
//! use grainfall::predict::Polynomial;
//! use grainfall::{Particle, Vector};
//!
//! # fn main() -> Result<(), grainfall::SetupError> {
//! let model = Parts {
//!     dynamics: UniformGravity::<2>::down(),
//!     predictor: Polynomial,
//!     collision_rule: Restitution::default(),
//!     state_policy: SlowDescent { wall_supports: true, ..SlowDescent::with_threshold(0.01) },
//!     boundary: Cuboid::new([Side::Open, Side::floor(0.0, 0.4)])?,
//! };
//! let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::<2>::zeros());
//! let mut simulation = Simulation::new(model, vec![ball])?;
//! let why = simulation.run(&Limits::all_frozen(), &mut ());
//! assert_eq!(why, StopReason::AllFrozen);
//! assert!((simulation.time().units() - 2.3295104).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```
//!
//! # Units
//!
//! The diameter d, the mass m and gravity g are 1. So lengths are in d, times in
//! √(d/g), speeds in √(gd), energies in mgd. Without gravity the unit of time is
//! the user's. The last axis points up.
//!
//! # Where things are
//!
//! | module | what |
//! |---|---|
//! | [`model`] | the contract: the traits [`Dynamics`](model::Dynamics), [`Predictor`](model::Predictor), [`CollisionRule`](model::CollisionRule), [`StatePolicy`](model::StatePolicy), [`Boundary`](model::Boundary), their bundle [`Model`](model::Model), and [`Observer`](model::Observer) |
//! | [`dynamics`] | how grains fly: constant gravity, no force, growing diameters |
//! | [`predict`] | when two flights meet: quadratic, cubic and quartic contacts |
//! | [`collide`] | what a collision does: constant restitution with an elastic cut-off |
//! | [`policy`] | who sleeps and who wakes: the paper's criteria with their alternatives, and nobody |
//! | [`boundary`] | where the world ends: a box with periodic, walled or open sides |
//! | [`engine`] | the simulation, its guards, limits and counts |
//! | [`observe`] | ready-made observers |
//! | [`setup`] | where grains come from: rain, gas, base, one by one |
//! | [`analysis`] | what is measured on grains: packing fractions, pairs, contacts, motion, surfaces |
//! | [`particle`], [`time`], [`error`] | grains, instants, refusals |
//! | `scenario`, `output`, `draw`, `plot`, `program` | scenario files, run folders, pictures, plots, the command line |
//!
//! # Features
//!
//! `program`, on by default, brings the last row of that table and the
//! dependencies of the command-line program. With `default-features = false` only
//! the library remains.

pub mod analysis;
pub mod boundary;
pub mod collide;
pub mod dynamics;
pub mod engine;
pub mod error;
pub mod model;
pub mod observe;
pub mod particle;
pub mod policy;
pub mod predict;
pub mod setup;
pub mod time;

#[cfg(feature = "program")]
pub mod draw;
#[cfg(feature = "program")]
pub mod output;
#[cfg(feature = "program")]
pub mod plot;
#[cfg(feature = "program")]
pub mod program;
#[cfg(feature = "program")]
pub mod scenario;

pub use error::SetupError;
pub use particle::{Mode, Particle, ParticleId, Vector, WallId, along};
pub use time::Time;

/// The listings of the README and of the book, compiled and run by `cargo test`.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../book/src/getting-started.md")]
    struct GettingStarted;
    #[doc = include_str!("../book/src/model.md")]
    struct TheModel;
    #[doc = include_str!("../book/src/drum.md")]
    struct Drum;
    #[doc = include_str!("../book/src/own-criterion.md")]
    struct OwnCriterion;
    #[doc = include_str!("../book/src/own-collision-rule.md")]
    struct OwnCollisionRule;
    #[doc = include_str!("../book/src/own-boundary.md")]
    struct OwnBoundary;
    #[doc = include_str!("../book/src/own-dynamics.md")]
    struct OwnDynamics;
    #[doc = include_str!("../book/src/own-predictor.md")]
    struct OwnPredictor;
    #[doc = include_str!("../book/src/prediction.md")]
    struct Prediction;
    #[doc = include_str!("../book/src/refusals.md")]
    struct Refusals;
    #[doc = include_str!("../book/src/notation.md")]
    struct Notation;
    #[cfg(feature = "program")]
    #[doc = include_str!("../book/src/interrupted.md")]
    struct InterruptedRuns;
    #[doc = include_str!("../book/src/analysis.md")]
    struct Analysis;
    #[doc = include_str!("../book/src/results.md")]
    struct Results;
}
