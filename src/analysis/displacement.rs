//! How far grains come, from configurations alone.

use crate::analysis::{AnalysisError, Container};
use crate::particle::{Particle, Vector};
use crate::time::Time;

/// Ways through periodic faces, followed from configuration to configuration.
///
/// Each step is taken to the nearest image, so between two configurations no
/// grain may come farther than half a period; [`Paths::longest_step`] says how
/// near that was. During a run the observer
/// [`Displacements`](crate::observe::Displacements) follows them exactly.
#[derive(Clone, Debug)]
pub struct Paths<const D: usize> {
    container: Container<D>,
    times: Vec<Time>,
    last: Vec<Vector<D>>,
    /// For each configuration, the displacement of each grain from the first.
    ways: Vec<Vec<Vector<D>>>,
    longest_step: f64,
}

impl<const D: usize> Paths<D> {
    /// No configuration yet.
    #[must_use]
    pub fn new(container: Container<D>) -> Self {
        Paths {
            container,
            times: Vec::new(),
            last: Vec::new(),
            ways: Vec::new(),
            longest_step: 0.0,
        }
    }

    /// One more configuration, later than those before, its grains by id.
    ///
    /// # Errors
    ///
    /// When it has not as many grains as the first.
    pub fn push(&mut self, time: Time, particles: &[Particle<D>]) -> Result<(), AnalysisError> {
        let Some(before) = self.ways.last() else {
            self.ways.push(vec![Vector::zeros(); particles.len()]);
            self.times.push(time);
            self.last = particles.iter().map(|particle| particle.position).collect();
            return Ok(());
        };
        if particles.len() != self.last.len() {
            return Err(AnalysisError::Grains {
                frame: self.times.len(),
                found: particles.len(),
                wanted: self.last.len(),
                what: "a displacement",
            });
        }
        let mut now = before.clone();
        for ((way, last), particle) in now.iter_mut().zip(&mut self.last).zip(particles) {
            let step = self.container.separation(last, &particle.position);
            for axis in (0..D).filter(|axis| self.container.periodic[*axis]) {
                let share = step[axis].abs() / self.container.lengths[axis];
                self.longest_step = self.longest_step.max(share);
            }
            *way += step;
            *last = particle.position;
        }
        self.ways.push(now);
        self.times.push(time);
        Ok(())
    }

    /// The longest step of any grain along a periodic axis, in periods. Near ½
    /// it is likely that grains have come farther and were taken for others.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        self.longest_step
    }

    /// The displacement of a grain from the first configuration to another, in
    /// d.
    #[must_use]
    pub fn displacement(&self, configuration: usize, grain: usize) -> Option<Vector<D>> {
        self.ways.get(configuration)?.get(grain).copied()
    }

    /// The mean square displacement of the grains that `counted` names, for each
    /// lapse of time: over all grains and all configurations to begin with that
    /// are so far apart, if all are equally far apart (to 10⁻⁶ of it); else
    /// from the first alone.
    #[must_use]
    pub fn mean_square(&self, counted: impl Fn(usize) -> bool) -> Vec<MeanSquare> {
        let grains: Vec<usize> = (0..self.last.len())
            .filter(|&grain| counted(grain))
            .collect();
        let even = self.is_even();
        let frames = self.times.len();
        (1..frames)
            .map(|lag| {
                let origins = if even { frames - lag } else { 1 };
                let (mut sum, mut lapse) = (0.0, 0.0);
                for origin in 0..origins {
                    lapse += self.times[origin + lag] - self.times[origin];
                    let (from, to) = (&self.ways[origin], &self.ways[origin + lag]);
                    let squares = grains
                        .iter()
                        .map(|&grain| (to[grain] - from[grain]).norm_squared());
                    sum += squares.sum::<f64>();
                }
                MeanSquare {
                    lapse: lapse / origins as f64,
                    value: sum / (origins * grains.len()) as f64,
                    origins,
                }
            })
            .collect()
    }

    fn is_even(&self) -> bool {
        let mut steps = self.times.windows(2).map(|pair| pair[1] - pair[0]);
        let Some(first) = steps.next() else {
            return false;
        };
        steps.all(|step| (step - first).abs() <= 1.0e-6 * first.abs())
    }
}

/// A mean square displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanSquare {
    /// After so much time, in √(d/g).
    pub lapse: f64,
    /// ⟨|Δr|²⟩, in d²; not a number without grains.
    pub value: f64,
    /// From how many configurations it was counted.
    pub origins: usize,
}
