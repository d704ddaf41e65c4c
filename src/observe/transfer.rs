use crate::model::{Observer, Occurrence, Surroundings};
use crate::time::Time;

/// What collisions of two grains transfer: how many there were, and the sum of
/// distance times momentum, Σ r·Δp, which is the collisional part of the
/// pressure.
///
/// ```
/// use grainfall::boundary::{Cuboid, Side};
/// use grainfall::collide::Restitution;
/// use grainfall::dynamics::ForceFree;
/// use grainfall::engine::{Limits, Simulation};
/// use grainfall::model::Parts;
/// use grainfall::observe::CollisionalTransfer;
/// use grainfall::policy::Never;
/// use grainfall::predict::Polynomial;
/// use grainfall::setup::{Gas, seeded};
///
/// # fn main() -> Result<(), grainfall::SetupError> {
/// let gas = Gas::<3> { count: 200, packing_fraction: 0.2, ..Gas::default() };
/// let (grains, edges) = gas.grains(&mut seeded(1))?;
/// let model = Parts {
///     dynamics: ForceFree,
///     predictor: Polynomial,
///     collision_rule: Restitution::elastic(),
///     state_policy: Never,
///     boundary: Cuboid::new([0, 1, 2].map(|axis| Side::periodic(edges[axis])))?,
/// };
/// let mut simulation = Simulation::new(model, grains)?;
/// let mut transfer = CollisionalTransfer::new(simulation.time());
/// simulation.run(&Limits::events(20_000), &mut transfer);
/// let pressure = transfer.pressure::<3>(
///     simulation.time(),
///     simulation.kinetic_energy(),
///     edges.product(),
/// );
/// // P V / N T = 2.41 at φ = 0.2.
/// let compressibility = pressure * edges.product() / 200.0;
/// assert!((2.3..2.5).contains(&compressibility));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CollisionalTransfer {
    since: Time,
    collisions: u64,
    virial: f64,
}

impl CollisionalTransfer {
    /// Nothing yet, at this time.
    #[must_use]
    pub fn new(since: Time) -> Self {
        CollisionalTransfer {
            since,
            collisions: 0,
            virial: 0.0,
        }
    }

    /// Collisions of two grains so far, static ones included.
    #[must_use]
    pub fn collisions(&self) -> u64 {
        self.collisions
    }

    /// Σ r·Δp so far, in m d √(gd): each collision adds the distance of the
    /// centres times the momentum transferred.
    #[must_use]
    pub fn virial(&self) -> f64 {
        self.virial
    }

    /// Mean pressure up to `now`, in mg/d^(D−1):
    /// (2 E + Σ r·Δp / Δt) / (D V), with the kinetic energy E in mgd (its mean,
    /// where it changes) and the volume V in d^D.
    #[must_use]
    pub fn pressure<const D: usize>(&self, now: Time, kinetic_energy: f64, volume: f64) -> f64 {
        let rate = self.virial / (now - self.since);
        (2.0 * kinetic_energy + rate) / (D as f64 * volume)
    }
}

impl<const D: usize> Observer<D> for CollisionalTransfer {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        let Some(other) = occurrence.other else {
            return;
        };
        let distance =
            after.particle(occurrence.particle).radius() + after.particle(other).radius();
        self.collisions += 1;
        // The momentum goes along the line of centres.
        self.virial += distance * occurrence.impulse.norm_squared().sqrt();
    }
}
