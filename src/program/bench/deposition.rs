//! `grainfall bench deposition`: events of the paper's rain.

mod outcome;

use crate::analysis::packing_fraction;
use crate::engine::{Counts, Limits, StopReason};
use crate::error::SetupError;
use crate::observe::TrajectoryHash;
use crate::program::bench::arguments::DepositionArguments;
use crate::program::bench::deposition::outcome::Outcome;
use crate::program::bench::memory::Memory;
use crate::program::bench::rain::{Deposit, Rain};
use crate::program::bench::timing::{Cost, sampled, timed};
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;
use crate::program::show::say_result;
use crate::time::Time;

/// How often the grains are counted by mode, in √(d/g).
const SAMPLED: f64 = 0.25;

/// The mean number of normal grains is taken from and up to these shares of the
/// time of the last landing, as in the summaries of runs.
const MEAN: [f64; 2] = [0.25, 0.8];

/// How many grains are normal, and falling, at equal intervals.
#[derive(Default)]
struct Samples(Vec<(usize, usize)>);

impl Samples {
    fn add(&mut self, simulation: &Deposit) {
        let modes = simulation.mode_counts();
        self.0.push((modes.normal, modes.falling));
    }

    /// The mean number of normal ones while the heap grew.
    fn mean(&self) -> Option<f64> {
        let last = self.0.iter().position(|(_, falling)| *falling == 0)?;
        let [from, to] = MEAN.map(|share| (share * last as f64).round() as usize);
        let chosen = self.0.get(from..=to)?;
        Some(chosen.iter().map(|(normal, _)| *normal as f64).sum::<f64>() / chosen.len() as f64)
    }
}

/// What is timed.
#[derive(Clone, Copy, Debug)]
struct Window {
    from: Option<f64>,
    until: Option<f64>,
    events: Option<u64>,
}

impl Window {
    /// The whole run, until all grains sleep.
    fn is_all(self) -> bool {
        self.from.is_none() && self.until.is_none() && self.events.is_none()
    }

    /// Goes to where the window begins.
    fn enter(self, simulation: &mut Deposit, progress: &mut Progress) -> (Cost, StopReason) {
        let Some(from) = self.from else {
            return (Cost::default(), StopReason::Time);
        };
        let limits = Limits {
            time: Time::from_units(from),
            all_frozen: true,
            ..Limits::default()
        };
        timed(simulation, &limits, &mut (), progress)
    }

    /// From here on.
    fn limits(self, simulation: &Deposit) -> Limits {
        let total = simulation.counts().total();
        Limits {
            time: self.until.map_or(Time::NEVER, Time::from_units),
            events: self
                .events
                .map_or(u64::MAX, |more| total.saturating_add(more)),
            all_frozen: true,
        }
    }
}

pub(super) fn measure(arguments: &DepositionArguments) -> Result<u8, ProgramError> {
    let count = arguments
        .count
        .unwrap_or(if arguments.quick { 300 } else { 4800 });
    let rain = Rain {
        count,
        width: arguments.width.unwrap_or_else(|| Rain::usual_width(count)),
        sleep_speed: arguments.sleep_speed,
        elastic_speed: arguments.elastic_speed.unwrap_or(if arguments.quick {
            1.0e-3
        } else {
            1.0e-4
        }),
        seed: arguments.seed,
    };
    let window = Window {
        from: arguments.from,
        until: arguments.until,
        events: arguments.events,
    };
    if let Some(until) = window.until
        && until <= window.from.unwrap_or(0.0)
    {
        return Err(SetupError::Parameter {
            field: "until",
            value: until,
            allowed: "a time after the one of --from is allowed",
        }
        .into());
    }
    let mut progress = Progress::new(false, None);
    let (mut outcome, code) = run(&rain, window, &mut progress)?;
    if arguments.hash {
        let hash = hash(&rain, window, &mut progress)?;
        outcome.trajectory_hash = Some(format!("{:016x}", hash.value()));
    }
    progress.finish();
    say_result(&outcome, arguments.json)?;
    Ok(code)
}

fn run(
    rain: &Rain,
    window: Window,
    progress: &mut Progress,
) -> Result<(Outcome, u8), ProgramError> {
    let memory = Memory::before();
    let clock = ProcessorClock::start();
    let mut simulation = rain.simulation(&memory)?;
    let setup_seconds = clock.seconds();
    let (spent_before, reached) = window.enter(&mut simulation, progress);
    if reached != StopReason::Time {
        return Err(SetupError::Parameter {
            field: "from",
            value: window.from.unwrap_or(0.0),
            allowed: "a time before all grains sleep is allowed",
        }
        .into());
    }
    let (before, from) = (*simulation.counts(), simulation.time().units());
    let limits = window.limits(&simulation);
    let mut samples = Samples::default();
    let (cost, reason) = if window.is_all() {
        let end = rain.last_landing();
        sampled(
            &mut simulation,
            SAMPLED,
            &limits,
            &mut (),
            |simulation, _| {
                samples.add(simulation);
                let time = simulation.time().units();
                progress.show(time, simulation.counts().total(), time / end);
                Ok(())
            },
        )?
    } else {
        timed(&mut simulation, &limits, &mut (), progress)
    };
    let modes = simulation.mode_counts();
    let peak_bytes = memory.peak_each(modes.total());
    let bytes = memory.now_each(modes.total());
    let whole = window.is_all() && reason == StopReason::AllFrozen;
    let packing = whole
        .then(|| packing_fraction(&simulation.snapshot(), rain.width * rain.width))
        .flatten();
    let (ended, code) = match reason {
        StopReason::Time | StopReason::Events => ("the window's end".to_owned(), 0),
        StopReason::AllFrozen | StopReason::NothingLeft => ("all grains asleep".to_owned(), 0),
        StopReason::Collapse(collapse) => (
            format!(
                "collapse of {} grains at t = {}",
                collapse.particles.len(),
                collapse.time.units()
            ),
            3,
        ),
        StopReason::Escaped(id) => (format!("grain {id} left"), 3),
    };
    let outcome = Outcome {
        benchmark: "deposition",
        count: rain.count,
        fixed: modes.fixed,
        width: rain.width,
        sleep_speed: rain.sleep_speed,
        elastic_speed: rain.elastic_speed,
        seed: rain.seed,
        setup_seconds,
        seconds_before: spent_before.seconds,
        from,
        until: simulation.time().units(),
        ended,
        processor_seconds: cost.seconds,
        events: cost.events,
        nanoseconds_per_event: cost.nanoseconds(),
        events_per_second: cost.rate(),
        by_kind: since(simulation.counts(), &before),
        normal: modes.normal,
        falling: modes.falling,
        frozen: modes.frozen,
        peak_bytes_per_particle: peak_bytes,
        bytes_per_particle: bytes,
        packing_fraction: packing.map(|slab| slab.value),
        mean_normal: if whole { samples.mean() } else { None },
        deepest_overlap: simulation.max_overlap(),
        trajectory_hash: None,
    };
    Ok((outcome, code))
}

/// The hash of the window.
fn hash(
    rain: &Rain,
    window: Window,
    progress: &mut Progress,
) -> Result<TrajectoryHash, ProgramError> {
    let mut simulation = rain.simulation(&Memory::before())?;
    window.enter(&mut simulation, progress);
    let limits = window.limits(&simulation);
    let mut hash = TrajectoryHash::new();
    timed(&mut simulation, &limits, &mut hash, progress);
    Ok(hash)
}

/// What has happened since.
fn since(now: &Counts, before: &Counts) -> Counts {
    Counts {
        pair: now.pair - before.pair,
        frozen: now.frozen - before.frozen,
        wake: now.wake - before.wake,
        sleep: now.sleep - before.sleep,
        check: now.check - before.check,
        support: now.support - before.support,
        check_wake: now.check_wake - before.check_wake,
        wall: now.wall - before.wall,
        transfer: now.transfer - before.transfer,
        elastic: now.elastic - before.elastic,
        guard: now.guard - before.guard,
    }
}
