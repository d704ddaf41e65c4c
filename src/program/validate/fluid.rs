//! Equal spheres or disks without gravity in a periodic box.

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::ForceFree;
use crate::engine::{Guards, Limits, Settings, Simulation};
use crate::error::SetupError;
use crate::model::{Observer, Parts};
use crate::particle::Particle;
use crate::policy::Never;
use crate::predict::Polynomial;
use crate::setup::{Gas, seeded};

type Model<const D: usize> = Parts<ForceFree, Polynomial, Restitution, Never, Cuboid<D>>;

/// A fluid and the box that it fills.
pub(super) struct Fluid<const D: usize> {
    pub(super) simulation: Simulation<Model<D>, D>,
    pub(super) volume: f64,
    /// Edge of the box, in d.
    pub(super) edge: f64,
    pub(super) count: usize,
}

impl<const D: usize> Fluid<D> {
    /// So many grains of this restitution at this packing fraction and the
    /// temperature 1.
    pub(super) fn new(
        count: usize,
        packing_fraction: f64,
        restitution: f64,
        seed: u64,
    ) -> Result<Self, SetupError> {
        Self::with_velocities(count, packing_fraction, restitution, seed, |_| {})
    }

    /// The same with other velocities.
    pub(super) fn with_velocities(
        count: usize,
        packing_fraction: f64,
        restitution: f64,
        seed: u64,
        change: impl FnOnce(&mut [Particle<D>]),
    ) -> Result<Self, SetupError> {
        let gas = Gas::<D> {
            count,
            packing_fraction,
            ..Gas::default()
        };
        let (mut grains, edges) = gas.grains(&mut seeded(seed))?;
        change(&mut grains);
        let model = Parts {
            dynamics: ForceFree,
            predictor: Polynomial,
            collision_rule: Restitution::constant(restitution),
            state_policy: Never,
            boundary: Cuboid::new(std::array::from_fn(|axis| Side::periodic(edges[axis])))?,
        };
        let settings = Settings {
            guards: Guards::none(),
            ..Settings::default()
        };
        Ok(Fluid {
            simulation: Simulation::with_settings(model, grains, settings)?,
            volume: edges.product(),
            edge: edges[0],
            count,
        })
    }

    /// Lets every grain collide so often, in the mean.
    pub(super) fn run<O: Observer<D>>(&mut self, collisions_each: u64, observer: &mut O) {
        // A collision is one of two grains.
        let more = collisions_each * self.count as u64 / 2;
        let limits = Limits::events(self.simulation.counts().total() + more);
        self.simulation.run(&limits, observer);
    }

    /// Kinetic temperature over the (N − 1) D degrees of freedom that the total
    /// momentum leaves, in mgd. With it the rates of collision in a periodic box
    /// are those of the canonical ensemble.
    pub(super) fn temperature(&self) -> f64 {
        2.0 * self.simulation.kinetic_energy() / self.degrees_of_freedom()
    }

    pub(super) fn degrees_of_freedom(&self) -> f64 {
        ((self.count - 1) * D) as f64
    }

    /// Grains per volume, in d^−D.
    pub(super) fn density(&self) -> f64 {
        self.count as f64 / self.volume
    }
}
