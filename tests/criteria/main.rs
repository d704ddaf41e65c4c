//! The gallery of sleep criteria: what each does, in scenes with known answers,
//! and that none of it depends on how it is packed or interrupted.
#![cfg(feature = "program")]

#[path = "../common/mod.rs"]
mod common;

mod compare;
mod why;

use common::{Heavy, close, heavy, periodic_laterally, rule, until, watch};
use grainfall::boundary::Side;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind as Kind, Place, StatePolicy};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{
    AtRest, Criterion, DisplacementWindow, DynamoSleep, GranularTemperature, IsostaticSupport,
    Never, SelfCheck, SlowDescent, VelocityVariance,
};
use grainfall::scenario::{Origin, built_in_criteria, read_text};
use grainfall::setup::{Rain, seeded};
use grainfall::{Mode, Particle, ParticleId, Vector};

/// All criteria with their defaults, by their names.
fn gallery() -> Vec<(&'static str, Criterion)> {
    let all = [
        Criterion::SlowDescent(SlowDescent::default()),
        Criterion::IsostaticSupport(IsostaticSupport::default()),
        Criterion::DisplacementWindow(AtRest::new(DisplacementWindow::default())),
        Criterion::VelocityVariance(AtRest::new(VelocityVariance::default())),
        Criterion::GranularTemperature(AtRest::new(GranularTemperature::default())),
        Criterion::DynamoSleep(AtRest {
            wake_speed: 0.0,
            store_time: 0.0,
            place: Place::Here,
            ..AtRest::new(DynamoSleep::default())
        }),
        Criterion::Never,
    ];
    let names = built_in_criteria().iter().map(|known| known.name);
    assert_eq!(names.len(), all.len());
    names.zip(all).collect()
}

/// A small rain on a square lattice of fixed grains, of width 6 in the plane and
/// 3 in space.
fn rain<S: StatePolicy<D>, const D: usize>(policy: S) -> Simulation<Heavy<S, D>, D> {
    let wide: u32 = if D == 2 { 6 } else { 3 };
    let width = f64::from(wide);
    let place = |number: u32| {
        let mut left = number;
        Vector::<D>::from_fn(|axis, _| {
            let along = left % wide;
            left /= wide;
            if axis + 1 < D {
                f64::from(along) + 0.5
            } else {
                0.0
            }
        })
    };
    let across = (1..D as u32).fold(1, |all, _| all * wide);
    let mut grains: Vec<Particle<D>> = (0..across).map(place).map(Particle::fixed).collect();
    let mut lengths = Vector::repeat(width);
    lengths[D - 1] = 0.0;
    let mut above = Rain::<D> {
        count: 12,
        lengths,
        packing_fraction: 0.1,
        ..Rain::default()
    };
    above.origin[D - 1] = 0.5;
    grains.extend(above.grains(&mut seeded(1)).unwrap());
    let model = heavy(rule(1.0e-3), policy, periodic_laterally(width));
    Simulation::new(model, grains).unwrap()
}

/// A line on how the rain has gone by t = 30, or 30 000 events.
fn line<const D: usize>(name: &str, criterion: Criterion) -> String {
    let mut simulation = rain::<_, D>(criterion);
    let mut hash = TrajectoryHash::new();
    let limits = Limits {
        all_frozen: true,
        events: 30_000,
        ..until(30.0)
    };
    simulation.run(&limits, &mut hash);
    let counts = simulation.counts();
    format!(
        "{name:20} {D}D {:6} events {:4} sleeps {:4} wakes {:2} awake {:016x}\n",
        counts.total(),
        counts.sleep,
        counts.wake,
        simulation.mode_counts().normal,
        hash.value()
    )
}

#[test]
fn trajectories_of_all_criteria() {
    let mut table = String::new();
    for (name, criterion) in gallery() {
        table += &line::<2>(name, criterion);
        table += &line::<3>(name, criterion);
    }
    insta::assert_snapshot!(table, @r"
    slow_descent         2D  12188 events   89 sleeps   77 wakes  0 awake 55907bbba8059e57
    slow_descent         3D   9379 events   50 sleeps   38 wakes  0 awake 3396a54f4ae41f50
    isostatic_support    2D  13384 events   83 sleeps   71 wakes  0 awake f08210d86deae891
    isostatic_support    3D   5316 events   58 sleeps   46 wakes  0 awake 2ba6a58d7b529fc6
    displacement_window  2D  30000 events   10 sleeps    7 wakes  9 awake eaaba3a5ef2db3c5
    displacement_window  3D  30000 events    6 sleeps    2 wakes  8 awake 7f6d63fda84be791
    velocity_variance    2D  30000 events    2 sleeps    2 wakes 12 awake f5fc5ea2373231c9
    velocity_variance    3D  30000 events   36 sleeps   32 wakes  8 awake 40175920eccf9454
    granular_temperature 2D  30000 events    0 sleeps    0 wakes 12 awake 53abbef39106457e
    granular_temperature 3D  30000 events    2 sleeps    1 wakes 11 awake f7f0bd415a25bb6c
    dynamo_sleep         2D  30000 events  109 sleeps  109 wakes 12 awake 55d9d57521c7d398
    dynamo_sleep         3D  30000 events  748 sleeps  744 wakes  8 awake 45d0d67992339688
    never                2D  30000 events    0 sleeps    0 wakes 12 awake 53abbef39106457e
    never                3D  30000 events    0 sleeps    0 wakes 12 awake 8abb5f1201e05fbc
    ");
}

fn hash_of<M: Model<D>, const D: usize>(mut simulation: Simulation<M, D>, events: u64) -> u64 {
    common::hash(&mut simulation, &Limits::events(events))
}

#[test]
fn one_type_for_all_does_what_each_does() {
    let enough = 3000;
    let [
        descent,
        isostatic,
        displacement,
        variance,
        temperature,
        dynamo,
        never,
    ] = gallery().try_into().unwrap_or_else(|_| panic!());
    let whole = |(_, criterion): (_, Criterion)| hash_of(rain::<_, 2>(criterion), enough);
    assert_eq!(
        whole(descent),
        hash_of(rain::<_, 2>(SlowDescent::default()), enough)
    );
    let alone = rain::<_, 2>(IsostaticSupport::default());
    assert_eq!(whole(isostatic), hash_of(alone, enough));
    let alone = rain::<_, 2>(AtRest::new(DisplacementWindow::default()));
    assert_eq!(whole(displacement), hash_of(alone, enough));
    let alone = rain::<_, 2>(AtRest::new(VelocityVariance::default()));
    assert_eq!(whole(variance), hash_of(alone, enough));
    let alone = rain::<_, 2>(AtRest::new(GranularTemperature::default()));
    assert_eq!(whole(temperature), hash_of(alone, enough));
    let Criterion::DynamoSleep(alone) = dynamo.1 else {
        panic!()
    };
    assert_eq!(whole(dynamo), hash_of(rain::<_, 2>(alone), enough));
    assert_eq!(whole(never), hash_of(rain::<_, 2>(Never), enough));
}

/// Written down at any event and read again, a run goes on as if nothing had
/// been: memories are saved whole.
#[test]
fn a_restored_run_is_the_same_run_for_every_criterion() {
    let checked = |criterion| match criterion {
        Criterion::DisplacementWindow(policy) => Criterion::DisplacementWindow(AtRest {
            self_check: Some(SelfCheck::default()),
            ..policy
        }),
        other => other,
    };
    for (name, criterion) in gallery() {
        let criterion = checked(criterion);
        let mut whole = rain::<_, 3>(criterion);
        let mut hash = TrajectoryHash::new();
        whole.run(&Limits::events(1200), &mut hash);
        for first in [1, 777] {
            let mut part = rain::<_, 3>(criterion);
            let mut again = TrajectoryHash::new();
            part.run(&Limits::events(first), &mut again);
            let saved = postcard::to_stdvec(&part.save()).unwrap();
            let read = postcard::from_bytes(&saved).unwrap();
            let model = heavy(rule(1.0e-3), criterion, periodic_laterally::<3>(3.0));
            let mut part = Simulation::restore(model, read).unwrap();
            part.run(&Limits::events(1200), &mut again);
            assert_eq!(again.value(), hash.value(), "{name}, cut at {first}");
        }
    }
}

/// A ball above a fixed grain: it lands at t = 1, 1.8, 2.12, 2.248, 2.2992 …
/// with 1, 0.4, 0.16, 0.064, 0.0256 …
fn bouncing<S: StatePolicy<2>>(policy: S, elastic_speed: f64) -> Vec<Occurrence<2>> {
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 1.5), Vector::zeros()),
    ];
    let model = heavy(rule(elastic_speed), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let limits = Limits {
        all_frozen: true,
        events: 500,
        ..until(3.0)
    };
    watch(&mut simulation, &limits).1
}

#[test]
fn the_window_of_displacements_sees_the_top_of_a_bounce() {
    // Bounces are lower than 0.005 d from the third on; the fourth comes 0.128
    // later, which is longer than the window.
    let policy = AtRest::new(DisplacementWindow::default());
    let events = bouncing(policy, 0.0);
    assert_eq!(events.len(), 5);
    let decided = events[3].reason.unwrap();
    assert_eq!(decided.condition, "within ε for longer than τ");
    close(decided.value, 0.128, 1.0e-12, "stayed");
    // Half-way through the flight of 0.0512 that follows.
    close(events[4].time.units(), 2.248 + 0.0256, 1.0e-12, "asleep");
    // A window that is longer than all that is left of the collapse is not
    // filled before, and V_c ends the collapse.
    let policy = AtRest::new(DisplacementWindow {
        window: 0.3,
        ..DisplacementWindow::default()
    });
    assert_eq!(bouncing(policy, 1.0e-3).last().unwrap().kind, Kind::Sleep);
}

#[test]
fn the_variance_needs_a_window_with_collisions() {
    let policy = AtRest::new(VelocityVariance::default());
    let events = bouncing(policy, 1.0e-3);
    let asleep = events.last().unwrap();
    assert_eq!(asleep.kind, Kind::Sleep);
    let decided = events[events.len() - 2].reason.unwrap();
    // The window that began with the fourth bounce holds the fifth and all
    // that follow: about a mean v̄ their squares deviate by ⟨v²⟩ − v̄².
    let arrivals: Vec<f64> = events[4..events.len() - 1]
        .iter()
        .map(|event| event.impact_speed)
        .collect();
    let number = arrivals.len() as f64;
    let mean = arrivals.iter().sum::<f64>() / number;
    let square = arrivals.iter().map(|v| v * v).sum::<f64>() / number;
    close(
        decided.value,
        (square - mean * mean).sqrt(),
        1.0e-12,
        "deviation",
    );
    assert!(asleep.time.units() > 2.248 + 0.1);
}

#[test]
fn dynamo_takes_a_ball_that_goes_up_for_one_at_rest() {
    // Twice in one place, and going up: asleep at its second bounce, with 0.16,
    // which no other criterion would do.
    let (_, criterion) = gallery().swap_remove(5);
    let events = bouncing(criterion, 0.0);
    let kinds: Vec<Kind> = events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [Kind::Frozen, Kind::Frozen, Kind::Sleep]);
    close(events[2].time.units(), 1.8, 1.0e-13, "at once");
    close(events[2].impulse[1], -0.16, 1.0e-13, "what it loses");
    // The slightest hit wakes it.
    let grains = vec![
        Particle::frozen(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 2.0), Vector::<2>::new(0.0, -1.0e-6))
            .with_mode(Mode::Falling),
    ];
    let model = heavy(rule(0.0), criterion, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &Limits::events(1));
    assert_eq!(events[0].kind, Kind::Wake);
}

/// A grain between two fixed ones, `gap` above where it touches both.
fn in_a_pit<S: StatePolicy<2>>(policy: S, gap: f64) -> Simulation<Heavy<S, 2>, 2> {
    let half: f64 = 0.6;
    let height = (1.0 - half * half).sqrt();
    let grains = vec![
        Particle::fixed(Vector::<2>::new(-half, 0.0)),
        Particle::fixed(Vector::<2>::new(half, 0.0)),
        Particle::new(Vector::<2>::new(1.0e-9, height + gap), Vector::<2>::zeros()),
    ];
    let model = heavy(rule(0.15), policy, [Side::Open; 2]);
    Simulation::new(model, grains).unwrap()
}

#[test]
fn a_rattler_in_a_pit_is_held() {
    // All its contacts are below V_c = 0.15, so elastic: for the paper's criteria
    // it is never slower than before, but for chance; for a pit that is nothing.
    let isostatic = IsostaticSupport::default();
    let mut simulation = in_a_pit(isostatic, 1.0e-4);
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    let reason = events[0].reason.unwrap();
    assert_eq!(reason.condition, "static contacts that hold the weight");
    assert_eq!((reason.value, reason.limit), (2.0, 2.0));
    assert_eq!(events.len(), 2, "asleep after its first contact");

    // On top of one grain, a perch: never, as for the paper's.
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::new(Vector::<2>::new(0.0, 1.0 + 1.0e-4), Vector::zeros()),
    ];
    let model = heavy(rule(0.15), isostatic, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    simulation.run(&Limits::events(2000), &mut ());
    assert_eq!(simulation.counts().sleep, 0);

    // Between two grains that are both on one side: a slope.
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::fixed(Vector::<2>::new(-0.9, -0.95)),
        Particle::new(Vector::<2>::new(-0.6, 0.8), Vector::<2>::zeros()),
    ];
    let model = heavy(rule(0.15), isostatic, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &Limits::events(50));
    assert!(events.iter().all(|event| event.reason.is_none()));
}

#[test]
fn a_cold_neighbourhood_is_one_that_moves_alike() {
    // Five grains touch a sixth that hovers between them; all but it are fixed,
    // and it comes down at 0.02: T = (v²/6 − (v/6)²)/2 = 2.8e-5 with its leaving
    // 0.4 v, so cold; at 0.3 it is warm.
    for (speed, sleeps) in [(0.02, true), (0.3, false)] {
        let mut grains: Vec<Particle<2>> = [-0.5, 0.5]
            .iter()
            .map(|&x| Particle::fixed(Vector::<2>::new(x, -0.87)))
            .collect();
        grains.extend(
            [(-1.05, 0.0), (1.05, 0.0), (0.0, 1.1)]
                .map(|(x, y)| Particle::fixed(Vector::<2>::new(x, y))),
        );
        grains.push(
            Particle::new(Vector::<2>::new(0.0, 0.01), Vector::<2>::new(0.0, -speed))
                .with_mode(Mode::Falling),
        );
        let policy = AtRest::new(GranularTemperature::default());
        let model = heavy(rule(0.0), policy, [Side::Open; 2]);
        let mut simulation = Simulation::new(model, grains).unwrap();
        let (_, events) = watch(&mut simulation, &Limits::events(1));
        let leaving = simulation.particle(ParticleId(5)).velocity.norm_squared();
        match events[0].reason {
            Some(reason) => {
                let temperature = 0.5 * (leaving / 6.0 - leaving / 36.0);
                close(reason.value, temperature, 1.0e-15, "temperature");
                assert!(sleeps);
            }
            None => assert!(!sleeps),
        }
    }
}

#[test]
fn scenarios_name_criteria() {
    let text = "dimension = 2\ngrains = [{ position = [0, 0] }]\nstop.time = 1\n";
    let read = |more: &str| read_text(&Origin::toml("test", &format!("{text}{more}")));
    for (name, criterion) in gallery() {
        let scenario = read(&format!("sleep.criterion = \"{name}\"\n")).unwrap();
        assert_eq!(scenario.criterion(), Some(criterion), "{name}");
        // What was left out stands there now.
        let written = toml_of(&scenario);
        assert_eq!(
            read_text(&Origin::toml("again", &written)).unwrap(),
            scenario
        );
    }
    let scenario = read(
        "sleep.criterion = \"displacement_window\"\ncriteria.displacement_window.window = 2\n",
    );
    let Some(Criterion::DisplacementWindow(policy)) = scenario.unwrap().criterion() else {
        panic!()
    };
    assert_eq!(
        (policy.condition.window, policy.condition.distance),
        (2.0, 0.005)
    );
    let refusals: Vec<String> = [
        "sleep.criterion = \"isostatic_suport\"",
        "criteria.displacement_window.widow = 2",
        "criteria.velocity_variance.window = 0",
        "criteria.granular_temperature.temperature = \"low\"",
        "criteria.mine.speed = 1",
    ]
    .iter()
    .map(|more| read(more).unwrap_err().to_string())
    .map(|refusal| refusal.lines().next().unwrap_or_default().to_owned())
    .collect();
    insta::assert_snapshot!(refusals.join("\n"), @r#"
    test:4:19: sleep.criterion: there is no criterion `isostatic_suport`; there are slow_descent, isostatic_support, displacement_window, velocity_variance, granular_temperature, dynamo_sleep, never; did you mean `isostatic_support`?
    test:4:30: criteria.displacement_window.widow: unknown key `widow`, expected `distance` or `window`; did you mean `window`?
    test:4:37: criteria.velocity_variance.window is 0; a number greater than 0 is allowed
    test:4:45: criteria.granular_temperature.temperature: invalid type: string "low", expected a number
    test:4:10: criteria.mine: there is no criterion `mine`; there are slow_descent, isostatic_support, displacement_window, velocity_variance, granular_temperature, dynamo_sleep, never
    "#);
}

fn toml_of(scenario: &grainfall::scenario::Scenario) -> String {
    // JSON is TOML's twin here: one schema for both.
    let json = serde_json::to_value(scenario).unwrap();
    let table: std::collections::BTreeMap<String, serde_json::Value> =
        serde_json::from_value(json).unwrap();
    let mut text = String::new();
    for (key, value) in table {
        text += &format!("{key} = {}\n", inline(&value));
    }
    text
}

fn inline(value: &serde_json::Value) -> String {
    use serde_json::Value;
    match value {
        Value::Object(entries) => {
            let entries: Vec<String> = entries
                .iter()
                .map(|(key, value)| format!("{key} = {}", inline(value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(inline).collect();
            format!("[{}]", values.join(", "))
        }
        other => other.to_string(),
    }
}
