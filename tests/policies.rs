//! Who falls asleep and who wakes under the built-in policy, by scenes of a few
//! grains.

mod common;

use common::{close, heavy, rule, until, watch};
use grainfall::boundary::Side;
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Model, Occurrence, OccurrenceKind as Kind, StatePolicy};
use grainfall::policy::{Criterion, EnergyStore, SlowDescent, StoreAt};
use grainfall::{Mode, Particle, ParticleId, Vector};

/// A grain in the plane.
fn grain(x: f64, y: f64, u: f64, v: f64) -> Particle<2> {
    Particle::new(Vector::<2>::new(x, y), Vector::<2>::new(u, v))
}

/// One that keeps its velocity until it hits something.
fn missile(x: f64, y: f64, u: f64, v: f64) -> Particle<2> {
    grain(x, y, u, v).with_mode(Mode::Falling)
}

/// The paper's rule without a cut-off, in a world without walls.
fn in_the_open(policy: SlowDescent, grains: Vec<Particle<2>>) -> Simulation<impl Model<2>, 2> {
    Simulation::new(heavy(rule(0.0), policy, [Side::Open; 2]), grains).unwrap()
}

/// The same above a floor at 0 that supports, of restitution 0.4.
fn on_a_floor(policy: SlowDescent, grains: Vec<Particle<2>>) -> Simulation<impl Model<2>, 2> {
    let policy = SlowDescent {
        wall_supports: true,
        ..policy
    };
    let sides = [Side::Open, Side::floor(0.0, 0.4)];
    Simulation::new(heavy(rule(0.0), policy, sides), grains).unwrap()
}

fn of_kind(events: &[Occurrence<2>], kind: Kind) -> Vec<Occurrence<2>> {
    let picked = events.iter().filter(|event| event.kind == kind);
    picked.copied().collect()
}

/// A ball above a fixed grain, on which it lands at t = 1 with speed 1; V_sleep
/// = 0.01. It slows down below that at its seventh bounce, at 2.327872, which it
/// leaves with 0.0016384.
fn ball_on_grain() -> Vec<Particle<2>> {
    vec![
        Particle::fixed(Vector::<2>::zeros()),
        grain(0.0, 1.5, 0.0, 0.0),
    ]
}
const SEVENTH: f64 = 2.327872;
const LEAVING: f64 = 0.0016384;

/// It is kept for every grain, asleep or not.
#[cfg(target_pointer_width = "64")]
#[test]
fn what_the_papers_criterion_remembers_is_short() {
    assert!(size_of::<<SlowDescent as StatePolicy<3>>::Memory>() <= 72);
    assert!(size_of::<<Criterion as StatePolicy<3>>::Memory>() <= 72);
}

#[test]
fn it_sleeps_half_way_to_its_next_collision() {
    let mut simulation = in_the_open(SlowDescent::with_threshold(0.01), ball_on_grain());
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    assert_eq!(events.len(), 8);
    let decided = events[6].reason.unwrap();
    assert_eq!(decided.condition, "speed below V_sleep");
    close(decided.value, 0.004096, 1.0e-14, "speed");
    close(decided.limit, 0.01, 0.0, "V_sleep");
    assert!(events[5].reason.is_none());
    let asleep = &events[7];
    assert_eq!((asleep.kind, asleep.particle.0), (Kind::Sleep, 1));
    close(asleep.time.units(), SEVENTH + LEAVING, 1.0e-13, "time");
    let place = simulation.particle(ParticleId(1)).position[1];
    close(place, 1.0 + 0.5 * LEAVING * LEAVING, 1.0e-15, "place");
}

#[test]
fn a_collision_before_cancels_the_sleep() {
    // A grain hovers 1e-4 beside it. Struck when the sleep has been decided and
    // not yet begun, it is pushed over: nothing that could be foreseen.
    let (gap, speed) = (1.0e-4, 0.5);
    let strike = SEVENTH + 0.25 * LEAVING;
    let mut grains = ball_on_grain();
    grains.push(missile(1.0 + gap, 1.0, 0.0, 0.0));
    grains.push(missile(2.0 + gap + speed * strike, 1.0, -speed, 0.0));
    let mut simulation = in_the_open(SlowDescent::with_threshold(0.01), grains);
    let (_, events) = watch(&mut simulation, &until(SEVENTH + 1.5 * LEAVING));
    assert!(events[6].reason.is_some(), "it was to sleep");
    assert_eq!(events[7].other, Some(ParticleId(3)), "the strike");
    assert_eq!(events[8].particle, ParticleId(1), "the push");
    let pushed = strike + gap / (0.85 * speed);
    close(events[8].time.units(), pushed, 1.0e-8, "the push");
    assert!(of_kind(&events, Kind::Sleep).is_empty());
    assert_eq!(simulation.particle(ParticleId(1)).mode, Mode::Normal);

    // A collision that can be foreseen only brings the sleep forward: it is at
    // half the time to that.
    let hit = SEVENTH + 0.5 * LEAVING;
    let height = 1.0 + 0.375 * LEAVING * LEAVING;
    let mut grains = ball_on_grain();
    grains.push(missile(0.0, height + 1.0 + speed * hit, 0.0, -speed));
    let mut simulation = in_the_open(SlowDescent::with_threshold(0.01), grains);
    let (_, events) = watch(&mut simulation, &Limits::events(8));
    assert_eq!(events[7].kind, Kind::Sleep);
    let asleep = events[7].time.units();
    close(asleep, SEVENTH + 0.25 * LEAVING, 1.0e-12, "earlier");
}

#[test]
fn without_a_next_collision_it_does_not_sleep() {
    // Thrown up against one grain it comes down beside another, slowly and
    // slower than it went up; grazes it, and never meets anything again.
    let grains = vec![
        Particle::fixed(Vector::<2>::new(0.0, 2.0)),
        Particle::fixed(Vector::<2>::new(0.995, 0.85)),
        grain(0.0, 0.99, 0.0, 0.424),
    ];
    let mut simulation = in_the_open(SlowDescent::with_threshold(0.5), grains);
    let (why, events) = watch(&mut simulation, &until(100.0));
    assert_eq!(why, StopReason::Time);
    assert_eq!(events.len(), 2);
    assert!(events[1].reason.is_some(), "it was to sleep");
    assert_eq!(simulation.particle(ParticleId(2)).mode, Mode::Normal);
}

#[test]
fn at_the_top_of_a_flight_nobody_sleeps() {
    // Thrown up gently, alone: at rest for an instant.
    let policy = SlowDescent::default();
    let mut simulation = in_the_open(policy, vec![grain(0.0, 0.0, 0.0, 0.05)]);
    assert_eq!(simulation.run(&until(1.0), &mut ()), StopReason::Time);
    assert_eq!(simulation.mode_counts().normal, 1);

    // A slow contact with a fixed grain overhead is no reason either, though
    // slower than the one before; nor is one on the way along.
    let mut falls = vec![
        Particle::fixed(Vector::<2>::zeros()),
        Particle::fixed(Vector::<2>::new(0.0, 2.0005)),
        grain(0.0, 1.0002, 0.0, 0.08),
    ];
    let mut simulation = in_the_open(policy, falls.clone());
    let (_, events) = watch(&mut simulation, &Limits::events(2));
    assert_eq!(events[0].other, Some(ParticleId(1)), "first overhead");
    assert!(events[0].reason.is_none());
    // Coming down from there it does sleep: slower than before.
    assert_eq!(events[1].other, Some(ParticleId(0)));
    assert!(events[1].impact_speed < 0.08);
    assert!(events[1].reason.is_some());
    // The other way round: it hits below first, is slower above.
    falls[2] = grain(0.0, 1.0002, 0.0, -0.08);
    let mut simulation = in_the_open(policy, falls);
    let (_, events) = watch(&mut simulation, &Limits::events(2));
    assert_eq!(events[1].other, Some(ParticleId(1)), "then overhead");
    assert!(events[1].impact_speed < 0.08);
    assert!(events[1].reason.is_none());
}

#[test]
fn a_first_contact_puts_nobody_to_sleep() {
    // No previous collision, however slow.
    let mut grains = ball_on_grain();
    grains[1] = grain(0.0, 1.0 + 1.0e-4, 0.0, 0.0);
    let mut simulation = in_the_open(SlowDescent::default(), grains);
    let (_, events) = watch(&mut simulation, &Limits::events(2));
    assert!(events[0].impact_speed < 0.1 && events[0].reason.is_none());
    assert!(events[1].impact_speed < events[0].impact_speed);
    assert!(events[1].reason.is_some());
}

#[test]
fn elastic_bounces_are_equally_fast() {
    // Below V_c = 0.15 nothing is lost, so no landing is slower than the one
    // before, whatever rounding makes of its last digits; and slow they are.
    for step in 0..200 {
        let height = 1.0e-3 + 1.0e-4 * f64::from(step) / 7.0;
        let grains = vec![
            Particle::fixed(Vector::<2>::new(0.3, 0.1)),
            grain(0.3, 1.1 + height, 0.0, 0.0),
        ];
        let policy = SlowDescent::with_threshold(0.2);
        let model = heavy(rule(0.15), policy, [Side::Open; 2]);
        let mut simulation = Simulation::new(model, grains).unwrap();
        assert_eq!(
            simulation.run(&Limits::events(40), &mut ()),
            StopReason::Events
        );
        assert_eq!(simulation.counts().elastic, 40);
        assert_eq!(simulation.counts().sleep, 0, "from {height} d");
    }
    // What V_c is in earnest: 5e-9 d high.
    let grains = vec![
        Particle::fixed(Vector::<2>::new(0.3, 0.1)),
        grain(0.3, 1.1 + 4.0e-9, 0.0, 0.0),
    ];
    let model = heavy(rule(1.0e-4), SlowDescent::default(), [Side::Open; 2]);
    let mut simulation = Simulation::new(model, grains).unwrap();
    let why = simulation.run(&Limits::events(10_000), &mut ());
    assert_eq!(why, StopReason::Events);
    assert_eq!(simulation.counts().sleep, 0);
}

#[test]
fn a_hit_wakes_if_its_normal_speed_is_above_the_threshold() {
    for (speed, wakes) in [(0.1 * (1.0 + 1.0e-12), true), (0.1, false), (0.0999, false)] {
        let sleeper = Particle::frozen(Vector::<2>::zeros());
        let mut simulation = in_the_open(
            SlowDescent::default(),
            vec![sleeper, missile(0.0, 2.0, 0.0, -speed)],
        );
        let (_, events) = watch(&mut simulation, &Limits::events(1));
        let event = &events[0];
        close(event.time.units(), 1.0 / speed, 1.0e-13, "time");
        assert_eq!((event.particle.0, event.other.unwrap().0), (1, 0));
        if wakes {
            assert_eq!(event.kind, Kind::Wake);
            assert_eq!(event.reason.unwrap().condition, "hit faster than V_wakeup");
            // As normal grains of equal masses with α = 0.7.
            close(event.velocity[1], -0.15 * speed, 1.0e-15, "the hitting");
            close(event.other_velocity[1], -0.85 * speed, 1.0e-15, "the woken");
            assert_eq!(simulation.mode_counts().normal, 2);
        } else {
            assert_eq!(event.kind, Kind::Frozen);
            close(event.velocity[1], 0.4 * speed, 1.0e-15, "the hitting");
            assert_eq!(event.other_velocity, Vector::<2>::zeros());
            assert_eq!(simulation.mode_counts().frozen, 1);
        }
    }
    // Fixed ones never wake.
    let never = Particle::fixed(Vector::<2>::zeros());
    let grains = vec![never, missile(0.0, 2.0, 0.0, -50.0)];
    let mut simulation = in_the_open(SlowDescent::default(), grains);
    let (_, events) = watch(&mut simulation, &Limits::events(1));
    assert_eq!(events[0].kind, Kind::Frozen);
}

/// Drift of the sleeper below while it bounced.
const DRIFT: f64 = 0.05;

/// A ball hops along a floor, drifting, and falls asleep at the top of a hop,
/// with the velocity (0.05, 0), at the time and place returned, less than 0.01 d
/// above the floor. V_sleep = 0.08.
fn hopper(policy: SlowDescent) -> (f64, Particle<2>) {
    let hop = grain(0.0, 0.52, DRIFT, 0.0);
    let mut simulation = on_a_floor(policy, vec![hop]);
    let (_, events) = watch(&mut simulation, &Limits::all_frozen());
    let asleep = events.last().unwrap();
    close(asleep.impulse[0], -DRIFT, 1.0e-15, "what it loses");
    close(asleep.impulse[1], 0.0, 1.0e-14, "what it loses");
    (asleep.time.units(), simulation.particle(ParticleId(0)))
}

/// The hit of the hopper from above, a time after it fell asleep.
fn hit_after(policy: SlowDescent, wait: f64, speed: f64) -> Occurrence<2> {
    let (asleep, place) = hopper(policy);
    let [x, y] = [place.position[0], place.position[1]];
    let high = y + 1.0 + speed * (asleep + wait);
    let grains = vec![grain(0.0, 0.52, DRIFT, 0.0), missile(x, high, 0.0, -speed)];
    let mut simulation = on_a_floor(policy, grains);
    let (_, events) = watch(&mut simulation, &until(asleep + 1.1 * wait));
    let wakes = of_kind(&events, Kind::Wake);
    assert_eq!(wakes.len(), 1);
    close(wakes[0].time.units(), asleep + wait, 1.0e-12, "time");
    wakes[0]
}

#[test]
fn a_sleeper_that_is_woken_soon_gets_its_velocity_back() {
    let policy = SlowDescent {
        sleep_speed: 0.08,
        ..SlowDescent::default()
    };
    // 2 V_sleep / ((1 − α_frozen) g)
    let window = 2.0 * 0.08 / 0.6;
    let (soon, late) = (window - 1.0e-6, window + 1.0e-6);
    // Hit straight from above: drift along the contact stays as it is.
    let given = hit_after(policy, soon, 0.5).other_velocity;
    close(given[0], DRIFT, 1.0e-12, "drift");
    close(given[1], -0.85 * 0.5, 1.0e-12, "down");
    let given = hit_after(policy, late, 0.5).other_velocity;
    close(given[0], 0.0, 1.0e-12, "drift");

    // Or never, or for as long as one likes.
    let off = SlowDescent {
        energy_store: EnergyStore::Off,
        ..policy
    };
    close(
        hit_after(off, soon, 0.5).other_velocity[0],
        0.0,
        1.0e-12,
        "off",
    );
    let long = SlowDescent {
        store_time: Some(1.0),
        ..policy
    };
    let given = hit_after(long, 0.99, 0.5).other_velocity;
    close(given[0], DRIFT, 1.0e-12, "a longer time");

    // As energy: straight down, but faster.
    let energy = SlowDescent {
        energy_store: EnergyStore::EnergyAfter,
        ..policy
    };
    let given = hit_after(energy, soon, 0.5).other_velocity;
    close(given[0], 0.0, 1.0e-12, "across");
    let speed = f64::hypot(0.85 * 0.5, DRIFT);
    close(given[1], -speed, 1.0e-12, "with energy");

    // The velocity that it left its last contact with has an upward part,
    // which makes the hit harder.
    let deciding = SlowDescent {
        store_at: StoreAt::Deciding,
        ..policy
    };
    let (_, place) = hopper(policy);
    let up = (2.0 * (place.position[1] - 0.5)).sqrt();
    assert!(up > 0.01);
    let given = hit_after(deciding, soon, 0.5).other_velocity;
    close(given[0], DRIFT, 1.0e-12, "drift");
    close(given[1], up - 0.85 * (0.5 + up), 1.0e-9, "down");
}

/// A missile at a height that meets the hopper, asleep at `place` since
/// `asleep`, from the side, a time after.
fn from_the_side(place: &Particle<2>, asleep: f64, wait: f64, speed: f64) -> Particle<2> {
    let [x, y] = [place.position[0], place.position[1]];
    missile(x - speed.signum() - speed * (asleep + wait), y, speed, 0.0)
}

#[test]
fn the_woken_compares_with_its_speed_before_the_hit() {
    // Given back its 0.05, and stopped by a hit from ahead, it comes down slower
    // than that: at its first contact it falls asleep again.
    let policy = SlowDescent {
        sleep_speed: 0.08,
        wake_speed: 0.02,
        ..SlowDescent::default()
    };
    let (asleep, place) = hopper(policy);
    for (store, sleeps) in [
        (EnergyStore::VelocityBefore, true),
        (EnergyStore::Off, false),
    ] {
        let policy = SlowDescent {
            energy_store: store,
            ..policy
        };
        let ahead = from_the_side(&place, asleep, 0.1, -0.03);
        let mut simulation = on_a_floor(policy, vec![grain(0.0, 0.52, DRIFT, 0.0), ahead]);
        let (_, events) = watch(&mut simulation, &until(asleep + 0.5));
        let hit = events.iter().position(|event| event.kind == Kind::Wake);
        let landed = |event: &&Occurrence<2>| event.kind == Kind::Wall && event.particle.0 == 0;
        let landing = events[hit.unwrap()..].iter().find(landed).unwrap();
        assert!(landing.impact_speed < 0.02);
        assert_eq!(landing.reason.is_some(), sleeps, "{store:?}");
    }
}

#[test]
fn without_a_collision_left_the_woken_just_goes() {
    // Struck from behind at 0.04, it gets back its 0.05 and is off.
    let policy = SlowDescent {
        sleep_speed: 0.08,
        wake_speed: 0.02,
        ..SlowDescent::default()
    };
    let (asleep, place) = hopper(policy);
    let (wait, speed) = (0.2, 0.04);
    let behind = from_the_side(&place, asleep, wait, speed);
    let mut simulation = on_a_floor(policy, vec![grain(0.0, 0.52, DRIFT, 0.0), behind]);
    let (_, events) = watch(&mut simulation, &until(asleep + 1.01 * wait));
    let event = of_kind(&events, Kind::Wake)[0];
    close(event.time.units(), asleep + wait, 1.0e-10, "time");
    close(
        event.impact_speed,
        speed,
        1.0e-12,
        "before anything is given back",
    );
    assert_eq!(event.impulse, Vector::<2>::zeros());
    assert_eq!(event.velocity, Vector::<2>::new(speed, 0.0));
    close(event.other_velocity[0], DRIFT, 1.0e-14, "given back");
    assert_eq!(simulation.mode_counts().frozen, 0);
}
