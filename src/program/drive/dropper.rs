use rand_chacha::ChaCha8Rng;

use crate::analysis;
use crate::engine::Simulation;
use crate::error::SetupError;
use crate::model::Model;
use crate::particle::Particle;
use crate::scenario::Scenario;
use crate::setup::OneByOne;

/// Grains still to be dropped, one by one.
pub(super) struct Dropper<const D: usize> {
    pub(super) source: OneByOne<D>,
    pub(super) random: ChaCha8Rng,
    pub(super) dropped: usize,
    pub(super) count: usize,
}

impl<const D: usize> Dropper<D> {
    pub(super) fn new(scenario: &Scenario) -> Option<Self> {
        let (source, random) = scenario.dropper()?;
        Some(Dropper {
            source,
            random,
            dropped: 0,
            count: scenario.one_by_one().map_or(0, |drops| drops.count),
        })
    }

    pub(super) fn has_more(&self) -> bool {
        self.dropped < self.count
    }

    /// Drops the next grain; one that can't be dropped leaves everything as it was.
    pub(super) fn drop_into<M: Model<D>>(
        &mut self,
        simulation: &mut Simulation<M, D>,
    ) -> Result<Particle<D>, SetupError> {
        let heap = simulation.snapshot();
        let top = analysis::highest_surface(&heap).unwrap_or(0.0);
        let mut random = self.random.clone();
        let grain = self.source.grain(top, &mut random)?;
        simulation.insert(grain)?;
        self.random = random;
        self.dropped += 1;
        Ok(grain)
    }
}
