//! The paper's rain, as benchmarks and figures run it.

use crate::engine::{Limits, Simulation, StopReason};
use crate::error::SetupError;
use crate::policy::Criterion;
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::timing::Cost;
use crate::scenario::{Assignment, GravityModel, Preset, ScenarioError, Start, read_text};
use crate::time::Time;

/// More grains than this are numbered along a curve, so that neighbours lie together
/// in memory.
pub(super) const MANY: usize = 20_000;

/// Grains of the paper's rain.
const PAPER_COUNT: f64 = 4800.0;
/// The edge of the paper's base, in d.
pub(super) const PAPER_WIDTH: f64 = 10.0;

/// A rain, simulated.
pub(super) type RainSimulation = Simulation<GravityModel<Criterion, 3>, 3>;

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

    /// The grains, all falling, above their base. When all is there but the simulation
    /// itself, `begin` is called.
    pub(super) fn simulation(&self, begin: impl FnOnce()) -> Result<RainSimulation, ProgramError> {
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
        begin();
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

/// Runs from sample to sample, a multiple of `step` in simulated time, until a
/// limit is reached, or until it has taken as much processor time as `longest`,
/// in seconds, and shows each; samples are not timed.
pub(super) fn sampled(
    simulation: &mut RainSimulation,
    step: f64,
    limits: &Limits,
    longest: f64,
    mut show: impl FnMut(&RainSimulation, Cost) -> Result<(), ProgramError>,
) -> Result<(Cost, StopReason), ProgramError> {
    let before = simulation.counts().total();
    let mut cost = Cost::default();
    show(simulation, cost)?;
    let mut sample = (simulation.time().units() / step).floor() + 1.0;
    loop {
        let end = Time::from_units(sample * step).min(limits.time);
        let clock = ProcessorClock::start();
        let portion = Limits {
            time: end,
            ..*limits
        };
        let reason = simulation.run(&portion, &mut ());
        cost.seconds += clock.seconds();
        cost.events = simulation.counts().total() - before;
        show(simulation, cost)?;
        if reason != StopReason::Time || end >= limits.time || cost.seconds >= longest {
            return Ok((cost, reason));
        }
        sample += 1.0;
    }
}
