//! The other readings of the paper's criteria: where each differs from the
//! default one.

mod common;

use common::{close, heavy, rule, until, watch};
use grainfall::boundary::Side;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind as Kind, Place};
use grainfall::policy::{Comparison, DescentRead, SlowDescent, SpeedRead, WakeRead};
use grainfall::{Mode, Particle, ParticleId, Vector};

fn grain(x: f64, y: f64, u: f64, v: f64) -> Particle<2> {
    Particle::new(Vector::<2>::new(x, y), Vector::<2>::new(u, v))
}

/// A ball that lands at t = 1 with speed 1 on a floor of restitution 0.4;
/// V_sleep = 0.01.
fn ball(elastic_speed: f64, policy: SlowDescent) -> Simulation<impl Model<2>, 2> {
    let sides = [Side::Open, Side::floor(0.0, 0.4)];
    let model = heavy(rule(elastic_speed), policy, sides);
    Simulation::new(model, vec![grain(0.0, 1.0, 0.0, 0.0)]).unwrap()
}

fn slow_on_floors() -> SlowDescent {
    SlowDescent {
        wall_supports: true,
        ..SlowDescent::with_threshold(0.01)
    }
}

fn asleep_at(policy: SlowDescent) -> (f64, f64) {
    let mut simulation = ball(0.0, policy);
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    let height = simulation.particle(ParticleId(0)).position[1] - 0.5;
    (events.last().unwrap().time.units(), height)
}

#[test]
fn the_leaving_speed_is_slow_one_bounce_earlier() {
    let policy = SlowDescent {
        speed_read: SpeedRead::Leaving,
        ..slow_on_floors()
    };
    // It leaves the sixth bounce, at 2.31968, with 0.004096.
    let (time, _) = asleep_at(policy);
    close(time, 2.31968 + 0.004096, 1.0e-13, "time");
}

#[test]
fn at_the_contact_itself() {
    let policy = SlowDescent {
        place: Place::Here,
        ..slow_on_floors()
    };
    let (time, height) = asleep_at(policy);
    close(time, 2.327872, 1.0e-13, "time");
    close(height, 0.0, 1.0e-15, "height");
}

#[test]
fn read_on_the_leaving_velocity_a_ball_on_a_floor_never_sleeps() {
    for descent_read in [DescentRead::Leaving, DescentRead::Both] {
        let policy = SlowDescent {
            descent_read,
            ..slow_on_floors()
        };
        let mut simulation = ball(1.0e-4, policy);
        assert_eq!(simulation.run(&until(4.0), &mut ()), StopReason::Time);
        assert_eq!(simulation.counts().sleep, 0);
        assert!(simulation.counts().elastic > 1000);
    }
}

#[test]
fn floors_support_only_if_asked_to() {
    let policy = SlowDescent {
        wall_supports: false,
        ..slow_on_floors()
    };
    let mut simulation = ball(1.0e-4, policy);
    assert_eq!(simulation.run(&until(4.0), &mut ()), StopReason::Time);
    assert_eq!(simulation.counts().sleep, 0);
}

/// A ball lands on a fixed grain at 0.08; at the top of its hop one that falls
/// at 0.04 hits it back down, so that it lands again at 0.047. V_sleep = 0.1.
/// Returns the collisions.
fn hit_at_the_top(comparison: Comparison) -> Vec<Occurrence<2>> {
    let landing = 0.08;
    let (hop, height) = (0.4 * landing, 0.5 * landing * landing);
    let top = landing + hop;
    let falling = 0.04;
    let above = 2.0 + 0.5 * hop * hop + falling * top;
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        grain(0.0, 1.0 + height, 0.0, 0.0),
        grain(0.0, above, 0.0, -falling).with_mode(Mode::Falling),
    ];
    let policy = SlowDescent {
        comparison,
        ..SlowDescent::default()
    };
    let model = heavy(rule(0.0), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(0.2));
    let collided = |event: &Occurrence<2>| event.kind != Kind::Sleep;
    events.into_iter().filter(collided).collect()
}

#[test]
fn a_hit_between_counts_only_in_the_comparison_with_any_collision() {
    for (comparison, sleeps) in [
        (Comparison::AnyCollision, false),
        (Comparison::StaticCollisions, true),
    ] {
        let hits = hit_at_the_top(comparison);
        let kinds: Vec<_> = hits.iter().map(|hit| hit.kind).take(3).collect();
        assert_eq!(kinds, [Kind::Frozen, Kind::Pair, Kind::Frozen]);
        close(hits[1].time.units(), 0.08 + 0.032, 1.0e-10, "at the top");
        let again = f64::hypot(0.85 * 0.04, 0.032);
        close(hits[2].impact_speed, again, 1.0e-10, "landing again");
        // Slower than at its last landing, but not than at the hit at the top
        // of its hop, where it was at rest.
        let decided = hits.iter().take(3).map(|hit| hit.reason.is_some());
        assert!(decided.eq([false, false, sleeps]), "{comparison:?}");
    }
}

#[test]
fn without_a_comparison_the_first_slow_contact_does() {
    assert!(hit_at_the_top(Comparison::None)[0].reason.is_some());
}

#[test]
fn the_relative_speed_wakes_where_the_normal_one_does_not() {
    // A grazing hit: 0.09 along the normal, 0.12 across.
    let sleeper = Particle::frozen(Vector::<2>::zeros());
    let start = Vector::<2>::new(-0.12 * 10.0, 1.0 + 0.09 * 10.0);
    let hit = Particle::new(start, Vector::<2>::new(0.12, -0.09)).with_mode(Mode::Falling);
    for (wake_read, kind, speed) in [
        (WakeRead::Normal, Kind::Frozen, 0.09),
        (WakeRead::Relative, Kind::Wake, 0.15),
    ] {
        let policy = SlowDescent {
            wake_read,
            ..SlowDescent::default()
        };
        let model = heavy(rule(0.0), policy, [Side::Open; 2]);
        let mut simulation = Simulation::new(model, vec![sleeper, hit]).unwrap();
        let (_, events) = watch(&mut simulation, &Limits::events(1));
        assert_eq!(events[0].kind, kind);
        close(events[0].time.units(), 10.0, 1.0e-12, "time");
        close(
            events[0].impact_speed,
            0.09,
            1.0e-12,
            "always the normal one",
        );
        if let Some(reason) = events[0].reason {
            close(reason.value, speed, 1.0e-12, "what was compared");
        }
    }
}

#[test]
fn nothing_wakes_with_an_infinite_threshold_and_nobody_sleeps_with_none() {
    let policy = SlowDescent {
        wake_speed: f64::INFINITY,
        sleep_speed: 0.0,
        ..SlowDescent::default()
    };
    let sleeper = Particle::frozen(Vector::<2>::zeros());
    let grains = vec![sleeper, grain(0.0, 50.0, 0.0, -20.0)];
    let model = heavy(rule(1.0e-3), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    simulation.run(&until(200.0), &mut ());
    let counts = simulation.counts();
    assert_eq!((counts.wake, counts.sleep), (0, 0));
    assert!(counts.frozen > 1000);
}

#[test]
fn a_grain_woken_from_rest_does_not_sleep_at_its_first_contact() {
    // A frozen grain hovers a hair above a fixed one. Struck from above it lands
    // on it: at that contact it is slow and goes down. If it was woken at rest
    // its previous speed is 0 and it stays awake.
    let gap = 1.0e-3;
    let grains = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::frozen(Vector::<2>::new(0.0, 1.0 + gap)),
        grain(0.0, 2.5, 0.0, -0.2).with_mode(Mode::Falling),
    ];
    let policy = SlowDescent {
        sleep_speed: 1.0,
        ..SlowDescent::default()
    };
    let model = heavy(rule(0.0), policy, [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &Limits::events(2));
    assert_eq!(events[0].kind, Kind::Wake);
    assert_eq!((events[1].kind, events[1].particle.0), (Kind::Frozen, 1));
    assert!(events[1].impact_speed < 1.0 && events[1].reason.is_none());
}
