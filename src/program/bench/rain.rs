//! The paper's rain, as large as wanted.

use crate::engine::Simulation;
use crate::error::SetupError;
use crate::policy::Criterion;
use crate::program::bench::MANY;
use crate::program::bench::memory::Memory;
use crate::program::error::ProgramError;
use crate::scenario::{Assignment, GravityModel, Preset, ScenarioError, Start, read_text};

/// The paper's grains a square diameter of the base: so high is the rain.
const PAPER_COUNT: f64 = 4800.0;
const PAPER_WIDTH: f64 = 10.0;

/// A rain on its base.
pub(super) type Deposit = Simulation<GravityModel<Criterion, 3>, 3>;

/// The rain and the base of the preset `deposition`, as large as wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rain {
    pub(super) count: usize,
    /// Edge of the base, in d.
    pub(super) width: f64,
    /// V_t, for falling asleep and waking, in √(gd).
    pub(super) sleep_speed: f64,
    /// V_c, in √(gd).
    pub(super) elastic_speed: f64,
    pub(super) seed: u64,
}

impl Rain {
    /// The width at which a rain of `count` grains is as high as the paper's.
    pub(super) fn usual_width(count: usize) -> f64 {
        PAPER_WIDTH * (count as f64 / PAPER_COUNT).sqrt()
    }

    /// About when the last grain lands, in √(d/g).
    pub(super) fn last_landing(&self) -> f64 {
        let share = self.count as f64 / PAPER_COUNT * (PAPER_WIDTH / self.width).powi(2);
        190.0 * share + 5.0
    }

    /// The grains, all falling, above their base.
    pub(super) fn simulation(&self, memory: &Memory) -> Result<Deposit, ProgramError> {
        if self.width < 2.0 {
            return Err(SetupError::Parameter {
                field: "width",
                value: self.width,
                allowed: "2 or more is allowed, two diameters; the usual width is less for fewer \
                          than 192 grains",
            }
            .into());
        }
        let preset = Preset::named("deposition").ok_or_else(|| ProgramError::UnknownScenario {
            name: "deposition".to_owned(),
            hint: String::new(),
        })?;
        let mut origin = preset.origin();
        let side = format!("{{ periodic = {{ length = {:?} }} }}", self.width);
        let numbering = if self.count > MANY { "space" } else { "drawn" };
        let assignments = [
            format!("numbering=\"{numbering}\""),
            format!("seed={}", self.seed),
            format!("boundaries=[{side}, {side}, \"open\"]"),
            format!("grains.1.rain.count={}", self.count),
            format!("parameters.sleep_speed={:?}", self.sleep_speed),
            format!("parameters.wake_speed={:?}", self.sleep_speed),
            format!("parameters.elastic_speed={:?}", self.elastic_speed),
        ];
        origin.assignments = assignments
            .iter()
            .filter_map(|text| text.parse::<Assignment>().ok())
            .collect();
        let scenario = read_text(&origin).map_err(ScenarioError::from)?;
        let start = Start::<3>::new(&origin, &scenario)?;
        memory.forget_peak();
        let model = scenario.gravity_model(
            Criterion::SlowDescent(scenario.slow_descent()),
            start.boundary,
        );
        Ok(Simulation::with_settings(
            model,
            start.grains,
            scenario.settings(),
        )?)
    }
}
