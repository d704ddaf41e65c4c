//! A ball that bounces on a floor: Fig. 1 of the paper.

use crate::common::{close, heavy, rule, until, watch};
use grainfall::boundary::Side;
use grainfall::engine::{Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::{Model, OccurrenceKind, StatePolicy};
use grainfall::policy::{Never, SlowDescent};
use grainfall::{Mode, Particle, ParticleId, Time, Vector, WallId};

/// Restitution of the floor, and impact speed at the first bounce, at t = 1.
const FLOOR: f64 = 0.4;

/// A ball at rest half a diameter above a floor.
fn ball<P: StatePolicy<2>>(
    elastic_speed: f64,
    policy: P,
    guards: Guards,
) -> Simulation<impl Model<2>, 2> {
    let model = heavy(
        rule(elastic_speed),
        policy,
        [Side::Open, Side::floor(0.0, FLOOR)],
    );
    let grain = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::zeros());
    let settings = Settings {
        guards,
        ..Settings::default()
    };
    Simulation::with_settings(model, vec![grain], settings).unwrap()
}

/// t* − 1 = 2 α V₀ / ((1 − α) g), here with V₀ = 1.
fn stopping_time() -> f64 {
    2.0 * FLOOR / (1.0 - FLOOR)
}

#[test]
fn bounces_come_when_they_should() {
    let mut simulation = ball(0.0, Never, Guards::none());
    let (why, events) = watch(&mut simulation, &Limits::events(30));
    assert_eq!(why, StopReason::Events);
    let mut speed = 1.0;
    for event in &events {
        assert_eq!(event.kind, OccurrenceKind::Wall);
        assert_eq!(event.wall, Some(WallId(0)));
        let wanted = 1.0 + stopping_time() * (1.0 - speed);
        close(event.time.units() / wanted, 1.0, 1.0e-13, "time of bounce");
        // Counted from the end, so that late bounces are held to it as well.
        let left = Time::from_units(1.0) + stopping_time() - event.time;
        close(left, stopping_time() * speed, 2.0e-15, "time left");
        close(event.impact_speed / speed, 1.0, 1.0e-12, "impact speed");
        speed *= FLOOR;
    }
}

#[test]
fn without_a_cut_off_bounces_collapse_at_the_stopping_time() {
    let mut simulation = ball(0.0, Never, Guards::none());
    let StopReason::Collapse(collapse) = simulation.run(&until(4.0), &mut ()) else {
        panic!("no collapse")
    };
    close(
        collapse.time.units(),
        1.0 + stopping_time(),
        1.0e-11,
        "time of collapse",
    );
    assert_eq!(collapse.particles, [ParticleId(0)]);
    assert_eq!(collapse.collisions, 100_000);
    // And it stays collapsed.
    let again = simulation.run(&until(5.0), &mut ());
    assert_eq!(again, StopReason::Collapse(collapse));
}

#[test]
fn with_a_cut_off_it_bounces_for_ever() {
    let mut simulation = ball(0.005, Never, Guards::default());
    let (why, events) = watch(&mut simulation, &until(4.0));
    assert_eq!(why, StopReason::Time);
    // Impact speeds 1, 0.4, …, 0.01024 lose energy; 0.4⁶ = 0.004096 does not.
    let last_speed = 0.004096;
    let regular = 2.327872;
    for (n, event) in events.iter().enumerate() {
        assert_eq!(event.elastic, n >= 6, "bounce {n}");
        if n >= 6 {
            let wanted = regular + 2.0 * last_speed * (n - 6) as f64;
            close(
                event.time.units(),
                wanted,
                1.0e-12,
                "time of elastic bounce",
            );
            close(event.impact_speed, last_speed, 1.0e-13, "impact speed");
        }
    }
    let elastic = ((4.0 - regular) / (2.0 * last_speed)) as u64 + 1;
    assert_eq!(simulation.counts().elastic, elastic);
    assert_eq!(simulation.counts().wall, elastic + 6);
    assert_eq!(simulation.counts().guard, 0);
}

#[test]
fn below_the_threshold_it_sleeps_half_way() {
    let policy = SlowDescent {
        sleep_speed: 0.01,
        wall_supports: true,
        ..SlowDescent::default()
    };
    let mut simulation = ball(0.0, policy, Guards::default());
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    let wanted = [1.0, 1.8, 2.12, 2.248, 2.2992, 2.31968, 2.327872, 2.3295104];
    assert_eq!(events.len(), wanted.len());
    for (event, time) in events.iter().zip(wanted) {
        close(event.time.units() / time, 1.0, 1.0e-13, "time");
    }
    assert_eq!(events[7].kind, OccurrenceKind::Sleep);
    let height = simulation.particle(ParticleId(0)).position[1] - 0.5;
    // The top of a flight that starts with 0.4 · 0.004096.
    close(height, 0.5 * 0.0016384 * 0.0016384, 1.0e-15, "height");
    close(height, 1.342177e-6, 1.0e-12, "height as the table has it");
    assert_eq!(simulation.particle(ParticleId(0)).mode, Mode::Frozen);
}
