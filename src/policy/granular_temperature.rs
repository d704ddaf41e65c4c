use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::model::{Impact, Reason, Surroundings};
use crate::particle::Vector;
use crate::policy::at_rest::RestCondition;
use crate::policy::parameters::{neighbour_range, positive};

/// At rest is who lives in a cold and dense neighbourhood: the granular
/// temperature of the grain and its neighbours,
/// T = ⟨m |v − ⟨v⟩|²⟩/(D m), is below a threshold.
///
/// This is the adaptive sparse contacts of the code Lethe (its grains: Golshan,
/// Munch, Gassmöller, Kronbichler and Blais 2023, doi:10.1007/s40571-022-00478-6),
/// which switches the contacts of whole cells off, here for each grain by itself. "Dense", there a bound on the
/// solid fraction of the cell, is a least number of neighbours here. As there,
/// the temperature does not see a motion that all share: it fails in plugs that
/// slide as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "program", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct GranularTemperature {
    /// T below which a neighbourhood is cold, in gd.
    #[cfg_attr(feature = "program", schemars(extend("exclusiveMinimum" = 0.0, "x-unit" = "gd")))]
    pub temperature: f64,
    /// Neighbours are nearer than this, in units of the distance at contact.
    #[cfg_attr(feature = "program", schemars(range(min = 1.0, max = 2.0), extend("x-unit" = "σ₁₂")))]
    pub range: f64,
    /// The fewest neighbours of a dense neighbourhood.
    pub least_neighbours: u32,
}

impl Default for GranularTemperature {
    /// Below 5·10⁻⁴ gd, with at least 3 grains nearer than 1.2: that of one grain
    /// in space that moves with 0.09 √(gd) among three at rest.
    fn default() -> Self {
        GranularTemperature {
            temperature: 5.0e-4,
            range: 1.2,
            least_neighbours: 3,
        }
    }
}

impl<const D: usize> RestCondition<D> for GranularTemperature {
    type History = ();

    fn validate(&self) -> Result<(), SetupError> {
        positive("temperature", self.temperature)?;
        neighbour_range("range", self.range)
    }

    fn at_rest<S: Surroundings<D>>(
        &self,
        impact: &Impact<D>,
        after: Vector<D>,
        near: &S,
        _history: &mut (),
    ) -> Result<Reason, Reason> {
        let mut count = 1;
        let mut sum = after;
        let mut squares = after.norm_squared();
        // Neighbours come in no stated order, so sums are taken in that of ids.
        let mut others = Vec::new();
        near.for_each_neighbour(impact.id, self.range, |other| others.push(other.id));
        others.sort_unstable();
        for other in others {
            let velocity = near.particle(other).velocity;
            count += 1;
            sum += velocity;
            squares += velocity.norm_squared();
        }
        let neighbours = f64::from(count - 1);
        if neighbours < f64::from(self.least_neighbours) {
            let least = f64::from(self.least_neighbours);
            return Err(Reason::new("enough neighbours", neighbours, least));
        }
        let number = f64::from(count);
        let spread = (squares / number - (sum / number).norm_squared()).max(0.0);
        let temperature = spread / D as f64;
        let reason = Reason::new("cold neighbourhood", temperature, self.temperature);
        if temperature < self.temperature {
            Ok(reason)
        } else {
            Err(reason)
        }
    }
}
