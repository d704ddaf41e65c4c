//! Sleepers that are told the instant at which they lose their support.

use crate::common::{close, hash, rule, until, watch};
use crate::{DOWN, filled, model, policy};
use grainfall::boundary::Cuboid;
use grainfall::dynamics::{Trochoid, TurningGravity, TurningGround};
use grainfall::engine::{Limits, Simulation, StopReason};
use grainfall::model::{Dynamics, OccurrenceKind, Parts};
use grainfall::observe::TrajectoryHash;
use grainfall::policy::{Phase, SelfCheck, SlowDescent, Timing};
use grainfall::predict::Turning;
use grainfall::{Mode, Particle, ParticleId, Vector};

pub(crate) fn with_events() -> SlowDescent {
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
