//! `grainfall bench deposition`: events of the paper's rain.

use serde::Serialize;

use crate::analysis::packing_fraction;
use crate::engine::{Counts, Limits, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::Observer;
use crate::observe::TrajectoryHash;
use crate::policy::Criterion;
use crate::program::bench::MANY;
use crate::program::bench::arguments::DepositionArguments;
use crate::program::bench::gas::bytes_of;
use crate::program::bench::memory::Memory;
use crate::program::bench::timing::{Cost, timed};
use crate::program::error::ProgramError;
use crate::program::processor::ProcessorClock;
use crate::program::progress::Progress;
use crate::program::show::say_result;
use crate::scenario::{Assignment, GravityModel, Preset, ScenarioError, Start, read_text};
use crate::time::Time;

/// How often the grains are counted by mode, in √(d/g).
const SAMPLED: f64 = 0.25;
/// The mean number of normal grains is taken from and up to these shares of the
/// time of the last landing, as in the summaries of runs.
const MEAN: [f64; 2] = [0.25, 0.8];

/// The paper's grains a square diameter of the base: so high is the rain.
const PAPER_COUNT: f64 = 4800.0;
const PAPER_WIDTH: f64 = 10.0;

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
    pub(super) fn simulation(
        &self,
        memory: &Memory,
    ) -> Result<Simulation<GravityModel<Criterion, 3>, 3>, ProgramError> {
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

/// Runs from sample to sample, a multiple of `step` in simulated time, until a
/// limit is reached, and shows each; samples are not timed.
pub(super) fn sampled<O: Observer<3>>(
    simulation: &mut Simulation<GravityModel<Criterion, 3>, 3>,
    step: f64,
    limits: &Limits,
    observer: &mut O,
    mut show: impl FnMut(&Simulation<GravityModel<Criterion, 3>, 3>, Cost) -> Result<(), ProgramError>,
) -> Result<(Cost, StopReason), ProgramError> {
    let before = simulation.counts().total();
    let mut cost = Cost::default();
    show(simulation, cost)?;
    let mut sample = (simulation.time().units() / step).floor() + 1.0;
    loop {
        let end = Time::from_units(sample * step).min(limits.time);
        let clock = ProcessorClock::start();
        let reason = simulation.run(
            &Limits {
                time: end,
                ..*limits
            },
            observer,
        );
        cost.seconds += clock.seconds();
        cost.events = simulation.counts().total() - before;
        show(simulation, cost)?;
        if reason != StopReason::Time || end >= limits.time {
            return Ok((cost, reason));
        }
        sample += 1.0;
    }
}

/// How many grains are normal, and falling, at equal intervals.
#[derive(Default)]
struct Samples(Vec<(usize, usize)>);

impl Samples {
    fn add(&mut self, simulation: &Simulation<GravityModel<Criterion, 3>, 3>) {
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
    fn enter(
        self,
        simulation: &mut Simulation<GravityModel<Criterion, 3>, 3>,
        progress: &mut Progress,
    ) -> (Cost, StopReason) {
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
    fn limits(self, simulation: &Simulation<GravityModel<Criterion, 3>, 3>) -> Limits {
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
