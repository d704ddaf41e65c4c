//! Drums: how they are made, gravity that turns, and ground that does.

mod common;

use common::{close, hash, rule, until, watch};
use grainfall::boundary::{Cuboid, Side};
use grainfall::dynamics::{Trochoid, TurningGravity, TurningGround};
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Dynamics, OccurrenceKind, Parts, StatePolicy};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{Never, Phase, SelfCheck, SlowDescent, Timing};
use grainfall::predict::Turning;
use grainfall::setup::{Drum, seeded};
use grainfall::{Mode, Particle, ParticleId, SetupError, Vector};

type Turned<Y, S> = Parts<Y, Turning, grainfall::collide::Restitution, S, Cuboid<2>>;

fn model<Y: Dynamics<2, Flight = Trochoid<2>>, S: StatePolicy<2>>(
    dynamics: Y,
    policy: S,
) -> Turned<Y, S> {
    Parts {
        dynamics,
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: policy,
        boundary: Cuboid::new([Side::Open, Side::Open]).unwrap(),
    }
}

fn policy() -> SlowDescent {
    SlowDescent {
        self_check: Some(SelfCheck::default()),
        ..SlowDescent::with_threshold(0.2)
    }
}

fn ring() -> Vec<Particle<2>> {
    let drum = Drum {
        radius: 5.0,
        rings: 1,
        ..Drum::default()
    };
    drum.wall::<2>().unwrap()
}

fn filled() -> Vec<Particle<2>> {
    let drum = Drum {
        radius: 5.0,
        rings: 1,
        ..Drum::default()
    };
    drum.grains::<2>(&mut seeded(3)).unwrap()
}

const DOWN: Vector<2> = Vector::<2>::new(0.0, -1.0);

#[test]
fn the_paper_s_wall_has_785_grains() {
    let wall = Drum::default().wall::<3>().unwrap();
    assert_eq!(wall.len(), 5 * 157);
    close(Drum::default().length(), 5.25, 1.0e-12, "length");
    for grain in &wall {
        let [x, y, z] = [grain.position.x, grain.position.y, grain.position.z];
        close(x.hypot(z), 25.0, 1.0e-12, "radius");
        assert!(grain.mode == Mode::Fixed && (0.0..5.25).contains(&y));
    }
    // Neighbours along the ring are an arc of 1.0005 apart.
    let arc = 2.0 * (0.5 * (wall[1].position - wall[0].position).norm() / 25.0).asin() * 25.0;
    close(arc, 1.0005, 1.0e-4, "arc");
}

#[test]
fn a_filling_sleeps_up_to_its_level() {
    let drum = Drum {
        radius: 6.0,
        rings: 3,
        level: -1.0,
        ..Drum::default()
    };
    let grains = drum.grains::<3>(&mut seeded(1)).unwrap();
    let filling = &grains[drum.wall::<3>().unwrap().len()..];
    for grain in filling {
        let [x, z] = [grain.position.x, grain.position.z];
        assert!(grain.mode == Mode::Frozen && z <= -1.0 && x.hypot(z) < 5.5);
    }
    // The segment of the inner circle below the level, at a random packing.
    let inner = 5.5_f64;
    let half_angle = (1.0 / inner).acos();
    let area = inner * inner * (half_angle - half_angle.sin() * half_angle.cos());
    let solid = filling.len() as f64 * core::f64::consts::PI / 6.0;
    let fraction = solid / (area * drum.length());
    assert!((0.5..0.66).contains(&fraction), "{fraction}");
    // The engine finds no overlap.
    let sides = [Side::Open, Side::periodic(drum.length()), Side::Open];
    let model = Parts {
        dynamics: TurningGravity::<3>::new(-Vector::z(), 0.1, [0, 2]),
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: Never,
        boundary: Cuboid::new(sides).unwrap(),
    };
    Simulation::new(model, grains).unwrap();
}

#[test]
fn drums_through_which_grains_would_slip_are_refused() {
    let refused = |drum: Drum, name: &str| {
        let Err(SetupError::Parameter { field, .. }) = drum.wall::<3>() else {
            panic!("{drum:?}");
        };
        assert_eq!(field, name);
    };
    let drum = Drum::default();
    refused(
        Drum {
            arc_spacing: 1.9,
            ..drum.clone()
        },
        "arc_spacing",
    );
    refused(
        Drum {
            ring_spacing: f64::NAN,
            ..drum.clone()
        },
        "ring_spacing",
    );
    refused(
        Drum {
            radius: 1.0,
            ..drum.clone()
        },
        "radius",
    );
    refused(Drum { rings: 1, ..drum }, "rings");
}

/// A grain that flies and bounces in a ring, while gravity turns.
fn thrown<Y: Dynamics<2, Flight = Trochoid<2>>>(dynamics: Y) -> (Vector<2>, usize) {
    let mut grains = ring();
    let start = Vector::<2>::new(0.3, 1.0);
    grains.push(Particle::new(start, Vector::<2>::new(0.4, 0.0)));
    let mut simulation = Simulation::new(model(dynamics, Never), grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(7.0));
    let last = simulation.snapshot().pop().unwrap();
    (last.position, events.len())
}

#[test]
fn steps_converge_at_first_order() {
    let gravity = TurningGravity::new(DOWN, 0.4, [0, 1]);
    let (exact, bounces) = thrown(gravity);
    assert!(bounces >= 2, "{bounces}");
    let off = |step: f64| (thrown(gravity.in_steps(step)).0 - exact).norm();
    let errors: Vec<f64> = [0.02, 0.01, 0.005, 0.0025, 0.00125].map(off).to_vec();
    println!("errors of steps from 0.02, halved four times: {errors:?}");
    for pair in errors.windows(2).skip(2) {
        let ratio = pair[0] / pair[1];
        assert!((1.9..2.1).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn what_is_carried_stays_on_its_circle() {
    let centre = Vector::<2>::new(1.0, 2.0);
    let ground = TurningGround::new(DOWN, 0.7, [0, 1], centre);
    let mut grain = Particle::fixed(Vector::<2>::new(4.0, -2.0));
    grain.mode = Mode::Frozen;
    let mut simulation = Simulation::new(model(ground, Never), vec![grain]).unwrap();
    let time = 1000.0;
    simulation.run(&until(time), &mut ());
    let grain = simulation.snapshot()[0];
    let (sin, cos) = libm::sincos(0.7 * time);
    let place = centre + Vector::<2>::new(3.0 * cos + 4.0 * sin, 3.0 * sin - 4.0 * cos);
    close((grain.position - place).norm(), 0.0, 1.0e-11, "place");
    let radius = grain.position - centre;
    let speed = Vector::<2>::new(-0.7 * radius.y, 0.7 * radius.x);
    close((grain.velocity - speed).norm(), 0.0, 1.0e-11, "velocity");
}

/// The first contact of a grain thrown across a drum that turns, against the
/// distances of its parabola from the circles of the wall's grains, step by step.
#[test]
fn a_wall_that_turns_is_met_where_it_is() {
    let rate = -0.9;
    let ground = TurningGround::new(DOWN, rate, [0, 1], Vector::<2>::zeros());
    let mut grains = ring();
    let wall = grains.clone();
    let (start, velocity) = (Vector::<2>::new(-1.0, 0.5), Vector::<2>::new(2.0, 1.5));
    grains.push(Particle::new(start, velocity));
    let mut simulation = Simulation::new(model(ground, Never), grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(5.0));
    let gap = |time: f64| {
        let place = start + velocity * time + DOWN * (0.5 * time * time);
        let (sin, cos) = libm::sincos(rate * time);
        let apart = wall.iter().map(|grain| {
            let (x, y) = (grain.position.x, grain.position.y);
            (place - Vector::<2>::new(x * cos - y * sin, x * sin + y * cos)).norm() - 1.0
        });
        apart.fold(f64::INFINITY, f64::min)
    };
    let first = events.first().unwrap();
    assert_eq!(first.kind, OccurrenceKind::Frozen);
    let time = first.time.units();
    close(gap(time), 0.0, 1.0e-13, "gap");
    for step in 0..10_000 {
        assert!(gap(time * f64::from(step) / 10_000.0) > 0.0);
    }
}

/// The other way round, left is right and right is left, to the last bit.
#[test]
fn mirrored_drums_turn_the_other_way() {
    let mirrored = |position: Vector<2>| Vector::<2>::new(-position.x, position.y);
    let grains = filled();
    let mut other = grains.clone();
    for grain in &mut other {
        grain.position = mirrored(grain.position);
    }
    let run = |policy: SlowDescent, rate: f64, grains: &[Particle<2>], end: f64| {
        let gravity = TurningGravity::new(DOWN, rate, [0, 1]);
        let model = model(gravity, policy);
        let mut simulation = Simulation::new(model, grains.to_vec()).unwrap();
        let (_, events) = watch(&mut simulation, &until(end));
        (simulation.snapshot(), events)
    };
    for (policy, end) in [(policy(), 12.0), (with_events(), 6.0)] {
        let (here, events) = run(policy, 0.25, &grains, end);
        let (there, mirrored_events) = run(policy, -0.25, &other, end);
        assert!(
            events
                .iter()
                .any(|event| event.kind == OccurrenceKind::CheckWake)
        );
        assert!(events.len() > 1000);
        assert_eq!(events.len(), mirrored_events.len());
        for (event, other) in events.iter().zip(&mirrored_events) {
            assert_eq!(
                (event.kind, event.particle, event.other),
                (other.kind, other.particle, other.other)
            );
            assert_eq!(event.time, other.time);
        }
        for (grain, other) in here.iter().zip(&there) {
            assert_eq!(grain.position, mirrored(other.position));
        }
    }
}

/// Who is called the first changes nothing: each grain's speeds count from the
/// ground where it is itself.
#[test]
fn names_do_not_matter_where_the_ground_turns() {
    let mut grains = filled();
    for (place, grain) in grains.iter_mut().enumerate() {
        if grain.mode == Mode::Frozen && place % 2 == 0 {
            grain.mode = Mode::Normal;
        }
    }
    let last = grains.len() as u32 - 1;
    let run = |grains: Vec<Particle<2>>| {
        let ground = TurningGround::new(DOWN, 0.4, [0, 1], Vector::<2>::zeros());
        let policy = SlowDescent::with_threshold(0.2);
        let mut simulation = Simulation::new(model(ground, policy), grains).unwrap();
        let (_, events) = watch(&mut simulation, &until(3.0));
        let sleeps = events.iter().filter(|e| e.kind == OccurrenceKind::Sleep);
        let sleeps: Vec<(u32, _)> = sleeps.map(|e| (e.particle.0, e.time)).collect();
        (simulation.snapshot(), sleeps)
    };
    let (here, sleeps) = run(grains.clone());
    grains.reverse();
    let (mut there, other_sleeps) = run(grains);
    there.reverse();
    assert!(sleeps.len() > 20, "{}", sleeps.len());
    for (sleep, other) in sleeps.iter().zip(&other_sleeps) {
        assert_eq!((sleep.0, sleep.1), (last - other.0, other.1));
    }
    for (grain, other) in here.iter().zip(&there) {
        assert_eq!(grain.position, other.position);
    }
}

fn with_events() -> SlowDescent {
    let check = SelfCheck {
        timing: Timing::Events,
        ..SelfCheck::default()
    };
    SlowDescent {
        self_check: Some(check),
        ..policy()
    }
}

/// When a grain wakes that sleeps on a fixed one, at `offset` from it; by the clock
/// of the self-check it is the next tick.
fn perch_wakes<Y, const D: usize>(dynamics: Y, offset: Vector<D>) -> Option<f64>
where
    Y: Dynamics<D, Flight = Trochoid<D>> + Copy,
{
    let found = perch_wakes_by(with_events(), dynamics, offset);
    let check = SelfCheck {
        interval: 0.03,
        phase: Phase::Own,
        ..SelfCheck::default()
    };
    let clock = SlowDescent {
        self_check: Some(check),
        ..policy()
    };
    let polled = perch_wakes_by(clock, dynamics, offset);
    assert_eq!(found.is_some(), polled.is_some());
    let late = polled.unwrap_or(0.0) - found.unwrap_or(0.0);
    assert!((-1.0e-9..0.031).contains(&late), "{late}");
    found
}

fn perch_wakes_by<Y, const D: usize>(
    policy: SlowDescent,
    dynamics: Y,
    offset: Vector<D>,
) -> Option<f64>
where
    Y: Dynamics<D, Flight = Trochoid<D>>,
{
    let model = Parts {
        dynamics,
        predictor: Turning,
        collision_rule: rule(1.0e-3),
        state_policy: policy,
        boundary: Cuboid::<D>::open(),
    };
    let mut sleeper = Particle::fixed(offset);
    sleeper.mode = Mode::Frozen;
    let grains = vec![Particle::fixed(Vector::zeros()), sleeper];
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (_, events) = watch(&mut simulation, &until(16.0));
    let first = events.first()?;
    assert_eq!(first.kind, OccurrenceKind::CheckWake);
    Some(first.time.units())
}

/// A perch holds as long as gravity has any part towards the support.
#[test]
fn a_perch_is_left_at_the_instant_at_which_gravity_leaves_it() {
    use core::f64::consts::PI;
    for (lean, rate) in [(0.3_f64, 0.25), (0.3, -0.25), (-1.2, 0.25), (1.5, 1.0)] {
        // To the right by `lean`, in radians. Gravity has to turn as far as the
        // perch leans less than a right angle, on the side to which it turns.
        let (sin, cos) = libm::sincos(lean);
        let offset = Vector::<2>::new(1.01 * sin, 1.01 * cos);
        let wanted = (0.5 * PI - f64::signum(rate) * lean) / f64::abs(rate);
        let gravity = TurningGravity::new(DOWN, rate, [0, 1]);
        let found = perch_wakes(gravity, offset).unwrap();
        close(found, wanted, 1.0e-11 / f64::abs(rate), "gravity turns");
        // Ground that turns the other way.
        let ground = TurningGround::new(DOWN, -rate, [0, 1], Vector::<2>::new(3.0, -7.0));
        let found = perch_wakes(ground, offset).unwrap();
        close(found, wanted, 1.0e-11 / f64::abs(rate), "the ground turns");
        // Steps: the first that turns it as far.
        let step = 0.07;
        let found = perch_wakes(gravity.in_steps(step), offset).unwrap();
        let wanted = step * f64::ceil(wanted / step);
        close(found, wanted, 1.0e-12, "it turns in steps");
    }
    // In space, with a part of gravity along the axis about which it turns: the
    // rest is left where cos θ is -1/2, or never.
    let gravity = Vector::<3>::new(0.0, -0.6, -1.2);
    let turning = TurningGravity::new(gravity, 0.5, [0, 2]);
    let offset = Vector::<3>::new(0.0, 1.0, 1.0) * 0.71;
    let found = perch_wakes(turning, offset).unwrap();
    close(found, 4.0 * PI / 3.0, 1.0e-11, "in space");
    let offset = Vector::<3>::new(0.0, 1.0, 0.45) * 0.92;
    assert_eq!(perch_wakes(turning, offset), None);
}

/// Stopped, written down and gone on from, a drum whose sleepers wait for what is
/// foreseen is the same drum.
#[test]
fn with_events_a_drum_goes_on_as_if_never_stopped() {
    let model = || model(TurningGravity::new(DOWN, 0.25, [0, 1]), with_events());
    let start = || Simulation::new(model(), filled()).unwrap();
    let mut straight = start();
    let wanted = hash(&mut straight, &until(4.0));
    let mut resumed = start();
    let mut trajectory = TrajectoryHash::new();
    let bytes = |simulation: &Simulation<_, 2>| postcard::to_stdvec(&simulation.save()).unwrap();
    // In the middle of cascades, too: between any two events.
    let mut waiting = 0;
    for events in 1.. {
        let limits = Limits {
            events: 29 * events,
            ..until(4.0)
        };
        let why = resumed.run(&limits, &mut trajectory);
        let saved = bytes(&resumed);
        resumed = Simulation::restore(model(), postcard::from_bytes(&saved).unwrap()).unwrap();
        assert!(saved == bytes(&resumed));
        waiting += u32::from(resumed.supporters(ParticleId(40)).count() > 0);
        if why == StopReason::Time {
            break;
        }
    }
    assert!(waiting > 0);
    assert_eq!(trajectory.value(), wanted);
    assert_eq!(resumed.counts(), straight.counts());
    assert!(bytes(&resumed) == bytes(&straight));
}

/// The first wakes of a filling that has slept until now.
fn first_wakes(check: SelfCheck, start: &[Particle<2>], count: usize) -> Vec<(u32, f64)> {
    let policy = SlowDescent {
        self_check: Some(check),
        ..policy()
    };
    let gravity = TurningGravity::new(DOWN, 0.25, [0, 1]);
    let mut simulation = Simulation::new(model(gravity, policy), start.to_vec()).unwrap();
    let mut wakes = Vec::new();
    while wakes.len() < count {
        let more = simulation.counts().total() + 1;
        let (_, events) = watch(&mut simulation, &Limits::events(more));
        let woken = events
            .iter()
            .filter(|e| e.kind == OccurrenceKind::CheckWake);
        wakes.extend(woken.map(|event| (event.particle.0, event.time.units())));
    }
    wakes
}

/// From one state the first wakes of the clock, ticking ever faster, tend to those
/// of the events: the same grains, and times that are off by less than a few ticks,
/// one for each step of a cascade.
#[test]
fn the_first_wakes_of_events_are_the_limit_of_the_clocks() {
    let grains = filled();
    let sorted = |check| {
        let mut wakes = first_wakes(check, &grains, 20);
        wakes.sort_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
        wakes
    };
    let events = sorted(SelfCheck {
        timing: Timing::Events,
        ..SelfCheck::default()
    });
    // The clock plays no part in them.
    assert_eq!(
        events,
        sorted(SelfCheck {
            timing: Timing::Events,
            interval: 7.0,
            ..SelfCheck::default()
        })
    );
    for tick in [1.0 / 2048.0, 1.0 / 4096.0, 1.0 / 8192.0] {
        let polled = sorted(SelfCheck {
            interval: tick,
            phase: Phase::Own,
            ..SelfCheck::default()
        });
        for (event, poll) in events.iter().zip(&polled) {
            assert_eq!(event.0, poll.0);
            let late = poll.1 - event.1;
            assert!((0.0..4.0 * tick).contains(&late), "{event:?}, {poll:?}");
        }
    }
}

/// Pinned: a change of these is a change of the physics, or of a last digit.
#[test]
fn pinned_drums() {
    let mut gravity = {
        let gravity = TurningGravity::new(DOWN, 0.25, [0, 1]);
        Simulation::new(model(gravity, policy()), filled()).unwrap()
    };
    let mut ground = {
        let ground = TurningGround::new(DOWN, -0.25, [0, 1], Vector::<2>::zeros());
        Simulation::new(model(ground, policy()), filled()).unwrap()
    };
    let found = [
        hash(&mut gravity, &until(10.0)),
        hash(&mut ground, &until(10.0)),
    ];
    let text = found.map(|hash| format!("{hash:016x}"));
    assert_eq!(text, ["ca369dada54737c7", "8f7f2d837d880a22"]);
}
