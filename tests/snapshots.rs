//! Small runs written out, for people to read what changes when something does.

mod common;

use common::{free, gas_grains, heavy, periodic_laterally, rain_on_base, rule, watch};
use grainfall::boundary::Side;
use grainfall::collide::Restitution;
use grainfall::engine::{Counts, Guards, Limits, Settings, Simulation, StopReason};
use grainfall::model::Occurrence;
use grainfall::policy::SlowDescent;
use grainfall::setup::Sizes;
use grainfall::{Particle, Vector};

const EQUAL: Sizes = Sizes::Equal { diameter: 1.0 };

/// One line an event: time, what, who, how fast, and the speed after.
fn table<const D: usize>(events: &[Occurrence<D>]) -> String {
    let mut text = String::new();
    for event in events {
        let other = match (event.other, event.wall) {
            (Some(id), _) => format!("on {id}"),
            (_, Some(wall)) => format!("on wall {wall}"),
            _ => String::new(),
        };
        let line = format!(
            "{:.6} {:<6} {} {:<9} at {:.6}, leaves with {:.6}",
            event.time,
            event.kind.name(),
            event.particle,
            other,
            event.impact_speed,
            event.velocity.norm(),
        );
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// What a run took, with three figures: the rest is allowed to move with the
/// last bits of the arithmetic.
fn work(counts: &Counts) -> String {
    let rounded = |count: u64| {
        let mut unit = 1;
        while count / unit >= 1000 {
            unit *= 10;
        }
        (count + unit / 2) / unit * unit
    };
    [
        ("pair", counts.pair),
        ("frozen", counts.frozen),
        ("wake", counts.wake),
        ("sleep", counts.sleep),
        ("wall", counts.wall),
        ("elastic", counts.elastic),
        ("transfer", counts.transfer),
        ("guard", counts.guard),
    ]
    .map(|(name, count)| format!("{name} {}\n", rounded(count)))
    .concat()
}

/// Fig. 1: a ball dropped on a floor falls asleep.
#[test]
fn bounce() {
    let policy = SlowDescent {
        wall_supports: true,
        ..SlowDescent::with_threshold(0.01)
    };
    let model = heavy(rule(1.0e-4), policy, [Side::Open, Side::floor(0.0, 0.4)]);
    let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::<2>::zeros());
    let mut simulation = Simulation::new(model, vec![ball]).unwrap();
    let (_, events) = watch(&mut simulation, &Limits::all_frozen());
    insta::assert_snapshot!(table(&events), @r"
    1.000000 wall   0 on wall 0 at 1.000000, leaves with 0.400000
    1.800000 wall   0 on wall 0 at 0.400000, leaves with 0.160000
    2.120000 wall   0 on wall 0 at 0.160000, leaves with 0.064000
    2.248000 wall   0 on wall 0 at 0.064000, leaves with 0.025600
    2.299200 wall   0 on wall 0 at 0.025600, leaves with 0.010240
    2.319680 wall   0 on wall 0 at 0.010240, leaves with 0.004096
    2.327872 wall   0 on wall 0 at 0.004096, leaves with 0.001638
    2.329510 sleep  0           at 0.000000, leaves with 0.000000
    ");
}

/// Fig. 2: two grains wedged between two frozen ones; and the mirror image.
fn arch_of(mirror: f64) -> Vec<Occurrence<2>> {
    let policy = SlowDescent {
        wake_speed: 0.5,
        ..SlowDescent::with_threshold(0.05)
    };
    let model = heavy(rule(1.0e-4), policy, [Side::Open, Side::Open]);
    let at = |x: f64, y: f64| Vector::<2>::new(mirror * x, y);
    let mut grains = vec![
        Particle::frozen(at(-1.296875, 0.0)),
        Particle::new(at(-0.5205078125, 0.6640625), Vector::zeros()),
        Particle::new(at(0.5234375, 0.66015625), Vector::zeros()),
        Particle::frozen(at(1.296875, 0.0)),
    ];
    if mirror < 0.0 {
        grains.reverse();
    }
    let mut simulation = Simulation::new(model, grains).unwrap();
    let (why, events) = watch(&mut simulation, &Limits::all_frozen());
    assert_eq!(why, StopReason::AllFrozen);
    events
}

#[test]
fn arch() {
    let events = arch_of(1.0);
    insta::assert_snapshot!(table(&events), @r"
    0.229276 frozen 2 on 3      at 0.145332, leaves with 0.186616
    0.259929 frozen 1 on 0      at 0.163828, leaves with 0.212174
    0.376563 pair   1 on 2      at 0.335406, leaves with 0.255041
    0.385518 frozen 2 on 3      at 0.257375, leaves with 0.163545
    0.392917 frozen 1 on 0      at 0.235351, leaves with 0.162349
    0.398385 pair   1 on 2      at 0.313947, leaves with 0.123951
    0.402512 frozen 1 on 0      at 0.123874, leaves with 0.054154
    0.408980 frozen 2 on 3      at 0.123635, leaves with 0.051886
    0.434587 pair   1 on 2      at 0.056087, leaves with 0.026411
    0.487729 frozen 2 on 3      at 0.036175, leaves with 0.023258
    0.487960 frozen 1 on 0      at 0.040113, leaves with 0.023533
    0.533577 pair   1 on 2      at 0.045731, leaves with 0.051967
    0.534228 frozen 2 on 3      at 0.044584, leaves with 0.036477
    0.535400 pair   1 on 2      at 0.017787, leaves with 0.059879
    0.535837 frozen 1 on 0      at 0.055843, leaves with 0.031797
    0.535946 pair   1 on 2      at 0.049772, leaves with 0.011761
    0.536159 frozen 1 on 0      at 0.011528, leaves with 0.005357
    0.536738 frozen 2 on 3      at 0.029496, leaves with 0.011825
    0.538577 pair   1 on 2      at 0.010951, leaves with 0.007719
    0.540514 frozen 1 on 0      at 0.005431, leaves with 0.005355
    0.547699 frozen 1 on 0      at 0.002172, leaves with 0.001200
    0.549136 sleep  1           at 0.000000, leaves with 0.000000
    0.553865 frozen 2 on 3      at 0.005967, leaves with 0.007628
    0.556029 sleep  2           at 0.000000, leaves with 0.000000
    ");

    // The other way round it is the other one that sleeps first: each takes the
    // other's part, at the same instants.
    let mirrored = arch_of(-1.0);
    assert_eq!(events.len(), mirrored.len());
    for (one, two) in events.iter().zip(&mirrored) {
        assert_eq!((one.kind, one.time), (two.kind, two.time));
        let names = |event: &Occurrence<2>, name: fn(u32) -> u32| {
            let mut names = vec![name(event.particle.0)];
            names.extend(event.other.map(|id| name(id.0)));
            names.sort_unstable();
            names
        };
        assert_eq!(names(one, |id| id), names(two, |id| 3 - id));
    }
}

#[test]
fn work_of_a_deposition() {
    let model = heavy(
        rule(1.0e-3),
        SlowDescent::default(),
        periodic_laterally::<3>(6.0),
    );
    let mut simulation = Simulation::new(model, rain_on_base::<3>(1, 200, 6.0, EQUAL)).unwrap();
    simulation.run(&Limits::all_frozen(), &mut ());
    insta::assert_snapshot!(work(simulation.counts()), @r"
    pair 86500
    frozen 278000
    wake 7450
    sleep 7650
    wall 0
    elastic 215000
    transfer 1670
    guard 536
    ");
}

#[test]
fn work_of_a_gas() {
    let (grains, sides) = gas_grains::<3>(1, 300, 0.3, EQUAL);
    let mut simulation = Simulation::new(free(Restitution::elastic(), sides), grains).unwrap();
    simulation.run(&Limits::events(30_000), &mut ());
    insta::assert_snapshot!(work(simulation.counts()), @r"
    pair 30000
    frozen 0
    wake 0
    sleep 0
    wall 0
    elastic 0
    transfer 16800
    guard 0
    ");
}

/// Fig. 1 without remedies: the collapse says who.
#[test]
fn collapse() {
    let policy = SlowDescent::with_threshold(0.0);
    let model = heavy(rule(0.0), policy, [Side::Open, Side::floor(0.0, 0.4)]);
    let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::<2>::zeros());
    let settings = Settings {
        guards: Guards {
            collapse: Some(1000),
            ..Guards::none()
        },
        ..Settings::default()
    };
    let mut simulation = Simulation::with_settings(model, vec![ball], settings).unwrap();
    let why = simulation.run(&Limits::default(), &mut ());
    let StopReason::Collapse(collapse) = why else {
        panic!("{why:?}");
    };
    let told = format!(
        "{:.9}: {} collisions of {:?}",
        collapse.time, collapse.collisions, collapse.particles
    );
    insta::assert_snapshot!(told, @"2.333333333: 1000 collisions of [ParticleId(0)]");
}
