//! Planted faults: each has to be seen, and called by its name.

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::leaning::Leaning;
use crate::engine::settings::Limits;
use crate::engine::simulation::Simulation;
use crate::engine::slot::Partner;
use crate::model::Parts;
use crate::particle::{Mode, Particle, ParticleId, Vector};
use crate::policy::{SelfCheck, SlowDescent};
use crate::predict::Polynomial;
use crate::time::Time;

type Heap =
    Simulation<Parts<UniformGravity<2>, Polynomial, Restitution, SlowDescent, Cuboid<2>>, 2>;

/// A rain on a row of fixed grains, when about half have come to rest.
fn heap() -> Heap {
    let model = Parts {
        dynamics: UniformGravity::<2>::down(),
        predictor: Polynomial,
        collision_rule: Restitution {
            elastic_speed: 1.0e-2,
            ..Restitution::default()
        },
        state_policy: SlowDescent {
            self_check: Some(SelfCheck::default()),
            ..SlowDescent::with_threshold(0.3)
        },
        boundary: Cuboid::new([Side::periodic(6.0), Side::Open]).unwrap(),
    };
    let mut grains: Vec<Particle<2>> = (0..5)
        .map(|i| Particle::fixed(Vector::<2>::new(1.2 * f64::from(i), 0.0)))
        .collect();
    grains.extend((0..30).map(|i| {
        let place = Vector::<2>::new(1.3 * f64::from(i % 4) + 0.01 * f64::from(i), 0.0);
        let height = Vector::<2>::new(0.0, 1.5 + 1.1 * f64::from(i / 4));
        Particle::new(place + height, Vector::<2>::zeros())
    }));
    let mut simulation = Simulation::new(model, grains).unwrap();
    while simulation.mode_counts().frozen < 5 {
        let one_more = simulation.counts().total() + 1;
        simulation.run(&Limits::events(one_more), &mut ());
    }
    simulation
}

/// A grain of this mode; the last, so that it is not fixed to the ground.
fn one(heap: &Heap, mode: Mode) -> u32 {
    let bodies = &heap.world.bodies;
    bodies.iter().rposition(|body| body.mode == mode).unwrap() as u32
}

#[track_caller]
fn seen(heap: &Heap, name: &str) {
    let fault = heap.check_everything().expect_err("nothing was seen");
    assert!(fault.contains(name), "{fault}, not {name}");
}

#[test]
fn a_sound_heap_passes() {
    assert_eq!(heap().check_everything(), Ok(()));
}

#[test]
fn faults_of_the_queue_are_seen() {
    let sound = heap();
    let mover = one(&sound, Mode::Normal);

    let mut heap = heap();
    heap.slots.make(mover).contact = heap.world.clock + 1.0e-9;
    heap.slots.make(mover).partner = Partner::Particle(0);
    seen(&heap, " is filed ");

    let mut heap = sound;
    let slots = heap.slots.clone();
    let known = |particle: u32| slots[particle].key(particle);
    let (first, soonest) = heap.queue.peek(known).unwrap();
    let mut late = soonest;
    late.time = soonest.time + 1.0;
    let fault = heap.queue.check_entry(first, late).unwrap_err();
    assert!(fault.contains("is filed as"), "{fault}");
    late.time = Time::NEVER;
    let fault = heap.queue.check_entry(first, late).unwrap_err();
    assert!(fault.contains("without an entry"), "{fault}");
}

#[test]
fn faults_of_entries_are_seen() {
    let sound = heap();
    let (mover, sleeper) = (one(&sound, Mode::Normal), one(&sound, Mode::Frozen));

    let mut late = heap();
    late.slots.make(mover).sleep = Time::ZERO;
    seen(&late, "was due at");

    let mut lonely = heap();
    lonely.slots.make(mover).contact = lonely.world.clock + 1.0;
    lonely.slots.make(mover).partner = Partner::Nobody;
    seen(&lonely, "meets nobody");
    lonely.slots.make(mover).partner = Partner::Particle(mover);
    seen(&lonely, "meets itself");
    lonely.slots.make(mover).partner = Partner::Particle(99);
    seen(&lonely, "who is not there");

    let mut restless = heap();
    restless.slots.make(sleeper).sleep = restless.world.clock + 1.0;
    seen(&restless, "is static and waits");
}

#[test]
fn faults_of_lists_are_seen() {
    let sound = heap();
    let mover = (0..sound.world.bodies.len() as u32)
        .find(|&particle| {
            let mut list = sound.world.near.list(particle);
            list.any(|found| sound.world.near.is_tied(found.particle))
        })
        .unwrap();

    let mut one_sided = heap();
    let listed: Vec<_> = one_sided.world.near.list(mover).collect();
    let both = listed
        .iter()
        .find(|found| one_sided.world.near.is_tied(found.particle))
        .unwrap();
    one_sided.world.near.forget(mover, both.particle);
    seen(&one_sided, "does not list");
    one_sided.world.near.forget(both.particle, mover);
    seen(&one_sided, "does not list");

    let mut absent = heap();
    let sleeper = one(&absent, Mode::Frozen);
    let watcher = (0..absent.world.bodies.len() as u32)
        .find(|&particle| {
            let mut list = absent.world.near.list(particle);
            list.any(|found| found.particle == sleeper)
        })
        .unwrap();
    loop {
        if absent.world.near.forget_first(watcher) == sleeper {
            break;
        }
    }
    seen(&absent, "list");

    let mut loose = heap();
    let place = loose.world.bodies[mover as usize].position;
    loose.world.near.release(mover, &place, 0.5);
    seen(&loose, "list");

    let mut misfiled = heap();
    // Another cell of the same image.
    let up = if place[1] < 5.0 { 5.0 } else { -5.0 };
    let elsewhere = place + Vector::<2>::new(0.0, up);
    misfiled.world.near.misfile(mover, &elsewhere);
    seen(&misfiled, "sits in cell");
}

#[test]
fn faults_of_states_are_seen() {
    let sound = heap();
    let (mover, sleeper) = (one(&sound, Mode::Normal), one(&sound, Mode::Frozen));

    let mut miscounted = heap();
    miscounted.world.modes.frozen -= 1;
    miscounted.world.modes.normal += 1;
    seen(&miscounted, "grains are normal, not");
    miscounted.world.modes.normal += 1;
    seen(&miscounted, "modes for");

    let mut strayed = heap();
    strayed.world.bodies[mover as usize].position[1] += 3.0;
    seen(&strayed, "on a leash of");

    let mut ahead = heap();
    ahead.world.bodies[mover as usize].since = ahead.world.clock + 1.0;
    seen(&ahead, "is ahead");

    let mut nowhere = heap();
    nowhere.world.bodies[mover as usize].velocity[0] = f64::NAN;
    seen(&nowhere, "is nowhere");

    let mut restless = heap();
    restless.world.bodies[sleeper as usize].still = false;
    seen(&restless, "is thought still");

    let mut short = heap();
    short.spins.pop();
    seen(&short, "spins for");
}

#[test]
fn faults_of_memories_and_of_the_policys_events_are_seen() {
    let sound = heap();
    let (mover, sleeper) = (one(&sound, Mode::Normal), one(&sound, Mode::Frozen));

    let mut confused = heap();
    let slept = confused.memories[sleeper].clone();
    *confused.memories.make(mover) = slept;
    seen(&confused, "it remembers");

    let mut overdue = heap();
    let mut alarm = overdue.alarms.pop().unwrap();
    alarm.0.key.time = Time::ZERO;
    overdue.alarms.push(alarm);
    seen(&overdue, "an event of the policy");
}

#[test]
fn an_audit_sees_what_is_missed() {
    let mut heap = heap();
    assert_eq!(heap.audit().missed, []);
    let meeting = |heap: &Heap| {
        let mut slots = heap.slots.each();
        let meeting = slots.find(|(_, slot)| slot.contact < slot.renewal);
        meeting.map(|(id, slot)| (id, slot.partner))
    };
    let (mover, partner) = meeting(&heap).unwrap();
    // Whoever it meets does not know of it either.
    for id in 0..heap.slots.len() as u32 {
        let slot = heap.slots.make(id);
        if id == mover || partner == Partner::Particle(id) || slot.partner == partner {
            slot.contact = Time::NEVER;
            slot.partner = Partner::Nobody;
        }
    }
    let missed = heap.audit().missed;
    let named = missed.iter().any(|missed| {
        missed.particle.0 == mover || missed.other.is_some_and(|other| other.0 == mover)
    });
    assert!(named, "{missed:?}");
}

#[test]
#[should_panic(expected = "inconsistent at")]
fn a_run_stops_at_a_fault() {
    let mut heap = heap();
    let sleeper = one(&heap, Mode::Frozen);
    heap.world.bodies[sleeper as usize].still = false;
    let one_more = heap.counts().total() + 1;
    heap.run(&Limits::events(one_more), &mut ());
}

#[test]
fn edges_of_the_support_graph() {
    let leaning = || {
        let mut heap = heap();
        let (sleeper, fixed) = (one(&heap, Mode::Frozen), one(&heap, Mode::Fixed));
        heap.commands
            .lean_on(ParticleId(sleeper), ParticleId(fixed));
        heap.schedule();
        heap.assert_consistent();
        (heap, sleeper)
    };
    // One who is awake leans.
    let (mut heap, sleeper) = leaning();
    let saved = heap.leaning.save();
    heap.let_go(sleeper);
    let awake = one(&heap, Mode::Normal);
    let mut edges = vec![Vec::new(); saved.len().max(awake as usize + 1)];
    edges[awake as usize] = saved[sleeper as usize].clone();
    let count = heap.world.bodies.len();
    heap.leaning = Leaning::restore(edges, count).unwrap();
    seen(&heap, "is awake and leans");
    // What is read is checked.
    let refused = |edges| Leaning::restore(edges, count).unwrap_err();
    let edge = saved[sleeper as usize][0];
    assert!(refused(vec![Vec::new(); count + 1]).contains("not there"));
    assert!(refused(vec![vec![edge, edge]]).contains("out of order"));
    assert!(refused(vec![vec![edge]]).contains("not there"));
}
