//! Profiles of velocity and of granular temperature.

use crate::analysis::error::check_axis;
use crate::analysis::{AnalysisError, Bins, Mean, blocked_mean};
use crate::particle::{Particle, Vector};

/// Where velocities are measured: bins along one axis, in a slab if wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe<const D: usize> {
    /// The axis of the bins.
    pub axis: usize,
    /// The bins, in d.
    pub bins: Bins,
    /// Only grains whose centres lie between these values on each axis, in d,
    /// count; all, where it is `None`.
    pub slab: [Option<(f64, f64)>; D],
}

impl<const D: usize> Probe<D> {
    /// Bins along an axis, through everything.
    ///
    /// # Errors
    ///
    /// When there is no such axis.
    pub fn new(axis: usize, bins: Bins) -> Result<Self, AnalysisError> {
        check_axis::<D>(axis)?;
        Ok(Probe {
            axis,
            bins,
            slab: [None; D],
        })
    }

    /// The same within `low ≤ x < high` on another axis, in d.
    ///
    /// # Errors
    ///
    /// When there is no such axis.
    pub fn within(mut self, axis: usize, low: f64, high: f64) -> Result<Self, AnalysisError> {
        check_axis::<D>(axis)?;
        self.slab[axis] = Some((low, high));
        Ok(self)
    }

    /// The bin of a grain that counts.
    #[must_use]
    pub fn bin_of(&self, position: &Vector<D>) -> Option<usize> {
        let inside = (0..D).all(|axis| {
            self.slab[axis].is_none_or(|(low, high)| (low..high).contains(&position[axis]))
        });
        inside.then(|| self.bins.bin_of(position[self.axis]))?
    }
}

/// What grains in the bins of one configuration do.
#[derive(Clone, Debug, PartialEq)]
pub struct BinnedMotion<const D: usize> {
    /// How many grains are in each bin.
    pub counts: Vec<usize>,
    /// Their mean velocity, weighted by mass: momentum over mass, in √(gd). Not
    /// a number in empty bins.
    pub velocities: Vec<Vector<D>>,
    /// Granular temperature in each bin, Σ m (v − u)²/(D (n − 1)), in mgd, with
    /// the mean velocity u of the bin in this configuration. Not a number for
    /// fewer than two grains.
    ///
    /// With n − 1 in place of n the mean's own fluctuation is counted for, also
    /// for unequal masses: independent velocities of temperature T give T on the
    /// average. A gradient of the mean velocity γ across a bin of width w adds
    /// about m γ² w²/(12 D): bins should be narrow.
    pub temperatures: Vec<f64>,
}

/// Counts, mean velocities and temperatures of the grains in each bin.
///
/// `ground` is the velocity of what counts as at rest where a grain is, in √(gd),
/// such as that of a drum that turns; it is subtracted. `counted` says which
/// grains count.
#[must_use]
pub fn binned_motion<const D: usize>(
    particles: &[Particle<D>],
    probe: &Probe<D>,
    ground: impl Fn(&Particle<D>) -> Vector<D>,
    counted: impl Fn(&Particle<D>) -> bool,
) -> BinnedMotion<D> {
    let bins = probe.bins.count();
    let mut counts = vec![0usize; bins];
    let mut masses = vec![0.0; bins];
    let mut momenta = vec![Vector::<D>::zeros(); bins];
    let in_bins: Vec<(usize, f64, Vector<D>)> = particles
        .iter()
        .filter(|particle| counted(particle))
        .filter_map(|particle| {
            let bin = probe.bin_of(&particle.position)?;
            let velocity = particle.velocity - ground(particle);
            Some((bin, particle.mass, velocity))
        })
        .collect();
    for (bin, mass, velocity) in &in_bins {
        counts[*bin] += 1;
        masses[*bin] += mass;
        momenta[*bin] += velocity * *mass;
    }
    let velocities: Vec<Vector<D>> = momenta
        .iter()
        .zip(&masses)
        .map(|(momentum, mass)| momentum / *mass)
        .collect();
    let mut squares = vec![0.0; bins];
    for (bin, mass, velocity) in &in_bins {
        squares[*bin] += mass * (velocity - velocities[*bin]).norm_squared();
    }
    let temperatures = squares
        .iter()
        .zip(&counts)
        .map(|(square, &count)| match count {
            0 | 1 => f64::NAN,
            _ => square / (D as f64 * (count - 1) as f64),
        })
        .collect();
    BinnedMotion {
        counts,
        velocities,
        temperatures,
    }
}

/// A profile over bins: means over configurations, with their errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The bins it is over, in d.
    pub bins: Bins,
    /// The mean in each, over the configurations that have a value there.
    pub means: Vec<Mean>,
}

impl Profile {
    /// The profile of `frames`, one list of values in the bins for each
    /// configuration, in the order of time. Errors as by [`blocked_mean`].
    #[must_use]
    pub fn of_frames<'a>(bins: &Bins, frames: impl IntoIterator<Item = &'a [f64]>) -> Self {
        let mut columns = vec![Vec::new(); bins.count()];
        for frame in frames {
            for (column, value) in columns.iter_mut().zip(frame) {
                column.push(*value);
            }
        }
        Profile {
            bins: *bins,
            means: columns.iter().map(|column| blocked_mean(column)).collect(),
        }
    }

    /// The points (middle of the bin, mean).
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 2]> {
        let centres = self.bins.centres();
        centres
            .into_iter()
            .zip(&self.means)
            .map(|(centre, mean)| [centre, mean.value])
            .collect()
    }

    /// The standard errors.
    #[must_use]
    pub fn errors(&self) -> Vec<f64> {
        self.means.iter().map(|mean| mean.error).collect()
    }
}
