//! `grainfall bench deposition`: events of the paper's rain.

use serde::Serialize;

use crate::analysis::packing_fraction;
use crate::engine::{Counts, Limits, StopReason};
use crate::error::SetupError;
use crate::observe::TrajectoryHash;
use crate::program::bench::arguments::DepositionArguments;
use crate::program::bench::gas::bytes_of;
use crate::program::bench::memory::Memory;
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;
use crate::program::rain::{Rain, RainSimulation, sampled};
use crate::program::show::say_result;
use crate::program::timing::{Cost, timed};
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
    fn add(&mut self, simulation: &RainSimulation) {
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
    fn enter(self, simulation: &mut RainSimulation, progress: &mut Progress) -> (Cost, StopReason) {
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
    fn limits(self, simulation: &RainSimulation) -> Limits {
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

/// What came out.
#[derive(Debug, Serialize)]
struct Outcome {
    benchmark: &'static str,
    count: usize,
    fixed: usize,
    width: f64,
    sleep_speed: f64,
    elastic_speed: f64,
    seed: u64,
    setup_seconds: f64,
    seconds_before: f64,
    from: f64,
    until: f64,
    ended: String,
    processor_seconds: f64,
    /// Physical events.
    events: u64,
    nanoseconds_per_event: f64,
    events_per_second: f64,
    by_kind: Counts,
    normal: usize,
    falling: usize,
    frozen: usize,
    peak_bytes_per_particle: Option<f64>,
    bytes_per_particle: Option<f64>,
    /// Of the whole run only.
    packing_fraction: Option<f64>,
    mean_normal: Option<f64>,
    deepest_overlap: f64,
    trajectory_hash: Option<String>,
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
    let mut simulation = rain.simulation(|| memory.forget_peak())?;
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
            f64::INFINITY,
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
    let mut simulation = rain.simulation(|| {})?;
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

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = &self.by_kind;
        writeln!(
            f,
            "deposition, {} grains on {:.2} d × {:.2} d with {} fixed ones, V_t = {}, V_c = {}",
            self.count, self.width, self.width, self.fixed, self.sleep_speed, self.elastic_speed
        )?;
        writeln!(
            f,
            "  set-up           {:.2} s; then {:.2} s up to the window",
            self.setup_seconds, self.seconds_before
        )?;
        writeln!(
            f,
            "  window           t = {:.3} … {:.3}, {}",
            self.from, self.until, self.ended
        )?;
        writeln!(
            f,
            "  timed            {} events: {:.3} s of processor time",
            self.events, self.processor_seconds
        )?;
        writeln!(
            f,
            "  an event         {:.1} ns, {:.0} a second",
            self.nanoseconds_per_event, self.events_per_second
        )?;
        writeln!(
            f,
            "  by kind          {} pair + {} frozen + {} wake + {} sleep + {} wall + {} check wake",
            kinds.pair, kinds.frozen, kinds.wake, kinds.sleep, kinds.wall, kinds.check_wake
        )?;
        writeln!(
            f,
            "  of these         {} elastic; guards acted {} times; lists made {:.4} an event",
            kinds.elastic,
            kinds.guard,
            kinds.transfer as f64 / self.events as f64
        )?;
        writeln!(
            f,
            "  at the end       {} falling, {} normal, {} frozen",
            self.falling, self.normal, self.frozen
        )?;
        writeln!(
            f,
            "  memory           {}",
            bytes_of(self.peak_bytes_per_particle, self.bytes_per_particle)
        )?;
        if let Some(fraction) = self.packing_fraction {
            writeln!(f, "  φ                {fraction:.4}")?;
        }
        if let Some(mean) = self.mean_normal {
            writeln!(
                f,
                "  normal grains    {mean:.1} in the mean while the heap grows"
            )?;
        }
        write!(
            f,
            "  deepest overlap  {:.1e} d since the start",
            self.deepest_overlap
        )?;
        if let Some(hash) = &self.trajectory_hash {
            write!(f, "\n  trajectory hash  {hash}")?;
        }
        Ok(())
    }
}
