//! A ball on a floor that takes a share of its speed at each bounce.

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::{Guards, Limits, Settings, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::{Occurrence, Parts};
use crate::particle::{Particle, Vector};
use crate::policy::Criterion;
use crate::predict::Polynomial;
use crate::program::estimate::Estimate;
use crate::program::validate::check::{Allowance, Check, Source};
use crate::program::validate::effort::Effort;

static SERIES: Source = Source {
    name: "exact",
    citation: "geometric series: bounce n = 0, 1, … of a ball that first hits the floor at t₀ with speed v₀ comes at t₀ + 2 v₀ α (1 − αⁿ)/((1 − α) g), the last one at t₀ + 2 v₀ α/((1 − α) g)",
};

/// Restitutions, and a late bounce that is looked at.
const CASES: [(f64, usize); 3] = [(0.4, 12), (0.7, 30), (0.9, 100)];

pub(super) fn checks(_effort: Effort) -> Result<Vec<Check>, SetupError> {
    let mut checks = Vec::new();
    for (restitution, late) in CASES {
        let model = Parts {
            dynamics: UniformGravity::<2>::down(),
            predictor: Polynomial,
            collision_rule: Restitution::elastic(),
            state_policy: Criterion::Never,
            boundary: Cuboid::new([Side::Open, Side::floor(0.0, restitution)])?,
        };
        // Half a diameter above the floor: it comes down at t = 1 with speed 1.
        let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::zeros());
        let settings = Settings {
            guards: Guards::none(),
            ..Settings::default()
        };
        let mut simulation = Simulation::with_settings(model, vec![ball], settings)?;
        let mut times = Vec::new();
        let mut record = |event: &Occurrence<2>| times.push(event.time.units());
        simulation.run(&Limits::events(late as u64 + 1), &mut record);
        let whole = 2.0 * restitution / (1.0 - restitution);
        let rest = (0..late).fold(1.0, |product, _| product * restitution);
        let time = times.get(late).copied().unwrap_or(f64::NAN);
        checks.push(Check::judged(
            format!("time of bounce {late}, α = {restitution}"),
            Estimate::exact(time),
            1,
            (1.0 + whole * (1.0 - rest), &SERIES),
            Allowance::flat(1.0e-12),
        ));
        let end = match simulation.run(&Limits::default(), &mut ()) {
            StopReason::Collapse(collapse) => collapse.time.units(),
            _ => f64::NAN,
        };
        checks.push(Check::judged(
            format!("time of collapse, α = {restitution}"),
            Estimate::exact(end),
            1,
            (1.0 + whole, &SERIES),
            Allowance::flat(1.0e-10),
        ));
    }
    Ok(checks)
}
