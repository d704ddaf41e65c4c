//! Small systems against their exact trajectories, computed with 80 decimal
//! digits by brute force over all pairs.
//!
//! Each case states how many of its leading events a double-precision run can
//! be held to; those must agree in kind and grains, and in time to 1e-6. The
//! final states must agree to 1e-6 where the case says they can. Gravity turns in the
//! cases 14 and 16.

use std::path::Path;

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{TurningGravity, UniformGravity};
use grainfall::engine::{Guards, Limits, Settings, Simulation};
use grainfall::model::{Boundary, Dynamics, Occurrence, Parts, Predictor};
use grainfall::policy::{
    Comparison, DescentRead, EnergyStore, Phase, SelfCheck, SlowDescent, SpeedRead, StoreAt,
    WakeRead,
};
use grainfall::predict::{Polynomial, Turning};
use grainfall::{Mode, Particle, Time, Vector};
use serde_json::Value;

const TOLERANCE: f64 = 1.0e-6;

fn load(folder: &str, name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/oracle")
        .join(folder)
        .join(format!("{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn vector<const D: usize>(value: &Value) -> Vector<D> {
    Vector::from_fn(|axis, _| value[axis].as_f64().unwrap())
}

fn particle<const D: usize>(value: &Value) -> Particle<D> {
    Particle {
        position: vector(&value["position"]),
        velocity: vector(&value["velocity"]),
        diameter: value["diameter"].as_f64().unwrap(),
        mass: value["mass"].as_f64().unwrap(),
        mode: match value["mode"].as_str().unwrap() {
            "normal" => Mode::Normal,
            "rain" => Mode::Falling,
            "frozen" => Mode::Frozen,
            "fixed" => Mode::Fixed,
            other => panic!("mode {other}"),
        },
    }
}

fn side(value: &Value) -> Side {
    match value["type"].as_str().unwrap() {
        "periodic" => Side::Periodic {
            origin: value["origin"].as_f64().unwrap_or(0.0),
            length: value["length"].as_f64().unwrap(),
        },
        "walls" => Side::Walls {
            low: value["lo"].as_f64(),
            high: value["hi"].as_f64(),
            restitution: value["restitution"].as_f64().unwrap(),
        },
        _ => Side::Open,
    }
}

fn rule(parameters: &Value) -> Restitution {
    let alpha = parameters["alpha"].as_f64().unwrap_or(1.0);
    Restitution {
        restitution: alpha,
        frozen_restitution: parameters["alpha_frozen"].as_f64().unwrap_or(alpha),
        elastic_speed: parameters["v_c"].as_f64().unwrap_or(0.0),
        elastic_on_static: true,
    }
}

/// The policy with the switches of the exact runs, whose defaults differ in
/// places from this crate's.
fn policy(parameters: &Value) -> SlowDescent {
    let number = |key: &str| parameters[key].as_f64();
    let flag = |key: &str, default| parameters[key].as_bool().unwrap_or(default);
    let is = |key: &str, name: &str| parameters[key].as_str() == Some(name);
    SlowDescent {
        sleep_speed: if flag("sleep", false) {
            number("v_sleep").unwrap_or(0.0)
        } else {
            0.0
        },
        wake_speed: number("v_wakeup").unwrap_or(f64::INFINITY),
        frozen_restitution: rule(parameters).frozen_restitution,
        energy_store: if !flag("energy_store", false) {
            EnergyStore::Off
        } else if is("reinject", "energy_after") {
            EnergyStore::EnergyAfter
        } else {
            EnergyStore::VelocityBefore
        },
        store_at: if is("store_at", "collision") {
            StoreAt::Deciding
        } else {
            StoreAt::Freezing
        },
        store_time: number("store_time"),
        speed_read: if is("sleep_speed", "pre") {
            SpeedRead::Arriving
        } else {
            SpeedRead::Leaving
        },
        descent_read: if is("sleep_down", "post") {
            DescentRead::Leaving
        } else {
            DescentRead::Arriving
        },
        comparison: if is("sleep_compare", "frozen") {
            Comparison::StaticCollisions
        } else {
            Comparison::AnyCollision
        },
        wake_read: if is("wakeup_speed", "speed") {
            WakeRead::Relative
        } else {
            WakeRead::Normal
        },
        wall_supports: flag("wall_supports", false),
        self_check: number("tau_check").map(|interval| SelfCheck {
            interval,
            support_range: number("support_range").unwrap_or(1.05),
            support_normals: flag("support_normals", true),
            phase: if is("check_clock", "global") {
                Phase::Global
            } else {
                Phase::Own
            },
            unsupported_wakes: false,
            ..SelfCheck::default()
        }),
        keep_history: !flag("reset_history_on_sleep", true),
        ..SlowDescent::default()
    }
}

/// The oracle's name of a wall from its number in the boundary.
fn wall_names(case: &Value) -> Vec<String> {
    let mut names = Vec::new();
    for (axis, side) in case["boundaries"].as_array().unwrap().iter().enumerate() {
        let letter = ["x", "y", "z"][axis];
        for (key, sign) in [("lo", "-"), ("hi", "+")] {
            if side["type"] == "walls" && !side[key].is_null() {
                names.push(format!("{letter}{sign}"));
            }
        }
    }
    names
}

fn run<const D: usize>(name: &str) {
    let case = load("cases", name);
    let gravity = vector(&case["gravity"]);
    let turning = &case["rotating_gravity"];
    if turning.is_null() {
        run_with(name, &case, UniformGravity::<D>::new(gravity), Polynomial);
    } else {
        let axis = |place: usize| turning["plane"][place].as_u64().unwrap() as usize;
        let rate = turning["omega"].as_f64().unwrap();
        let turning = TurningGravity::<D>::new(gravity, rate, [axis(0), axis(1)]);
        run_with(name, &case, turning, Turning);
    }
}

fn run_with<const D: usize, Y: Dynamics<D>, P: Predictor<D, Y::Flight>>(
    name: &str,
    case: &Value,
    dynamics: Y,
    predictor: P,
) {
    let expected = load("expected", name);
    let sides: [Side; D] = std::array::from_fn(|axis| side(&case["boundaries"][axis]));
    let parameters = &case["parameters"];
    let model = Parts {
        dynamics,
        predictor,
        collision_rule: rule(parameters),
        state_policy: policy(parameters),
        boundary: Cuboid::new(sides).unwrap(),
    };
    let boundary = model.boundary.clone();
    let grains = case["grains"].as_array().unwrap();
    let settings = Settings {
        guards: Guards::none(),
        sleep_horizon: parameters["sleep_horizon"].as_f64().unwrap_or(1000.0),
        ..Settings::default()
    };
    let particles = grains.iter().map(particle).collect();
    let mut simulation = Simulation::with_settings(model, particles, settings).unwrap();
    // The last event is at the last instant, to within rounding.
    let (time, events) = if expected["status"] == "max_time" {
        let end = expected["t_end"].as_f64().unwrap();
        (Time::from_units(end), u64::MAX)
    } else {
        (Time::NEVER, expected["n_events"].as_u64().unwrap())
    };
    let limits = Limits {
        time,
        events,
        all_frozen: false,
    };
    let mut events: Vec<Occurrence<D>> = Vec::new();
    simulation.run(&limits, &mut |event: &Occurrence<D>| events.push(*event));

    let walls = wall_names(case);
    let comparable = expected["comparable_events"].as_u64().unwrap() as usize;
    assert!(events.len() >= comparable, "{} events only", events.len());
    for (place, (event, wanted)) in events
        .iter()
        .zip(expected["events"].as_array().unwrap())
        .take(comparable)
        .enumerate()
    {
        let found = (
            event.kind.name(),
            Some(u64::from(event.particle.0)),
            event.other.map(|id| u64::from(id.0)),
            event.wall.map(|id| walls[id.index()].as_str()),
        );
        let exact = (
            wanted["kind"].as_str().unwrap(),
            wanted["i"].as_u64(),
            wanted["j"].as_u64(),
            wanted["wall"].as_str(),
        );
        let time = wanted["t"].as_f64().unwrap();
        assert_eq!(found, exact, "event {place} of {name} at {time}");
        let late = event.time.units() - time;
        assert!(
            late.abs() < TOLERANCE,
            "event {place} of {name} is late by {late}"
        );
        if let Some(speed) = wanted["impact_speed"].as_f64() {
            let off = event.impact_speed - speed;
            let deviation = expected["impact_speed_deviation"].as_f64().unwrap();
            let allowed = TOLERANCE.max(10.0 * deviation);
            assert!(
                off.abs() < allowed,
                "event {place} of {name}: speed off by {off}"
            );
        }
    }
    if expected["final_comparable"].as_bool().unwrap() {
        let state = simulation.snapshot();
        for (id, (found, wanted)) in state
            .iter()
            .zip(expected["final"].as_array().unwrap())
            .enumerate()
        {
            let exact = particle_final::<D>(wanted);
            let off = boundary.displacement(&exact.0, &found.position).norm();
            assert!(off < TOLERANCE, "grain {id} of {name} is off by {off}");
            let off = (found.velocity - exact.1).norm();
            assert!(
                off < TOLERANCE,
                "grain {id} of {name}: velocity off by {off}"
            );
            assert_eq!(found.mode.name(), exact.2, "grain {id} of {name}");
        }
    }
}

fn particle_final<const D: usize>(value: &Value) -> (Vector<D>, Vector<D>, &str) {
    let mode = match value["mode"].as_str().unwrap() {
        "rain" => "falling",
        other => other,
    };
    (vector(&value["position"]), vector(&value["velocity"]), mode)
}

macro_rules! oracle {
    ($($test:ident: $dimension:literal, $name:literal;)*) => {
        $(#[test]
        fn $test() {
            run::<$dimension>($name);
        })*
    };
}

oracle! {
    oracle_01_gas2d_elastic: 2, "01_gas2d_elastic";
    oracle_02_gas3d_elastic: 3, "02_gas3d_elastic";
    oracle_04_gas3d_inelastic: 3, "04_gas3d_inelastic";
    oracle_05_floor2d: 2, "05_floor2d";
    oracle_07_poly2d_box: 2, "07_poly2d_box";
    oracle_09_rain2d: 2, "09_rain2d";
    oracle_11_pile2d_hit: 2, "11_pile2d_hit";
    oracle_13_arch2d: 2, "13_arch2d";
    oracle_14_drum2d: 2, "14_drum2d";
    oracle_16_selfcheck: 2, "16_selfcheck2d";
    oracle_17_sleep_floor2d: 2, "17_sleep_floor2d";
    oracle_18_switch_base: 2, "18_switch_base";
    oracle_19_switch_sleep_speed: 2, "19_switch_sleep_speed";
    oracle_22_switch_store_at: 2, "22_switch_store_at";
    oracle_24_switch_reinject: 2, "24_switch_reinject";
    oracle_26_store2d: 2, "26_store2d";
}
