//! Readers of scenarios and of grains against a great many inputs that are
//! nearly right: no panic, no hang, and messages that help.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::mutate::{mutate_bytes, mutate_lines, mutate_tree};
use grainfall::Time;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::output::{XyzError, XyzReader};
use grainfall::scenario::{
    Dimension, Format, Gravity, Origin, Problem, Scenario, ScenarioError, SourceKind, Start,
    presets, read_text,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Small scenarios that use what the presets don't.
const MORE: [&str; 3] = [
    "dimension = 2\nseed = 3\ngravity = [0.1, -1.0]\nboundaries = [{ periodic = { origin = -1.0, length = 9.0 } }, { walls = { low = 0.0, high = 30.0, restitution = 0.4 } }]\n[parameters]\nrestitution = 0.7\nfrozen_restitution = 0.6\nelastic_speed = 1e-3\nsleep_speed = 0.1\nwake_speed = 0.3\n[self_check]\ninterval = 1.0\n[stop]\ntime = 5.0\nevents = 400\n[output]\nseries_every = 1.0\n[[grains]]\nposition = [0.0, 0.6]\nmode = \"fixed\"\n[[grains]]\nposition = [3.0, 1.0]\nvelocity = [0.5, 0.1]\ndiameter = 0.8\nmass = 2.0\n[[grains]]\nrain = { count = 12, packing_fraction = 0.3, fall_speed = 2.5, sizes = { uniform = { least = 0.5, most = 1.0 } } }\n",
    "dimension = 3\ngravity = \"none\"\n[stop]\ntime = 2.0\nevents = 300\n[[grains]]\ngas = { count = 20, packing_fraction = 0.2, temperature = 1.0, aspect = [1.0, 1.0, 2.0], sizes = { bimodal = { small = 0.7, large = 1.0, large_fraction = 0.5 } } }\n",
    "dimension = 2\nboundaries = [{ periodic = { length = 6.0 } }, \"open\"]\n[stop]\ntime = 9.0\nevents = 500\n[guards]\nhold = 1e-6\n[[grains]]\nbase = { thickness = 2.0, bottom = -2.0 }\n[[grains]]\none_by_one = { count = 3, clearance = 1.0, fall_speed = 1.0 }\n",
];

/// Prints what is being tried if it panics, and ends the process if it hangs.
struct Watch {
    seed: u64,
    index: Arc<AtomicU64>,
    ended: Arc<AtomicBool>,
}

/// Nothing takes as long as that on the slowest machine.
const HANGS: Duration = Duration::from_secs(60);

impl Watch {
    fn new(seed: u64) -> Self {
        let index = Arc::new(AtomicU64::new(0));
        let ended = Arc::new(AtomicBool::new(false));
        let (at, stop) = (index.clone(), ended.clone());
        std::thread::spawn(move || {
            let (mut last, mut since) = (0, Instant::now());
            while !stop.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(200));
                let now = at.load(Ordering::Relaxed);
                if now != last {
                    (last, since) = (now, Instant::now());
                } else if since.elapsed() > HANGS {
                    eprintln!("input {now} of seed {seed} hangs");
                    std::process::abort();
                }
            }
        });
        Watch { seed, index, ended }
    }

    /// The generator of an input: repeat it with this seed and index.
    fn random(&self, index: u64) -> ChaCha8Rng {
        self.index.store(index, Ordering::Relaxed);
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(index);
        rng
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if std::thread::panicking() {
            let index = self.index.load(Ordering::Relaxed);
            eprintln!("input {index} of seed {}", self.seed);
        }
    }
}

/// Highest use of memory so far, in MiB, where the system tells.
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let size = line.and_then(|rest| rest.trim().strip_suffix("kB"));
    size.and_then(|kilobytes| kilobytes.trim().parse::<f64>().ok())
        .unwrap_or(0.0)
        / 1024.0
}

fn bases() -> Vec<toml::Value> {
    let texts = presets().iter().map(|preset| preset.text).chain(MORE);
    texts
        .map(|text| toml::Value::Table(toml::from_str(text).unwrap()))
        .collect()
}

/// A text that is nearly a scenario.
fn nearly(bases: &[toml::Value], rng: &mut ChaCha8Rng) -> Origin {
    let mut tree = bases[rng.random_range(0..bases.len())].clone();
    for _ in 0..rng.random_range(1..3) {
        mutate_tree(&mut tree, rng);
    }
    let json = rng.random_range(0..4) == 0;
    let text = if json {
        serde_json::to_string_pretty(&tree).unwrap()
    } else {
        toml::to_string(&tree).unwrap_or_default()
    };
    let mut bytes = text.into_bytes();
    if rng.random_range(0..12) == 0 {
        mutate_bytes(&mut bytes, rng);
    }
    let mut origin = Origin::toml("input", &String::from_utf8_lossy(&bytes));
    if json {
        origin.format = Format::Json;
    }
    origin
}

/// A message says where, and what would be allowed.
fn assert_helpful(error: &ScenarioError, origin: &Origin) {
    let said = error.to_string();
    let context = || format!("{said}\nof\n{}", origin.text);
    let ScenarioError::Refused(refusal) = error else {
        // Files that are not there.
        assert!(said.starts_with("cannot read"), "{}", context());
        return;
    };
    assert!(said.len() < 4000, "{} bytes: {}", said.len(), context());
    let place = &refusal.place;
    assert!(said.starts_with(&place.source), "{}", context());
    let located = place.line.is_some() || said.contains(&place.path.to_string());
    assert!(located, "no place: {}", context());
    if !matches!(*refusal.problem, Problem::Syntax { .. }) {
        let words = [
            "allowed",
            "expected",
            "needed",
            "missing",
            "wanted",
            "has to",
            "give ",
            "did you",
            "at least",
            "at most",
            "must",
            "only",
            "more than",
            "may touch",
            "leave out",
            "no room",
            "overlap",
        ];
        let helps = words.iter().any(|word| said.contains(word));
        assert!(helps, "what is allowed? {}", context());
    }
}

/// How far an input got.
#[derive(Clone, Copy, PartialEq)]
enum Got {
    Nowhere,
    PastParsing,
    Accepted,
}

fn check<const D: usize>(origin: &Origin, scenario: &Scenario) -> Result<(), ScenarioError> {
    let start = Start::<D>::given(origin, scenario)?;
    let (grains, sides) = (start.grains.clone(), start.boundary.clone());
    let settings = scenario.settings();
    let tried = match scenario.gravity {
        Gravity::None => {
            Simulation::with_settings(scenario.floating_model(sides), grains, settings).map(drop)
        }
        _ => Simulation::with_settings(
            scenario.gravity_model(scenario.criterion().unwrap(), sides),
            grains,
            settings,
        )
        .map(drop),
    };
    tried.map_err(|error| start.refuse(origin, scenario, error))
}

/// Makes the grains and runs a few events.
fn run<const D: usize>(origin: &Origin, scenario: &Scenario) -> Result<StopReason, ScenarioError> {
    let start = Start::<D>::new(origin, scenario)?;
    let (grains, sides) = (start.grains.clone(), start.boundary.clone());
    let settings = scenario.settings();
    // What falls out of the world falls for ever.
    let limits = Limits {
        time: Time::from_units(2.0),
        ..Limits::events(300)
    };
    let ran = match scenario.gravity {
        Gravity::None => {
            Simulation::with_settings(scenario.floating_model(sides), grains, settings)
                .map(|mut simulation| simulation.run(&limits, &mut ()))
        }
        _ => Simulation::with_settings(
            scenario.gravity_model(scenario.criterion().unwrap(), sides),
            grains,
            settings,
        )
        .map(|mut simulation| simulation.run(&limits, &mut ())),
    };
    ran.map_err(|error| start.refuse(origin, scenario, error))
}

/// As `grainfall check` does it.
fn try_scenario(origin: &Origin) -> (Got, Option<Scenario>) {
    let scenario = match read_text(origin) {
        Ok(scenario) => scenario,
        Err(refusal) => {
            let parsed = !matches!(
                *refusal.problem,
                Problem::Syntax { .. } | Problem::Schema { .. }
            );
            assert_helpful(&refusal.into(), origin);
            let got = if parsed {
                Got::PastParsing
            } else {
                Got::Nowhere
            };
            return (got, None);
        }
    };
    let checked = match scenario.dimension {
        Dimension::Two => check::<2>(origin, &scenario),
        Dimension::Three => check::<3>(origin, &scenario),
    };
    match checked {
        Ok(()) => (Got::Accepted, Some(scenario)),
        Err(error) => {
            assert_helpful(&error, origin);
            (Got::PastParsing, None)
        }
    }
}

/// Few enough grains to be made and run here.
fn is_small(scenario: &Scenario) -> bool {
    let mut grains = 0;
    for source in &scenario.grains {
        grains += match source.kind() {
            Ok(SourceKind::Base(base)) => {
                let area: f64 = (0..scenario.axes() - 1)
                    .map(|axis| scenario.lateral(axis).map_or(1.0, |(_, length, _)| length))
                    .product();
                let size = base.sizes.smallest().powi(scenario.axes() as i32);
                (2.0 * area * base.thickness / size) as usize
            }
            _ => source.count(),
        };
    }
    grains <= 200
}

fn scenarios(seed: u64, count: u64, runs: u64) {
    let bases = bases();
    let watch = Watch::new(seed);
    let (mut parsed, mut accepted, mut ran, mut refused_late) = (0, 0, 0, 0);
    let mut longest = Duration::ZERO;
    for index in 0..count {
        let rng = &mut watch.random(index);
        let origin = nearly(&bases, rng);
        let begun = Instant::now();
        let (got, scenario) = try_scenario(&origin);
        longest = longest.max(begun.elapsed());
        parsed += u64::from(got != Got::Nowhere);
        accepted += u64::from(got == Got::Accepted);
        let Some(scenario) = scenario.filter(|scenario| ran < runs && is_small(scenario)) else {
            continue;
        };
        ran += 1;
        let begun = Instant::now();
        let done = match scenario.dimension {
            Dimension::Two => run::<2>(&origin, &scenario),
            Dimension::Three => run::<3>(&origin, &scenario),
        };
        if begun.elapsed() > Duration::from_secs(2) {
            println!("input {index} took {:?}:\n{}", begun.elapsed(), origin.text);
        }
        if let Err(error) = done {
            refused_late += 1;
            assert_helpful(&error, &origin);
        }
    }
    println!(
        "scenarios: {count}, past parsing {parsed}, accepted {accepted}, run {ran} \
         ({refused_late} refused while being set up), longest check {longest:?}, peak {:.0} MiB",
        peak_memory()
    );
    assert!(parsed * 10 >= count * 3, "{parsed} of {count}");
    assert!(ran * 2 >= runs, "{ran} run");
    assert!(peak_memory() < 256.0, "{} MiB", peak_memory());
}

const FRAMES: [&str; 4] = [
    "2\nLattice=\"10.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 5.0\" Origin=\"0.0 0.0 0.0\" pbc=\"T F F\" Properties=id:I:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:type:S:1 Time=2.5 dimension=3\n0 1.0 2.0 3.0 0.1 0.2 0.3 0.5 1.0 normal\n1 5.0 2.0 3.0 0.0 0.0 0.0 0.5 1.0 fixed\n",
    "3\ncomment\nAr 0 0 0\nAr 2 0 0\nAr 0 2 0.5\n",
    "1\nProperties=species:S:1:pos:R:3:diameter:R:1 Time=1e3\nHe 1 2 3 0.8\n1\nProperties=pos:R:3\n1 2 3\n",
    "2\nProperties=id:I:1:pos:R:3 dimension=2\n1 0.5 0.25 0\n0 2 2 0\n",
];

fn frames(seed: u64, count: u64) {
    let watch = Watch::new(seed);
    let mut parsed = 0;
    for index in 0..count {
        let rng = &mut watch.random(index);
        let base = FRAMES[rng.random_range(0..FRAMES.len())];
        let mut bytes = mutate_lines(base, rng).into_bytes();
        if rng.random_range(0..6) == 0 {
            mutate_bytes(&mut bytes, rng);
        }
        match XyzReader::new(bytes.as_slice()).last_frame() {
            Ok(frame) => {
                parsed += 1;
                let _ = grainfall::draw::svg(&frame);
                let mut text = Vec::new();
                frame.write(&mut text).unwrap();
                let again = XyzReader::new(text.as_slice()).last_frame().unwrap();
                assert_eq!(again.grains, frame.grains);
            }
            Err(error) => {
                let said = error.to_string();
                let shown = String::from_utf8_lossy(&bytes);
                assert!(said.len() < 400, "{said}\nof\n{shown}");
                let located = said.contains("line ") || matches!(error, XyzError::Empty);
                assert!(located, "where? {said}\nof\n{shown}");
                if let XyzError::Malformed { wanted, .. } = error {
                    assert!(!wanted.is_empty());
                }
            }
        }
    }
    println!(
        "frames: {count}, read {parsed}, peak {:.0} MiB",
        peak_memory()
    );
    assert!(parsed * 10 >= count * 3, "{parsed} of {count}");
    assert!(peak_memory() < 256.0, "{} MiB", peak_memory());
}

#[test]
fn nearly_right_scenarios_are_refused_with_a_place_or_run() {
    scenarios(1, 4000, 20);
}

#[test]
fn nearly_right_frames_are_refused_with_a_line_or_read() {
    frames(1, 20_000);
}

/// cargo test --test program_refusals million -- --ignored --nocapture
#[test]
#[ignore = "a million inputs take many minutes"]
fn a_million_inputs() {
    frames(2, 500_000);
    scenarios(2, 600_000, 500);
}
