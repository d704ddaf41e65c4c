use nalgebra::SMatrix;

use crate::analysis::error::check_axis;
use crate::analysis::{AnalysisError, Bins, Container};
use crate::model::{Observer, Occurrence, OccurrenceKind, Surroundings};
use crate::particle::{Particle, Vector};
use crate::time::Time;

/// The stress in slabs across an axis, from collisions and from what grains carry
/// along.
///
/// A collision moves momentum Δp over the branch r between two centres. Each slab
/// is given r ⊗ Δp times the share of the branch that lies in it (Irving &
/// Kirkwood 1950, doi:10.1063/1.1747782); that over volume and time is the
/// *collisional* part. The *kinetic* part is the momentum that grains carry
/// through the slab by their fluctuation, Σ m (v − u) ⊗ (v − u) over the volume,
/// with the mean velocity u of the slab; it is taken from snapshots, by
/// [`StressMeter::sample`]. Pressure is positive.
///
/// At a wall the branch goes from the point of contact to the centre. At a grain
/// that is asleep or fixed it goes to that grain's centre, where the momentum is
/// lost to the ground: static grains transmit nothing to each other, so inside a
/// region that is asleep there is no stress to be measured, though weight rests
/// on it.
///
/// ```
/// use grainfall::analysis::{Bins, Container, StressMeter};
/// use grainfall::boundary::{Cuboid, Side};
/// use grainfall::collide::Restitution;
/// use grainfall::dynamics::ForceFree;
/// use grainfall::engine::{Limits, Simulation};
/// use grainfall::model::Parts;
/// use grainfall::policy::Never;
/// use grainfall::predict::Polynomial;
/// use grainfall::setup::{Gas, seeded};
/// use grainfall::Time;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let gas = Gas::<3> { count: 200, packing_fraction: 0.2, ..Gas::default() };
/// let (grains, edges) = gas.grains(&mut seeded(1))?;
/// let boundary = Cuboid::new([0, 1, 2].map(|axis| Side::periodic(edges[axis])))?;
/// let container = Container::around(&boundary, &grains)?;
/// let model = Parts {
///     dynamics: ForceFree,
///     predictor: Polynomial,
///     collision_rule: Restitution::elastic(),
///     state_policy: Never,
///     boundary,
/// };
/// let mut simulation = Simulation::new(model, grains)?;
/// let whole = Bins::new(0.0, edges[2], 1)?;
/// let mut meter = StressMeter::new(container, 2, whole, simulation.time())?;
/// for step in 1..=50 {
///     let until = Time::from_units(0.2 * f64::from(step));
///     simulation.run(&Limits::until(until), &mut meter);
///     meter.sample(&simulation.snapshot());
/// }
/// // P V / N T = 2.41 at φ = 0.2.
/// let pressure = meter.stresses(simulation.time())[0].pressure();
/// assert!((2.3..2.5).contains(&(pressure * edges.product() / 200.0)));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct StressMeter<const D: usize> {
    container: Container<D>,
    axis: usize,
    bins: Bins,
    since: Time,
    slabs: Vec<Slab<D>>,
    samples: u64,
}

/// What has been summed up in a slab.
#[derive(Clone, Copy, Debug)]
struct Slab<const D: usize> {
    /// Σ r ⊗ Δp.
    transfer: SMatrix<f64, D, D>,
    /// Σ m, Σ m v and Σ m v ⊗ v over all samples.
    mass: f64,
    momentum: Vector<D>,
    flux: SMatrix<f64, D, D>,
}

/// The stress in a slab, in mg/d^(D−1); pressure is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<const D: usize> {
    /// From collisions: component (i, j) is the momentum along j that goes
    /// through a unit of area across i in a unit of time. Symmetric for smooth
    /// grains.
    pub collisional: SMatrix<f64, D, D>,
    /// From the motion of grains; zero without samples.
    pub kinetic: SMatrix<f64, D, D>,
}

impl<const D: usize> Stress<D> {
    /// Both parts.
    #[must_use]
    pub fn total(&self) -> SMatrix<f64, D, D> {
        self.collisional + self.kinetic
    }

    /// The mean of the normal stresses.
    #[must_use]
    pub fn pressure(&self) -> f64 {
        self.total().trace() / D as f64
    }
}

impl<const D: usize> StressMeter<D> {
    /// Nothing yet, at this time; slabs across `axis`.
    ///
    /// # Errors
    ///
    /// When there is no such axis.
    pub fn new(
        container: Container<D>,
        axis: usize,
        bins: Bins,
        since: Time,
    ) -> Result<Self, AnalysisError> {
        check_axis::<D>(axis)?;
        let slab = Slab {
            transfer: SMatrix::zeros(),
            mass: 0.0,
            momentum: Vector::zeros(),
            flux: SMatrix::zeros(),
        };
        Ok(StressMeter {
            container,
            axis,
            bins,
            since,
            slabs: vec![slab; bins.count()],
            samples: 0,
        })
    }

    /// The slabs.
    #[must_use]
    pub fn bins(&self) -> &Bins {
        &self.bins
    }

    /// Counts what grains carry along now; those at rest or on prescribed paths
    /// carry nothing.
    pub fn sample(&mut self, particles: &[Particle<D>]) {
        self.samples += 1;
        for particle in particles
            .iter()
            .filter(|particle| particle.mode.is_mobile())
        {
            let place = particle.position[self.axis];
            let whole = (self.bins.from(), self.bins.to());
            for shift in self.container.shifts(self.axis, (place, place), whole) {
                let Some(bin) = self.bins.bin_of(place + shift) else {
                    continue;
                };
                let slab = &mut self.slabs[bin];
                let momentum = particle.velocity * particle.mass;
                slab.mass += particle.mass;
                slab.momentum += momentum;
                slab.flux += momentum * particle.velocity.transpose();
            }
        }
    }

    /// The stresses in the slabs, means from the start to `now`. Not a number
    /// when no time has passed.
    #[must_use]
    pub fn stresses(&self, now: Time) -> Vec<Stress<D>> {
        let volume = self.bins.width() * self.container.cross_section(self.axis);
        let of_slab = |slab: &Slab<D>| {
            let samples = self.samples.max(1) as f64;
            let drift = match slab.mass > 0.0 {
                true => slab.momentum * slab.momentum.transpose() / slab.mass,
                false => SMatrix::zeros(),
            };
            Stress {
                collisional: slab.transfer / (volume * (now - self.since)),
                kinetic: (slab.flux - drift) / (volume * samples),
            }
        };
        self.slabs.iter().map(of_slab).collect()
    }

    /// Gives each slab its share of a branch that begins at `from` on the axis.
    fn spread(&mut self, from: f64, branch: &Vector<D>, momentum: &Vector<D>) {
        let transfer = branch * momentum.transpose();
        let length = branch[self.axis];
        let ends = (from.min(from + length), from.max(from + length));
        let whole = (self.bins.from(), self.bins.to());
        for shift in self.container.shifts(self.axis, ends, whole) {
            let (low, high) = (ends.0 + shift, ends.1 + shift);
            for bin in self.bins.touched(low, high) {
                let overlap = high.min(self.bins.edge(bin + 1)) - low.max(self.bins.edge(bin));
                // Of a branch that lies flat all is in one slab.
                let share = if high > low {
                    overlap.max(0.0) / (high - low)
                } else {
                    1.0
                };
                self.slabs[bin].transfer += transfer * share;
            }
        }
    }
}

impl<const D: usize> Observer<D> for StressMeter<D> {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        let grain = after.particle(occurrence.particle);
        let branch = match (occurrence.kind, occurrence.other) {
            (OccurrenceKind::Wall, _) => {
                let size = occurrence.impulse.norm_squared().sqrt();
                if size == 0.0 {
                    return;
                }
                // Along the wall's normal.
                occurrence.impulse * (grain.radius() / size)
            }
            (_, Some(other)) => {
                let other = after.particle(other);
                self.container.separation(&other.position, &grain.position)
            }
            _ => return,
        };
        let from = grain.position[self.axis] - branch[self.axis];
        self.spread(from, &branch, &occurrence.impulse);
    }
}
