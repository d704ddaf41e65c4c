//! The deposits: Figs. 3 and 4, and the numbers of the paper's section 3.

mod cost;
mod fraction;
mod layer;

pub(super) use cost::cost;
pub(super) use fraction::{fraction, loosest};
pub(super) use layer::{layer, pictures};

use crate::output::Summary;
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::Context;
use crate::program::reproduce::effort::Effort;
use crate::program::reproduce::runs::RunSpec;

/// A deposit by rain with V_sleep = V_wakeup = `threshold`.
fn deposit(effort: &Effort, threshold: f64, seed: u64) -> RunSpec {
    let mut set = vec![
        format!("grains.1.rain.count={}", effort.grains),
        format!("parameters.sleep_speed={threshold:?}"),
        format!("parameters.wake_speed={threshold:?}"),
        format!("parameters.elastic_speed={:?}", effort.elastic_speed),
        "output.series_every=0.25".to_owned(),
    ];
    if seed == 1 {
        // For pictures.
        set.push("output.frames_every=2.0".to_owned());
    }
    set.push(format!("output.mean_normal_from={:?}", effort.normal_from));
    RunSpec {
        name: format!("deposit_V={threshold}_seed={seed}"),
        preset: "deposition",
        seed,
        set,
    }
}

fn one_by_one(effort: &Effort, sleep_speed: f64, seed: u64) -> RunSpec {
    RunSpec {
        name: format!("one-by-one_V={sleep_speed}_seed={seed}"),
        preset: "one-by-one",
        seed,
        set: vec![
            format!("grains.1.one_by_one.count={}", effort.drops),
            format!("parameters.sleep_speed={sleep_speed:?}"),
            format!("parameters.elastic_speed={:?}", effort.elastic_speed),
        ],
    }
}

/// What might be behind the disagreement of Fig. 3: one decision altered each, at
/// the least threshold.
fn variations(effort: &Effort) -> Vec<(&'static str, RunSpec)> {
    let altered = |name: &'static str, what: &'static str, set: &[&str]| {
        let mut run = deposit(effort, least(effort), 1);
        run.name = format!("variation_{name}");
        // These are for a comparison, not for a number: with V_c = 1e-3.
        run.set.push("parameters.elastic_speed=1e-3".to_owned());
        run.set.extend(set.iter().map(|&set| set.to_owned()));
        (what, run)
    };
    vec![
        altered("none", "nothing but V_c = 1e-3", &[]),
        altered(
            "rain",
            "a rain of φ = 0.04",
            &["grains.1.rain.packing_fraction=0.04"],
        ),
        altered("store", "no stored energy", &["sleep.energy_store=\"off\""]),
        altered(
            "leaving",
            "the leaving speed read",
            &["sleep.speed_read=\"leaving\""],
        ),
        altered(
            "comparison",
            "no comparison with the previous speed",
            &["sleep.comparison=\"none\""],
        ),
        altered("contact", "asleep at contact", &["sleep.place=\"here\""]),
    ]
}

fn least(effort: &Effort) -> f64 {
    effort
        .thresholds
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min)
}

/// All deposits by rain.
pub(super) fn rain_runs(effort: &Effort) -> Vec<RunSpec> {
    let thresholds = effort.thresholds.iter();
    thresholds
        .flat_map(|&threshold| (1..=effort.seeds).map(move |seed| deposit(effort, threshold, seed)))
        .collect()
}

pub(super) fn layer_runs(effort: &Effort) -> Vec<RunSpec> {
    let mut runs: Vec<RunSpec> = (1..=effort.seeds)
        .map(|seed| deposit(effort, least(effort), seed))
        .collect();
    runs.push(deposit(effort, 0.1, 1));
    runs.extend(variations(effort).into_iter().map(|(_, run)| run));
    runs
}

pub(super) fn picture_runs(effort: &Effort) -> Vec<RunSpec> {
    vec![deposit(effort, 0.1, 1)]
}

pub(super) fn one_by_one_runs(effort: &Effort) -> Vec<RunSpec> {
    (1..=effort.seeds)
        .flat_map(|seed| [0.05, 0.01].map(|speed| one_by_one(effort, speed, seed)))
        .collect()
}

/// The means of one figure over seeds, for each threshold.
fn over_seeds(
    context: &Context<'_>,
    of: impl Fn(&Summary) -> Option<f64>,
) -> Result<Vec<(f64, Estimate)>, ProgramError> {
    let effort = &context.effort;
    let mut means = Vec::new();
    for &threshold in effort.thresholds {
        let mut values = Vec::new();
        for seed in 1..=effort.seeds {
            let summary = context
                .finished
                .summary(&deposit(effort, threshold, seed))?;
            values.extend(of(&summary));
        }
        means.push((threshold, Estimate::of(&values)));
    }
    Ok(means)
}
